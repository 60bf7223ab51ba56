// meshcat's viewer and what it draws: bodies and groups from Python's commands, arrows of forces, and the payload.
import { data } from "./data.js";
import { touching } from "./collision.js";
import { ON_LIMIT, joints, root } from "./kinematics.js";
import { flow, gravity } from "./statics.js";
import { change, onChange, state } from "./state.js";
import { byId, dark, say } from "./page.js";
import { IDENTITY, compose, placed, plus, scaled } from "./vectors.js";

export const { THREE } = MeshCat;
export const viewer = makeViewer();
// Without WebGL nothing is drawn: look.css hides what only serves the picture, and all else works.
function makeViewer() {
  try {
    return new MeshCat.Viewer(byId("pane"));
  } catch {
    document.documentElement.dataset.drawn = "false";
    say("webgl", "The arm is not drawn: this browser offers no WebGL. The numbers and their controls work without it.");
    const none = () => {};
    const renderer = { domElement: document.createElement("canvas"), setPixelRatio: none, setSize: none, render: none };
    return new MeshCat.Viewer(byId("pane"), true, renderer);
  }
}
export const split = (path) => path.split("/").filter((part) => part);
export const vector = (elements) => new THREE.Vector3().fromArray(elements);
export const matrix = (pose) => new THREE.Matrix4().set(...pose.flat(), 0, 0, 0, 1);
const groupPath = (group) => split(`/meshcat/alpha5/${group}`);
export const nodeOf = (group) => viewer.scene_tree.find(groupPath(group)).object;
// The meshes under a node of meshcat's scene tree.
function meshesUnder(node) {
  const found = [];
  node.traverse((part) => part.isMesh && found.push(part));
  return found;
}
export const meshesOf = (group) => meshesUnder(nodeOf(group));
export const bodiesOf = (link) => data.links[link] ? meshesUnder(viewer.scene_tree.find(split(data.links[link])).object) : [];
// The limit that a joint is beyond by more than rounding, or undefined.
export function limitBeyond(joint) {
  const at = state.q[joints.indexOf(joint)];
  return [joint.lower, joint.upper].find((end, i) => (i ? 1 : -1) * (at - end) > ON_LIMIT);
}

// ---- commands that build and move the scene, from this file or from a live server
const geometries = {}; // meshes by identifier; one that several shapes share comes with the first of them
const listeners = [];
export const onCommand = (listener) => listeners.push(listener);
const handle = viewer.handle_command.bind(viewer);

viewer.handle_command = (command) => {
  const { geometries: sent = [], materials = [] } = command.type === "set_object" ? command.object : {};
  for (const geometry of sent) {
    if (geometry.data) geometries[geometry.uuid] = geometry.data;
    else geometry.data = geometries[geometry.uuid];
  }
  // Transparent shapes touch bodies in places: draw them as if they were nearer.
  for (const each of materials) {
    Object.assign(each, { polygonOffset: each.opacity < 1, polygonOffsetFactor: -1, polygonOffsetUnits: -4 });
  }
  handle(command);
  if (command.type === "set_property" && command.property === "visible") {
    const group = split(command.path)[2];
    if (group in state.shown) change({ shown: { [group]: command.value } }, "python");
  }
  for (const listener of listeners) listener(command);
};

// ---- where everything is
export function anchored(item) {
  if (item.link) return compose(state.poses[item.link], item.placement);
  const total = item.points.reduce((sum, entry) => sum + entry[1], 0);
  const mean = item.points.reduce((sum, [link, weight, point]) => plus(sum, placed(state.poses[link], point), weight / total), item.offset);
  return IDENTITY.map((row, i) => [...row.slice(0, 3), mean[i]]);
}
onChange(() => {
  for (const link in data.links) viewer.set_transform(split(data.links[link]), matrix(state.poses[link]).elements);
  for (const item of data.anchors) viewer.set_transform(split(item.path), matrix(anchored(item.anchor)).elements);
});

// ---- groups; bodies that are seen through; links beyond a limit, or that touch, in red
export const RED = new THREE.Color("#d40f0f");
onChange(() => {
  for (const { name } of data.groups) {
    if (name !== "labels" && name !== "see-through") nodeOf(name).visible = Boolean(state.shown[name]);
  }
  const veiled = Boolean(state.shown["see-through"]);
  const red = new Set([...joints.filter((joint) => limitBeyond(joint) !== undefined).map((joint) => joint.child), ...touching(state.poses).flat()]);
  for (const link in data.links) {
    for (const { material } of bodiesOf(link)) {
      material.emissive.copy(RED).multiplyScalar(red.has(link) ? 0.55 : 0);
      if (material.transparent === veiled) continue;
      Object.assign(material, { transparent: veiled, opacity: veiled ? data.seeThrough : 1, depthWrite: !veiled, needsUpdate: true });
    }
  }
  viewer.set_dirty();
});

