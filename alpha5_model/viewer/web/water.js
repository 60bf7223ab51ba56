// Controls of the water: the fluid, the current, and how the arm is mounted in it.
const FLUIDS = new Map([["air", 0], ["fresh", 1000], ["sea", 1025]]);
const DENSEST = 2000; // kg/m3
const FASTEST = 5; // m/s
const TURNED = Math.PI / 180;

const water = foldable("water", "Water");
const fluidRow = added(water.box, "div", { className: "line" });
const fluidButtons = [...FLUIDS].map(([name, density]) => added(fluidRow, "button", { textContent: name, onclick: () => change({ density }) }));
numberField(fluidRow, {
  name: "Density", unit: "kg/m\u00b3", each: 1, low: 0, high: DENSEST, digits: 3,
  get: () => state.density, set: (density) => change({ density }),
});
added(fluidRow, "span", { textContent: "kg/m\u00b3" });

const currentRow = added(water.box, "div", { className: "line" });
added(currentRow, "span", { textContent: "current" });
["x", "y", "z"].forEach((axis, i) => {
  const label = added(currentRow, "label", { textContent: axis });
  numberField(label, {
    name: `Current along ${axis}`, unit: "m/s", each: 1, low: -FASTEST, high: FASTEST, digits: 3,
    get: () => flowing()[i], set: (value) => setCurrent(flowing().with(i, value)),
  });
});
added(currentRow, "span", { textContent: "m/s" });
const forces = added(water.box, "p");

// A current that is not shown has no load, so it is none.
function flowing() {
  return shown.current ? state.current : [0, 0, 0];
}
// A current that is set is shown, too.
function setCurrent(current) {
  change({ current });
  if (!shown.current) setGroup("current", true);
}

function showWater() {
  [...FLUIDS.values()].forEach((density, i) => fluidButtons[i].setAttribute("aria-pressed", state.density === density));
  const known = [...FLUIDS].find(([, density]) => density === state.density);
  const fluid = state.density === 0 ? "air" : `${known ? `${known[0]}, ` : ""}${Number(state.density.toFixed(3))} kg/m\u00b3`;
  const speed = Math.hypot(...state.current);
  water.say(shown.current ? `${fluid}, current ${fixed(speed, 2)} m/s` : fluid);
  const { weight, buoyancy } = totals();
  const lift = state.density ? `, buoyancy ${fixed(buoyancy, 2)} N` : "";
  const load = state.density ? "The load of a current is estimated, with its interval." : "In air a current has no load here.";
  forces.textContent = `Arm: weight ${fixed(weight, 2)} N${lift}. ${load}`;
}

// ---- the attitude of the base: gravity points down in the picture
const mount = foldable("mount", "Mount");
if (data.fixed) {
  const row = added(mount.box, "div", { className: "line" });
  ["roll", "pitch"].forEach((name, i) => {
    const label = added(row, "label", { textContent: name });
    numberField(label, {
      name: `Mount's ${name}`, unit: "\u00b0", each: TURNED, low: -180, high: 180, digits: 2,
      get: () => state.attitude[i], set: (angle) => change({ attitude: state.attitude.with(i, angle) }),
    });
    added(row, "span", { textContent: "\u00b0" });
  });
  added(mount.box, "p", { textContent: "How base_link is turned on its carrier. Targets, tcp and current stay in base_link." });
  mount.load = added(mount.box, "p", { id: "rest-load" });
} else {
  byId("mount").hidden = true;
}
// Force and moment that the arm at rest puts on its carrier at base_link, in base_link: weights, and buoyancies upwards.
function restLoad() {
  const [force, moment] = [new THREE.Vector3(), new THREE.Vector3()];
  const pull = (link, point, mass) => {
    const each = vector(data.water.gravity).multiplyScalar(mass);
    force.add(each);
    moment.add(vector(point).applyMatrix4(poses[link]).sub(origin(poses[root])).cross(each));
  };
  for (const { link, mass, com, volume, cob } of data.loads) {
    pull(link, com, mass);
    pull(link, cob, -state.density * volume);
  }
  pull("tcp", state.payload.com, state.payload.mass - state.density * state.payload.volume);
  return [force, moment].map((each) => toBaseAxes(each.toArray()).toArray());
}
function showRestLoad() {
  if (!mount.load) return;
  const parts = (values, digits) => values.map((value, i) => `${"xyz"[i]} ${fixed(value, digits)}`).join(" ");
  const [force, moment] = restLoad();
  const but = shown.current ? ", without what the current adds" : "";
  write(mount.load, `Load on the carrier at rest: force ${parts(force, 2)} N, moment ${parts(moment, 3)} N\u00b7m${but}.`);
}
function showMount() {
  const turned = state.attitude.map((angle) => `${Number((angle / TURNED).toFixed(1))}\u00b0`.replace("-", "\u2212"));
  mount.say(state.attitude.some((angle) => Math.abs(angle) > 1e-9) ? `roll ${turned[0]}, pitch ${turned[1]}` : "level");
}
onChange((part) => {
  if ("density" in part || "current" in part) showWater();
  if ("attitude" in part) showMount();
  if (["density", "current", "payload", "attitude"].some((entry) => entry in part) && poses[root]) place("page");
});
