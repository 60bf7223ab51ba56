// Where the tcp should be: a button for each way to get there within the limits.
const target = ["x", "y", "z"].map((axis) => {
  const label = byId("target").appendChild(document.createElement("label"));
  const input = document.createElement("input");
  Object.assign(input, { type: "number", step: "5", name: axis });
  label.append(`${axis} `, input);
  input.oninput = () => solve();
  return input;
});
byId("target").append("mm");
const ways = data.branches.map((name, i) => {
  const button = byId("ways").appendChild(document.createElement("button"));
  button.textContent = name.replace("_", " ");
  button.onclick = () => setPose([...solve().q[i], ...data.sliders.slice(4).map((joint) => q[joint])]);
  return button;
});
function solve() {
  const found = formulas.inverse_kinematics(target.map((input) => Number(input.value) / 1e3), angles()[3]);
  const empty = target.some((input) => input.value === "");
  ways.forEach((button, i) => { button.disabled = empty || !found.within_limits[i]; });
  return found;
}
solve();
