// Self-collision: which links touch at the poses of all links, exactly for the boxes and cylinders that stand for them.
//
// Two convex shapes touch if the differences of their points contain the origin. GJK looks for a tetrahedron of
// such differences around it [Gilbert1988]; each step adds the difference that is farthest towards the origin.
import { data } from "./data.js";
import { compose, cross, dot, minus, origin } from "./vectors.js";

const STEPS_OF_GJK = 64;

// The pairs of links that touch at some poses, [[name, name], ...].
export function touching(at) {
  const placed = data.collision.bodies.map((body) => body.shapes.map((shape) => inWorld(shape, at[body.link])));
  const found = data.collision.pairs.filter(([one, other]) => placed[one].some((a) => placed[other].some((b) => meet(a, b))));
  return found.map((pair) => pair.map((body) => data.collision.bodies[body].link));
}
// A shape with its axes as rows, and its middle.
function inWorld(shape, link) {
  const pose = compose(link, shape.placement);
  return { ...shape, axes: [0, 1, 2].map((j) => pose.map((row) => row[j])), middle: origin(pose) };
}
export const spoken = (pairs) => pairs.map((pair) => pair.join(" with ")).join(", ");

function meet(a, b) {
  const between = minus(a.middle, b.middle);
  const reach = a.radius + b.radius;
  return dot(between, between) <= reach * reach && contains([], between, a, b);
}
// Whether the differences of points of a and b contain the origin.
function contains(corners, start, a, b) {
  let direction = start.map((x) => -x);
  for (let step = 0; step < STEPS_OF_GJK; step++) {
    const opposite = direction.map((x) => -x);
    const corner = minus(farthest(a, direction), farthest(b, opposite));
    if (dot(corner, direction) < 0) return false;
    corners.push(corner);
    direction = PARTS[corners.length - 1](corners);
    if (!direction || dot(direction, direction) === 0) return true;
  }
  return true; // so near to contact that rounding decides
}
// The point of a shape that is farthest in a direction.
function farthest(shape, direction) {
  const local = shape.axes.map((axis) => dot(axis, direction));
  const [x, y, z] = shape.half;
  const across = Math.hypot(local[0], local[1]);
  const scale = across > 0 ? x / across : 0;
  const ends = shape.round ? [scale * local[0], scale * local[1]] : [x * signed(local[0]), y * signed(local[1])];
  const at = [...ends, z * signed(local[2])];
  return shape.middle.map((m, i) => m + at[0] * shape.axes[0][i] + at[1] * shape.axes[1][i] + at[2] * shape.axes[2][i]);
}
const signed = (x) => x < 0 ? -1 : 1;

// By number of corners: keep the part next to the origin, newest corner last, and say where the origin is from it.
const PARTS = [(corners) => corners[0].map((x) => -x), nearEdge, nearTriangle, nearTetrahedron];
function nearEdge(corners) {
  const [b, a] = corners;
  const edge = minus(b, a);
  const inwards = a.map((x) => -x);
  if (dot(edge, inwards) > 0) return cross(cross(edge, inwards), edge);
  corners.splice(0, 2, a);
  return inwards;
}
function nearTriangle(corners) {
  const [c, b, a] = corners;
  const [ab, ac] = [minus(b, a), minus(c, a)];
  const inwards = a.map((x) => -x);
  const normal = cross(ab, ac);
  if (dot(cross(normal, ac), inwards) > 0 && dot(ac, inwards) > 0) {
    corners.splice(0, 3, c, a);
    return cross(cross(ac, inwards), ac);
  }
  if (dot(cross(normal, ac), inwards) > 0 || dot(cross(ab, normal), inwards) > 0) {
    corners.splice(0, 3, b, a);
    return nearEdge(corners);
  }
  if (dot(normal, inwards) > 0) return normal;
  corners.splice(0, 3, b, c, a); // turned, so that the normal looks at the origin
  return normal.map((x) => -x);
}
function nearTetrahedron(corners) {
  const [d, c, b, a] = corners;
  const inwards = a.map((x) => -x);
  for (const [one, other] of [[b, c], [c, d], [d, b]]) {
    if (dot(cross(minus(one, a), minus(other, a)), inwards) > 0) {
      corners.splice(0, 4, other, one, a);
      return nearTriangle(corners);
    }
  }
  return null; // the origin is inside
}
