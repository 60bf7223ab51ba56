// The panel: joints, named poses, groups, the position of the tcp, and messages about problems.
import { data } from "./data.js";
import { spoken, touching } from "./collision.js";
import { joints, tip, weakest } from "./kinematics.js";
import { torques } from "./statics.js";
import { change, onChange, state } from "./state.js";
import { added, asTyped, byId, fixed, mm, say, write } from "./page.js";
import { limitBeyond, viewer } from "./scene.js";
import { keepInSight } from "./camera.js";
import { moveByHand, travelTo } from "./travel.js";
import { leaveTarget } from "./target.js";
import { apart, clamp, placed } from "./vectors.js";

for (const note of data.notes) added(byId("notes"), "p", { textContent: note });

export function fold(on) {
  byId("panel").classList.toggle("folded", on);
  byId("fold").setAttribute("aria-expanded", !on);
  byId("fold").setAttribute("aria-label", on ? "Unfold the panel" : "Fold the panel");
  viewer.set_3d_pane_size();
}
byId("fold").onclick = () => fold(!byId("panel").classList.contains("folded"));

// ---- joints, in degrees or radians
const DIGITS = { rad: 4, "\u00b0": 2, mm: 2 };
const UNITS = { rad: 1, "\u00b0": Math.PI / 180, mm: 1e-3 };
// Keys of a slider, and the step of one of them: 0.1 degree or 0.1 mm.
const SLIDER_KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
const isRod = (joint) => joint.kind === "prismatic";
const keyStep = (joint) => isRod(joint) ? 1e-4 : 0.1 * Math.PI / 180;
const unit = (joint) => isRod(joint) ? "mm" : state.degrees ? "\u00b0" : "rad";
const amount = (joint, value) => isRod(joint) ? `${mm(value)} mm` : `${fixed(value * 180 / Math.PI, 1)}\u00b0`;
const openingAt = (poses) => apart(...Object.entries(data.fingerTips).map(([finger, tip]) => placed(poses[finger], tip)));
const at = (joint) => state.q[joints.indexOf(joint)];
const rows = joints.map((joint) => {
  const row = added(byId("joints"), "div", { className: "joint" });
  added(row, "label", { textContent: joint.name, htmlFor: `${joint.name}-value` });
  const slider = added(row, "input", { type: "range", min: joint.lower, max: joint.upper, step: "any", name: joint.name });
  slider.setAttribute("aria-label", joint.name);
  slider.oninput = () => turn(joint, slider.valueAsNumber);
  slider.onkeydown = (event) => {
    const step = SLIDER_KEYS[event.key];
    if (!step) return;
    event.preventDefault();
    turn(joint, clamp(at(joint) + step * keyStep(joint), joint.lower, joint.upper));
  };
  slider.onchange = keepInSight;
  const value = added(row, "input", { type: "number", step: "any", id: `${joint.name}-value` });
  value.onchange = () => {
    moveTo(joint, value);
    value.value = shownValue(joint);
    keepInSight();
  };
  return { joint, row, slider, value, unit: added(row, "span", { className: "unit" }), torque: added(row, "span", { className: "torque" }) };
});
const units = document.querySelectorAll("#units button");
for (const button of units) button.onclick = () => change({ degrees: button.value === "deg" });
for (const [name, values] of Object.entries(data.poses)) {
  added(byId("poses"), "button", { textContent: name, onclick: () => { leaveTarget(); travelTo(values, name); } });
}

