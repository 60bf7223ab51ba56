// A motion, played by the clock: a slow browser drops frames, not time.
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
  setPose(data.motion.q[i].map((after, j) => data.motion.q[i - 1][j] + part * (after - data.motion.q[i - 1][j])), "motion");
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
onPose((by) => { if (by !== "motion") pause(); });
if (data.motion) {
  byId("player").hidden = false;
  byId("time").max = last;
  byId("time").value = 0;
  byId("clock").textContent = `0.0 / ${last.toFixed(1)} s  ${data.motion.name}`;
  byId("play").onclick = () => (started === null ? play() : pause());
  byId("time").oninput = () => { pause(); seek(Number(byId("time").value)); };
}
