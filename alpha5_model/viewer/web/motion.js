// Play a motion in real time, and draw its curves: torque by cause, load on the mount, a recording beside the model, and signals
// of the user. Drag in them to move through the motion, and turn the wheel or pinch to zoom in time. A slow browser drops
// frames.
//
// The curves of a long motion have two rows for each span of time: the lowest and the highest value in it.
import { data } from "./data.js";
import { joints } from "./kinematics.js";
import { change, onChange, state } from "./state.js";
import { added, byId, fixed, write } from "./page.js";
import { viewer } from "./scene.js";
import { clamp, largestDifference } from "./vectors.js";

const ZOOM_KEYS = { "+": 0.5, "-": 2 }; // in the slider of the time; 0 shows all
let started = null;
const times = data.motion ? data.motion.time : [0];
const last = times[times.length - 1];
let now = 0;
const spans = data.motion && data.motion.spans; // their starts, or null if each sample is drawn

// Interpolate rows of numbers linearly at a time of the motion.
function between(columns, time) {
  let i = 1;
  let high = times.length - 1;
  while (i < high) {
    const middle = (i + high) >> 1;
    if (times[middle] < time) i = middle + 1; else high = middle;
  }
  const span = times[i] - times[i - 1];
  const part = span > 0 ? clamp((time - times[i - 1]) / span, 0, 1) : 1;
  return columns[i].map((after, j) => {
    const before = columns[i - 1][j];
    return before === null || after === null ? NaN : before + part * (after - before);
  });
}
export function seek(time) {
  if (!Number.isFinite(time)) return;
  now = clamp(time, 0, last);
  if (now < from || now > to) zoom(now - (to - from) / 2, now + (to - from) / 2);
  change({ q: between(data.motion.q, now) }, "motion");
}
// Whether the arm is where the motion has it at the time of the cursor, to the digits of its data.
const showsMotion = () => largestDifference(state.q, between(data.motion.q, now)) < 1e-6;
function tick(clock) {
  if (started === null) return;
  const time = (clock - started) / 1e3 * speed();
  const ends = time >= last && byId("loop").getAttribute("aria-pressed") === "false";
  seek(ends ? last : time % last);
  if (ends) pause();
  else requestAnimationFrame(tick);
}
const speed = () => Number(byId("speed").value);
const startHere = () => start(performance.now() - 1e3 * (now % last) / speed());
export function play() {
  startHere();
  requestAnimationFrame(tick);
}
export const pause = () => start(null);
function start(clock) {
  started = clock;
  byId("play").textContent = started === null ? "\u25b6" : "\u275a\u275a";
  byId("play").setAttribute("aria-label", started === null ? "Play" : "Pause");
}
if (data.motion) {
  byId("strip").hidden = false;
  byId("time").max = last;
  byId("clock").append("", added(byId("clock"), "span", { textContent: data.motion.name, title: data.motion.name }));
  for (const times of [0.1, 0.25, 0.5, 1, 2, 5, 10]) added(byId("speed"), "option", { value: times, textContent: `${times}\u00d7`, selected: times === 1 });
  byId("speed").onchange = () => { if (started !== null) startHere(); };
  byId("loop").onclick = () => byId("loop").setAttribute("aria-pressed", byId("loop").getAttribute("aria-pressed") === "false");
  byId("thinned").textContent = thinnedText();
  byId("play").onclick = () => (started === null ? play() : pause());
  byId("time").oninput = () => { pause(); seek(byId("time").valueAsNumber); };
  byId("time").onkeydown = ({ key }) => {
    if (key === "0") zoom(0, last);
    else if (key in ZOOM_KEYS) zoomAt(now, ZOOM_KEYS[key]);
  };
  onChange((part, by) => {
    if ("q" in part && by !== "motion" && started !== null) pause();
    byId("time").value = now;
    byId("clock").firstChild.textContent = `${now.toFixed(1)} / ${last.toFixed(1)} s`;
    showStrip();
  });
}
function thinnedText() {
  const { samples } = data.motion;
  const played = samples > times.length ? `The arm plays ${times.length} of ${samples} samples. ` : "";
  return spans ? `${played}Curves show the lowest and highest of each ${fixed(last / 1000, 2)} s.` : "";
}

