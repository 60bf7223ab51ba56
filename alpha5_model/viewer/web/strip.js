// Curves of the motion: torque by cause and load on the mount; drag in them to move through the motion.
const CAUSES = [
  ["weight", "weight", "#d98200"],
  ["buoyancy", "buoyancy", "#3a9fd8"],
  ["inertia", "inertia", "#c46a9d"],
  ["coriolis", "Coriolis", "#0a9a70"],
  ["moving_water", "current", "#2f6fd0"],
];
const AXES = [["x", "#d0482a"], ["y", "#0a9a70"], ["z", "#2f6fd0"]];
const charts = [];

// The torques of a joint by cause, and their sum, as curves.
function torqueCurves(k) {
  const known = CAUSES.filter(([cause]) => data.motion[cause]);
  const parts = known.map(([cause, name, color]) => ({ name, color, values: data.motion[cause].map((row) => row[k]) }));
  const total = times.map((_, i) => parts.reduce((sum, part) => sum + part.values[i], 0));
  return [...parts, { name: "total", color: "var(--ink)", values: total }];
}
function axisCurves(first) {
  return AXES.map(([name, color], k) => ({ name, color, values: data.motion.mount.map((row) => row[first + k]) }));
}
const extent = (curves) => curves.flatMap((curve) => curve.values).reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [0, 0]);

function addChart(title, unit, curves, range) {
  const element = added(byId("charts"), "figure", {
    innerHTML: `<figcaption><b>${title}</b><span></span><span class="legend"></span></figcaption>
      <div class="plot"><svg viewBox="0 0 1000 100" preserveAspectRatio="none"></svg><small></small><small></small><i></i></div>`,
  });
  const [name, sign, legend, svg, high, low, cursor] = ["b", "b + span", ".legend", "svg", "small", "small + small", "i"].map((part) => element.querySelector(part));
  const chart = { name, sign, legend, svg, ends: [low, high], cursor };
  draw(chart, unit, curves, range);
  svg.onpointerdown = svg.onpointermove = (event) => {
    if (!event.buttons) return;
    svg.setPointerCapture(event.pointerId);
    const box = svg.getBoundingClientRect();
    pause();
    seek(last * (event.clientX - box.left) / box.width);
  };
  charts.push(chart);
  return chart;
}
function draw(chart, unit, curves, [low, high]) {
  const height = (value) => (96 - 92 * (value - low) / (high - low || 1)).toFixed(2);
  const points = (values) => values.map((value, i) => `${(1000 * times[i] / last).toFixed(2)},${height(value)}`).join(" ");
  chart.sign.textContent = unit;
  chart.svg.innerHTML = `<line x2="1000" y1="${height(0)}" y2="${height(0)}"/>${curves.map(
    ({ name, color, values }) => `<polyline class="${name}" style="stroke: ${color}" points="${points(values)}"/>`).join("")}`;
  chart.legend.innerHTML = curves.map(
    ({ name, color }) => `<span class="item" data-curve="${name}" style="--own: ${color}">${name}<output></output></span>`).join("");
  chart.curves = curves.map(({ values }, i) => ({ rows: values.map((value) => [value]), output: chart.legend.children[i].lastChild }));
  const digits = high - low < 0.2 ? 3 : high - low < 2 ? 2 : 1;
  chart.ends.forEach((end, i) => { end.textContent = fixed([low, high][i], digits); });
}
// The cursor and the numbers are the motion's: with the arm elsewhere, the cursor is grey and there are no numbers.
function showStrip() {
  const apart = charts.length && !showsMotion();
  byId("charts").classList.toggle("apart", apart);
  byId("charts").title = apart ? "The arm has left the motion: drag here to return to it." : "";
  for (const { curves, cursor } of charts) {
    cursor.style.transform = `translateX(${(100 * now / last).toFixed(3)}%)`;
    for (const { rows, output } of curves) {
      [output.dataset.value] = between(rows, now);
      output.textContent = fixed(Number(output.dataset.value), 2);
    }
  }
}

if (data.motion && data.motion.mount) {
  const unitOf = (k) => joints[k].kind === "prismatic" ? "N" : "N\u00b7m";
  // Joints with the same unit share a scale, so that a small torque looks small.
  const rangeOf = (k) => extent(joints.flatMap((_, other) => unitOf(other) === unitOf(k) ? torqueCurves(other) : []));
  const torque = addChart("Torque of ", unitOf(1), torqueCurves(1), rangeOf(1));
  const select = added(torque.name, "select", { id: "torque-of", onchange: () => {
    const k = select.selectedIndex;
    draw(torque, unitOf(k), torqueCurves(k), rangeOf(k));
    showStrip();
  } });
  select.setAttribute("aria-label", "Joint whose torque is drawn");
  for (const joint of joints) added(select, "option", { textContent: joint.name });
  select.selectedIndex = 1;
  addChart("Force on the mount", "N", axisCurves(0), extent(axisCurves(0)));
  addChart("Moment on the mount", "N\u00b7m", axisCurves(3), extent(axisCurves(3)));
}
function unfold(on) {
  byId("charts").hidden = !on;
  byId("curves").setAttribute("aria-expanded", on);
  viewer.set_3d_pane_size();
}
byId("curves").hidden = !charts.length;
byId("curves").onclick = () => unfold(byId("charts").hidden);
if (data.motion) {
  showTime();
  showStrip();
  onPose(showStrip);
}
