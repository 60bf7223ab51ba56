// What the arm holds, and what it could hold: torque of each joint as a bar against a limit that the user enters.
const HEAVIEST = 20; // kg
const SLIDER_END = 1; // kg
const LARGEST = 20e-3; // m3
const STRONGEST = 1000; // N m

const payloadBox = foldable("payload", "Payload");
const massRow = added(payloadBox.box, "div", { className: "line" });
const massSlider = added(massRow, "input", { type: "range", min: 0, max: SLIDER_END, step: 0.01, name: "payload" });
massSlider.setAttribute("aria-label", "Payload in g");
massSlider.oninput = () => setPayload({ mass: massSlider.valueAsNumber });
numberField(massRow, {
  name: "Payload", unit: "g", each: 1e-3, low: 0, high: 1e3 * HEAVIEST, digits: 1,
  get: () => state.payload.mass, set: (mass) => setPayload({ mass }),
});
added(massRow, "span", { textContent: "g" });
const volumeRow = added(payloadBox.box, "div", { className: "line" });
const volumeLabel = added(volumeRow, "label", { className: "tight", textContent: "its volume" });
numberField(volumeLabel, {
  name: "Volume of the payload", unit: "cm\u00b3", each: 1e-6, low: 0, high: 1e6 * LARGEST, digits: 2,
  get: () => state.payload.volume, set: (volume) => setPayload({ volume }),
});
added(volumeRow, "span", { textContent: "cm\u00b3" });
const heldForce = added(payloadBox.box, "p");

function setPayload(part) {
  change({ payload: { ...state.payload, ...part } });
  if (!shown.payload) setGroup("payload", true);
}
// Force of the payload in the world: its weight without its buoyancy.
const payloadForce = () => vector(data.water.gravity).multiplyScalar(state.payload.mass - state.density * state.payload.volume);

// ---- what can it hold here?
const capacity = foldable("capacity", "What can it hold here?");
const barGrid = added(capacity.box, "div", { id: "bars" });
const torqueBars = data.sliders.slice(0, 4).map((name, i) => {
  added(barGrid, "span", { textContent: name });
  const track = added(barGrid, "div", { className: "bar" });
  const bar = { track, fill: added(track, "i"), value: added(barGrid, "output") };
  numberField(barGrid, {
    name: `Limit of ${name}`, unit: "N\u00b7m", each: 1, low: 0, high: STRONGEST, digits: 3, optional: true,
    get: () => state.limits[i], set: (limit) => change({ limits: state.limits.with(i, limit) }),
  }).placeholder = "limit";
  return bar;
});
const verdict = added(capacity.box, "p", { id: "verdict" });

const worst = ({ low, high }) => Math.max(Math.abs(low), Math.abs(high));
function showCapacity() {
  const loads = torques();
  const largest = Math.max(...loads.map(worst), 1e-9);
  torqueBars.forEach(({ track, fill, value }, i) => {
    const limit = state.limits[i];
    const share = worst(loads[i]) / (limit ?? largest);
    fill.style.width = `${(100 * Math.min(share, 1)).toFixed(1)}%`;
    track.classList.toggle("over", limit !== null && share > 1);
    track.classList.toggle("judged", limit !== null);
    value.textContent = fixed(worst(loads[i]), 3);
  });
  const text = capacityText();
  verdict.textContent = text;
  const isJudged = state.limits.some((limit) => limit !== null);
  capacity.say(isJudged ? text.split(/\. | here|:/)[0].replace("Holds ", "") : "");
}
// Torques are linear in the mass at the tcp, so each limit allows an interval of masses.
function allowedMasses() {
  const empty = torques({ ...state.payload, mass: 0 });
  const slope = holding({ ...state.payload, mass: 1 }).map((torque, i) => torque - holding({ ...state.payload, mass: 0 })[i]);
  let [least, most, first] = [0, Infinity, null];
  state.limits.forEach((limit, i) => {
    if (limit === null) return;
    const { low, high } = empty[i];
    if (Math.abs(slope[i]) < 1e-12) {
      if (Math.max(high, -low) > limit) [most, first] = [-1, i];
      return;
    }
    const ends = [(limit - high) / slope[i], (-limit - low) / slope[i]];
    const [from, to] = slope[i] > 0 ? [ends[1], ends[0]] : [ends[0], ends[1]];
    least = Math.max(least, from);
    if (to < most) [most, first] = [to, i];
  });
  return { least, most, first };
}
function capacityText() {
  if (state.limits.every((limit) => limit === null)) {
    return "Enter the torque that a joint may hold, in N\u00b7m. The documents print no rating.";
  }
  const { least, most, first } = allowedMasses();
  const { mass } = state.payload;
  const judged = mass ? `${mass >= least && mass <= most ? "Yes" : "No"} for ${fixed(1e3 * mass, 0)} g. ` : "";
  return judged + allowedText(least, most, first);
}
function allowedText(least, most, first) {
  if (most < least) return `Nothing here: ${data.sliders[first]} is beyond its limit.`;
  const from = least > 0 ? `${fixed(Math.ceil(1e3 * least), 0)} to ` : "up to ";
  if (most === Infinity) return "Any mass: it hangs on no joint with a limit.";
  return `Holds ${from}${fixed(Math.floor(1e3 * most), 0)} g here: ${data.sliders[first]} is the first at its limit.`;
}

function showPayload() {
  massSlider.value = state.payload.mass;
  massSlider.setAttribute("aria-valuetext", `${fixed(1e3 * state.payload.mass, 0)} g`);
  payloadBox.say(state.payload.mass ? payloadText() : "none");
  heldForce.textContent = state.payload.volume
    ? `Its weight without its buoyancy: ${fixed(payloadForce().length(), 2)} N.`
    : "At the tcp, a point mass: without a volume, the water does not lift it.";
}
const payloadText = () => `${fixed(1e3 * state.payload.mass, 0)} g, ${fixed(payloadForce().length(), 2)} N`;
onChange((part) => {
  if ("payload" in part || "density" in part) showPayload();
  if ("limits" in part) showCapacity();
});
