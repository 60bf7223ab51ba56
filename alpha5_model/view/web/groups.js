// What is shown: switches of the groups of things in the scene.
const shown = {};
const DOTS = { com: "#e0a400", cob: "#1f78c8", weight: "#c8322d", buoyancy: "#2a8fd6", collision: "#ee8b1a", workspace: "#159a80", surface: "#159a80", current: "#00808c" };

for (const group of data.groups) {
  const label = added(byId("groups"), "label");
  const box = added(label, "input", { type: "checkbox", name: group.name, checked: group.shown });
  label.append(group.title);
  if (DOTS[group.name]) added(label, "span", { className: "dot" }).style.background = DOTS[group.name];
  box.onchange = () => setGroup(group.name, box.checked);
  shown[group.name] = group.shown;
}

function setGroup(name, on) {
  shown[name] = on;
  if (name === "see-through") seeThrough(on);
  else if (name !== "labels") viewer.set_property(split(`/meshcat/alpha5/${name}`), "visible", on);
  const box = document.querySelector(`#groups input[name="${name}"]`);
  if (box) box.checked = on;
  if (name === "current") showTorques();
  viewer.set_dirty();
}

function seeThrough(on) {
  viewer.scene_tree.find(split("/meshcat/alpha5/bodies")).object.traverse((object) => {
    if (!object.material) return;
    object.material.transparent = on;
    object.material.opacity = on ? data.seeThrough : 1;
    object.material.depthWrite = !on;
    object.material.needsUpdate = true;
  });
}
