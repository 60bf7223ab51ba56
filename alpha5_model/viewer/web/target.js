// The target of the tcp: typed, dragged or given. The arm follows on its branch; the other solutions are ghosts.
import { data } from "./data.js";
import { spoken, touching } from "./collision.js";
import { currentBranch, reach, root, solutions, tip, turnBetween } from "./kinematics.js";
import { change, onChange, posesOf, state } from "./state.js";
import { added, asTyped, byId, mm, say } from "./page.js";
import { RED, THREE, bodiesOf, matrix, nodeOf, viewer } from "./scene.js";
import { fromScreen, inCamera, keepInSight, onScreen, pictureAxes, stopGliding } from "./camera.js";
import { followHand, isMoving, moveByHand, onArrival, travelTo } from "./travel.js";
import { apart, largestDifference, origin, placedBack, plus } from "./vectors.js";

// Distances below half the last digit that is shown are none [m].
const SHOWN = 0.05e-3;
// Largest coordinate that may be typed [mm]; the arm reaches a twentieth of it.
export const NEAR = 10000;
let short = false; // whether the arm was sent to the target and its branch cannot reach it
let missed = false; // whether the page shows that the tcp is not at the target
export const isMissed = () => missed;
const tcp = () => tip(state.q);
const withJaws = (turned) => [...turned, ...state.q.slice(4)];

const fields = ["x", "y", "z"].map((axis) => {
  const label = added(byId("target"), "label", { textContent: axis });
  const input = added(label, "input", { type: "number", step: "any", name: axis });
  input.setAttribute("aria-label", `target ${axis} in mm`);
  input.oninput = () => {
    say("typed", "");
    if (isNear(input)) change({ aim: typed() });
  };
  input.onchange = () => {
    if (!isNear(input)) refuse(input, axis);
    else if (state.aim) follow(state.aim, freeBranch(state.aim), (goal) => travelTo(goal, "Target"));
  };
  return input;
});
added(byId("target"), "span", { textContent: "mm" });
const branchNames = data.branches.map((name) => name.replace("_", " "));
const buttons = branchNames.map((name, i) => added(byId("ways"), "button", { textContent: name, onclick: () => take(i) }));

const isNear = (input) => !(Math.abs(input.valueAsNumber) > NEAR) && !input.validity.badInput;
function refuse(input, axis) {
  const given = input.validity.badInput ? "needs a number" : `cannot be ${asTyped(input)} mm`;
  say("typed", `The target's ${axis} ${given}: it must lie between \u2212${NEAR} and ${NEAR} mm.`);
  input.value = state.aim ? (1e3 * state.aim[fields.indexOf(input)]).toFixed(1) : "";
}
function typed() {
  const point = fields.map((input) => input.valueAsNumber / 1e3);
  return point.every(Number.isFinite) ? point : null;
}
// Move one joint, or all, by hand: the arm leaves its target.
export function leaveTarget() {
  if (!state.aim) return;
  for (const input of fields) input.value = "";
  change({ aim: null });
}
// Move the tcp to a point in base_link, or as near to it as a branch can; the jaws stay as they are.
export function follow(point, branch, move = moveByHand) {
  const nearest = reach(point, branch, state.q);
  change({ aim: point });
  move(withJaws(nearest.q));
  short = nearest.away > 1e-7;
  if (short) change({}, "page");
}
// The branch of the arm, or another one that reaches the point if the arm would touch itself on its own.
function freeBranch(point) {
  const now = currentBranch(state.q);
  const found = solutions(point, state.q[3]);
  const collides = (i) => touching(posesOf(withJaws(found.q[i]))).length > 0;
  if (!found.within_limits[now] || !collides(now)) return now;
  const free = branchNames.findIndex((_, i) => found.within_limits[i] && !collides(i));
  return free < 0 ? now : free;
}
// Move the arm to another branch, with the tcp at the target or where it is.
function take(branch) {
  follow(state.aim || tcp(), branch, (goal) => travelTo(goal, branchNames[branch]));
}

onChange((part, by) => {
  if ("q" in part && by !== "travel") short = false;
  fields.forEach((input, i) => { if (state.aim && input !== document.activeElement) input.value = (1e3 * state.aim[i]).toFixed(1); });
  showSolutions();
});
onArrival(() => { showSolutions(); keepInSight(); });
function showSolutions() {
  const found = solutions(state.aim || tcp(), state.q[3]);
  const now = currentBranch(state.q);
  const wouldTouch = branchNames.map((_, i) => found.within_limits[i] ? touching(posesOf(withJaws(found.q[i]))) : []);
  buttons.forEach((button, i) => {
    button.disabled = !found.within_limits[i];
    button.setAttribute("aria-pressed", i === now);
    button.classList.toggle("collides", wouldTouch[i].length > 0);
    button.title = wouldTouch[i].length ? `The arm collides with itself there: ${spoken(wouldTouch[i])}.` : "";
  });
  const away = state.aim ? apart(tcp(), state.aim) : 0;
  missed = away > SHOWN && (short || !found.within_limits.some(Boolean));
  say("target", missed && !isMoving() ? missText(found, away) : "");
  drawGhosts(found, wouldTouch);
}
function missText(found, away) {
  const others = branchNames.filter((_, i) => found.within_limits[i]);
  const nearest = Math.min(...branchNames.map((_, i) => reach(state.aim, i, state.q).away));
  if (nearest > SHOWN && away - nearest < SHOWN) return `Target out of reach: the tip stops ${mm(away)} mm from it.`;
  if (nearest > SHOWN) return `Target out of reach by ${mm(nearest)} mm; the tip is ${mm(away)} mm from it.`;
  return `The tip is ${mm(away)} mm from the target, which ${others.join(" and ")} ${others.length > 1 ? "reach" : "reaches"}.`;
}

