// The camera: named views that frame the arm, its motion and all that is shown, in the free part of the window; scale bars.
//
// meshcat's camera is in a frame whose y axis points up.
import { data } from "./data.js";
import { change, posesOf, state } from "./state.js";
import { added, byId, calm, narrow, write } from "./page.js";
import { THREE, bodiesOf, matrix, meshesOf, onCommand, vector, viewer } from "./scene.js";
import { root } from "./kinematics.js";
import { clamp, placed } from "./vectors.js";

// "home" is the pose, so the button of its view has another word.
const TITLES = { home: "Corner", fit: "Fit", front: "Front", side: "Side", top: "Top" };
const KEYS = new Map([["h", "home"], ["f", "fit"], ["1", "front"], ["2", "side"], ["3", "top"]]);
const swap = ([x, y, z]) => [x, z, -y];
const unswap = ({ x, y, z }) => new THREE.Vector3(x, -z, y);
viewer.camera.fov = data.camera.field_of_view;
viewer.controls.minDistance = 0.05;
viewer.controls.maxDistance = 12;
let gliding = 0; // number of the latest camera movement; an earlier one stops
viewer.controls.addEventListener("start", () => {
  change({ view: null });
  gliding++;
});

for (const [key, name] of KEYS) {
  const title = TITLES[name];
  added(byId("views"), "button", { textContent: title, title: `${title} view (key ${key.toUpperCase()})`, onclick: () => look(name) });
}
document.addEventListener("keydown", (event) => {
  const name = KEYS.get(event.key.toLowerCase());
  if (name && !event.ctrlKey && !event.metaKey && !event.altKey && !event.target.closest("input[type=number], select")) look(name);
});

// The part of the window that no panel covers: [left, top, right, bottom] in pixels. It is measured when it has changed: a
// measurement in every frame would lay out the page in every frame.
let freePart = null;
export const free = () => freePart ??= measured();
function measured() {
  const box = (id) => byId(id).getBoundingClientRect();
  const bottom = byId("strip").hidden ? window.innerHeight : box("strip").top;
  const top = box("views").bottom;
  if (narrow.matches) return [0, top, window.innerWidth, Math.max(Math.min(bottom, box("panel").top), top + 120)];
  const folded = byId("panel").classList.contains("folded");
  return [folded ? 0 : box("panel").right, top, window.innerWidth, bottom];
}
const covers = new ResizeObserver(() => { freePart = null; viewer.set_dirty(); });
for (const id of ["panel", "views", "strip"]) covers.observe(byId(id));

// Pixels of the window to the camera's coordinates, a point of the world to pixels and depth, and back. meshcat's scene is turned.
export const inCamera = (x, y) => ({ x: 2 * x / window.innerWidth - 1, y: 1 - 2 * y / window.innerHeight });
export function onScreen(point) {
  const at = vector(point).applyMatrix4(viewer.scene.matrixWorld).project(viewer.camera);
  return [(at.x + 1) / 2 * window.innerWidth, (1 - at.y) / 2 * window.innerHeight, at.z];
}
export function fromScreen(x, y, depth) {
  const at = inCamera(x, y);
  return new THREE.Vector3(at.x, at.y, depth).unproject(viewer.camera).applyMatrix4(viewer.scene.matrixWorld.clone().invert()).toArray();
}

// ---- what the camera frames: the bodies at the poses to come, and everything else that is shown
const corners = {};
// The outermost vertices of a mesh in 26 directions.
function outermost(geometry) {
  if (corners[geometry.uuid]) return corners[geometry.uuid];
  const points = geometry.attributes.position;
  const far = [];
  for (let k = 0; k < 27; k++) {
    const [x, y, z] = [k % 3 - 1, (k / 3 | 0) % 3 - 1, (k / 9 | 0) - 1];
    let [best, at] = [-Infinity, 0];
    for (let i = 0; i < points.count; i++) {
      const along = x * points.getX(i) + y * points.getY(i) + z * points.getZ(i);
      if (along > best) [best, at] = [along, i];
    }
    far.push(new THREE.Vector3().fromBufferAttribute(points, at));
  }
  return corners[geometry.uuid] = far;
}
function bodiesAt(poses) {
  return Object.keys(data.links).flatMap((link) => bodiesOf(link).flatMap(
    (part) => outermost(part.geometry).map((point) => point.clone().applyMatrix4(matrix(poses[link])))));
}
const isSeen = (part) => !part || (part.visible && isSeen(part.parent));
const UNFRAMED = ["bodies", "labels", "see-through", "obstacles"]; // the sea bed is too wide to be seen whole
function pointsToFrame(all) {
  viewer.scene.updateMatrixWorld();
  const points = bodiesAt(state.poses);
  const coming = data.motion ? data.motion.q : Object.values(data.poses);
  const step = Math.ceil(coming.length / 40);
  if (all) for (let i = 0; i < coming.length; i += step) points.push(...bodiesAt(posesOf(coming[i])));
  if (state.aim) points.push(vector(placed(state.poses[root], state.aim)));
  for (const { name } of data.groups) {
    if (!state.shown[name] || UNFRAMED.includes(name)) continue;
    const parts = meshesOf(name).filter(isSeen);
    points.push(...parts.flatMap((part) => outermost(part.geometry).map((point) => unswap(point.clone().applyMatrix4(part.matrixWorld)))));
  }
  return points;
}

