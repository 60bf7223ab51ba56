// Moves the arm in the browser: joint tree, sliders, switches, labels and playback around meshcat.
"use strict";
const alpha5 = (() => {
  const data = JSON.parse(document.getElementById("alpha5-data").textContent);
  const THREE = MeshCat.THREE;
  const byId = (id) => document.getElementById(id);
  let viewer;
  try {
    viewer = new MeshCat.Viewer(byId("pane"));
  } catch (error) {
    document.querySelector("#panel h1").textContent = "This page needs WebGL, which this browser does not offer.";
    throw error;
  }
  const split = (path) => path.split("/").filter((part) => part);
  const matrix = (rows) => new THREE.Matrix4().set(...rows.flat());
  const vector = (elements) => new THREE.Vector3().fromArray(elements);
  const q = { ...data.q };
  const shown = {};
  let poses = {};

  // ---- kinematics: the arm by the generated formulas, what is fixed to it or beyond it joint by joint
  for (const joint of data.tree) {
    joint.matrix = matrix(joint.transform);
    joint.direction = vector(joint.axis).normalize();
  }
  const angles = () => data.sliders.slice(0, 4).map((name) => q[name]);
  const position = (joint) => joint.multiplier * (q[joint.source] || 0) + joint.offset;
  function motion(joint) {
    if (joint.kind === "revolute") return new THREE.Matrix4().makeRotationAxis(joint.direction, position(joint));
    const step = joint.kind === "prismatic" ? position(joint) : 0;
    return new THREE.Matrix4().makeTranslation(...joint.direction.clone().multiplyScalar(step).toArray());
  }
  function forwardKinematics() {
    const found = {};
    for (const link in data.root) found[link] = matrix(data.root[link]);
    const placed = { ...formulas.link_poses(angles()), tcp: formulas.forward_kinematics(angles()) };
    for (const link in placed) found[link] = found.base_link.clone().multiply(matrix(placed[link]));
    for (const joint of data.tree) {
      if (!(joint.child in placed)) found[joint.child] = found[joint.parent].clone().multiply(joint.matrix).multiply(motion(joint));
    }
    return found;
  }
  function anchor(item) {
    if (item.link) return poses[item.link].clone().multiply(matrix(item.placement));
    const total = item.points.reduce((sum, entry) => sum + entry[1], 0);
    const mean = vector(item.offset);
    for (const [link, weight, point] of item.points) mean.addScaledVector(vector(point).applyMatrix4(poses[link]), weight / total);
    return new THREE.Matrix4().makeTranslation(mean.x, mean.y, mean.z);
  }
  // The joint positions that the poses of the links in the scene stand for.
  function readScene() {
    for (const joint of data.tree) {
      if (!data.sliders.includes(joint.name)) continue;
      const node = (link) => viewer.scene_tree.find(split(data.links[link])).object;
      const [parent, child] = [node(joint.parent), node(joint.child)];
      parent.updateMatrix();
      child.updateMatrix();
      const relative = parent.matrix.clone().multiply(joint.matrix).invert().multiply(child.matrix);
      const [place, turn, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
      relative.decompose(place, turn, scale);
      if (joint.kind === "prismatic") {
        q[joint.name] = place.dot(joint.direction);
      } else {
        let angle = 2 * Math.atan2(new THREE.Vector3(turn.x, turn.y, turn.z).dot(joint.direction), turn.w);
        while (angle < joint.lower - 1e-6) angle += 2 * Math.PI;
        while (angle > joint.upper + 1e-6 && angle - 2 * Math.PI >= joint.lower) angle -= 2 * Math.PI;
        q[joint.name] = angle;
      }
    }
  }

  // ---- statics: the torque that holds the arm still; bodies beyond link_4 move in it and count where they are
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
  // A steady current on links at rest: drag of their strips, and the Munk moment of their added mass.
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

  // ---- drawing
  function place() {
    poses = forwardKinematics();
    for (const link in poses) if (data.links[link]) viewer.set_transform(split(data.links[link]), poses[link].elements);
    for (const item of data.anchors) viewer.set_transform(split(item.path), anchor(item.anchor).elements);
    refresh();
  }
  function refresh() {
    poses = forwardKinematics();
    const torques = holding();
    Object.values(rows).forEach((row, i) => row.show(torques[i]));
    const tcp = poses.tcp && new THREE.Vector3().setFromMatrixPosition(poses.tcp);
    if (tcp) byId("readout").textContent = `tcp  x ${mm(tcp.x)}  y ${mm(tcp.y)}  z ${mm(tcp.z)} mm`;
    viewer.set_dirty();
  }
  function fixed(value, digits) {
    const text = value.toFixed(digits);
    return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "\u2212");
  }
  const mm = (metres) => fixed(1e3 * metres, 1);
  function setJoint(name, value) {
    q[name] = value;
    place();
  }
  function setPose(values) {
    data.sliders.forEach((name, i) => { q[name] = values[i]; });
    place();
  }
  function setGroup(name, on) {
    shown[name] = on;
    if (name === "see-through") seeThrough(on);
    else if (name !== "labels") viewer.set_property(split(`/meshcat/alpha5/${name}`), "visible", on);
    const box = document.querySelector(`#groups input[name="${name}"]`);
    if (box) box.checked = on;
    if (name === "current" && poses.base_link) refresh();
    viewer.set_dirty();
  }
  function seeThrough(on) {
    viewer.scene_tree.find(split("/meshcat/alpha5/bodies")).object.traverse((object) => {
      if (!object.material) return;
      object.material.transparent = on;
      object.material.opacity = on ? data.seeThrough : 1;
      object.material.depthWrite = !on;
      object.material.needsUpdate = true;
    });
  }

  // ---- labels, laid over the canvas
  for (const label of data.labels) {
    label.element = byId("labels").appendChild(document.createElement("div"));
    label.element.textContent = label.text;
    label.element.style.color = `rgb(${label.color.map((c) => Math.round(255 * c))})`;
  }
  function drawLabels() {
    const pane = byId("pane");
    const placed = [];
    viewer.scene.updateMatrixWorld();
    for (const label of data.labels) {
      const point = new THREE.Vector3().setFromMatrixPosition(anchor(label.anchor));
      point.applyMatrix4(viewer.scene.matrixWorld).project(viewer.camera);
      const visible = shown.labels && shown[label.group] && point.z < 1;
      label.element.style.display = visible ? "" : "none";
      if (visible) placed.push({ label, x: (point.x + 1) / 2 * pane.clientWidth + 10, y: (1 - point.y) / 2 * pane.clientHeight - 9 });
    }
    placed.sort((a, b) => a.y - b.y);
    const width = (item) => item.label.element.offsetWidth;
    placed.forEach((item, i) => {
      for (const above of placed.slice(0, i)) {
        const beside = item.x > above.x + width(above) || item.x + width(item) < above.x;
        if (!beside && item.y < above.y + 18) item.y = above.y + 18;
      }
      item.label.element.style.transform = `translate(${item.x.toFixed(1)}px, ${item.y.toFixed(1)}px)`;
    });
  }
  const render = viewer.render.bind(viewer);
  viewer.render = () => { render(); drawLabels(); };

  // ---- the panel
  document.querySelector("#panel h1").textContent = data.title;
  byId("fold").onclick = () => byId("panel").classList.toggle("folded");
  for (const note of data.notes) byId("notes").appendChild(document.createElement("p")).textContent = note;
  const rows = {};
  for (const joint of data.tree) {
    if (!data.sliders.includes(joint.name)) continue;
    const row = byId("joints").appendChild(document.createElement("div"));
    row.className = "joint";
    const [name, slider, value, torque] = ["label", "input", "span", "span"].map((tag) => row.appendChild(document.createElement(tag)));
    name.textContent = joint.name;
    Object.assign(slider, { type: "range", min: joint.lower, max: joint.upper, step: "any", name: joint.name });
    slider.setAttribute("aria-label", joint.name);
    value.className = "value";
    torque.className = "torque";
    slider.oninput = () => { pause(); setJoint(joint.name, Number(slider.value)); };
    rows[joint.name] = { show: (still) => {
      slider.value = q[joint.name];
      value.textContent = joint.kind === "prismatic" ? `${mm(q[joint.name])} mm` : `${(q[joint.name] * 180 / Math.PI).toFixed(1)}\u00b0`;
      if (still === undefined) return; // the jaws
      const torqueNow = shown.current ? still - drag(joint) : still;
      torque.dataset.value = torqueNow;
      torque.textContent = `holds ${fixed(torqueNow, 3)} N\u00b7m`;
    } };
  }
  for (const name in data.poses) {
    const button = byId("poses").appendChild(document.createElement("button"));
    button.textContent = name;
    button.onclick = () => { pause(); setPose(data.poses[name]); };
  }
  // ---- where the tcp should be: a button for each way to get there within the limits
  const target = ["x", "y", "z"].map((axis) => {
    const label = byId("target").appendChild(document.createElement("label"));
    const input = document.createElement("input");
    Object.assign(input, { type: "number", step: "5", name: axis });
    label.append(`${axis} `, input);
    input.oninput = () => solve();
    return input;
  });
  byId("target").append("mm");
  const ways = data.branches.map((name, i) => {
    const button = byId("ways").appendChild(document.createElement("button"));
    button.textContent = name.replace("_", " ");
    button.onclick = () => { pause(); setPose([...solve().q[i], ...data.sliders.slice(4).map((joint) => q[joint])]); };
    return button;
  });
  function solve() {
    const found = formulas.inverse_kinematics(target.map((input) => Number(input.value) / 1e3), angles()[3]);
    const empty = target.some((input) => input.value === "");
    ways.forEach((button, i) => { button.disabled = empty || !found.within_limits[i]; });
    return found;
  }
  solve();
  const dots = { com: "#e0a400", cob: "#1f78c8", weight: "#c8322d", buoyancy: "#2a8fd6", collision: "#ee8b1a", workspace: "#159a80", surface: "#159a80", current: "#00808c" };
  for (const group of data.groups) {
    const label = byId("groups").appendChild(document.createElement("label"));
    const box = label.appendChild(document.createElement("input"));
    Object.assign(box, { type: "checkbox", name: group.name, checked: group.shown });
    label.append(group.title);
    if (dots[group.name]) Object.assign(label.appendChild(document.createElement("span")), { className: "dot" }).style.background = dots[group.name];
    box.onchange = () => setGroup(group.name, box.checked);
    shown[group.name] = group.shown;
  }

  // ---- playback by the clock: a slow browser drops frames, not time
  let started = null;
  const last = data.motion ? data.motion.time[data.motion.time.length - 1] : 0;
  function seek(time) {
    const times = data.motion.time;
    let i = 1;
    let high = times.length - 1;
    while (i < high) {
      const middle = (i + high) >> 1;
      if (times[middle] < time) i = middle + 1; else high = middle;
    }
    const span = times[i] - times[i - 1];
    const part = span > 0 ? Math.min(Math.max((time - times[i - 1]) / span, 0), 1) : 1;
    setPose(data.motion.q[i].map((after, j) => data.motion.q[i - 1][j] + part * (after - data.motion.q[i - 1][j])));
    byId("time").value = time;
    byId("clock").textContent = `${time.toFixed(1)} / ${last.toFixed(1)} s  ${data.motion.name}`;
  }
  function tick(now) {
    if (started === null) return;
    seek(((now - started) / 1e3) % last);
    requestAnimationFrame(tick);
  }
  function play() {
    started = performance.now() - 1e3 * (Number(byId("time").value) % last);
    byId("play").textContent = "\u2016";
    requestAnimationFrame(tick);
  }
  function pause() {
    started = null;
    byId("play").textContent = "\u25b6";
  }
  if (data.motion) {
    byId("player").hidden = false;
    byId("time").max = last;
    byId("time").value = 0;
    byId("clock").textContent = `0.0 / ${last.toFixed(1)} s  ${data.motion.name}`;
    byId("play").onclick = () => (started === null ? play() : pause());
    byId("time").oninput = () => { pause(); seek(Number(byId("time").value)); };
  }

  // ---- camera: meshcat's camera sits in a frame turned so that its y axis is up
  const swap = ([x, y, z]) => [x, z, -y];
  viewer.camera.fov = data.camera.field_of_view;
  // A little further away than a picture: the arm will move.
  const eye = vector(data.camera.eye).sub(vector(data.camera.target)).multiplyScalar(1.15).add(vector(data.camera.target));
  viewer.camera.position.set(...swap(eye.toArray()));
  viewer.controls.target.set(...swap(data.camera.target));
  // Centre the arm in what the panel leaves free.
  const resize = viewer.set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = (...size) => {
    resize(...size);
    const [w, h] = [window.innerWidth, window.innerHeight];
    viewer.camera.setViewOffset(w, h, w > 760 ? -160 : 0, data.motion ? 20 : 0, w, h);
    viewer.set_dirty();
  };
  viewer.set_3d_pane_size();

  // ---- the scene: from this file, or over the connection
  let unread = false;
  const handle = viewer.handle_command.bind(viewer);
  const geometries = {}; // a mesh that several shapes share comes with the first of them
  viewer.handle_command = (command) => {
    for (const geometry of command.type === "set_object" ? command.object.geometries : []) {
      if (geometry.data) geometries[geometry.uuid] = geometry.data;
      else geometry.data = geometries[geometry.uuid];
    }
    handle(command);
    if (command.type === "set_property" && command.property === "visible") {
      const group = split(command.path)[2];
      if (group in shown) setGroup(group, command.value);
    }
    if (command.type === "set_transform" && data.live && !unread) {
      unread = true;
      requestAnimationFrame(() => { unread = false; readScene(); refresh(); });
    }
  };
  for (const command of data.commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(command), (c) => c.charCodeAt(0)));
  }
  if (data.live) viewer.connect();
  else place();
  if (data.live) refresh();
  if (shown["see-through"]) setGroup("see-through", true);
  document.documentElement.dataset.ready = "true";
  return { viewer, data, q, holding, setJoint, setPose, setGroup, seek, play, pause, poses: () => poses };
})();