// ---- backdrop and lights
function backdrop() {
  const [top, bottom] = data.backdrop[dark.matches ? "dark" : "light"];
  viewer.set_property(["Background"], "top_color", top);
  viewer.set_property(["Background"], "bottom_color", bottom);
}
backdrop();
dark.addEventListener("change", backdrop);
// The dark bodies need more light than meshcat's scene has.
for (const [name, strength] of [["AmbientLight", 0.75], ["PointLightNegativeX", 0.5], ["PointLightPositiveX", 0.5], ["FillLight", 0.5]]) {
  viewer.set_property(["Lights", name, "<object>"], "intensity", strength);
}
for (const name of ["Grid", "Axes"]) viewer.set_property([name], "visible", false);

// ---- arrows
const HEAD = 0.35; // of an arrow's length, at most
export const ARROW_COLORS = { weight: "#cc2b26", buoyancy: "#298cdb", current: "#00808c", payload: "#f28c1a" };
class Arrow {
  constructor(group, radius) {
    this.radius = radius;
    const material = new THREE.MeshPhongMaterial({ color: ARROW_COLORS[group], transparent: true, depthTest: false });
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 16).translate(0, 0.5, 0), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 20).translate(0, 0.5, 0), material);
    this.whole = new THREE.Group().add(this.shaft, this.head);
    for (const part of [this.shaft, this.head]) part.renderOrder = 1;
    nodeOf(group).add(this.whole);
  }
  // Draw it from a point of the world along a vector [m].
  point(from, along) {
    const length = Math.hypot(...along);
    this.whole.visible = length > 1e-6;
    if (!this.whole.visible) return;
    const head = Math.min(5 * this.radius, HEAD * length);
    this.whole.position.copy(vector(from));
    this.whole.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector(along).normalize());
    this.shaft.scale.set(this.radius, length - head, this.radius);
    this.head.scale.set(0.4 * head, head, 0.4 * head);
    this.head.position.y = length - head;
  }
}

// ---- weight and buoyancy of each body, and of the whole arm
const strength = Math.hypot(...gravity);
export const totals = () => ({
  weight: strength * data.loads.reduce((sum, { mass }) => sum + mass, 0),
  buoyancy: strength * state.density * data.loads.reduce((sum, { volume }) => sum + volume, 0),
});
export const KINDS = [
  { group: "weight", share: "mass", point: "com", newtons: () => 1 },
  { group: "buoyancy", share: "volume", point: "cob", newtons: () => -state.density },
].map((kind) => ({ ...kind, each: data.loads.map(() => new Arrow(kind.group, 0.0022)), whole: new Arrow(kind.group, 0.004) }));
onChange(() => {
  for (const kind of KINDS) {
    const along = (amount) => scaled(gravity, kind.newtons() * amount * data.arrows.force);
    const total = data.loads.reduce((sum, load) => sum + load[kind.share], 0);
    let middle = [0, 0, 0];
    data.loads.forEach((load, i) => {
      const at = placed(state.poses[load.link], load[kind.point]);
      kind.each[i].point(at, along(load[kind.share]));
      middle = plus(middle, at, load[kind.share] / total);
    });
    kind.whole.point(middle, along(total));
    kind.end = plus(middle, along(total));
  }
});

// ---- the current, and the payload: a ball of its volume at the tcp, and its net force
const currentArrow = new Arrow("current", 0.004);
export const currentFrom = () => placed(data.fixed ? state.poses[root] : IDENTITY, data.currentAt);
export const payloadAt = () => placed(state.poses.tcp, state.payload.com);
export const payloadForce = () => scaled(gravity, state.payload.mass - state.density * state.payload.volume);
const payloadBall = new THREE.Mesh(new THREE.SphereGeometry(1, 32, 16), new THREE.MeshPhongMaterial({ color: ARROW_COLORS.payload }));
nodeOf("payload").add(payloadBall);
const payloadArrow = new Arrow("payload", 0.004);
onChange(() => {
  const { mass, volume } = state.payload;
  currentArrow.point(currentFrom(), scaled(flow(state), data.arrows.current));
  payloadBall.visible = mass > 0;
  payloadBall.position.copy(vector(payloadAt()));
  payloadBall.scale.setScalar(Math.max(Math.cbrt(volume * 3 / (4 * Math.PI)), data.payloadRadius));
  payloadArrow.point(payloadAt(), scaled(payloadForce(), mass > 0 ? data.arrows.force : 0));
});

for (const command of data.commands) {
  viewer.handle_command_bytearray(Uint8Array.from(atob(command), (c) => c.charCodeAt(0)));
}
