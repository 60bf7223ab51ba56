// Numbers, vectors (3) and poses: the upper three rows of a transform, (3, 4).
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
export const wrapped = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const plus = (a, b, times = 1) => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
export const scaled = (a, by) => [a[0] * by, a[1] * by, a[2] * by];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const apart = (a, b) => Math.hypot(...minus(a, b));
export const largestDifference = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));

export const IDENTITY = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];
export const compose = (a, b) => a.map((row) => [0, 1, 2, 3].map(
  (j) => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j] + (j === 3 ? row[3] : 0)));
export const origin = (pose) => pose.map((row) => row[3]);
// A direction, and a point, of a frame in the world.
export const turned = (pose, direction) => pose.map((row) => dot(row, direction));
export const placed = (pose, point) => pose.map((row) => dot(row, point) + row[3]);
// A direction, and a point, of the world in a frame.
export const turnedBack = (pose, direction) => [0, 1, 2].map((j) => pose[0][j] * direction[0] + pose[1][j] * direction[1] + pose[2][j] * direction[2]);
export const placedBack = (pose, point) => turnedBack(pose, minus(point, origin(pose)));
// The turn by an angle about a unit axis [Rodrigues].
export function rotation([x, y, z], angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const t = 1 - c;
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0],
  ];
}
export const translation = ([x, y, z]) => [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z]];
