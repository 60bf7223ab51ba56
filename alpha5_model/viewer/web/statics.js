// Torques that hold the arm still: sums of moments of weights, buoyancies and the drag of a steady current.
//
// `at` has what they depend on: poses of the links, density of the fluid, current, and payload (entries of the state).
import { data } from "./data.js";
import { axis, carried, joints, pivot, root } from "./kinematics.js";
import { cross, dot, minus, origin, placed, plus, scaled, turned, turnedBack } from "./vectors.js";

export const { gravity } = data.water;
const LEVELS = ["low", "nominal", "high"];

// Force on each body and the point where it acts, in the world: weight at the centre of mass, buoyancy at its own.
function* forces({ poses, density, payload }) {
  const bodies = [...data.loads, { link: "tcp", mass: payload.mass, com: payload.com, volume: payload.volume, cob: payload.com }];
  for (const { link, mass, com, volume, cob } of bodies) {
    yield { link, force: scaled(gravity, mass), point: placed(poses[link], com) };
    yield { link, force: scaled(gravity, -density * volume), point: placed(poses[link], cob) };
  }
}
// The torque of each of the first four joints, without the current.
export function holding(at) {
  const all = [...forces(at)];
  return joints.slice(0, 4).map((joint) => {
    const [line, middle] = [axis(joint, at.poses), pivot(joint, at.poses)];
    const moved = all.filter(({ link }) => carried[joint.child].includes(link));
    return -moved.reduce((sum, { force, point }) => sum + dot(line, cross(minus(point, middle), force)), 0);
  });
}
// Force and moment that the arm at rest puts on its carrier at base_link, in base_link.
export function restLoad(at) {
  let [force, moment] = [[0, 0, 0], [0, 0, 0]];
  for (const each of forces(at)) {
    force = plus(force, each.force);
    moment = plus(moment, cross(minus(each.point, origin(at.poses[root])), each.force));
  }
  return [force, moment].map((each) => turnedBack(at.poses[root], each));
}

// Velocity of the water in the world.
export const flow = ({ poses, current }) => data.fixed ? turned(poses[root], current) : current;
// Torque of a steady current on a joint at rest: drag of the strips, and the Munk moment of the added mass.
function drag(joint, at, level) {
  const { poses, density } = at;
  const water = flow(at);
  let total = [0, 0, 0];
  for (const stream of data.water.streams[level]) {
    if (!carried[joint.child].includes(stream.link)) continue;
    const pose = poses[stream.link];
    for (const [middle, direction, across, along] of stream.strips) {
      const line = turned(pose, direction);
      const parallel = scaled(line, dot(water, line));
      const normal = minus(water, parallel);
      const force = plus(scaled(normal, across * Math.hypot(...normal)), parallel, along * Math.hypot(...parallel));
      total = plus(total, cross(minus(placed(pose, middle), pivot(joint, poses)), force));
    }
    const local = turnedBack(pose, water);
    total = plus(total, turned(pose, cross(local, turned(stream.added_mass, local))), -1);
  }
  return density * dot(total, axis(joint, poses));
}
// What each joint holds, and the interval of the estimates if the water flows: [{ value, low, high }, ...].
export function torques(at, flows) {
  return holding(at).map((still, i) => {
    if (!flows) return { value: still, low: still, high: still };
    const levels = LEVELS.map((level) => still - drag(joints[i], at, level));
    return { value: levels[1], low: Math.min(...levels), high: Math.max(...levels) };
  });
}
