// The other solutions for the target, or for the present tcp, as ghosts; a click on one moves the arm there.
const GHOSTS = ["#0d8c80", "#d9730d", "#734dbf", "#8c801a"];
const ghosts = data.branches.map((name, i) => {
  const solid = { color: GHOSTS[i], transparent: true, depthWrite: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  return { material: litAtVertices(new THREE.MeshPhongMaterial(solid)), group: new THREE.Group(), links: {}, label: null, open: false };
});

// Poses of all links at angles of the arm, with the jaws as they are.
const posesAt = (turned) => forwardKinematics(named(withJaws(turned)));

// Make a ghost when it is first needed; it shares the geometries of the bodies.
function makeGhost(ghost) {
  for (const link in data.links) {
    if (link === root || link === "link_0") continue;
    const copy = new THREE.Group();
    for (const part of meshes(data.links[link])) copy.add(new THREE.Mesh(part.geometry, ghost.material));
    if (!copy.children.length) continue;
    copy.matrixAutoUpdate = false;
    ghost.group.add(copy);
    ghost.links[link] = copy;
  }
  if (Object.keys(ghost.links).length) viewer.scene_tree.find(split("/meshcat/alpha5/ghosts")).object.add(ghost.group);
}

// Draw the ghosts; links at the same pose as in the arm or in another ghost are left out.
function drawGhosts(found, wouldTouch) {
  const drawn = [poses];
  ghosts.forEach((ghost, i) => {
    ghost.label.element.disabled = !(ghost.open = found.within_limits[i]);
    ghost.group.visible = shown.ghosts && found.exists[i] && largestDifference(found.q[i], angles()) > 1e-6;
    const collides = wouldTouch[i].length > 0;
    ghost.label.text = `${branchNames[i]}${collides ? ", collides" : ghost.open ? "" : ", beyond the limits"}`;
    ghost.material.color.set(collides ? RED : GHOSTS[i]);
    if (!ghost.group.visible) return;
    if (!ghost.group.parent) makeGhost(ghost);
    ghost.material.opacity = ghost.open ? 0.42 : 0.16;
    ghost.poses = posesAt(found.q[i]);
    for (const link in ghost.links) {
      const pose = ghost.poses[link];
      ghost.links[link].matrix.copy(pose);
      ghost.links[link].visible = !drawn.some((other) => largestDifference(pose.elements, other[link].elements) < 1e-6);
    }
    drawn.push(ghost.poses);
  });
}

// A click chooses a ghost, unless the pointer was dragged to turn the view.
let pressed = null;
byId("pane").addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
byId("pane").addEventListener("click", (event) => {
  if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
  const chosen = ghostAt(event.clientX, event.clientY);
  if (chosen >= 0) take(chosen);
});
function ghostAt(x, y) {
  const caster = new THREE.Raycaster();
  caster.setFromCamera(inCamera(x, y), viewer.camera);
  const seen = ghosts.map((ghost, i) => {
    const hit = ghost.group.visible && ghost.open && caster.intersectObject(ghost.group, true).find((each) => each.object.parent.visible);
    return hit ? hit.distance : Infinity;
  });
  const nearest = Math.min(...seen);
  return nearest < Infinity ? seen.indexOf(nearest) : -1;
}