// ---- the handle on the tip: drag it in the plane that faces the camera
const handle = byId("tip");
let held = null;
handle.onpointerdown = (event) => {
  handle.setPointerCapture(event.pointerId);
  stopGliding();
  const [x, y, depth] = onScreen(origin(state.poses.tcp));
  held = { branch: currentBranch(state.q), dx: x - event.clientX, dy: y - event.clientY, depth };
  change({ shown: { ghosts: true } });
  event.preventDefault();
};
handle.onpointermove = (event) => {
  if (!held) return;
  const point = fromScreen(event.clientX + held.dx, event.clientY + held.dy, held.depth);
  follow(placedBack(state.poses[root], point), held.branch, followHand);
};
handle.onpointerup = handle.onpointercancel = () => keepInSight(held = null);
// An arrow key moves the tip by STEP in the plane that faces the camera, ten times as far with the shift key.
const STEP = 1e-3; // m
const ARROW_KEYS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
handle.onkeydown = (event) => {
  if (!(event.key in ARROW_KEYS)) return;
  event.preventDefault();
  const [right, up] = ARROW_KEYS[event.key];
  const length = STEP * (event.shiftKey ? 10 : 1);
  const [across, upwards] = pictureAxes();
  const goal = plus(plus(origin(state.poses.tcp), across, right * length), upwards, up * length);
  follow(placedBack(state.poses[root], goal), currentBranch(state.q), followHand);
};

// ---- ghosts: the other solutions for the target, or for the present tcp; a click on one moves the arm there
const COLORS = ["#0d8c80", "#d9730d", "#734dbf", "#8c801a"];
export const ghosts = branchNames.map((name, i) => {
  const solid = { color: COLORS[i], transparent: true, depthWrite: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  const ghost = { color: COLORS[i], material: new THREE.MeshPhongMaterial(solid), group: new THREE.Group(), links: {}, poses: {}, text: "", open: false };
  return Object.assign(ghost, { choose: () => { if (ghost.open) take(i); } });
});
// Make a ghost when it is first needed; it shares the geometries of the bodies.
function makeGhost(ghost) {
  for (const link in data.links) {
    if (link === root || link === "link_0") continue;
    const copy = new THREE.Group();
    for (const part of bodiesOf(link)) copy.add(new THREE.Mesh(part.geometry, ghost.material));
    if (!copy.children.length) continue;
    copy.matrixAutoUpdate = false;
    ghost.group.add(copy);
    ghost.links[link] = copy;
  }
  if (Object.keys(ghost.links).length) nodeOf("ghosts").add(ghost.group);
}
// Links at the same pose as in the arm or in another ghost are left out.
function drawGhosts(found, wouldTouch) {
  const drawn = [state.poses];
  ghosts.forEach((ghost, i) => {
    ghost.open = found.within_limits[i];
    ghost.group.visible = Boolean(state.shown.ghosts) && found.exists[i] && turnBetween(found.q[i], state.q.slice(0, 4)) > 1e-6;
    const collides = wouldTouch[i].length > 0;
    ghost.text = `${branchNames[i]}${collides ? ", collides" : ghost.open ? "" : ", beyond the limits"}`;
    ghost.material.color.set(collides ? RED : COLORS[i]);
    if (!ghost.group.visible) return;
    if (!ghost.group.parent) makeGhost(ghost);
    ghost.material.opacity = ghost.open ? 0.42 : 0.16;
    ghost.poses = posesOf(withJaws(found.q[i]));
    for (const link in ghost.links) {
      const pose = ghost.poses[link];
      ghost.links[link].matrix.copy(matrix(pose));
      ghost.links[link].visible = !drawn.some((other) => largestDifference(pose.flat(), other[link].flat()) < 1e-6);
    }
    drawn.push(ghost.poses);
  });
  viewer.set_dirty();
}
// A click chooses a ghost, unless the pointer was dragged to turn the view.
let pressed = null;
byId("pane").addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
byId("pane").addEventListener("click", (event) => {
  if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
  const chosen = ghostAt(event.clientX, event.clientY);
  if (chosen >= 0) take(chosen);
});
function ghostAt(x, y) {
  const caster = new THREE.Raycaster();
  caster.setFromCamera(inCamera(x, y), viewer.camera);
  const seen = ghosts.map((ghost) => {
    const hit = ghost.group.visible && ghost.open && caster.intersectObject(ghost.group, true).find((each) => each.object.parent.visible);
    return hit ? hit.distance : Infinity;
  });
  const nearest = Math.min(...seen);
  return nearest < Infinity ? seen.indexOf(nearest) : -1;
}
