// The panel: joints, named poses, the position of the tcp, and messages about problems.
for (const note of data.notes) added(byId("notes"), "p", { textContent: note });

function fold(on) {
  byId("panel").classList.toggle("folded", on);
  byId("fold").setAttribute("aria-expanded", !on);
  byId("fold").setAttribute("aria-label", on ? "Unfold the panel" : "Fold the panel");
  viewer.set_3d_pane_size();
}
byId("fold").onclick = () => fold(!byId("panel").classList.contains("folded"));

// ---- messages, one for each subject
const messages = {};
function say(matter, text) {
  if (messages[matter] === text) return;
  messages[matter] = text;
  byId("message").replaceChildren();
  for (const each of Object.values(messages).filter(Boolean)) added(byId("message"), "p", { textContent: each });
}

// ---- joints, in degrees or radians
const DIGITS = { rad: 4, "\u00b0": 2, mm: 2 };
const UNITS = { rad: 1, "\u00b0": Math.PI / 180, mm: 1e-3 };
// Keys of a slider, and the step of one of them: 0.1 degree or 0.1 mm.
const SLIDER_KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
const KEY_STEP = { revolute: 0.1 * Math.PI / 180, continuous: 0.1 * Math.PI / 180, prismatic: 1e-4 };
const unit = (joint) => joint.kind === "prismatic" ? "mm" : state.degrees ? "\u00b0" : "rad";
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
    turn(joint, clamp(q[joint.name] + step * KEY_STEP[joint.kind], joint.lower, joint.upper));
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
  added(byId("poses"), "button", { textContent: name, onclick: () => { dropTarget(); travelTo(values, name); } });
}

// Turn one joint by hand. The arm leaves its target then.
function turn(joint, value) {
  dropTarget();
  setJoint(joint.name, value);
}
// Move a joint to the typed value, or say why not. A displayed limit may be rounded to beyond the limit.
function moveTo(joint, field) {
  const rounding = 0.5 * 10 ** -DIGITS[unit(joint)];
  const within = (end, sign) => sign * field.valueAsNumber <= sign * end / UNITS[unit(joint)] + rounding;
  if (within(joint.lower, -1) && within(joint.upper, 1)) {
    turn(joint, clamp(field.valueAsNumber * UNITS[unit(joint)], joint.lower, joint.upper));
    return;
  }
  const stays = `It stays at ${amount(joint, q[joint.name])}.`;
  if (!Number.isNaN(field.valueAsNumber)) {
    const range = `${amount(joint, joint.lower)} to ${amount(joint, joint.upper)}`;
    say("typed", `${joint.name} cannot go to ${asTyped(field)}${unit(joint) === "\u00b0" ? "" : " "}${unit(joint)}: its range is ${range}. ${stays}`);
  } else if (field.validity.badInput) {
    say("typed", `${joint.name} needs a number. ${stays}`);
  }
}
const asTyped = (field) => (field.value.length < 12 ? field.value : field.valueAsNumber.toExponential(2)).replace("-", "\u2212");
const shownValue = (joint) => (q[joint.name] / UNITS[unit(joint)]).toFixed(DIGITS[unit(joint)]);
onPose((by) => { if (by === "hand") say("typed", ""); });

function showJoints() {
  for (const { joint, row, slider, value, unit: sign } of rows) {
    slider.value = q[joint.name];
    slider.setAttribute("aria-valuetext", amount(joint, q[joint.name]));
    if (value !== document.activeElement) value.value = shownValue(joint);
    write(sign, unit(joint));
    row.classList.toggle("beyond", limit(joint) !== undefined);
  }
  for (const button of units) button.setAttribute("aria-pressed", state.degrees === (button.value === "deg"));
  const [x, y, z] = tcpInBase();
  write(byId("readout"), `tcp  x ${mm(x)}  y ${mm(y)}  z ${mm(z)} mm`);
}
// Show the torque that each joint holds; there is none for the jaws' rod.
function showTorques() {
  torques().forEach(({ value, low, high }, i) => {
    const ends = [low, high].map((end) => fixed(end, 3));
    const interval = ends[0] === ends[1] ? "" : ` (${ends.join(" to ")})`;
    rows[i].torque.dataset.value = value;
    write(rows[i].torque, `holds ${fixed(value, 3)}${interval} N\u00b7m`);
  });
  showCapacity();
}
// While the arm moves by itself the panel follows ten times a second, and in every third frame of a slow browser:
// nobody reads faster, and painting the panel costs as much as drawing a body. It ends with what is shown.
const LEAST_FRAMES = 3;
const LEAST_WAIT = 100; // ms
const LONGEST_WAIT = 500; // ms
let skipped = { frames: 0, since: 0, timer: null };
function showPanel(by) {
  const isOn = by === "travel" || (by === "motion" && started !== null);
  skipped.frames++;
  if (isOn && (skipped.frames < LEAST_FRAMES || performance.now() - skipped.since < LEAST_WAIT)) {
    skipped.timer ??= setTimeout(showPanelNow, LONGEST_WAIT);
  } else {
    showPanelNow();
  }
}
function showPanelNow() {
  clearTimeout(skipped.timer);
  skipped = { frames: 0, since: performance.now(), timer: null };
  showJoints();
  showTorques();
  showRestLoad();
}

// ---- joints beyond their limits, and links that touch: a message, a red row, a red body
const RED = new THREE.Color("#d40f0f");
function showLimits() {
  const beyond = joints.filter((joint) => limit(joint) !== undefined);
  const side = (joint) => limit(joint) === joint.lower ? "below its lower" : "above its upper";
  say("limits", beyond.map((joint) => `${joint.name} at ${amount(joint, q[joint.name])} is ${side(joint)} limit, ${amount(joint, limit(joint))}.`).join(" "));
  const pairs = touching(poses);
  say("touching", pairs.length ? `The arm collides with itself: ${spoken(pairs)}.` : "");
  const red = new Set([...beyond.map((joint) => joint.child), ...pairs.flat()]);
  for (const link in data.links) {
    for (const part of meshes(data.links[link])) part.material.emissive.copy(RED).multiplyScalar(red.has(link) ? 0.55 : 0);
  }
}
const spoken = (pairs) => pairs.map((pair) => pair.join(" with ")).join(", ");
for (const show of [showPanel, showLimits]) onPose(show);
onChange((part) => { if ("degrees" in part) showJoints(); });

// ---- if it is wanted, a hand does not move the arm from a free position into itself
const guard = byId("guard").firstChild;
guard.onchange = () => change({ guard: guard.checked });
onChange((part) => {
  if (!("guard" in part)) return;
  guard.checked = state.guard;
  say("guard", "");
});
function isBlocked(values) {
  if (!state.guard || touching(poses).length) return false;
  const pairs = touching(forwardKinematics(named(values)));
  if (pairs.length) say("guard", `Stopped: ${spoken(pairs)} would touch.`);
  return pairs.length > 0;
}
