// What the page shares with others: a live program sends and gets poses, and a link restores what a person has changed.
import { data } from "./data.js";
import { ON_LIMIT, joints } from "./kinematics.js";
import { change, isPose, onChange, state } from "./state.js";
import { added, byId, fixed, say } from "./page.js";
import { onCommand, viewer } from "./scene.js";
import { eye, look, lookedAt, moveCamera } from "./camera.js";
import { NEAR } from "./target.js";
import { DENSEST, FASTEST, HEAVIEST, LARGEST, STRONGEST } from "./water.js";
import { apart, clamp, largestDifference } from "./vectors.js";

onCommand((command) => {
  if (command.type === "pose" && isPose(command.q)) {
    change({ q: command.q, root: command.root }, "python");
  } else if (command.type === "refused") {
    say("refused", `Python refused this: ${command.reason}.`);
  } else if (command.type === "show") {
    const known = Object.entries(command.groups).filter(([name]) => name in state.shown);
    change({ shown: Object.fromEntries(known) }, "python");
  } else if (command.type === "camera") {
    moveCamera(command.eye, command.target);
    change({ view: null }, "python");
  }
});

let lost = false; // whether the program behind the page has ended
function connect() {
  viewer.connect(location.href.split("#")[0].replace(/^http/, "ws"));
  viewer.connection.onclose = () => {
    lost = true;
    say("lost", "The program behind this page has ended, or cannot be reached. What you move here does not move its arm.");
    setTimeout(connect, 1000);
  };
  // The arm may have moved meanwhile.
  viewer.connection.onopen = () => { if (lost) location.reload(); };
}
if (data.live) {
  connect();
  // The page may drive a real arm: send only positions within the limits, even if Python showed others.
  const inside = () => state.q.map((value, i) => clamp(value, joints[i].lower, joints[i].upper));
  // Send at most one message for each frame.
  let waiting = false;
  onChange((part, by) => {
    if (!("q" in part)) return;
    if (by === "hand") say("refused", "");
    if (waiting || !["hand", "motion", "travel"].includes(by)) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      if (viewer.connection.readyState !== WebSocket.OPEN) return;
      viewer.connection.send(JSON.stringify({ q: inside() }));
      if (by === "hand" && largestDifference(inside(), state.q) > 1e-9) change({ q: inside() }, "page");
    });
  });
}

// ---- links: the entries of the state behind the # of the address, in SI units and rad.
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
// A named view, or a camera and the point that it looks at.
function linkView(name, text) {
  if (Object.hasOwn(data.views, text)) return text;
  const numbers = linkNumbers(name, text, within(FARTHEST, 6));
  if (apart(numbers.slice(0, 3), numbers.slice(3)) < 1e-3) throw new RangeError(`${name} needs a camera away from what it looks at`);
  return numbers;
}
const within = (end, count = 3) => Array.from({ length: count }, () => [-end, end]);
// Limits of joints are written with all digits, but an angle of a link may be rounded.
const withinLimits = () => joints.map((joint) => [joint.lower - ON_LIMIT, joint.upper + ON_LIMIT]);
const groups = () => Object.keys(state.shown);

// Entry -> [its text now, or null if there is none; what a text says, as entries of the state].
const LINKED = {
  fluid: [() => [state.density], (name, text) => ({ density: linkNumbers(name, text, [[0, DENSEST]])[0] })],
  current: [() => state.current, (name, text) => ({ current: linkNumbers(name, text, within(FASTEST)) })],
  payload: [
    () => [state.payload.mass, ...state.payload.com, state.payload.volume],
    (name, text) => {
      const [mass, x, y, z, volume] = linkNumbers(name, text, [[0, HEAVIEST], ...within(FARTHEST), [0, LARGEST]]);
      return { payload: { mass, com: [x, y, z], volume } };
    },
  ],
  limits: [
    () => state.limits.some((limit) => limit !== null) ? state.limits.map((limit) => limit ?? "none") : null,
    (name, text) => ({ limits: linkLimits(name, text) }),
  ],
  mount: [
    () => data.fixed ? state.attitude : null,
    (name, text) => ({ attitude: linkNumbers(name, text, within(Math.PI, data.fixed ? 2 : 0)) }),
  ],
  show: [
    () => groups().filter((name) => state.shown[name]),
    (name, text) => {
      const words = linkWords(name, text, groups());
      return { shown: Object.fromEntries(groups().map((group) => [group, words.includes(group)])) };
    },
  ],
  units: [() => [state.degrees ? "deg" : "rad"], (name, text) => ({ degrees: linkWords(name, text, ["deg", "rad"])[0] !== "rad" })],
  guard: [() => [state.guard ? "stop" : "warn"], (name, text) => ({ guard: linkWords(name, text, ["stop", "warn"])[0] === "stop" })],
  q: [() => state.q, (name, text) => ({ q: linkNumbers(name, text, withinLimits()) })],
  target: [() => state.aim, (name, text) => ({ aim: linkNumbers(name, text, within(FARTHEST)) })],
  view: [() => state.view ? [state.view] : [...eye(), ...lookedAt()], (name, text) => ({ view: linkView(name, text) })],
};

// The state as the part of a link behind the #.
export function linkText() {
  const texts = Object.entries(LINKED).map(([name, [values]]) => [name, values()]);
  return texts.filter(([, values]) => values).map(([name, values]) => `${name}=${values.join(",")}`).join("&");
}
// The entries of the state that a link's part behind the # has; an error if one cannot be read.
function linkedState(text) {
  if (text.length > LONGEST_LINK) throw new RangeError(`it has more than ${LONGEST_LINK} characters`);
  const given = {};
  for (const part of text.split("&")) {
    const [name, value, ...more] = part.split("=");
    if (!Object.hasOwn(LINKED, name) || value === undefined || more.length || name in given) {
      throw new RangeError(`it holds ${Object.keys(LINKED).join(", ")}, each once`);
    }
    given[name] = LINKED[name][1](name, decodeURIComponent(value));
  }
  return Object.assign({}, ...Object.values(given));
}
export function openLink() {
  if (location.hash.length < 2) return;
  say("link", "");
  try {
    const { view, ...entries } = linkedState(location.hash.slice(1));
    change(entries, "page");
    if (typeof view === "string") {
      look(view, false);
    } else if (view) {
      change({ view: null }, "page");
      moveCamera(view.slice(0, 3), view.slice(3));
    }
  } catch (error) {
    say("link", `The link cannot be read: ${error instanceof URIError ? "it is damaged" : error.message}.`);
  }
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
