// Where the links are, the inverse kinematics, and the nearest point that a branch reaches.
//
// q are the positions of the joints with a slider, axis_e to axis_b and perhaps axis_a. In branch i of data.branches the
// arm faces the point if i is even, and turns its back to it if i is odd; in branches 2 and 3 the elbow is flipped.
import { data } from "./data.js";
import { IDENTITY, apart, clamp, compose, cross, dot, minus, origin, placed, rotation, scaled, translation, turned, wrapped } from "./vectors.js";
import { inverse_kinematics } from "./inverse_kinematics.js";

export const root = data.tree[0].parent;
export const joints = data.sliders.map((name) => data.tree.find((joint) => joint.name === name));
// A joint this far beyond a limit is on it [rad or m]: the number may have been printed with six digits.
export const ON_LIMIT = 1e-6;
// Link -> the links that move with it, itself included.
export const carried = {};
for (const joint of data.tree.slice().reverse()) {
  carried[joint.child] = [joint.child, ...(carried[joint.child] || [])];
  carried[joint.parent] = [...(carried[joint.parent] || []), ...carried[joint.child]];
}
const toTip = data.tree.filter((joint) => carried[joint.child].includes("tcp"));

// Pose of a joint's child in its parent.
function motion(joint, q) {
  const at = data.sliders.indexOf(joint.source);
  const position = joint.multiplier * (at < 0 ? 0 : q[at]) + joint.offset;
  const moved = joint.kind === "revolute" ? rotation(joint.axis, position) : translation(scaled(joint.axis, joint.kind === "prismatic" ? position : 0));
  return compose(joint.transform, moved);
}
// Poses of all links; `fixed` has those of links without a joint.
export function posesAt(q, fixed) {
  const poses = { ...fixed };
  for (const joint of data.tree) poses[joint.child] = compose(poses[joint.parent], motion(joint, q));
  return poses;
}
// The turn of a base with roll and pitch in the world.
export const mounting = ([roll, pitch]) => compose(rotation([0, 1, 0], pitch), rotation([1, 0, 0], roll));
// The tcp in base_link.
export const tip = (q) => origin(toTip.reduce((pose, joint) => compose(pose, motion(joint, q)), IDENTITY));
// The axis of a joint, and a point on it.
export const axis = (joint, poses) => turned(poses[joint.child], joint.axis);
export const pivot = (joint, poses) => origin(poses[joint.child]);

// How far the tip moves per rad of the joints in its weakest direction [m/rad]: the least singular value of its Jacobian,
// by the eigenvalues of a symmetric matrix in closed form [Smith1961].
export function weakest(poses) {
  const columns = joints.slice(0, 4).map((joint) => cross(axis(joint, poses), minus(origin(poses.tcp), pivot(joint, poses))));
  const m = [0, 1, 2].map((i) => [0, 1, 2].map((j) => columns.reduce((sum, column) => sum + column[i] * column[j], 0)));
  const mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  const off = m[0][1] ** 2 + m[0][2] ** 2 + m[1][2] ** 2;
  const spread = Math.sqrt(([0, 1, 2].reduce((sum, i) => sum + (m[i][i] - mean) ** 2, 0) + 2 * off) / 6);
  if (spread === 0) return Math.sqrt(mean);
  const b = m.map((row, i) => row.map((x, j) => (x - (i === j ? mean : 0)) / spread));
  const half = dot(b[0], cross(b[1], b[2])) / 2;
  return Math.sqrt(Math.max(mean + 2 * spread * Math.cos(Math.acos(clamp(half, -1, 1)) / 3 + 2 * Math.PI / 3), 0));
}

// ---- inverse kinematics
export const solutions = (point, wrist) => inverse_kinematics(point, wrist, data.kinematics);
export const turnBetween = (one, other) => Math.max(...one.map((value, i) => Math.abs(wrapped(value - other[i]))));
// The branch that the arm is on; the first one if two meet there.
export function currentBranch(q) {
  const found = solutions(tip(q), q[3]);
  const gaps = found.q.map((solution, i) => found.exists[i] ? turnBetween(solution, q.slice(0, 4)) : Infinity);
  return gaps.indexOf(Math.min(...gaps));
}

// Joint angles of a branch, within the limits, with the tcp at a point or as near to it as possible, and the distance.
//
// At the present theta_3 the tool point is at the distance w beside the plane of the arm, r outwards and z up:
// tcp = (r cos - w sin, r sin + w cos, z) of the azimuth that the plane faces. The second link in the plane ends at the foot
// of the tool point. See alpha5_model/kinematics/geometry.py.
export function reach(point, branch, present) {
  const wrist = present[3];
  const found = solutions(point, wrist);
  const forearm = forearmAt(wrist);
  const radius = Math.hypot(point[0], point[1]);
  if (found.within_limits[branch]) { // on the yaw axis any azimuth will do
    const free = Math.max(radius, Math.abs(forearm.w)) < 1e-9;
    return { q: free ? [present[0], ...found.q[branch].slice(1)] : found.q[branch], away: 0 };
  }
  const { lower, upper, azimuth_offset } = data.shape;
  const side = branch % 2 ? -1 : 1;
  const facing = azimuthTo(point, side * radius, forearm.w) - azimuth_offset;
  const starts = radius < 1e-9 ? [present[0]] : [facing, lower[0], upper[0]];
  let best = { away: Infinity };
  for (const start of starts) {
    const nearest = descend(point, branch, side, forearm, turnWithin(start), wrist);
    if (nearest.away < best.away) best = nearest;
  }
  // The limits may leave no angle to a branch.
  return best.q ? best : { q: present.slice(0, 4), away: apart(tip(present), point) };
}
const azimuthTo = ([x, y], r, w) => Math.atan2(y * r - x * w, x * r + y * w);
// The angle of axis_e within its limits that is nearest to another one.
function turnWithin(angle) {
  const [low, high] = [data.shape.lower[0], data.shape.upper[0]];
  const middle = (low + high) / 2;
  return clamp(middle + wrapped(angle - middle), low, high);
}

