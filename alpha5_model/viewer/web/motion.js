// Play a motion in real time; a slow browser drops frames.
let started = null;
const times = data.motion ? data.motion.time : [0];
const last = times[times.length - 1];
let now = 0;

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

function seek(time) {
  if (!Number.isFinite(time)) return;
  now = clamp(time, 0, last);
  setPose(between(data.motion.q, now), "motion");
  showTime();
}
// Whether the arm is where the motion has it at the time of the cursor.
const showsMotion = () => largestDifference(joints.map((joint) => q[joint.name]), between(data.motion.q, now)) < 1e-9;
function showTime() {
  byId("time").value = now;
  byId("clock").firstChild.textContent = `${now.toFixed(1)} / ${last.toFixed(1)} s`;
}
function tick(clock) {
  if (started === null) return;
  seek(((clock - started) / 1e3) % last);
  requestAnimationFrame(tick);
}
function play() {
  start(performance.now() - 1e3 * (now % last));
  requestAnimationFrame(tick);
}
const pause = () => start(null);
function start(clock) {
  started = clock;
  if (started === null) showPanelNow();
  byId("play").textContent = started === null ? "\u25b6" : "\u275a\u275a";
  byId("play").setAttribute("aria-label", started === null ? "Play" : "Pause");
}
onPose((by) => { if (by !== "motion" && started !== null) pause(); });

if (data.motion) {
  byId("strip").hidden = false;
  byId("time").max = last;
  byId("clock").append("", added(byId("clock"), "span", { textContent: data.motion.name, title: data.motion.name }));
  byId("play").onclick = () => (started === null ? play() : pause());
  byId("time").oninput = () => { pause(); seek(byId("time").valueAsNumber); };
}
