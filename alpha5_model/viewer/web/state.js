// All that a person can change on the page, in one place: what a link has to restore. Angles in rad, all else in SI units.
//
// change({ entry: value, ... }, by) is the only way to change it; `shown` takes some of its groups. After that each watcher of
// onChange is called with what was given and with who changed it: "hand", "travel", "motion", "python" or "page".
import { data } from "./data.js";
import { mounting, posesAt, root } from "./kinematics.js";

export const state = {
  q: data.q, // of the joints with a slider, in their order
  root: data.root, // poses of links without a joint; Python moves a floating base
  aim: data.target, // target of the tcp in base_link, or null
  density: data.water.density, // of the fluid
  current: data.water.water_velocity, // velocity of the water, in base_link if the base is fixed
  payload: data.payload, // mass, com and volume of what the arm holds, in tcp
  attitude: data.attitude, // roll and pitch of a fixed base in the world, in which gravity points down
  limits: data.sliders.slice(0, 4).map(() => null), // torques that the joints may hold, or null
  shown: Object.fromEntries(data.groups.map(({ name, shown }) => [name, shown])),
  view: "home", // the view that is kept when the window changes; null after the user has turned it
  degrees: true, // whether angles are in degrees
  guard: false, // whether a hand stops before the arm touches itself
};
export const isPose = (q) => Array.isArray(q) && q.length === data.sliders.length && q.every(Number.isFinite);
// Poses of all links at q, with the base as it is now.
export const posesOf = (q) => posesAt(q, data.fixed ? { ...state.root, [root]: mounting(state.attitude) } : state.root);
state.poses = posesOf(state.q);

const watchers = [];
export const onChange = (watcher) => watchers.push(watcher);
export function change(part, by = "hand") {
  if ("q" in part && !isPose(part.q)) throw new RangeError(`expected ${data.sliders.length} finite numbers, got ${part.q}`);
  Object.assign(state, part, { shown: { ...state.shown, ...part.shown } });
  if ("q" in part || "attitude" in part || "root" in part) state.poses = posesOf(state.q);
  for (const watcher of watchers) watcher(part, by);
}