// The second link: its length, gamma minus theta_2, and w, at an angle of axis_b.
function forearmAt(wrist) {
  const { a_2, x, y, z, elbow_offset, wrist_offset } = data.shape;
  const [cosine, sine] = [Math.cos(wrist + wrist_offset), Math.sin(wrist + wrist_offset)];
  const along = a_2 + x * cosine - y * sine;
  return {
    length: Math.hypot(along, z),
    gamma_offset: elbow_offset + Math.PI - Math.atan2(-z, along),
    w: -(x * sine + y * cosine),
  };
}

// Move the arm in its plane and turn the plane in turns, each to the nearest point, until neither helps.
function descend(point, branch, side, forearm, start, wrist) {
  const { azimuth_offset } = data.shape;
  let best = { away: Infinity };
  let turn = start;
  for (let i = 0; i < 300; i++) {
    const nearest = inPlane(point, branch, side, forearm, turn, wrist);
    if (!(nearest.away < best.away - 1e-12)) break;
    best = nearest;
    if (Math.hypot(point[0], point[1]) < 1e-9) break; // no azimuth is nearer than another
    const [x, y] = tip(nearest.q);
    const facing = turn + azimuth_offset;
    turn = turnWithin(azimuthTo(point, x * Math.cos(facing) + y * Math.sin(facing), forearm.w) - azimuth_offset);
  }
  return best;
}

// The nearest point with axis_e at an angle: the foot of the point in the plane, or a point on an edge.
function inPlane(point, branch, side, forearm, turn, wrist) {
  const facing = turn + data.shape.azimuth_offset;
  const [cosine, sine] = [Math.cos(facing), Math.sin(facing)];
  const goal = [point[0] * cosine + point[1] * sine, point[2]];
  const foot = solutions([goal[0] * cosine - forearm.w * sine, goal[0] * sine + forearm.w * cosine, point[2]], wrist);
  const inside = foot.within_limits[branch] ? [foot.q[branch].slice(1, 3)] : [];
  let best = { away: Infinity };
  for (const [theta1, theta2] of [...inside, ...edges(goal, side, branch > 1, forearm)]) {
    const q = [turn, theta1, theta2, wrist];
    const away = apart(tip(q), point);
    if (away < best.away) best = { q, away };
  }
  return best;
}

// Candidates for the nearest point in the plane: on the arcs on which one joint moves and the other is at a limit.
function edges(goal, side, flipped, { length: l_2, gamma_offset }) {
  const { a_0, d_0, a_1: l_1, phi_offset, lower, upper } = data.shape;
  const phis = [lower[1] + phi_offset, upper[1] + phi_offset];
  const found = [];
  function arc(center, length, from, to, jointsAt) {
    const toGoal = Math.atan2(goal[1] - center[1], goal[0] - center[0]);
    const across = Math.acos(-center[0] / length); // where the arc meets the yaw axis; NaN if it does not
    for (const angle of [from, to, toGoal, across, -across]) {
      const onArc = from + ((angle - from) % (2 * Math.PI) + 2 * Math.PI) % (2 * Math.PI);
      const inside = onArc <= to || angle === to;
      const r = center[0] + length * Math.cos(angle);
      if (inside && side * r >= -1e-12) {
        const [phi, gamma] = jointsAt(angle === to ? to : onArc);
        found.push([phi - phi_offset, gamma - gamma_offset]);
      }
    }
  }
  for (const gammas of elbowRanges(lower[2] + gamma_offset, upper[2] + gamma_offset, flipped)) {
    for (const phi of phis) {
      const elbow = [a_0 + l_1 * Math.cos(phi), d_0 + l_1 * Math.sin(phi)];
      arc(elbow, l_2, phi + Math.PI - gammas[1], phi + Math.PI - gammas[0], (angle) => [phi, phi + Math.PI - angle]);
    }
    for (const gamma of gammas) {
      const [x, z] = [l_1 - l_2 * Math.cos(gamma), l_2 * Math.sin(gamma)];
      const lead = Math.atan2(z, x);
      arc([a_0, d_0], Math.hypot(x, z), phis[0] + lead, phis[1] + lead, (angle) => [angle - lead, gamma]);
    }
  }
  return found;
}
// The parts of a range of gamma in which the elbow is flipped, or is not: between pi and 2 pi, or 0 and pi, up to turns.
function elbowRanges(low, high, flipped) {
  const found = [];
  for (let half = Math.floor(low / Math.PI); half * Math.PI <= high; half++) {
    const odd = half % 2 !== 0;
    if (odd === flipped) found.push([Math.max(low, half * Math.PI), Math.min(high, (half + 1) * Math.PI)]);
  }
  return found;
}
// A point of base_link in the world.
