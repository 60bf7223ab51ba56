// The target of the tcp: typed, dragged or given. The arm follows on its branch; the other solutions are ghosts.
let aim = data.target; // in base_link [m], or null
let short = false; // whether the arm was sent there and its branch cannot reach it
let missed = false; // whether the page shows that the tcp is not at the target

const fields = ["x", "y", "z"].map((axis) => {
  const label = added(byId("target"), "label", { textContent: axis });
  const input = added(label, "input", { type: "number", step: "any", name: axis });
  input.setAttribute("aria-label", `target ${axis} in mm`);
  input.oninput = () => {
    say("typed", "");
    if (near(input)) setAim(typed());
  };
  input.onchange = () => {
    if (!near(input)) refuse(input, axis);
    else if (aim) follow(aim, currentBranch());
  };
  return input;
});
added(byId("target"), "span", { textContent: "mm" });
const branchNames = data.branches.map((name) => name.replace("_", " "));
const buttons = branchNames.map((name, i) => added(byId("ways"), "button", { textContent: name, onclick: () => take(i) }));

// Largest coordinate that may be typed [mm]; the arm reaches a twentieth of it.
const NEAR = 10000;
const near = (input) => !(Math.abs(input.valueAsNumber) > NEAR) && !input.validity.badInput;
function refuse(input, axis) {
  const given = input.validity.badInput ? "needs a number" : `cannot be ${asTyped(input)} mm`;
  say("typed", `The target's ${axis} ${given}: it must lie between \u2212${NEAR} and ${NEAR} mm.`);
  input.value = aim ? (1e3 * aim[fields.indexOf(input)]).toFixed(1) : "";
}
function typed() {
  const point = fields.map((input) => input.valueAsNumber / 1e3);
  return point.every(Number.isFinite) ? point : null;
}
function fill() {
  fields.forEach((input, i) => { if (aim && input !== document.activeElement) input.value = (1e3 * aim[i]).toFixed(1); });
}
fill();
function setAim(point) {
  aim = point;
  showSolutions();
  viewer.set_dirty();
}
// Move the tcp to a point in base_link, or as near to it as a branch can; the jaws stay as they are.
function follow(point, branch) {
  aim = point;
  fill();
  const nearest = reach(point, branch);
  setPose(withJaws(nearest.q));
  short = nearest.away > 1e-7;
  if (short) showSolutions();
}
// Move the arm to another branch, with the tcp at the target or where it is.
function take(branch) {
  follow(aim || tcpInBase(), branch);
  keepInSight();
}

function showSolutions() {
  const found = solutions(aim || tcpInBase());
  const now = poses[root] && currentBranch();
  buttons.forEach((button, i) => {
    button.disabled = !aim || !found.within_limits[i];
    button.setAttribute("aria-pressed", aim !== null && i === now);
  });
  const away = aim ? Math.hypot(...tcpInBase().map((value, i) => value - aim[i])) : 0;
  missed = away > 1e-7 && (short || !found.within_limits.some(Boolean));
  say("target", missed ? missText(found, now, away) : "");
  drawGhosts(found);
}
function missText(found, now, away) {
  const others = branchNames.filter((_, i) => found.within_limits[i]);
  const nearest = Math.min(...data.branches.map((_, i) => reach(aim, i).away));
  if (nearest > 1e-7 && away - nearest < 1e-7) return `Target out of reach: the tip stops ${mm(away)} mm from it.`;
  if (nearest > 1e-7) return `Target out of reach by ${mm(nearest)} mm; the tip is ${mm(away)} mm from it.`;
  return `The tip is ${mm(away)} mm from the target, which ${others.join(" and ")} ${others.length > 1 ? "reach" : "reaches"}.`;
}
onPose(() => {
  short = false;
  showSolutions();
});

// ---- the handle on the tip: drag it in the plane that faces the camera
const tip = byId("tip");
let held = null;
tip.onpointerdown = (event) => {
  tip.setPointerCapture(event.pointerId);
  const [x, y, depth] = onScreen(origin(poses.tcp));
  held = { branch: currentBranch(), dx: x - event.clientX, dy: y - event.clientY, depth };
  if (!shown.ghosts) setGroup("ghosts", true);
  event.preventDefault();
};
tip.onpointermove = (event) => {
  if (held) follow(toBase(fromScreen(event.clientX + held.dx, event.clientY + held.dy, held.depth)), held.branch);
};
tip.onpointerup = tip.onpointercancel = () => keepInSight(held = null);