// ---- curves
const CAUSES = [
  ["weight", "weight", "#d98200"],
  ["buoyancy", "buoyancy", "#3a9fd8"],
  ["inertia", "inertia", "#c46a9d"],
  ["coriolis", "Coriolis", "#0a9a70"],
  ["moving_water", "current", "#2f6fd0"],
];
const AXES = [["x", "#d0482a"], ["y", "#0a9a70"], ["z", "#2f6fd0"]];
const RECORDED = "#d0482a";
const charts = [];
// What the page has set that the curves were not computed with.
function changed() {
  const flowing = data.motion.moving_water ? data.water.water_velocity : [0, 0, 0];
  const { mass, com, volume } = state.payload;
  const held = [mass, volume, ...com];
  const { payload } = data;
  const apart = {
    fluid: state.density !== data.water.density,
    current: state.density > 0 && largestDifference(state.shown.current ? state.current : [0, 0, 0], flowing) > 0,
    payload: largestDifference(held, [payload.mass, payload.volume, ...payload.com]) > 0,
    mount: data.fixed && largestDifference(state.attitude, data.attitude) > 1e-9,
  };
  return Object.keys(apart).filter((name) => apart[name]);
}
const isRod = (k) => joints[k].kind === "prismatic";
const degree = 180 / Math.PI;

// ---- what can be drawn: a title, a unit and curves, which may depend on the joint k
// The torques of a joint by cause, and their sum, as curves.
function torqueCurves(k) {
  const known = CAUSES.filter(([cause]) => data.motion[cause]);
  const parts = known.map(([cause, name, color]) => ({ name, color, values: data.motion[cause].map((row) => row[k]) }));
  return [...parts, { name: "total", color: "var(--ink)", values: data.motion.total.map((row) => row[k]) }];
}
function axisCurves(first) {
  return AXES.map(([name, color], k) => ({ name, color, values: data.motion.mount.map((row) => row[first + k]) }));
}
// A recorded quantity beside the computed one, and what the recording has more.
const COMPARED = {
  position: { title: "Position", computed: "smoothed", unit: (k) => isRod(k) ? "mm" : "\u00b0", each: (k) => isRod(k) ? 1e3 : degree },
  effort: { title: "Effort", computed: "model", unit: (k) => isRod(k) ? "N" : "N\u00b7m", each: () => 1 },
  current: { title: "Motor current", computed: "model", unit: () => "A", each: () => 1 },
};
const compared = (name, kind, k) => data.motion.compared[name][kind].map((row) => row[k] === null ? null : COMPARED[name].each(k) * row[k]);
function comparison(name, k) {
  const computed = { name: COMPARED[name].computed, color: "var(--accent)", values: compared(name, "computed", k) };
  return [{ name: "recorded", color: RECORDED, values: compared(name, "recorded", k) }, computed];
}
const residual = (name, k) => [{ name: "recorded minus computed", color: RECORDED, values: compared(name, "residual", k) }];
const extent = (curves) => curves.flatMap((curve) => curve.values).reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [0, 0]);
// The range of the known values of curves.
function tight(curves) {
  const known = curves.flatMap((curve) => curve.values).filter((value) => value !== null);
  return known.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}
function quantities() {
  const found = [];
  const add = (quantity) => found.push(quantity);
  if (data.motion.mount) {
    const unit = (k) => isRod(k) ? "N" : "N\u00b7m";
    // Joints with the same unit share a scale, so that a small torque looks small.
    const range = (k) => extent(joints.flatMap((_, other) => unit(other) === unit(k) ? torqueCurves(other) : []));
    add({ title: "Torque", ofJoint: true, modelled: true, unit, curves: torqueCurves, range });
    add({ title: "Force on the mount", modelled: true, unit: () => "N", curves: () => axisCurves(0) });
    add({ title: "Moment on the mount", modelled: true, unit: () => "N\u00b7m", curves: () => axisCurves(3) });
  }
  for (const name in data.motion.compared) {
    const { title, unit } = COMPARED[name];
    const modelled = name !== "position";
    add({ title, ofJoint: true, modelled, unit, curves: (k) => comparison(name, k), range: (k) => tight(comparison(name, k)) });
    add({ title: `${title}, residual`, ofJoint: true, modelled, unit, curves: (k) => residual(name, k) });
  }
  for (const [name, values] of Object.entries(data.motion.signals)) {
    const curves = [{ name: "value", color: "var(--accent)", values }];
    add({ title: name, unit: () => "", curves: () => curves, range: () => tight(curves) });
  }
  return found;
}
const drawable = data.motion ? quantities() : [];
// What is drawn at first: a recording with its residual, or the torques; the user's first signal comes last.
function atFirst() {
  const at = (title) => drawable.findIndex((quantity) => quantity.title === title);
  const measured = ["Effort", "Motor current"].find((title) => at(title) >= 0);
  const first = measured ? [measured, `${measured}, residual`] : ["Torque", "Force on the mount"];
  const [signal] = Object.keys(data.motion.signals);
  return [...first, signal || "Moment on the mount"].map(at).filter((place) => place >= 0);
}

