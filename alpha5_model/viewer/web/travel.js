// How the arm moves: at once while a hand moves it a little, else as fast as its joints are rated, along a straight joint line
// or after the hand. Only Python's plan proves that the arm does not touch itself on the way.
import { data } from "./data.js";
import { spoken, touching } from "./collision.js";
import { change, onChange, posesOf, state } from "./state.js";
import { byId, calm, fixed, say, write } from "./page.js";
import { clamp, largestDifference } from "./vectors.js";

const LONGEST_FRAME = 0.1; // s; while the browser stalls the arm waits, so that it never jumps
const FAR = 0.35; // rad; where a drag would turn a joint by more at once, the arm follows as fast as it can

// If it is wanted, a hand does not move the arm from a free position into itself.
const guard = byId("guard").firstChild;
guard.onchange = () => {
  say("guard", "");
  change({ guard: guard.checked });
};
onChange((part, by) => {
  guard.checked = state.guard;
  if ("q" in part && by !== "page") say("guard", "");
});
function isBlocked(q) {
  if (!state.guard || touching(state.poses).length) return false;
  const pairs = touching(posesOf(q));
  if (pairs.length) say("guard", `Stopped: ${spoken(pairs)} would touch.`);
  return pairs.length > 0;
}
// Move the arm at once, as a hand does; sliders and fields show where it stays if it is stopped.
export function moveByHand(q) {
  if (isBlocked(q)) change({}, "page");
  else change({ q }, "hand");
}

let goal = null; // where the arm is going, or null
let rates = data.speed; // how fast [rad/s or m/s]
let last = 0; // when the arm was moved last [ms]
export const isMoving = () => goal !== null;
const ends = [];
export const onArrival = (listener) => ends.push(listener);
const tell = (text) => write(byId("travel"), text);

// Move the arm to joint positions at rated speed.
export function travelTo(q, name) {
  if (isBlocked(q)) return change({}, "page");
  if (calm.matches || largestDifference(q, state.q) === 0) {
    moveByHand(q);
    return arrive();
  }
  const seconds = Math.max(...q.map((value, i) => Math.abs(value - state.q[i]) / data.speed[i]));
  // All joints arrive at the same time.
  start(q, q.map((value, i) => Math.abs(value - state.q[i]) / seconds), `${name}: ${fixed(seconds, 1)} s at rated speed.`);
}
// Follow a hand: at once, or as fast as the joints are rated if the arm would jump.
export function followHand(q) {
  if (calm.matches || (!isMoving() && largestDifference(q, state.q) < FAR)) return moveByHand(q);
  if (isMoving()) goal = q;
  else start(q, data.speed, "The arm follows as fast as it can.");
}
function start(q, speed, text) {
  tell(text);
  const wasMoving = isMoving();
  goal = q;
  rates = speed;
  if (wasMoving) return;
  last = performance.now();
  requestAnimationFrame(step);
}
function step(clock) {
  if (goal === null) return;
  const seconds = clamp((clock - last) / 1e3, 0, LONGEST_FRAME);
  last = clock;
  const next = state.q.map((value, i) => value + clamp(goal[i] - value, -seconds * rates[i], seconds * rates[i]));
  const arrived = next.every((value, i) => value === goal[i]);
  if (!isBlocked(next)) {
    change({ q: next }, "travel");
    if (!arrived) return requestAnimationFrame(step);
  }
  arrive();
}
function arrive() {
  goal = null;
  tell("");
  for (const listener of ends) listener();
}
// Whoever else moves the arm stops it.
onChange((part, by) => {
  if (!("q" in part) || by === "travel" || goal === null) return;
  goal = null;
  tell("");
});
