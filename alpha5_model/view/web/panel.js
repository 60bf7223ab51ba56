// The panel: joints, named poses, the tcp, and messages of what is not as it should be.
for (const note of data.notes) added(byId("notes"), "p", { textContent: note });

function fold(on) {
  byId("panel").classList.toggle("folded", on);
  byId("fold").setAttribute("aria-expanded", !on);
  byId("fold").setAttribute("aria-label", on ? "Unfold the panel" : "Fold the panel");
  viewer.set_3d_pane_size();
}
byId("fold").onclick = () => fold(!byId("panel").classList.contains("folded"));

// ---- messages, one for each matter
const messages = {};
function say(matter, text) {
  if (messages[matter] === text) return;
  messages[matter] = text;
  byId("message").replaceChildren();
  for (const each of Object.values(messages).filter(Boolean)) added(byId("message"), "p", { textContent: each });
}

// ---- joints, in degrees or radians
let degrees = true;
const UNITS = { rad: 1, "\u00b0": Math.PI / 180, mm: 1e-3 };
const unit = (joint) => joint.kind === "prismatic" ? "mm" : degrees ? "\u00b0" : "rad";
const rows = joints.map((joint) => {
  const row = added(byId("joints"), "div", { className: "joint" });
  added(row, "label", { textContent: joint.name, htmlFor: `${joint.name}-value` });
  const slider = added(row, "input", { type: "range", min: joint.lower, max: joint.upper, step: "any", name: joint.name });
  slider.setAttribute("aria-label", joint.name);
  slider.oninput = () => setJoint(joint.name, slider.valueAsNumber);
  slider.onchange = keepInSight;
  const value = added(row, "input", { type: "number", step: "any", id: `${joint.name}-value` });
  value.onchange = () => {
    if (Number.isFinite(value.valueAsNumber)) setJoint(joint.name, value.valueAsNumber * UNITS[unit(joint)]);
    showJoints();
    keepInSight();
  };
  return { joint, row, slider, value, unit: added(row, "span", { className: "unit" }), torque: added(row, "span", { className: "torque" }) };
});
const units = document.querySelectorAll("#units button");
for (const button of units) button.onclick = () => showJoints(degrees = button.value === "deg");
for (const [name, values] of Object.entries(data.poses)) {
  added(byId("poses"), "button", { textContent: name, onclick: () => keepInSight(setPose(values)) });
}

function showJoints() {
  for (const { joint, row, slider, value, unit: sign } of rows) {
    const digits = { rad: 4, "\u00b0": 2, mm: 2 }[unit(joint)];
    slider.value = q[joint.name];
    if (value !== document.activeElement) value.value = (q[joint.name] / UNITS[unit(joint)]).toFixed(digits);
    sign.textContent = unit(joint);
    row.classList.toggle("beyond", limit(joint) !== undefined);
  }
  for (const button of units) button.setAttribute("aria-pressed", degrees === (button.value === "deg"));
  const [x, y, z] = tcpInBase();
  byId("readout").textContent = `tcp  x ${mm(x)}  y ${mm(y)}  z ${mm(z)} mm`;
}
// What each joint holds; the jaws' rod has no figure.
function showTorques() {
  holding().forEach((still, i) => {
    const torque = shown.current ? still - drag(rows[i].joint) : still;
    rows[i].torque.dataset.value = torque;
    rows[i].torque.textContent = `holds ${fixed(torque, 3)} N\u00b7m`;
  });
}

// ---- joints beyond their limits: a message, a red row, a red body
const RED = new THREE.Color("#d40f0f");
function showLimits() {
  const beyond = joints.filter((joint) => limit(joint) !== undefined);
  const side = (joint) => limit(joint) === joint.lower ? "below its lower" : "above its upper";
  say("limits", beyond.map((joint) => `${joint.name} at ${amount(joint, q[joint.name])} is ${side(joint)} limit, ${amount(joint, limit(joint))}.`).join(" "));
  for (const joint of joints) {
    for (const part of meshes(data.links[joint.child])) part.material.emissive.copy(RED).multiplyScalar(beyond.includes(joint) ? 0.55 : 0);
  }
}
for (const show of [showJoints, showTorques, showLimits]) onPose(show);