// ---- charts
let chartedJoint = 1;
let [from, to] = [0, last]; // the part of the motion that the charts show
const shareOf = (time) => (time - from) / (to - from || 1);
// Times at round steps, of which the last leaves room for its number.
function ticks() {
  const quarter = (to - from) / 4;
  const power = 10 ** Math.floor(Math.log10(quarter));
  const step = power * [1, 2, 5, 10].find((digit) => digit * power >= quarter * (1 - 1e-9));
  const first = Math.ceil(from / step - 1e-9);
  return Array.from({ length: 5 }, (_, i) => (first + i) * step).filter((time) => shareOf(time) < 0.95);
}
// Show a part of the motion, no shorter than a thousandth of it.
function zoom(start, end) {
  const length = clamp(end - start, last / 1000, last);
  from = clamp(start, 0, last - length);
  to = from + length;
  for (const chart of charts) drawAxis(chart);
  showStrip();
}
// Make the part some times as long; a time stays where it is in the charts.
const zoomAt = (time, times) => zoom(time - times * (time - from), time + times * (to - time));
function addChart(place) {
  const element = added(byId("charts"), "figure", {
    innerHTML: `<figcaption><select class="what"></select><b></b><span></span><span class="legend"></span></figcaption>
      <div class="plot"><svg preserveAspectRatio="none"></svg><small></small><small></small><i></i></div><div class="axis"></div>`,
  });
  const [what, name, sign, legend, svg, high, low, cursor, axis] = [".what", "b", "b + span", ".legend", "svg", "small", "small + small", "i", ".axis"].map((part) => element.querySelector(part));
  const chart = { element, what, name, sign, legend, svg, ends: [low, high], cursor, axis };
  what.setAttribute("aria-label", `What chart ${charts.length + 1} shows`);
  svg.setAttribute("role", "img");
  for (const { title } of drawable) added(what, "option", { textContent: title });
  what.selectedIndex = place;
  what.onchange = () => {
    draw(chart);
    showStrip();
  };
  // One pointer moves through the motion; two stretch it, so that each stays on its time.
  const held = new Map();
  const timeAt = (event) => {
    const box = svg.getBoundingClientRect();
    return from + (to - from) * (event.clientX - box.left) / box.width;
  };
  svg.onpointerdown = (event) => {
    svg.setPointerCapture(event.pointerId);
    held.set(event.pointerId, { time: timeAt(event) });
    svg.onpointermove(event);
  };
  svg.onpointermove = (event) => {
    if (!held.has(event.pointerId)) return;
    const box = svg.getBoundingClientRect();
    Object.assign(held.get(event.pointerId), { x: event.clientX - box.left });
    const [one, other] = held.values();
    if (!other) {
      pause();
      return seek(timeAt(event));
    }
    const perPixel = (other.time - one.time) / (other.x - one.x);
    const start = one.time - perPixel * one.x;
    // Two fingers on one pixel have no scale.
    if (perPixel > 0 && Number.isFinite(perPixel)) {
      zoom(start, start + perPixel * box.width);
    }
  };
  svg.onpointerup = svg.onpointercancel = (event) => held.delete(event.pointerId);
  svg.onwheel = (event) => {
    event.preventDefault();
    zoomAt(timeAt(event), Math.exp(0.002 * event.deltaY));
  };
  svg.ondblclick = () => zoom(0, last);
  charts.push(chart);
  return chart;
}
function draw(chart) {
  const { title, ofJoint, unit, curves: of, range } = drawable[chart.what.selectedIndex];
  const curves = of(chartedJoint);
  const [low, high] = range ? range(chartedJoint) : extent(curves);
  const height = (value) => (96 - 92 * (value - low) / (high - low || 1)).toFixed(2);
  chart.name.hidden = !ofJoint;
  chart.sign.textContent = unit(chartedJoint);
  chart.svg.replaceChildren();
  chart.svg.innerHTML = `<line x2="1000" y1="${height(0)}" y2="${height(0)}"/><g></g>`;
  drawAxis(chart);
  chart.legend.replaceChildren();
  chart.curves = curves.map(({ name, color, values }) => {
    for (const points of pieces(values, height)) {
      chart.svg.insertAdjacentHTML("beforeend", `<polyline class="${name}" style="stroke: ${color}" points="${points}"/>`);
    }
    const item = added(chart.legend, "span", { className: "item", textContent: name });
    item.dataset.curve = name;
    item.style.setProperty("--own", color);
    return { values, rows: values.map((value) => [value]), output: added(item, "output", { ariaLive: "off" }) };
  });
  const digits = high - low < 0.2 ? 3 : high - low < 2 ? 2 : 1;
  chart.digits = Math.max(digits, 2);
  chart.ends.forEach((end, i) => { end.textContent = fixed([low, high][i], digits); });
  const whose = ofJoint ? ` of ${joints[chartedJoint].name}` : "";
  chart.svg.setAttribute("aria-label", `${title}${whose} over time, ${chart.ends[0].textContent} to ${chart.ends[1].textContent} ${unit(chartedJoint)}`.trim());
}
// The numbers and lines of the part of the motion that is shown.
function drawAxis({ svg, axis }) {
  svg.setAttribute("viewBox", `${1000 * from / last} 0 ${1000 * (to - from) / last} 100`);
  svg.querySelector("g").innerHTML = ticks().map((time) => `<line class="tick" x1="${1000 * time / last}" x2="${1000 * time / last}" y2="100"/>`).join("");
  axis.replaceChildren();
  ticks().forEach((time, i) => {
    const tick = added(axis, "span", { textContent: `${Number(time.toPrecision(6))}${i ? "" : " s"}` });
    tick.style.left = `${100 * shareOf(time)}%`;
    if (shareOf(time) < 0.03) tick.style.transform = "none";
  });
}
// Where row i of a curve is on the time axis: the two of a span are in its middle.
function timeOf(i) {
  if (!spans) return times[i];
  const span = i >> 1;
  return (spans[span] + (spans[span + 1] ?? last)) / 2;
}
// The points of a curve, in pieces between values that are not known.
function pieces(values, height) {
  const found = [[]];
  values.forEach((value, i) => {
    if (value === null) found.push([]);
    else found[found.length - 1].push(`${(1000 * timeOf(i) / last).toFixed(2)},${height(value)}`);
  });
  return found.filter((points) => points.length).map((points) => points.join(" "));
}
// The cursor and the numbers are the motion's: with the arm elsewhere, the cursor is grey and there are no numbers.
function showStrip() {
  const apart = charts.length && !showsMotion();
  byId("charts").classList.toggle("apart", apart);
  const other = changed();
  write(byId("other"), other.length ? `Grey: the panel has another ${other.join(" and ")} than the motion was computed with.` : "");
  for (const chart of charts) chart.element.classList.toggle("stale", other.length > 0 && Boolean(drawable[chart.what.selectedIndex].modelled));
  for (const { curves, svg, cursor, digits } of charts) {
    svg.parentElement.title = apart ? "The arm has left the motion: drag here to return to it." : "Drag to move in time. Wheel or pinch to zoom, double click to see all.";
    cursor.style.transform = `translateX(${(100 * shareOf(now)).toFixed(3)}%)`;
    for (const { values, rows, output } of curves) {
      if (spans) {
        write(output, rangeText(values, digits));
        continue;
      }
      const [value] = between(rows, now);
      output.dataset.value = value;
      write(output, Number.isFinite(value) ? fixed(value, digits) : "\u2013");
    }
  }
}
// The lowest and the highest value in the span of the cursor.
function rangeText(values, digits) {
  const i = Math.max(0, spans.findLastIndex((start) => start <= now));
  const [low, high] = values.slice(2 * i, 2 * i + 2);
  return low === null ? "\u2013" : `${fixed(low, digits)} to ${fixed(high, digits)}`;
}

if (drawable.length) {
  for (const place of atFirst()) addChart(place);
  const select = added(charts[0].name, "select", { id: "torque-of", onchange: () => {
    chartedJoint = select.selectedIndex;
    drawAll();
  } });
  select.before("of ");
  select.setAttribute("aria-label", "Joint whose curves are drawn");
  for (const joint of joints) added(select, "option", { textContent: joint.name });
  select.selectedIndex = chartedJoint;
  drawAll();
}
function drawAll() {
  charts.forEach((chart, i) => {
    if (i) chart.name.textContent = `of ${joints[chartedJoint].name}`;
    draw(chart);
  });
  showStrip();
}
export function unfold(on) {
  byId("charts").hidden = !on;
  byId("curves").setAttribute("aria-expanded", on);
  viewer.set_3d_pane_size();
}
byId("curves").hidden = !charts.length;
byId("curves").onclick = () => unfold(byId("charts").hidden);
