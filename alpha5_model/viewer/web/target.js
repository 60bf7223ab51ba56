// Where the tcp should be: typed, dragged or given. The arm follows on its branch; the other ways are ghosts.
let aim = data.target; // in base_link [m], or null
let short = false; // the arm was sent there, and its branch does not get there
let missed = false; // which is said, and drawn

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
    else if (aim) follow(aim, branchNow());
  };
  return input;
});
added(byId("target"), "span", { textContent: "mm" });
const wayNames = data.branches.map((name) => name.replace("_", " "));
const buttons = wayNames.map((name, i) => added(byId("ways"), "button", { textContent: name, onclick: () => take(i) }));

// What is typed lies this near to the base [mm]; the arm reaches a twentieth of it.
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
  showWays();
  viewer.set_dirty();
}
// Bring the tcp to a point of base_link, or as near as this branch comes; the jaws stay as they are.
function follow(point, branch) {
  aim = point;
  fill();
  const nearest = reach(point, branch);
  setPose(withJaws(nearest.q));
  short = nearest.away > 1e-7;
  if (short) showWays();
}
// Go one way: to the target, or to where the tcp is already.
function take(branch) {
  follow(aim || tcpInBase(), branch);
  keepInSight();
}

function showWays() {
  const found = ways(aim || tcpInBase());
  const now = poses[root] && branchNow();
  buttons.forEach((button, i) => {
    button.disabled = !aim || !found.within_limits[i];
    button.setAttribute("aria-pressed", aim !== null && i === now);
  });
  const away = aim ? Math.hypot(...tcpInBase().map((value, i) => value - aim[i])) : 0;
  missed = away > 1e-7 && (short || !found.within_limits.some(Boolean));
  say("target", missed ? howFar(found, now, away) : "");
  drawGhosts(found);
}
function howFar(found, now, away) {
  const others = wayNames.filter((_, i) => found.within_limits[i]);
  const nearest = Math.min(...data.branches.map((_, i) => reach(aim, i).away));
  if (nearest > 1e-7 && away - nearest < 1e-7) return `Target out of reach: the tip stops ${mm(away)} mm from it.`;
  if (nearest > 1e-7) return `Target out of reach by ${mm(nearest)} mm; the tip is ${mm(away)} mm from it.`;
  return `The tip is ${mm(away)} mm from the target, which ${others.join(" and ")} ${others.length > 1 ? "reach" : "reaches"}.`;
}
onPose(() => {
  short = false;
  showWays();
});

// ---- the tip as a handle: drag it in the plane that faces the eye
const tip = byId("tip");
let held = null;
tip.onpointerdown = (event) => {
  tip.setPointerCapture(event.pointerId);
  const [x, y, depth] = onScreen(origin(poses.tcp));
  held = { branch: branchNow(), dx: x - event.clientX, dy: y - event.clientY, depth };
  if (!shown.ghosts) setGroup("ghosts", true);
  event.preventDefault();
};
tip.onpointermove = (event) => {
  if (held) follow(toBase(fromScreen(event.clientX + held.dx, event.clientY + held.dy, held.depth)), held.branch);
};
tip.onpointerup = tip.onpointercancel = () => keepInSight(held = null);
