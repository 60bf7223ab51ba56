// The panel: joints, named poses, the tcp.
document.querySelector("#panel h1").textContent = data.title;
byId("fold").onclick = () => byId("panel").classList.toggle("folded");
for (const note of data.notes) added(byId("notes"), "p", { textContent: note });

const rows = data.tree.filter((joint) => data.sliders.includes(joint.name)).map(jointRow);
function jointRow(joint) {
  const row = added(byId("joints"), "div", { className: "joint" });
  added(row, "label", { textContent: joint.name });
  const slider = added(row, "input", { type: "range", min: joint.lower, max: joint.upper, step: "any", name: joint.name });
  slider.setAttribute("aria-label", joint.name);
  slider.oninput = () => setJoint(joint.name, Number(slider.value));
  const value = added(row, "span", { className: "value" });
  const torque = added(row, "span", { className: "torque" });
  return { joint, slider, value, torque };
}

for (const name in data.poses) {
  added(byId("poses"), "button", { textContent: name, onclick: () => setPose(data.poses[name]) });
}

function showJoints() {
  for (const { joint, slider, value } of rows) {
    slider.value = q[joint.name];
    value.textContent = joint.kind === "prismatic" ? `${mm(q[joint.name])} mm` : `${fixed(q[joint.name] * 180 / Math.PI, 1)}\u00b0`;
  }
  const tcp = poses.tcp && new THREE.Vector3().setFromMatrixPosition(poses.tcp);
  if (tcp) byId("readout").textContent = `tcp  x ${mm(tcp.x)}  y ${mm(tcp.y)}  z ${mm(tcp.z)} mm`;
}
// What each joint holds; the jaws' rod has no figure.
function showTorques() {
  if (!poses.link_4) return;
  holding().forEach((still, i) => {
    const torque = shown.current ? still - drag(rows[i].joint) : still;
    rows[i].torque.dataset.value = torque;
    rows[i].torque.textContent = `holds ${fixed(torque, 3)} N\u00b7m`;
  });
}
onPose(showJoints);
onPose(showTorques);
