// Switches that show and hide the groups of the scene.
const { shown } = state;
const DOTS = { com: "#e0a400", cob: "#1f78c8", weight: "#c8322d", buoyancy: "#2a8fd6", collision: "#ee8b1a", workspace: "#159a80", surface: "#159a80", current: "#00808c", payload: "#f28c1a" };

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
  document.querySelector(`#groups input[name="${name}"]`).checked = on;
  if (name === "current" && poses[root]) {
    showTorques();
    showRestLoad();
    showWater();
    for (const show of numberFields) show();
  }
  if (name === "ghosts" && poses[root]) showSolutions();
  viewer.set_dirty();
}

function seeThrough(on) {
  for (const { material } of meshes("/meshcat/alpha5/bodies")) {
    Object.assign(material, { transparent: on, opacity: on ? data.seeThrough : 1, depthWrite: !on, needsUpdate: true });
  }
}

// The backdrop is lighter than the dark bodies and, in the light colour scheme, darker than the jaws.
function backdrop() {
  const [top, bottom] = dark.matches ? [[0.42, 0.47, 0.51], [0.20, 0.24, 0.28]] : [[0.78, 0.83, 0.87], [0.56, 0.65, 0.71]];
  viewer.set_property(["Background"], "top_color", top);
  viewer.set_property(["Background"], "bottom_color", bottom);
}
// The dark bodies need more light than meshcat's scene has.
for (const [name, strength] of [["AmbientLight", 0.75], ["PointLightNegativeX", 0.5], ["PointLightPositiveX", 0.5], ["FillLight", 0.5]]) {
  viewer.set_property(["Lights", name, "<object>"], "intensity", strength);
}
// meshcat draws its backdrop anew in every frame; the browser does so once.
viewer.show_background = () => {
  const { top_color: top, bottom_color: bottom } = viewer.scene_tree.find(["Background"]).object;
  byId("pane").style.background = `linear-gradient(rgb(${top}), rgb(${bottom}))`;
};
viewer.hide_background = () => { byId("pane").style.background = "none"; };
viewer.scene.background = null;
for (const name of ["Grid", "Axes"]) viewer.set_property([name], "visible", false);
dark.addEventListener("change", backdrop);
