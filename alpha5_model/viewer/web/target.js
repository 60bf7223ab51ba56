// The target of the tcp: typed, dragged or given. The arm follows on its branch; the other solutions are ghosts.
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
    else if (state.aim) follow(state.aim, freeBranch(state.aim), (goal) => travelTo(goal, "Target"));
  };
  return input;
});
added(byId("target"), "span", { textContent: "mm" });
const branchNames = data.branches.map((name) => name.replace("_", " "));
const buttons = branchNames.map((name, i) => added(byId("ways"), "button", { textContent: name, onclick: () => take(i) }));

// Distances below half the last digit that is shown are none [m].
const SHOWN = 0.05e-3;
// Largest coordinate that may be typed [mm]; the arm reaches a twentieth of it.
const NEAR = 10000;
const near = (input) => !(Math.abs(input.valueAsNumber) > NEAR) && !input.validity.badInput;
function refuse(input, axis) {
  const given = input.validity.badInput ? "needs a number" : `cannot be ${asTyped(input)} mm`;
  say("typed", `The target's ${axis} ${given}: it must lie between \u2212${NEAR} and ${NEAR} mm.`);
  input.value = state.aim ? (1e3 * state.aim[fields.indexOf(input)]).toFixed(1) : "";
}
function typed() {
  const point = fields.map((input) => input.valueAsNumber / 1e3);
  return point.every(Number.isFinite) ? point : null;
}
function fill() {
  fields.forEach((input, i) => { if (state.aim && input !== document.activeElement) input.value = (1e3 * state.aim[i]).toFixed(1); });
}
fill();
function setAim(point) {
  change({ aim: point });
  showSolutions();
  viewer.set_dirty();
}
// Forget the target, which the arm leaves.
function dropTarget() {
  if (!state.aim) return;
  for (const input of fields) input.value = "";
  setAim(null);
}
// Move the tcp to a point in base_link, or as near to it as a branch can; the jaws stay as they are.
function follow(point, branch, move = setPose) {
  change({ aim: point });
  fill();
  const nearest = reach(point, branch);
  move(withJaws(nearest.q));
  short = nearest.away > 1e-7;
  if (short) showSolutions();
}
// The branch of the arm, or another one that reaches the point if the arm would touch itself on its own.
function freeBranch(point) {
  const now = currentBranch();
  const found = solutions(point);
  const collides = (i) => touching(posesAt(found.q[i])).length > 0;
  if (!found.within_limits[now] || !collides(now)) return now;
  const free = branchNames.findIndex((_, i) => found.within_limits[i] && !collides(i));
  return free < 0 ? now : free;
}
// Move the arm to another branch, with the tcp at the target or where it is.
function take(branch) {
  follow(state.aim || tcpInBase(), branch, (goal) => travelTo(goal, branchNames[branch]));
}

function showSolutions() {
  const found = solutions(state.aim || tcpInBase());
  const now = poses[root] && currentBranch();
  const wouldTouch = branchNames.map((_, i) => found.within_limits[i] ? touching(posesAt(found.q[i])) : []);
  buttons.forEach((button, i) => {
    button.disabled = !found.within_limits[i];
    button.setAttribute("aria-pressed", i === now);
    button.classList.toggle("collides", wouldTouch[i].length > 0);
    button.title = wouldTouch[i].length ? `The arm collides with itself there: ${spoken(wouldTouch[i])}.` : "";
  });
  const away = state.aim ? Math.hypot(...tcpInBase().map((value, i) => value - state.aim[i])) : 0;
  missed = away > SHOWN && (short || !found.within_limits.some(Boolean));
  say("target", missed && !moving ? missText(found, now, away) : "");
  drawGhosts(found, wouldTouch);
}
function missText(found, now, away) {
  const others = branchNames.filter((_, i) => found.within_limits[i]);
  const nearest = Math.min(...data.branches.map((_, i) => reach(state.aim, i).away));
  if (nearest > SHOWN && away - nearest < SHOWN) return `Target out of reach: the tip stops ${mm(away)} mm from it.`;
  if (nearest > SHOWN) return `Target out of reach by ${mm(nearest)} mm; the tip is ${mm(away)} mm from it.`;
  return `The tip is ${mm(away)} mm from the target, which ${others.join(" and ")} ${others.length > 1 ? "reach" : "reaches"}.`;
}
onPose((by) => {
  if (by !== "travel") short = false;
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
  if (held) follow(toBase(fromScreen(event.clientX + held.dx, event.clientY + held.dy, held.depth)), held.branch, moveWithHand);
};
tip.onpointerup = tip.onpointercancel = () => keepInSight(held = null);
// An arrow key moves the tip by STEP_OF_TIP in the plane that faces the camera, ten times as far with the shift key.
const STEP_OF_TIP = 1e-3; // m
const ARROW_KEYS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
tip.onkeydown = (event) => {
  if (!(event.key in ARROW_KEYS)) return;
  event.preventDefault();
  const [right, up] = ARROW_KEYS[event.key];
  const length = STEP_OF_TIP * (event.shiftKey ? 10 : 1);
  const back = backwards();
  const across = new THREE.Vector3(0, 0, 1).cross(back).normalize();
  const upwards = back.clone().cross(across);
  const goal = origin(poses.tcp).addScaledVector(across, right * length).addScaledVector(upwards, up * length);
  follow(toBase(goal), currentBranch(), moveWithHand);
};
