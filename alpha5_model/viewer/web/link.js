// A link restores what a person has changed: the entries of the state behind the # of the address, in SI units and rad.
//
// What stands in a link was written by anybody: it is taken whole or refused whole, with a message.
const LONGEST_LINK = 2000; // characters
const FARTHEST = NEAR / 1e3; // m, of a target or a camera
const NUMBER = /^-?\d+(\.\d+)?(e-?\d+)?$/;

// The numbers of an entry, or an error; `ranges` has the least and the most of each.
function linkNumbers(name, text, ranges) {
  const parts = text.split(",");
  const numbers = parts.map(Number);
  if (numbers.length !== ranges.length) throw new RangeError(`${name} needs ${ranges.length} numbers`);
  const wrong = parts.findIndex((part, i) => !NUMBER.test(part) || numbers[i] < ranges[i][0] || numbers[i] > ranges[i][1]);
  if (wrong >= 0) {
    const [low, high] = ranges[wrong].map((end) => fixed(end, 3));
    throw new RangeError(`number ${wrong + 1} of ${name} must lie between ${low} and ${high}`);
  }
  return numbers;
}
function linkWords(name, text, known) {
  const words = text.split(",").filter(Boolean);
  const other = words.find((word) => !known.includes(word));
  if (other !== undefined) throw new RangeError(`${name} takes ${known.join(", ")}`);
  return words;
}
// Limits of torques, null for "none".
function linkLimits(name, text) {
  const parts = text.split(",");
  const numbers = linkNumbers(name, parts.map((part) => part === "none" ? "0" : part).join(","), state.limits.map(() => [0, STRONGEST]));
  return numbers.map((limit, i) => parts[i] === "none" ? null : limit);
}
const within = (end, count = 3) => Array.from({ length: count }, () => [-end, end]);
// Limits of joints are written with all digits, but an angle of a link may be rounded.
const withinLimits = () => joints.map((joint) => [joint.lower - 1e-9, joint.upper + 1e-9]);

// Entry -> [its text now, or null if there is none; what a text says; how that is carried out].
const LINKED = {
  fluid: [() => [state.density], (name, text) => linkNumbers(name, text, [[0, DENSEST]])[0], (density) => change({ density })],
  current: [() => state.current, (name, text) => linkNumbers(name, text, within(FASTEST)), (current) => change({ current })],
  payload: [
    () => [state.payload.mass, ...state.payload.com, state.payload.volume],
    (name, text) => linkNumbers(name, text, [[0, HEAVIEST], ...within(FARTHEST), [0, LARGEST]]),
    ([mass, x, y, z, volume]) => change({ payload: { mass, com: [x, y, z], volume } }),
  ],
  limits: [
    () => state.limits.some((limit) => limit !== null) ? state.limits.map((limit) => limit ?? "none") : null,
    linkLimits,
    (limits) => change({ limits }),
  ],
  mount: [
    () => data.fixed ? state.attitude : null,
    (name, text) => linkNumbers(name, text, within(Math.PI, data.fixed ? 2 : 0)),
    (attitude) => change({ attitude }),
  ],
  show: [
    () => Object.keys(shown).filter((name) => shown[name]),
    (name, text) => linkWords(name, text, Object.keys(shown)),
    (words) => { for (const name in shown) setGroup(name, words.includes(name)); },
  ],
  units: [() => [state.degrees ? "deg" : "rad"], (name, text) => linkWords(name, text, ["deg", "rad"])[0], (word) => change({ degrees: word !== "rad" })],
  guard: [() => [state.guard ? "stop" : "warn"], (name, text) => linkWords(name, text, ["stop", "warn"])[0], (word) => change({ guard: word === "stop" })],
  q: [() => joints.map((joint) => q[joint.name]), (name, text) => linkNumbers(name, text, withinLimits()), (values) => setPose(values, "page")],
  target: [
    () => state.aim,
    (name, text) => linkNumbers(name, text, within(FARTHEST)),
    (point) => { change({ aim: point }); fill(); showSolutions(); },
  ],
  view: [
    () => state.view ? [state.view] : [...unswap(viewer.camera.position).toArray(), ...unswap(viewer.controls.target).toArray()],
    (name, text) => Object.hasOwn(data.views, text) ? text : linkNumbers(name, text, within(FARTHEST, 6)),
    (view) => {
      if (typeof view === "string") return look(view, false);
      change({ view: null });
      moveCamera(vector(view.slice(0, 3)), vector(view.slice(3)));
    },
  ],
};

// The state as the part of a link behind the #.
function linkText() {
  const texts = Object.entries(LINKED).map(([name, [values]]) => [name, values()]);
  return texts.filter(([, values]) => values).map(([name, values]) => `${name}=${values.join(",")}`).join("&");
}
// Restore the state of a link's part behind the #; returns what is wrong with it, or nothing.
function restore(text) {
  try {
    if (text.length > LONGEST_LINK) throw new RangeError(`it has more than ${LONGEST_LINK} characters`);
    const given = new Map();
    for (const part of text.split("&")) {
      const [name, value, ...more] = part.split("=");
      if (!Object.hasOwn(LINKED, name) || value === undefined || more.length || given.has(name)) {
        throw new RangeError(`it holds ${Object.keys(LINKED).join(", ")}, each once`);
      }
      given.set(name, LINKED[name][1](name, decodeURIComponent(value)));
    }
    for (const name in LINKED) if (given.has(name)) LINKED[name][2](given.get(name));
  } catch (error) {
    return `The link cannot be read: ${error instanceof URIError ? "it is damaged" : error.message}.`;
  }
  return "";
}
function openLink() {
  if (location.hash.length > 1) say("link", restore(location.hash.slice(1)));
}
addEventListener("hashchange", openLink);

// The address bar has the link, too: a page from disk may not be allowed to use the clipboard.
const linkButton = added(byId("views"), "button", { id: "link", textContent: "Link", title: "Copy a link that shows the same" });
linkButton.onclick = async () => {
  history.replaceState(null, "", `#${linkText()}`);
  say("link", "");
  const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
  linkButton.textContent = copied ? "Copied" : "See address";
  setTimeout(() => { linkButton.textContent = "Link"; }, 1500);
};
