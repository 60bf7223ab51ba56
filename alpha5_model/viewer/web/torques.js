// Torques that hold the arm still in its water, with its payload, at its attitude, and in its current.
//
// The generated formulas take base parameters, which are linear in the moments of the bodies, and gravity in base_link.
const carried = {}; // link -> the links that move with it
for (const joint of data.tree.slice().reverse()) {
  carried[joint.child] = [joint.child, ...(carried[joint.child] || [])];
  carried[joint.parent] = [...(carried[joint.parent] || []), ...carried[joint.child]];
}
const LEVELS = ["low", "nominal", "high"];
const toBaseAxes = (direction) => vector(direction).transformDirection(poses[root].clone().invert()).multiplyScalar(Math.hypot(...direction));

// First moment and mass of a payload, and of its volume, in the frame of its link.
function beyondOf({ mass, com, volume }) {
  return { link: "tcp", mass: [...com.map((x) => mass * x), mass], volume: [...com.map((x) => volume * x), volume] };
}
// Bodies beyond link_4 move relative to it, so their moments are added at their present pose.
function baseParameters(payload) {
  const toLink = poses.link_4.clone().invert();
  const net = new THREE.Vector4(0, 0, 0, 0);
  for (const { link, mass, volume } of [...data.statics.beyond, beyondOf(payload)]) {
    const moment = new THREE.Vector4(...mass.map((each, i) => each - state.density * volume[i]));
    net.add(moment.applyMatrix4(toLink.clone().multiply(poses[link])));
  }
  const still = data.statics.mass.map((each, i) => each - state.density * data.statics.volume[i]);
  const parameters = still.map((each, i) => each + net.dot(new THREE.Vector4(...data.statics.share[i])));
  parameters.splice(-3, 3, ...toBaseAxes(data.water.gravity).toArray());
  return parameters;
}
const holding = (payload = state.payload) => formulas.hydrostatic_torque(angles(), baseParameters(payload));

// Velocity of the water in the world.
function flow() {
  const water = vector(state.current);
  return data.fixed ? water.applyMatrix3(new THREE.Matrix3().setFromMatrix4(poses[root])) : water;
}
// Torque of a steady current on a joint at rest: drag of the strips, and the Munk moment of the added mass.
function drag(joint, level = "nominal") {
  const origin = new THREE.Vector3().setFromMatrixPosition(poses[joint.child]);
  const axis = joint.direction.clone().transformDirection(poses[joint.child]);
  const water = flow();
  const total = new THREE.Vector3();
  for (const stream of data.water.streams[level]) {
    if (!carried[joint.child].includes(stream.link)) continue;
    const turn = new THREE.Matrix3().setFromMatrix4(poses[stream.link]);
    for (const [middle, direction, across, along] of stream.strips) {
      const line = vector(direction).applyMatrix3(turn);
      const parallel = line.clone().multiplyScalar(water.dot(line));
      const normal = water.clone().sub(parallel);
      const force = normal.multiplyScalar(across * normal.length()).addScaledVector(parallel, along * parallel.length());
      total.add(vector(middle).applyMatrix4(poses[stream.link]).sub(origin).cross(force));
    }
    const local = water.clone().applyMatrix3(turn.clone().transpose());
    const momentum = vector(stream.added_mass.map((row) => vector(row).dot(local)));
    total.sub(local.cross(momentum).applyMatrix3(turn));
  }
  return state.density * total.dot(axis);
}

// What each joint holds, and the interval of the estimates if there is a current: [{ value, low, high }, ...].
function torques(payload = state.payload) {
  return holding(payload).map((still, i) => {
    if (!shown.current) return { value: still, low: still, high: still };
    const levels = LEVELS.map((level) => still - drag(joints[i], level));
    return { value: levels[1], low: Math.min(...levels), high: Math.max(...levels) };
  });
}
