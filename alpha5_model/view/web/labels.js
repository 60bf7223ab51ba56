// Labels, laid over the canvas.
for (const label of data.labels) {
  label.element = added(byId("labels"), "div", { textContent: label.text });
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
