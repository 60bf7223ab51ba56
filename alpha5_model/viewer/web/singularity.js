// Singularities: where the tip hardly moves in some direction, however the joints turn.
const WEAK = 0.01; // m/rad; below it a message says so

// How far the tip moves per rad in its weakest direction: the least singular value of the Jacobian of its position [m/rad].
function weakest() {
  const rows = formulas.jacobian(angles()).slice(0, 3);
  const gram = rows.map((one) => rows.map((other) => one.reduce((sum, x, i) => sum + x * other[i], 0)));
  return Math.sqrt(Math.max(leastEigenvalue(gram), 0));
}
// The least eigenvalue of a symmetric 3 by 3 matrix, in closed form [Smith1961].
function leastEigenvalue(m) {
  const mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  const off = m[0][1] ** 2 + m[0][2] ** 2 + m[1][2] ** 2;
  const spread = Math.sqrt(([0, 1, 2].reduce((sum, i) => sum + (m[i][i] - mean) ** 2, 0) + 2 * off) / 6);
  if (spread === 0) return mean;
  const b = m.map((row, i) => row.map((x, k) => (x - (i === k ? mean : 0)) / spread));
  const half = (b[0][0] * (b[1][1] * b[2][2] - b[1][2] ** 2) - b[0][1] * (b[0][1] * b[2][2] - b[1][2] * b[0][2])
    + b[0][2] * (b[0][1] * b[1][2] - b[1][1] * b[0][2])) / 2;
  return mean + 2 * spread * Math.cos(Math.acos(clamp(half, -1, 1)) / 3 + 2 * Math.PI / 3);
}
onPose(() => {
  const least = weakest();
  say("singular", least < WEAK ? `Near a singularity: in one direction the tip moves by ${fixed(1e3 * least, 1)} mm per rad of the joints.` : "");
});