// Turn one joint by hand. The arm leaves its target then.
function turn(joint, value) {
  leaveTarget();
  moveByHand(state.q.with(joints.indexOf(joint), value));
}
// Move a joint to the typed value, or say why not. A displayed limit may be rounded to beyond the limit.
function moveTo(joint, field) {
  const rounding = 0.5 * 10 ** -DIGITS[unit(joint)];
  const within = (end, sign) => sign * field.valueAsNumber <= sign * end / UNITS[unit(joint)] + rounding;
  if (within(joint.lower, -1) && within(joint.upper, 1)) {
    turn(joint, clamp(field.valueAsNumber * UNITS[unit(joint)], joint.lower, joint.upper));
    return;
  }
  const stays = `It stays at ${amount(joint, at(joint))}.`;
  if (!Number.isNaN(field.valueAsNumber)) {
    const range = `${amount(joint, joint.lower)} to ${amount(joint, joint.upper)}`;
    say("typed", `${joint.name} cannot go to ${asTyped(field)}${unit(joint) === "\u00b0" ? "" : " "}${unit(joint)}: its range is ${range}. ${stays}`);
  } else if (field.validity.badInput) {
    say("typed", `${joint.name} needs a number. ${stays}`);
  }
}
const shownValue = (joint) => (at(joint) / UNITS[unit(joint)]).toFixed(DIGITS[unit(joint)]);

onChange((part, by) => {
  if ("q" in part && by === "hand") say("typed", "");
  const loads = torques(state, state.shown.current);
  rows.forEach(({ joint, row, slider, value, unit: sign, torque }, i) => {
    slider.value = at(joint);
    slider.setAttribute("aria-valuetext", amount(joint, at(joint)));
    if (value !== document.activeElement) value.value = shownValue(joint);
    write(sign, unit(joint));
    value.setAttribute("aria-label", `${joint.name} in ${unit(joint)}`);
    row.classList.toggle("beyond", limitBeyond(joint) !== undefined);
    if (loads[i]) showTorque(torque, loads[i]);
    else write(torque, `tips ${mm(openingAt(state.poses))} mm apart`); // no torque is known for the jaws' rod
  });
  for (const button of units) button.setAttribute("aria-pressed", state.degrees === (button.value === "deg"));
  const [x, y, z] = tip(state.q);
  write(byId("readout"), `tcp  x ${mm(x)}  y ${mm(y)}  z ${mm(z)} mm`);
});
function showTorque(element, { value, low, high }) {
  const ends = [low, high].map((end) => fixed(end, 3));
  const interval = ends[0] === ends[1] ? "" : ` (${ends.join(" to ")})`;
  element.dataset.value = value;
  write(element, `holds ${fixed(value, 3)}${interval} N\u00b7m`);
}

// ---- problems of the pose
const WEAK = 0.01; // m/rad; below it a message says that the arm is near a singularity
onChange(() => {
  const beyond = joints.filter((joint) => limitBeyond(joint) !== undefined);
  const side = (joint) => limitBeyond(joint) === joint.lower ? "below its lower" : "above its upper";
  say("limits", beyond.map((joint) => `${joint.name} at ${amount(joint, at(joint))} is ${side(joint)} limit, ${amount(joint, limitBeyond(joint))}.`).join(" "));
  const pairs = touching(state.poses);
  say("touching", pairs.length ? `The arm collides with itself: ${spoken(pairs)}.` : "");
  const least = weakest(state.poses);
  say("singular", least < WEAK ? `Near a singularity: in one direction the tip moves by ${fixed(1e3 * least, 1)} mm per rad of the joints.` : "");
});

// ---- groups of the scene
const DOTS = { com: "#e0a400", cob: "#1f78c8", weight: "#c8322d", buoyancy: "#2a8fd6", collision: "#ee8b1a", workspace: "#159a80", surface: "#159a80", current: "#00808c", payload: "#f28c1a" };
const boxes = data.groups.map(({ name, title }) => {
  const label = added(byId("groups"), "label");
  const box = added(label, "input", { type: "checkbox", name, onchange: () => change({ shown: { [name]: box.checked } }) });
  label.append(title);
  if (DOTS[name]) added(label, "span", { className: "dot" }).style.background = DOTS[name];
  return box;
});
onChange(() => { for (const box of boxes) box.checked = Boolean(state.shown[box.name]); });
