// Labels over the canvas, each beside its point and with a line to it; no label covers another. One without room is
// shortened to what is before its comma, or left out.
const GAP = 10;
const ROW = 20;
// Places for a label, the best first: [1 right or -1 left of its point, rows below it]; up is better than down.
const STEPS = [1, -1].flatMap((side) => Array.from({ length: 31 }, (_, k) => [side, k - 15]));
const cost = ([side, step]) => Math.abs(step) + (side < 0 ? 2.5 : 0) + (step > 0 ? 1.2 : 0);
STEPS.sort((one, other) => cost(one) - cost(other));
const labels = [
  ...data.labels.map((label) => ({ ...label, where: () => origin(anchor(label.anchor)) })),
  ...forceLabels,
  ...ghosts.map((ghost, i) => ghost.label = {
    group: "ghosts",
    text: "",
    color: new THREE.Color(GHOSTS[i]).multiplyScalar(0.8).toArray(),
    where: () => ghost.group.visible && origin(ghost.poses.link_3),
    choose: () => ghost.open && take(i),
  }),
  { group: "ghosts", text: "target", color: [0.75, 0.05, 0.4], where: () => state.aim && toWorld(state.aim) },
];
for (const label of labels) {
  label.element = added(byId("labels"), label.choose ? "button" : "div", { onclick: label.choose });
  label.element.style.setProperty("--own", `rgb(${label.color.map((c) => Math.round(255 * c))})`);
  label.line = added(byId("leaders"), "i");
}
const mark = added(byId("leaders"), "b");
const gap = added(byId("leaders"), "i", { id: "gap" });

const moveElement = (element, x, y) => { element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`; };
// A line is a thin rotated element: an SVG over the whole window would be slower than the scene.
function drawLine(line, x1, y1, x2, y2) {
  line.ends = [x1, y1, x2, y2];
  line.style.display = "";
  line.style.width = `${Math.hypot(x2 - x1, y2 - y1).toFixed(1)}px`;
  line.style.transform = `translate(${x1.toFixed(1)}px, ${y1.toFixed(1)}px) rotate(${Math.atan2(y2 - y1, x2 - x1).toFixed(4)}rad)`;
}

// Write a text into a label, and measure each text once.
const widths = {};
function writeLabel(label, text) {
  write(label.element, text);
  label.width = widths[text] = widths[text] || label.element.offsetWidth;
}
// What no label may cover: handles, messages and scale bars.
function obstacles() {
  const around = ([x, y], half) => ({ left: x - half, right: x + half - 3, top: y - half, bottom: y + half });
  const boxes = [...byId("scale").children, ...byId("message").children].map((element) => element.getBoundingClientRect());
  const handles = [around(onScreen(origin(poses.tcp)), 10), ...(shown.current ? [around(onScreen(currentTo()), 9)] : [])];
  return [...handles, ...boxes.filter((box) => box.width)];
}
// The best free place for a label beside its point, [left, top], or undefined.
function placeFor({ width }, x, y, placed) {
  const [left, top, right, bottom] = lastFree();
  const isFree = ([at, row]) => at > left && at + width < right && row > top && row + ROW < bottom && placed.every(
    (box) => at >= box.right + 2 || at + width <= box.left - 2 || row >= box.bottom || row + ROW <= box.top);
  return STEPS.map(([side, step]) => [x + (side > 0 ? GAP : -GAP - width), y - 9 + step * ROW]).find(isFree);
}

function drawLabels() {
  const [left, top, right, bottom] = lastFree();
  const points = [];
  for (const label of labels) {
    const where = shown.labels && shown[label.group] && label.where();
    const [x, y, depth] = where ? onScreen(where) : [0, 0, 2];
    const seen = depth < 1 && x > left && x < right && y > top && y < bottom;
    if (seen) points.push({ label, x, y });
    else hide(label);
  }
  const placed = obstacles();
  points.sort((a, b) => b.y - a.y);
  for (const { label, x, y } of points) drawLabel(label, x, y, placed);
  drawTip();
  drawFlowHandle();
}
function drawLabel(label, x, y, placed) {
  const text = label.words ? label.words() : label.text;
  let place;
  label.element.style.display = ""; // what is hidden has no width
  for (const each of [text, text.split(",")[0]]) {
    writeLabel(label, each);
    place = placeFor(label, x, y, placed);
    if (place) break;
  }
  if (!place) {
    hide(label);
    return;
  }
  const [at, row] = place;
  placed.push({ left: at, right: at + label.width, top: row, bottom: row + ROW });
  moveElement(label.element, at, row);
  const end = [clamp(x, at, at + label.width), clamp(y, row + 2, row + ROW - 4)];
  if (Math.hypot(end[0] - x, end[1] - y) > GAP + 3) drawLine(label.line, x, y, ...end);
  else label.line.style.display = "none";
}
function hide(label) {
  label.element.style.display = "none";
  label.line.style.display = "none";
}

function drawFlowHandle() {
  const [x, y, depth] = onScreen(currentTo());
  flowHandle.style.display = shown.current && depth < 1 ? "" : "none";
  moveElement(flowHandle, x, y);
}

// Draw the handle on the tip, the target, and a dashed line between them if the target is out of reach.
function drawTip() {
  const from = onScreen(origin(poses.tcp));
  moveElement(tip, from[0], from[1]);
  tip.style.display = from[2] < 1 ? "" : "none";
  const to = state.aim ? onScreen(toWorld(state.aim)) : [0, 0, 2];
  const away = to[2] < 1 && Math.hypot(to[0] - from[0], to[1] - from[1]) > 1;
  mark.style.display = to[2] < 1 && (away || shown.ghosts) ? "" : "none";
  moveElement(mark, to[0], to[1]);
  if (away && missed) drawLine(gap, ...from.slice(0, 2), ...to.slice(0, 2));
  else gap.style.display = "none";
}

const render = viewer.render.bind(viewer);
viewer.render = () => {
  render();
  if (!poses[root]) return;
  drawScale();
  drawLabels();
  rendered();
};
