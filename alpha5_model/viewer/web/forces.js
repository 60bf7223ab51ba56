// Arrows that the page draws itself: weight, buoyancy, current, and the payload with its force.
const HEAD = 0.35; // of an arrow's length, at most
const ARROW_COLORS = { weight: "#cc2b26", buoyancy: "#298cdb", current: "#00808c", payload: "#f28c1a" };

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
    const length = along.length();
    this.whole.visible = length > 1e-6;
    if (!this.whole.visible) return;
    const head = Math.min(5 * this.radius, HEAD * length);
    this.whole.position.copy(from);
    this.whole.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.clone().normalize());
    this.shaft.scale.set(this.radius, length - head, this.radius);
    this.head.scale.set(0.4 * head, head, 0.4 * head);
    this.head.position.y = length - head;
  }
}
const nodeOf = (group) => viewer.scene_tree.find(split(`/meshcat/alpha5/${group}`)).object;

// ---- weight and buoyancy of each body, and of the whole arm
const strength = vector(data.water.gravity).length();
const totals = () => ({
  weight: strength * data.loads.reduce((sum, { mass }) => sum + mass, 0),
  buoyancy: strength * state.density * data.loads.reduce((sum, { volume }) => sum + volume, 0),
});
const KINDS = [
  { group: "weight", share: "mass", point: "com", sense: 1, density: () => 1 },
  { group: "buoyancy", share: "volume", point: "cob", sense: -1, density: () => state.density },
].map((kind) => ({ ...kind, each: data.loads.map(() => new Arrow(kind.group, 0.0022)), whole: new Arrow(kind.group, 0.004) }));

function drawForces() {
  for (const kind of KINDS) {
    const force = (amount) => vector(data.water.gravity).multiplyScalar(kind.sense * kind.density() * amount * data.arrows.force);
    const middle = new THREE.Vector3();
    const total = data.loads.reduce((sum, load) => sum + load[kind.share], 0);
    data.loads.forEach((load, i) => {
      const at = vector(load[kind.point]).applyMatrix4(poses[load.link]);
      kind.each[i].point(at, force(load[kind.share]));
      middle.addScaledVector(at, load[kind.share] / total);
    });
    kind.whole.point(middle, force(total));
    kind.end = middle.clone().add(force(total));
  }
}

// ---- the current: drag the end of its arrow in the level plane, or in the one that faces the camera if that is upright
const currentArrow = new Arrow("current", 0.004);
const currentFrom = () => vector(data.currentAt).applyMatrix4(data.fixed ? poses[root] : new THREE.Matrix4());
const currentTo = () => currentFrom().addScaledVector(flow(), data.arrows.current);
const LEVEL_VIEW = 0.2; // how far a line of sight must dip to meet the level plane well
const flowHandle = byId("flow");
let pulled = null;
flowHandle.onpointerdown = (event) => {
  flowHandle.setPointerCapture(event.pointerId);
  const [x, y, depth] = onScreen(currentTo());
  pulled = { dx: x - event.clientX, dy: y - event.clientY, depth, height: currentTo().z };
  event.preventDefault();
};
flowHandle.onpointermove = (event) => {
  if (!pulled) return;
  const end = pulledTo(event.clientX + pulled.dx, event.clientY + pulled.dy);
  const water = end.sub(currentFrom()).divideScalar(data.arrows.current).clampLength(0, FASTEST);
  setFlow(water);
};
flowHandle.onpointerup = flowHandle.onpointercancel = () => { pulled = null; };
function pulledTo(x, y) {
  const at = fromScreen(x, y, pulled.depth);
  const sight = at.clone().sub(unswap(viewer.camera.position)).normalize();
  if (Math.abs(sight.z) < LEVEL_VIEW) return at;
  return at.addScaledVector(sight, (pulled.height - at.z) / sight.z);
}
// Set the velocity of the water in the world, with two decimals.
function setFlow(water) {
  const own = data.fixed ? water.applyMatrix3(new THREE.Matrix3().setFromMatrix4(poses[root].clone().invert())) : water;
  setCurrent(own.toArray().map((each) => Number(each.toFixed(2)) + 0));
}
// Left and right turn the current by 5 degrees, up and down change its speed by 0.05 m/s.
const FLOW_KEYS = { ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, 0.05], ArrowDown: [0, -0.05] };
flowHandle.onkeydown = (event) => {
  if (!(event.key in FLOW_KEYS)) return;
  event.preventDefault();
  const [turned, faster] = FLOW_KEYS[event.key];
  const water = flow().applyAxisAngle(new THREE.Vector3(0, 0, 1), turned * Math.PI / 180);
  const speed = clamp(water.length() + faster, 0, FASTEST);
  setFlow(water.length() > 1e-9 ? water.setLength(speed) : new THREE.Vector3(speed, 0, 0));
};

// ---- the payload: a ball of its volume at the tcp, and its net force
const ballMaterial = new THREE.MeshPhongMaterial({ color: ARROW_COLORS.payload });
const payloadBall = new THREE.Mesh(new THREE.SphereGeometry(1, 32, 16), ballMaterial);
nodeOf("payload").add(payloadBall);
const payloadArrow = new Arrow("payload", 0.004);
const payloadAt = () => vector(state.payload.com).applyMatrix4(poses.tcp);
function drawPayload() {
  payloadBall.visible = state.payload.mass > 0;
  payloadBall.position.copy(payloadAt());
  payloadBall.scale.setScalar(Math.max(Math.cbrt(state.payload.volume * 3 / (4 * Math.PI)), data.payloadRadius));
  const force = payloadForce().multiplyScalar(state.payload.mass > 0 ? data.arrows.force : 0);
  payloadArrow.point(payloadAt(), force);
}

onPose(() => {
  drawForces();
  currentArrow.point(currentFrom(), flow().multiplyScalar(data.arrows.current));
  drawPayload();
});
// Labels of these arrows, with the words of the moment.
const forceLabels = [
  ...KINDS.map((kind) => ({
    group: kind.group,
    words: () => `${kind.group} ${fixed(totals()[kind.group], 2)} N`,
    color: new THREE.Color(ARROW_COLORS[kind.group]).multiplyScalar(0.8).toArray(),
    where: () => totals()[kind.group] > 0 && kind.end,
  })),
  {
    group: "current",
    words: () => `current ${Number(Math.hypot(...state.current).toPrecision(3))} m/s, ${state.density ? "load estimated" : "no load in air"}`,
    color: new THREE.Color(ARROW_COLORS.current).toArray(),
    where: currentFrom,
  },
  {
    group: "payload",
    words: () => `payload ${payloadText()}`,
    color: [0.45, 0.33, 0],
    where: () => state.payload.mass > 0 && payloadAt().addScaledVector(payloadForce(), data.arrows.force),
  },
];
