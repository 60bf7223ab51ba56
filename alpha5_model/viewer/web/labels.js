// Labels over the canvas, each beside its point and with a line to it; no label covers another. One without room is
// shortened to what is before its comma, or left out. The picture that a person saves has them, too.
import { data } from "./data.js";
import { root } from "./kinematics.js";
import { flow } from "./statics.js";
import { state } from "./state.js";
import { added, byId, fixed, write } from "./page.js";
import { ARROW_COLORS, KINDS, THREE, anchored, currentFrom, payloadAt, payloadForce, totals, viewer } from "./scene.js";
import { drawScale, free, onScreen } from "./camera.js";
import { ghosts, isMissed } from "./target.js";
import { payloadText } from "./water.js";
import { clamp, origin, placed, plus } from "./vectors.js";

const GAP = 10;
const ROW = 20;
// Places for a label, the best first: [1 right or -1 left of its point, rows below it]; up is better than down.
const STEPS = [1, -1].flatMap((side) => Array.from({ length: 31 }, (_, k) => [side, k - 15]));
const cost = ([side, step]) => Math.abs(step) + (side < 0 ? 2.5 : 0) + (step > 0 ? 1.2 : 0);
STEPS.sort((one, other) => cost(one) - cost(other));
const darker = (color) => new THREE.Color(color).multiplyScalar(0.8).toArray();
const speed = () => Number(Math.hypot(...flow(state)).toPrecision(3));
const aim = () => state.aim && placed(state.poses[root], state.aim);
// text and where are functions; where gives nothing if there is nothing to label.
const labels = [
  ...data.labels.map(({ group, text, color, anchor }) => ({ group, color, text: () => text, where: () => origin(anchored(anchor)) })),
  ...KINDS.map((kind) => ({
    group: kind.group,
    text: () => `${kind.group} ${fixed(totals()[kind.group], 2)} N`,
    color: darker(ARROW_COLORS[kind.group]),
    where: () => totals()[kind.group] > 0 && kind.end,
  })),
  {
    group: "current",
    text: () => `current ${speed()} m/s, ${state.density ? "load estimated" : "no load in air"}`,
    color: new THREE.Color(ARROW_COLORS.current).toArray(),
    where: currentFrom,
  },
  {
    group: "payload",
    text: () => `payload ${payloadText()}`,
    color: [0.45, 0.33, 0],
    where: () => state.payload.mass > 0 && plus(payloadAt(), payloadForce(), data.arrows.force),
  },
  ...ghosts.map((ghost) => ({ group: "ghosts", text: () => ghost.text, color: darker(ghost.color), where: () => ghost.group.visible && origin(ghost.poses.link_3), ghost })),
  { group: "ghosts", text: () => "target", color: [0.75, 0.05, 0.4], where: aim },
];
for (const label of labels) {
  // The panel has the same buttons for a keyboard.
  label.element = added(byId("labels"), label.ghost ? "button" : "div", { onclick: label.ghost?.choose, tabIndex: -1 });
  label.element.style.setProperty("--own", `rgb(${label.color.map((c) => Math.round(255 * c))})`);
  label.line = added(byId("leaders"), "i");
}
const mark = added(byId("leaders"), "b");
const gap = added(byId("leaders"), "i", { id: "gap" });
const tip = byId("tip");

