// What the arm is in and what it holds: fluid, current, mount, payload, and the torques that its joints may hold.
import { data } from "./data.js";
import { holding, restLoad, torques } from "./statics.js";
import { change, onChange, state } from "./state.js";
import { added, byId, fixed, foldable, numberField, write } from "./page.js";
import { payloadForce, totals } from "./scene.js";

const FLUIDS = new Map([["air", 0], ["fresh", 1000], ["sea", 1025]]);
export const DENSEST = 2000; // kg/m3
export const FASTEST = 5; // m/s
export const HEAVIEST = 20; // kg
export const LARGEST = 20e-3; // m3
export const STRONGEST = 1000; // N m
const SLIDER_END = 1; // kg
const DEGREE = Math.PI / 180;

// ---- water
const water = foldable("water", "Water");
const fluidRow = added(water.box, "div", { className: "line" });
const fluidButtons = [...FLUIDS].map(([name, density]) => added(fluidRow, "button", { textContent: name, onclick: () => change({ density }) }));
numberField(fluidRow, {
  name: "Density", unit: "kg/m\u00b3", each: 1, low: 0, high: DENSEST, digits: 3,
  get: () => state.density, set: (density) => change({ density }),
});
added(fluidRow, "span", { textContent: "kg/m\u00b3" });
// A current that is not shown has no load, so it is none. One that is set is shown, too.
const flowing = () => state.shown.current ? state.current : [0, 0, 0];
const currentRow = added(water.box, "div", { className: "line" });
added(currentRow, "span", { textContent: "current" });
["x", "y", "z"].forEach((axis, i) => {
  const label = added(currentRow, "label", { textContent: axis });
  numberField(label, {
    name: `Current along ${axis}`, unit: "m/s", each: 1, low: -FASTEST, high: FASTEST, digits: 3,
    get: () => flowing()[i], set: (value) => change({ current: flowing().with(i, value), shown: { current: true } }),
  });
});
added(currentRow, "span", { textContent: "m/s" });
const forces = added(water.box, "p");

onChange(() => {
  [...FLUIDS.values()].forEach((density, i) => fluidButtons[i].setAttribute("aria-pressed", state.density === density));
  const known = [...FLUIDS].find(([, density]) => density === state.density);
  const fluid = state.density === 0 ? "air" : `${known ? `${known[0]}, ` : ""}${Number(state.density.toFixed(3))} kg/m\u00b3`;
  const speed = Math.hypot(...state.current);
  water.say(state.shown.current ? `${fluid}, current ${fixed(speed, 2)} m/s` : fluid);
  const { weight, buoyancy } = totals();
  const lift = state.density ? `, buoyancy ${fixed(buoyancy, 2)} N` : "";
  const load = state.density ? "The load of a current is estimated, with its interval." : "In air a current has no load here.";
  write(forces, `Arm: weight ${fixed(weight, 2)} N${lift}. ${load}`);
});

// ---- the attitude of the base: gravity points down in the picture
if (data.fixed) showMount();
else byId("mount").hidden = true;
function showMount() {
  const mount = foldable("mount", "Mount");
  const row = added(mount.box, "div", { className: "line" });
  ["roll", "pitch"].forEach((name, i) => {
    const label = added(row, "label", { textContent: name });
    numberField(label, {
      name: `Mount's ${name}`, unit: "\u00b0", each: DEGREE, low: -180, high: 180, digits: 2,
      get: () => state.attitude[i], set: (angle) => change({ attitude: state.attitude.with(i, angle) }),
    });
    added(row, "span", { textContent: "\u00b0" });
  });
  added(mount.box, "p", { textContent: "How base_link is turned on its carrier. Targets, tcp and current stay in base_link." });
  const load = added(mount.box, "p", { id: "rest-load" });
  onChange(() => {
    const parts = (values, digits) => values.map((value, i) => `${"xyz"[i]} ${fixed(value, digits)}`).join(" ");
    const [force, moment] = restLoad(state);
    const but = state.shown.current ? ", without what the current adds" : "";
    write(load, `Load on the carrier at rest: force ${parts(force, 2)} N, moment ${parts(moment, 3)} N\u00b7m${but}.`);
    const turned = state.attitude.map((angle) => `${Number((angle / DEGREE).toFixed(1))}\u00b0`.replace("-", "\u2212"));
    mount.say(state.attitude.some((angle) => Math.abs(angle) > 1e-9) ? `roll ${turned[0]}, pitch ${turned[1]}` : "level");
  });
}

