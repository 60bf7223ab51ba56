// Curves and sliders that a Python program adds while the page is open: viewer.curve(...) and viewer.slider(...).
const LONGEST_FEED = 600; // samples
const feeds = new Map(); // name -> its samples, [[seconds, value], ...], and its picture

// Add samples to a curve; `whole` replaces it.
function feed({ name, samples, whole }) {
  if (!feeds.has(name)) feeds.set(name, makeFeed(name));
  const one = feeds.get(name);
  one.samples = (whole ? samples : [...one.samples, ...samples]).slice(-LONGEST_FEED);
  if (one.waiting) return;
  one.waiting = true;
  requestAnimationFrame(() => drawFeed(one));
}
function makeFeed(name) {
  const element = added(byId("feeds"), "figure", {
    innerHTML: `<figcaption><b></b><output></output></figcaption>
      <div class="plot"><svg viewBox="0 0 1000 100" preserveAspectRatio="none"><polyline/></svg><small></small><small></small></div>`,
  });
  element.querySelector("b").textContent = name;
  byId("strip").hidden = false;
  byId("player").hidden = !data.motion;
  viewer.set_3d_pane_size();
  return { element, samples: [], waiting: false };
}
function drawFeed(one) {
  one.waiting = false;
  const { element, samples } = one;
  const values = samples.map(([, value]) => value);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const [begin, end] = [samples[0][0], samples[samples.length - 1][0]];
  const x = (time) => (end > begin ? 1000 * (time - begin) / (end - begin) : 1000).toFixed(2);
  const y = (value) => (96 - 92 * (high > low ? (value - low) / (high - low) : 0.5)).toFixed(2);
  element.querySelector("polyline").setAttribute("points", samples.map(([time, value]) => `${x(time)},${y(value)}`).join(" "));
  const text = (value) => Number(value.toPrecision(5)).toString().replace("-", "\u2212");
  element.querySelector("output").textContent = text(values[values.length - 1]);
  const [top, bottom] = element.querySelectorAll("small");
  top.textContent = text(high);
  bottom.textContent = text(low);
}

// ---- sliders of a program
const dials = new Map(); // name -> its slider and its number
function dial({ name, low, high, value }) {
  if (!dials.has(name)) dials.set(name, makeDial(name));
  const { slider, output } = dials.get(name);
  Object.assign(slider, { min: low, max: high, step: "any" });
  slider.value = value;
  output.textContent = dialText(value);
}
function makeDial(name) {
  const row = added(byId("controls"), "label", { className: "line" });
  added(row, "span", { textContent: name });
  const slider = added(row, "input", { type: "range" });
  const output = added(row, "output");
  slider.oninput = () => {
    output.textContent = dialText(slider.valueAsNumber);
    sendSoon(name, slider.valueAsNumber);
  };
  return { slider, output };
}
const dialText = (value) => Number(value.toPrecision(4)).toString().replace("-", "\u2212");
// Send at most one message of each slider for each frame.
const unsent = new Map();
function sendSoon(name, value) {
  if (!unsent.has(name)) {
    requestAnimationFrame(() => {
      const last = unsent.get(name);
      unsent.delete(name);
      if (viewer.connection.readyState === WebSocket.OPEN) viewer.connection.send(JSON.stringify({ slider: name, value: last }));
    });
  }
  unsent.set(name, value);
}
