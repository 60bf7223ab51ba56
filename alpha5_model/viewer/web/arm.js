// Joint positions, and what follows from them: the poses of the links.
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
  if (data.fixed) found[root] = mounting();
  const turned = data.sliders.slice(0, 4).map((name) => at[name]);
  const placed = { ...formulas.link_poses(turned), tcp: formulas.forward_kinematics(turned) };
  for (const link in placed) found[link] = found.base_link.clone().multiply(matrix(placed[link]));
  for (const joint of data.tree) {
    if (!(joint.child in placed)) found[joint.child] = found[joint.parent].clone().multiply(joint.matrix).multiply(motion(joint, at));
  }
  return found;
}
const root = data.tree[0].parent;
// Pose of a fixed base in the world.
function mounting() {
  const [roll, pitch] = state.attitude;
  return new THREE.Matrix4().makeRotationFromEuler(new THREE.Euler(roll, pitch, 0, "ZYX"));
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
