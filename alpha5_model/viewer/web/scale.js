// Scale bars of lengths and arrows, at the distance of the camera's target.
const bars = [
  { name: "length", unit: "mm", each: 1e-3, groups: ["bodies", "labels"] },
  { name: "force", unit: "N", each: data.arrows.force, groups: ["weight", "buoyancy"] },
  { name: "current", unit: "m/s", each: data.arrows.current, groups: ["current"] },
];
for (const bar of bars) {
  bar.element = added(byId("scale"), "div", { className: bar.name });
  for (const part of ["span", "i"]) added(bar.element, part);
}

// The largest of 1, 2 or 5 times a power of ten that is at most a number.
function round(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((digit) => digit * power <= most * (1 + 1e-9)) * power;
}
function drawScale() {
  const distance = viewer.camera.position.distanceTo(viewer.controls.target);
  const pixels = window.innerHeight / 2 / Math.tan(viewer.camera.fov * Math.PI / 360) / distance; // per metre
  for (const { unit, each, groups, element } of bars) {
    element.hidden = !groups.some((name) => shown[name]);
    const size = round(120 / (pixels * each));
    element.dataset.size = size;
    write(element.firstChild, `${Number(size.toPrecision(1))} ${unit}`);
    element.lastChild.style.width = `${(size * each * pixels).toFixed(2)}px`;
  }
}