// ---- moving the camera
export function moveCamera(eye, target) {
  viewer.camera.position.set(...swap(eye));
  viewer.controls.target.set(...swap(target));
  viewer.controls.update();
  viewer.scene.updateMatrixWorld();
  viewer.set_dirty();
}
export const eye = () => unswap(viewer.camera.position).toArray();
export const lookedAt = () => unswap(viewer.controls.target).toArray();
// Centre the picture in the free part of the window.
function center() {
  const folded = byId("panel").classList.contains("folded");
  document.documentElement.style.setProperty("--left", folded ? "12px" : "352px");
  freePart = null;
  const [left, top, right, bottom] = free();
  const [w, h] = [window.innerWidth, window.innerHeight];
  document.documentElement.style.setProperty("--floor", `${h - bottom + 10}px`);
  viewer.renderer.setSize(w, h);
  viewer.camera.setViewOffset(w, h, (w - left - right) / 2, (h - top - bottom) / 2, w, h);
}
// The nearest camera that looks one way and sees all points in the free part of the window.
function framing(points, back) {
  const [left, top, right, bottom] = free();
  const tangent = Math.tan(viewer.camera.fov * Math.PI / 360) / (window.innerHeight / 2); // per pixel
  const margin = narrow.matches ? 14 : 32;
  const [wide, high] = [(right - left) / 2 - margin, (bottom - top) / 2 - margin].map((pixels) => Math.max(pixels, 40) * tangent);
  const [across, up] = levelAxes(back);
  const target = new THREE.Box3().setFromPoints(points).getCenter(new THREE.Vector3());
  let distance = 0;
  for (let i = 0; i < 4; i++) { // near points look larger, so the middle in space is not the middle in the picture
    const seen = points.map((point) => point.clone().sub(target)).map((p) => [p.dot(across), p.dot(up), p.dot(back)]);
    distance = Math.max(...seen.map(([x, y, z]) => z + Math.max(Math.abs(x) / wide, Math.abs(y) / high)));
    [across, up].forEach((axis, k) => {
      const tangents = seen.map((p) => p[k] / (distance - p[2]));
      target.addScaledVector(axis, (Math.max(...tangents) + Math.min(...tangents)) / 2 * distance);
    });
  }
  return { eye: target.clone().addScaledVector(back, distance), target };
}
const backwards = () => unswap(viewer.camera.position).sub(unswap(viewer.controls.target)).normalize();
// To the right and upwards in the picture of a camera that looks along -back.
function levelAxes(back) {
  const across = new THREE.Vector3(0, 0, 1).cross(back).normalize();
  return [across, back.clone().cross(across)];
}
export const pictureAxes = () => levelAxes(backwards()).map((axis) => axis.toArray());

export function look(name, slowly = true) {
  const back = name in data.views ? vector(data.views[name]).normalize() : backwards();
  change({ view: name in data.views ? name : null });
  center();
  const points = pointsToFrame(name !== "fit");
  if (!points.length) return;
  const to = framing(points, back);
  if (slowly && !calm.matches) glide(to);
  else moveCamera(to.eye.toArray(), to.target.toArray());
}
function glide(to) {
  const from = { eye: unswap(viewer.camera.position), target: unswap(viewer.controls.target) };
  const began = performance.now();
  const mine = ++gliding;
  const [near, far] = [from, to].map((at) => at.eye.distanceTo(at.target));
  const [start, end] = [from, to].map((at) => at.eye.clone().sub(at.target).normalize());
  function step(now) {
    if (mine !== gliding) return;
    const part = clamp((now - began) / 350, 0, 1);
    const eased = part * part * (3 - 2 * part);
    const target = from.target.clone().lerp(to.target, eased);
    const way = start.clone().lerp(end, eased).normalize();
    moveCamera(target.clone().addScaledVector(way, near + eased * (far - near)).toArray(), target.toArray());
    if (part < 1) requestAnimationFrame(step);
  }
  requestAnimationFrame(step);
}
export const stopGliding = () => { gliding++; };
// After the user has let go: move the camera back if the arm is out of the picture.
export function keepInSight() {
  const [left, top, right, bottom] = free();
  const aim = state.aim ? [placed(state.poses[root], state.aim)] : [];
  const seen = [...bodiesAt(state.poses).map((point) => point.toArray()), ...aim].map(onScreen);
  if (seen.some(([x, y]) => x < left || x > right || y < top || y > bottom)) glide(framing(pointsToFrame(true), backwards()));
}
viewer.set_3d_pane_size = () => {
  center();
  if (state.view) look(state.view, false);
  viewer.set_dirty();
};
// Frame the scene again when objects have come.
let waiting = false;
onCommand((command) => {
  if (command.type !== "set_object" || waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; if (state.view) look(state.view, false); });
});

// ---- scale bars of lengths and arrows, at the distance of the camera's target
const bars = [
  { name: "length", unit: "mm", each: 1e-3, groups: ["bodies", "labels"] },
  { name: "force", unit: "N", each: data.arrows.force, groups: ["weight", "buoyancy"] },
  { name: "current", unit: "m/s", each: data.arrows.current, groups: ["current"] },
];
for (const bar of bars) {
  bar.element = added(byId("scale"), "div", { className: bar.name });
  for (const part of ["span", "i"]) added(bar.element, part);
}
// The largest of 1, 2 or 5 times a power of ten that is at most a number.
function roundBelow(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((digit) => digit * power <= most * (1 + 1e-9)) * power;
}
export function drawScale() {
  const distance = viewer.camera.position.distanceTo(viewer.controls.target);
  const pixels = window.innerHeight / 2 / Math.tan(viewer.camera.fov * Math.PI / 360) / distance; // per metre
  for (const { unit, each, groups, element } of bars) {
    element.hidden = !groups.some((name) => state.shown[name]);
    const size = roundBelow(120 / (pixels * each));
    element.dataset.size = size;
    write(element.firstChild, `${Number(size.toPrecision(1))} ${unit}`);
    element.lastChild.style.width = `${(size * each * pixels).toFixed(2)}px`;
  }
}