// ---- what the arm holds
const payload = foldable("payload", "Payload");
const setPayload = (part) => change({ payload: { ...state.payload, ...part }, shown: { payload: true } });
const massRow = added(payload.box, "div", { className: "line" });
const massSlider = added(massRow, "input", { type: "range", min: 0, max: SLIDER_END, step: 0.01, name: "payload" });
massSlider.setAttribute("aria-label", "Payload");
massSlider.oninput = () => setPayload({ mass: massSlider.valueAsNumber });
numberField(massRow, {
  name: "Payload", unit: "g", each: 1e-3, low: 0, high: 1e3 * HEAVIEST, digits: 1,
  get: () => state.payload.mass, set: (mass) => setPayload({ mass }),
});
added(massRow, "span", { textContent: "g" });
const volumeRow = added(payload.box, "div", { className: "line" });
const volumeLabel = added(volumeRow, "label", { className: "tight", textContent: "its volume" });
numberField(volumeLabel, {
  name: "Volume of the payload", unit: "cm\u00b3", each: 1e-6, low: 0, high: 1e6 * LARGEST, digits: 2,
  get: () => state.payload.volume, set: (volume) => setPayload({ volume }),
});
added(volumeRow, "span", { textContent: "cm\u00b3" });
const heldForce = added(payload.box, "p");
export const payloadText = () => `${fixed(1e3 * state.payload.mass, 0)} g, ${fixed(Math.hypot(...payloadForce()), 2)} N`;
onChange(() => {
  massSlider.value = state.payload.mass;
  massSlider.setAttribute("aria-valuetext", `${fixed(1e3 * state.payload.mass, 0)} g`);
  payload.say(state.payload.mass ? payloadText() : "none");
  write(heldForce, state.payload.volume
    ? `Its weight without its buoyancy: ${fixed(Math.hypot(...payloadForce()), 2)} N.`
    : "At the tcp, a point mass: without a volume, the water does not lift it.");
});

// ---- what it could hold: the torque of each joint as a bar against a limit that the user enters
const capacity = foldable("capacity", "What can it hold here?");
const barGrid = added(capacity.box, "div", { id: "bars" });
const torqueBars = data.sliders.slice(0, 4).map((name, i) => {
  added(barGrid, "span", { textContent: name });
  const track = added(barGrid, "div", { className: "bar" });
  const bar = { track, fill: added(track, "i"), value: added(barGrid, "output", { ariaLive: "off" }) };
  numberField(barGrid, {
    name: `Limit of ${name}`, unit: "N\u00b7m", each: 1, low: 0, high: STRONGEST, digits: 3, optional: true,
    get: () => state.limits[i], set: (limit) => change({ limits: state.limits.with(i, limit) }),
  }).placeholder = "limit";
  return bar;
});
const verdict = added(capacity.box, "p", { id: "verdict" });

const worst = ({ low, high }) => Math.max(Math.abs(low), Math.abs(high));
onChange(() => {
  const loads = torques(state, state.shown.current);
  const largest = Math.max(...loads.map(worst), 1e-9);
  torqueBars.forEach(({ track, fill, value }, i) => {
    const limit = state.limits[i];
    const share = worst(loads[i]) / (limit ?? largest);
    fill.style.width = `${(100 * Math.min(share, 1)).toFixed(1)}%`;
    track.classList.toggle("over", limit !== null && share > 1);
    track.classList.toggle("judged", limit !== null);
    write(value, fixed(worst(loads[i]), 3));
  });
  const { short, long } = capacityText();
  write(verdict, long);
  capacity.say(short);
});
// Torques are linear in the mass at the tcp, so each limit allows an interval of masses.
function allowedMasses() {
  const bare = { ...state, payload: { ...state.payload, mass: 0 } };
  const still = holding(bare);
  const slope = holding({ ...state, payload: { ...state.payload, mass: 1 } }).map((torque, i) => torque - still[i]);
  const empty = torques(bare, state.shown.current);
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
// What a limit allows, for the heading and for the box.
function capacityText() {
  if (state.limits.every((limit) => limit === null)) {
    return { short: "", long: "Enter the torque that a joint may hold, in N\u00b7m. The documents print no rating." };
  }
  const { least, most, first } = allowedMasses();
  const { mass } = state.payload;
  const judged = mass ? `${mass >= least && mass <= most ? "Yes" : "No"} for ${fixed(1e3 * mass, 0)} g` : "";
  const allowed = allowedText(least, most, first);
  return { short: judged || allowed.split(/ here|:/)[0].replace("Holds ", ""), long: judged ? `${judged}. ${allowed}` : allowed };
}
function allowedText(least, most, first) {
  if (most < least) return `Nothing here: ${data.sliders[first]} is beyond its limit.`;
  const from = least > 0 ? `${fixed(Math.ceil(1e3 * least), 0)} to ` : "up to ";
  if (most === Infinity) return "Any mass: it hangs on no joint with a limit.";
  return `Holds ${from}${fixed(Math.floor(1e3 * most), 0)} g here: ${data.sliders[first]} is the first at its limit.`;
}
