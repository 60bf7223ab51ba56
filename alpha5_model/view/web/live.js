// A live server: its commands move the page, and the page says what a hand did.
let unread = false;

// The joint positions that the poses of the links in the scene stand for.
function readScene() {
  const values = data.sliders.map((name) => q[name]);
  for (const joint of data.tree) {
    if (!data.sliders.includes(joint.name)) continue;
    const node = (link) => viewer.scene_tree.find(split(data.links[link])).object;
    const [parent, child] = [node(joint.parent), node(joint.child)];
    parent.updateMatrix();
    child.updateMatrix();
    const relative = parent.matrix.clone().multiply(joint.matrix).invert().multiply(child.matrix);
    const [place, turn, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
    relative.decompose(place, turn, scale);
    let value = place.dot(joint.direction);
    if (joint.kind !== "prismatic") {
      value = 2 * Math.atan2(new THREE.Vector3(turn.x, turn.y, turn.z).dot(joint.direction), turn.w);
      while (value < joint.lower - 1e-6) value += 2 * Math.PI;
      while (value > joint.upper + 1e-6 && value - 2 * Math.PI >= joint.lower) value -= 2 * Math.PI;
    }
    values[data.sliders.indexOf(joint.name)] = value;
  }
  setPose(values, "python");
}

// Called with every command that came, after it was carried out.
function heard(command) {
  if (command.type === "set_transform" && data.live && !unread) {
    unread = true;
    requestAnimationFrame(() => { unread = false; readScene(); });
  }
}
if (data.live) viewer.connect();
