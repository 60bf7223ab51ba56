// Joint angles of a branch, within the limits, with the tcp at a point or as near to it as possible, and the distance.
function reach(point, branch) {
  const found = solutions(point);
  const radius = Math.hypot(point[0], point[1]);
  if (found.within_limits[branch]) { // on the yaw axis any azimuth will do
    return { q: radius < 1e-9 ? [angles()[0], ...found.q[branch].slice(1)] : found.q[branch], away: 0 };
  }
  const { lower, upper, middle, azimuth_offset } = data.plane;
  const side = branch % 2 ? -1 : 1;
  const azimuth = Math.atan2(side * point[1], side * point[0]) - azimuth_offset - middle[0];
  const turn = radius < 1e-9 ? angles()[0] : clamp(middle[0] + wrapped(azimuth), lower[0], upper[0]);
  const facing = turn + azimuth_offset;
  const goal = [point[0] * Math.cos(facing) + point[1] * Math.sin(facing), point[2]];
  const foot = solutions([goal[0] * Math.cos(facing), goal[0] * Math.sin(facing), point[2]]);
  const inside = foot.within_limits[branch] ? [foot.q[branch].slice(1, 3)] : []; // the point may be in reach in the plane at the azimuth limit
  let best = { away: Infinity };
  for (const [theta1, theta2] of [...inside, ...edges(goal, side, branch > 1)]) {
    const q = [turn, theta1, theta2, angles()[3]];
    const place = formulas.forward_kinematics(q).slice(0, 3).map((row) => row[3]);
    const away = Math.hypot(...place.map((value, i) => value - point[i]));
    if (away < best.away) best = { q, away };
  }
  return best;
}

// Candidates for the nearest point in the plane: on the arcs on which one joint moves and the other is at a limit.
function edges(goal, side, flipped) {
  const { a_0, d_0, l_1, l_2, phi_offset, gamma_offset, lower, upper } = data.plane;
  const phis = [lower[1] + phi_offset, upper[1] + phi_offset];
  const gammas = flipped ? [Math.PI, upper[2] + gamma_offset] : [lower[2] + gamma_offset, Math.PI];
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
  for (const phi of phis) {
    const elbow = [a_0 + l_1 * Math.cos(phi), d_0 + l_1 * Math.sin(phi)];
    arc(elbow, l_2, phi + Math.PI - gammas[1], phi + Math.PI - gammas[0], (angle) => [phi, phi + Math.PI - angle]);
  }
  for (const gamma of gammas) {
    const [x, z] = [l_1 - l_2 * Math.cos(gamma), l_2 * Math.sin(gamma)];
    const lead = Math.atan2(z, x);
    arc([a_0, d_0], Math.hypot(x, z), phis[0] + lead, phis[1] + lead, (angle) => [angle - lead, gamma]);
  }
  return found;
}