const moveElement = (element, x, y) => { element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`; };
// A line is a thin rotated element: an SVG over the whole window would be slower than the scene.
function drawLine(line, x1, y1, x2, y2) {
  line.ends = [x1, y1, x2, y2];
  line.style.display = "";
  line.style.width = `${Math.hypot(x2 - x1, y2 - y1).toFixed(1)}px`;
  line.style.transform = `translate(${x1.toFixed(1)}px, ${y1.toFixed(1)}px) rotate(${Math.atan2(y2 - y1, x2 - x1).toFixed(4)}rad)`;
}

// What no label may cover: the handle, messages and scale bars.
function taken() {
  const [x, y] = onScreen(origin(state.poses.tcp));
  const boxes = [...byId("scale").children, ...byId("message").children].map((element) => element.getBoundingClientRect());
  return [{ left: x - 10, right: x + 7, top: y - 10, bottom: y + 10 }, ...boxes.filter((box) => box.width)];
}
// The best free place for a label beside its point, [left, top], or undefined.
function placeFor(width, x, y, boxes) {
  const [left, top, right, bottom] = free();
  const isFree = ([at, row]) => at > left && at + width < right && row > top && row + ROW < bottom && boxes.every(
    (box) => at >= box.right + 2 || at + width <= box.left - 2 || row >= box.bottom || row + ROW <= box.top);
  return STEPS.map(([side, step]) => [x + (side > 0 ? GAP : -GAP - width), y - 9 + step * ROW]).find(isFree);
}
function drawLabels() {
  const [left, top, right, bottom] = free();
  const points = [];
  for (const label of labels) {
    const where = state.shown.labels && state.shown[label.group] && label.where();
    const [x, y, depth] = where ? onScreen(where) : [0, 0, 2];
    const seen = depth < 1 && x > left && x < right && y > top && y < bottom;
    if (seen) points.push({ label, x, y });
    else hide(label);
  }
  const boxes = taken();
  points.sort((a, b) => b.y - a.y);
  for (const { label, x, y } of points) drawLabel(label, x, y, boxes);
}
const widths = {}; // each text is measured once
function drawLabel(label, x, y, boxes) {
  const { element } = label;
  element.style.display = ""; // what is hidden has no width
  element.disabled = label.ghost && !label.ghost.open;
  let place;
  let width;
  for (const text of [label.text(), label.text().split(",")[0]]) {
    write(element, text);
    width = widths[text] ??= element.offsetWidth;
    place = placeFor(width, x, y, boxes);
    if (place) break;
  }
  if (!place) return hide(label);
  const [at, row] = place;
  boxes.push({ left: at, right: at + width, top: row, bottom: row + ROW });
  moveElement(element, at, row);
  const end = [clamp(x, at, at + width), clamp(y, row + 2, row + ROW - 4)];
  if (Math.hypot(end[0] - x, end[1] - y) > GAP + 3) drawLine(label.line, x, y, ...end);
  else label.line.style.display = "none";
}
function hide(label) {
  label.element.style.display = "none";
  label.line.style.display = "none";
}
// Draw the handle on the tip, the target, and a dashed line between them if the target is out of reach.
function drawTip() {
  const from = onScreen(origin(state.poses.tcp));
  moveElement(tip, from[0], from[1]);
  tip.style.display = from[2] < 1 ? "" : "none";
  const to = state.aim ? onScreen(aim()) : [0, 0, 2];
  const away = to[2] < 1 && Math.hypot(to[0] - from[0], to[1] - from[1]) > 1;
  mark.style.display = to[2] < 1 && (away || state.shown.ghosts) ? "" : "none";
  moveElement(mark, to[0], to[1]);
  if (away && isMissed()) drawLine(gap, ...from.slice(0, 2), ...to.slice(0, 2));
  else gap.style.display = "none";
}
const render = viewer.render.bind(viewer);
viewer.render = () => {
  render();
  drawScale();
  drawLabels();
  drawTip();
};

// ---- a picture of the free part of the window, with labels and scales
export function picture() {
  const frame = free();
  const dots = viewer.renderer.domElement.width / window.innerWidth;
  const [width, height] = [(frame[2] - frame[0]) * dots, (frame[3] - frame[1]) * dots].map(Math.floor);
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  viewer.render();
  const pen = canvas.getContext("2d");
  pen.setTransform(dots, 0, 0, dots, -frame[0] * dots, -frame[1] * dots);
  pen.drawImage(viewer.renderer.domElement, 0, 0, window.innerWidth, window.innerHeight);
  for (const line of document.querySelectorAll("#leaders i")) {
    if (line.style.display === "none" || !line.ends) continue;
    const [x1, y1, x2, y2] = line.ends;
    pen.strokeStyle = getComputedStyle(line).borderTopColor;
    pen.stroke(new Path2D(`M${x1},${y1}L${x2},${y2}`));
  }
  for (const element of document.querySelectorAll("#labels > *, #scale span, #scale i")) {
    const box = element.getBoundingClientRect();
    if (!box.width) continue;
    const style = getComputedStyle(element);
    pen.fillStyle = style.backgroundColor;
    pen.fillRect(box.left, box.top, box.width, box.height);
    pen.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    pen.fillStyle = style.color;
    pen.textBaseline = "middle";
    pen.fillText(element.textContent, box.left + parseFloat(style.paddingLeft), box.top + box.height / 2);
  }
  return canvas.toDataURL("image/png");
}
const save = (name, address) => Object.assign(document.createElement("a"), { href: address, download: name }).click();
added(byId("views"), "button", { id: "png", textContent: "PNG", title: "Keep this picture", onclick: () => save("alpha5.png", picture()) });
