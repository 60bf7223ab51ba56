// Joint angles of a branch, within the limits, with the tcp at a point or as near to it as possible, and the distance.
//
// This is nearest.js for any lengths, limits and tool point. At the present theta_3 the tool point is at the distance w
// beside the plane of the arm, r outwards and z up: tcp = (r cos - w sin, r sin + w cos, z) of the azimuth that the plane
// faces. The second link in the plane ends at the foot of the tool point. See alpha5_model/kinematics/geometry.py.
function reach(point, branch) {
  const found = solutions(point);
  const forearm = forearmAt(angles()[3]);
  const radius = Math.hypot(point[0], point[1]);
  if (found.within_limits[branch]) { // on the yaw axis any azimuth will do
    const free = Math.max(radius, Math.abs(forearm.w)) < 1e-9;
    return { q: free ? [angles()[0], ...found.q[branch].slice(1)] : found.q[branch], away: 0 };
  }
  const { lower, upper, azimuth_offset } = data.own.shape;
  const side = branch % 2 ? -1 : 1;
  const facing = azimuthTo(point, side * radius, forearm.w) - azimuth_offset;
  const starts = radius < 1e-9 ? [angles()[0]] : [facing, lower[0], upper[0]];
  const stays = tcpInBase();
  let best = { away: Infinity };
  for (const start of starts) {
    const nearest = descend(point, branch, side, forearm, turnWithin(start));
    if (nearest.away < best.away) best = nearest;
  }
  // The limits may leave no angle to a branch.
  return best.q ? best : { q: angles(), away: apart(stays, point) };
}
const apart = (one, other) => Math.hypot(...one.map((value, i) => value - other[i]));
const azimuthTo = ([x, y], r, w) => Math.atan2(y * r - x * w, x * r + y * w);
// The angle of axis_e within its limits that is nearest to another one.
function turnWithin(angle) {
  const [low, high] = [data.own.shape.lower[0], data.own.shape.upper[0]];
  const middle = (low + high) / 2;
  return clamp(middle + wrapped(angle - middle), low, high);
}

// The second link: its length, gamma minus theta_2, and w, at an angle of axis_b.
function forearmAt(wrist) {
  const { a_2, x, y, z, elbow_offset, wrist_offset } = data.own.shape;
  const [cosine, sine] = [Math.cos(wrist + wrist_offset), Math.sin(wrist + wrist_offset)];
  const along = a_2 + x * cosine - y * sine;
  return {
    length: Math.hypot(along, z),
    gamma_offset: elbow_offset + Math.PI - Math.atan2(-z, along),
    w: -(x * sine + y * cosine),
  };
}

// Move the arm in its plane and turn the plane in turns, each to the nearest point, until neither helps.
function descend(point, branch, side, forearm, start) {
  const { azimuth_offset } = data.own.shape;
  let best = { away: Infinity };
  let turn = start;
  for (let i = 0; i < 300; i++) {
    const nearest = inPlane(point, branch, side, forearm, turn);
    if (!(nearest.away < best.away - 1e-12)) break;
    best = nearest;
    if (Math.hypot(point[0], point[1]) < 1e-9) break; // no azimuth is nearer than another
    const [x, y] = formulas.forward_kinematics(nearest.q).map((row) => row[3]);
    const facing = turn + azimuth_offset;
    turn = turnWithin(azimuthTo(point, x * Math.cos(facing) + y * Math.sin(facing), forearm.w) - azimuth_offset);
  }
  return best;
}

// The nearest point with axis_e at an angle: the foot of the point in the plane, or a point on an edge.
function inPlane(point, branch, side, forearm, turn) {
  const facing = turn + data.own.shape.azimuth_offset;
  const [cosine, sine] = [Math.cos(facing), Math.sin(facing)];
  const goal = [point[0] * cosine + point[1] * sine, point[2]];
  const foot = solutions([goal[0] * cosine - forearm.w * sine, goal[0] * sine + forearm.w * cosine, point[2]]);
  const inside = foot.within_limits[branch] ? [foot.q[branch].slice(1, 3)] : [];
  let best = { away: Infinity };
  for (const [theta1, theta2] of [...inside, ...edges(goal, side, branch > 1, forearm)]) {
    const q = [turn, theta1, theta2, angles()[3]];
    const away = apart(formulas.forward_kinematics(q).slice(0, 3).map((row) => row[3]), point);
    if (away < best.away) best = { q, away };
  }
  return best;
}

// Candidates for the nearest point in the plane: on the arcs on which one joint moves and the other is at a limit.
function edges(goal, side, flipped, { length: l_2, gamma_offset }) {
  const { a_0, d_0, a_1: l_1, phi_offset, lower, upper } = data.own.shape;
  const phis = [lower[1] + phi_offset, upper[1] + phi_offset];
  const found = [];
  function arc(center, length, from, to, jointsAt) {
    const toGoal = Math.atan2(goal[1] - center[1], goal[0] - center[0]);
    const across = Math.acos(-center[0] / length); // where the arc meets the yaw axis; NaN if it does not
    for (const angle of [from, to, toGoal, across, -across]) {
      const turned = from + ((angle - from) % (2 * Math.PI) + 2 * Math.PI) % (2 * Math.PI);
      const inside = turned <= to || angle === to;
      const r = center[0] + length * Math.cos(angle);
      if (inside && side * r >= -1e-12) {
        const [phi, gamma] = jointsAt(angle === to ? to : turned);
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
