// Joint positions, and what follows from them: the poses of the links and the torques that hold the arm still.
//
// setPose(values, by) moves the arm; onPose(listener) calls listener(by) after every move. `by` is what moved
// it: "hand", "travel", "motion", "python" or "page".
const { q } = state;
let poses = {};
const listeners = [];
const onPose = (listener) => listeners.push(listener);

for (const joint of data.tree) {
  joint.matrix = matrix(joint.transform);
  joint.direction = vector(joint.axis).normalize();
}
const joints = data.tree.filter((joint) => data.sliders.includes(joint.name));
const angles = () => data.sliders.slice(0, 4).map((name) => q[name]);
const amount = (joint, value) => joint.kind === "prismatic" ? `${mm(value)} mm` : `${fixed(value * 180 / Math.PI, 1)}\u00b0`;
// The limit that a joint is beyond by more than rounding, or undefined.
const limit = (joint) => [joint.lower, joint.upper].find((end, i) => (i ? 1 : -1) * (q[joint.name] - end) > 1e-9);

function setPose(values, by = "hand") {
  if (!isPose(values)) throw new RangeError(`expected ${data.sliders.length} finite numbers, got ${values}`);
  say("guard", "");
  if (by === "hand" && isBlocked(values)) return place("page");
  data.sliders.forEach((name, i) => { q[name] = values[i]; });
  place(by);
}
const isPose = (values) => Array.isArray(values) && values.length === data.sliders.length && values.every(Number.isFinite);
const setJoint = (name, value) => setPose(data.sliders.map((each) => each === name ? value : q[each]));
const named = (values) => Object.fromEntries(data.sliders.map((name, i) => [name, values[i]]));
const withJaws = (turned) => [...turned, ...data.sliders.slice(4).map((name) => q[name])];

// Move everything drawn to where it is at the joint positions q.
function place(by) {
  poses = forwardKinematics();
  for (const link in poses) if (data.links[link]) viewer.set_transform(split(data.links[link]), poses[link].elements);
  for (const item of data.anchors) viewer.set_transform(split(item.path), anchor(item.anchor).elements);
  for (const listener of listeners) listener(by);
  viewer.set_dirty();
}

// ---- kinematics: the links of the arm by the generated formulas, all other links joint by joint
function forwardKinematics(at = q) {
  const found = {};
  for (const link in data.root) found[link] = matrix(data.root[link]);
  const turned = data.sliders.slice(0, 4).map((name) => at[name]);
  const placed = { ...formulas.link_poses(turned), tcp: formulas.forward_kinematics(turned) };
  for (const link in placed) found[link] = found.base_link.clone().multiply(matrix(placed[link]));
  for (const joint of data.tree) {
    if (!(joint.child in placed)) found[joint.child] = found[joint.parent].clone().multiply(joint.matrix).multiply(motion(joint, at));
  }
  return found;
}
function motion(joint, at) {
  const position = joint.multiplier * (at[joint.source] || 0) + joint.offset;
  if (joint.kind === "revolute") return new THREE.Matrix4().makeRotationAxis(joint.direction, position);
  const step = joint.kind === "prismatic" ? position : 0;
  return new THREE.Matrix4().makeTranslation(...joint.direction.clone().multiplyScalar(step).toArray());
}
function anchor(item) {
  if (item.link) return poses[item.link].clone().multiply(matrix(item.placement));
  const total = item.points.reduce((sum, entry) => sum + entry[1], 0);
  const mean = vector(item.offset);
  for (const [link, weight, point] of item.points) mean.addScaledVector(vector(point).applyMatrix4(poses[link]), weight / total);
  return new THREE.Matrix4().makeTranslation(mean.x, mean.y, mean.z);
}

// ---- statics: bodies beyond link_4 move relative to it, so their moments are added at their present pose
const carried = {};
for (const joint of data.tree.slice().reverse()) {
  carried[joint.child] = [joint.child, ...(carried[joint.child] || [])];
  carried[joint.parent] = [...(carried[joint.parent] || []), ...carried[joint.child]];
}
function holding() {
  const toLink = poses.link_4.clone().invert();
  const net = new THREE.Vector4(0, 0, 0, 0);
  for (const [link, moment] of data.statics.beyond) {
    net.add(new THREE.Vector4(...moment).applyMatrix4(toLink.clone().multiply(poses[link])));
  }
  const share = data.statics.share.map((row) => net.dot(new THREE.Vector4(...row)));
  const parameters = data.statics.parameters.map((still, i) => still + share[i]);
  return formulas.hydrostatic_torque(angles(), parameters);
}

// Torque of a steady current on a joint at rest: drag of the strips, and the Munk moment of the added mass.
function drag(joint) {
  const origin = new THREE.Vector3().setFromMatrixPosition(poses[joint.child]);
  const axis = joint.direction.clone().transformDirection(poses[joint.child]);
  const flow = vector(data.current);
  const total = new THREE.Vector3();
  for (const stream of data.streams) {
    if (!carried[joint.child].includes(stream.link)) continue;
    const turn = new THREE.Matrix3().setFromMatrix4(poses[stream.link]);
    for (const [middle, direction, across, along] of stream.strips) {
      const line = vector(direction).applyMatrix3(turn);
      const parallel = line.clone().multiplyScalar(flow.dot(line));
      const normal = flow.clone().sub(parallel);
      const force = normal.multiplyScalar(across * normal.length()).addScaledVector(parallel, along * parallel.length());
      total.add(vector(middle).applyMatrix4(poses[stream.link]).sub(origin).cross(force));
    }
    const local = flow.clone().applyMatrix3(turn.clone().transpose());
    const momentum = vector(stream.added_mass.map((row) => vector(row).dot(local)));
    total.sub(local.cross(momentum).applyMatrix3(turn));
  }
  return total.dot(axis);
}
