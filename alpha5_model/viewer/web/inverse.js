// Inverse kinematics: all solutions for a point in base_link, and the nearest point if a branch has none.
//
// In branch i of data.branches the arm faces the point if i is even, and turns its back to it if i is odd; in
// branches 2 and 3 the elbow is flipped. In the arm's plane, r outwards and z up,
// tcp = (a_0, d_0) + l_1 e(phi) + l_2 e(phi + pi - gamma) with e(x) = (cos x, sin x), as in the Python package.
const tcpInBase = () => formulas.forward_kinematics(angles()).slice(0, 3).map((row) => row[3]);
const toBase = (point) => point.clone().applyMatrix4(poses[root].clone().invert()).toArray();
const toWorld = (point) => vector(point).applyMatrix4(poses[root]);
const solutions = (point) => formulas.inverse_kinematics(point, angles()[3]);
const largestDifference = (one, other) => Math.max(...one.map((value, i) => Math.abs(wrapped(value - other[i]))));

// The branch that the arm is on; the first one if two meet there.
function currentBranch() {
  const found = solutions(tcpInBase());
  const gaps = found.q.map((solution, i) => found.exists[i] ? largestDifference(solution, angles()) : Infinity);
  return gaps.indexOf(Math.min(...gaps));
}
