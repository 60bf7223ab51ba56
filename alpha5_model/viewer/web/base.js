// The data of the page, meshcat's viewer, and helpers that all other files use.
const data = JSON.parse(document.getElementById("alpha5-data").textContent);
const THREE = MeshCat.THREE;
const byId = (id) => document.getElementById(id);
let viewer;
try {
  viewer = new MeshCat.Viewer(byId("pane"));
} catch (error) {
  document.querySelector("#panel h1").textContent = "This page needs WebGL, which this browser does not offer.";
  throw error;
}
const narrow = matchMedia("(max-width: 760px)");
const dark = matchMedia("(prefers-color-scheme: dark)");

const split = (path) => path.split("/").filter((part) => part);
const matrix = (rows) => new THREE.Matrix4().set(...rows.flat());
const vector = (elements) => new THREE.Vector3().fromArray(elements);
const origin = (pose) => new THREE.Vector3().setFromMatrixPosition(pose);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const wrapped = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
// The meshes under a path of meshcat's scene tree.
function meshes(path) {
  const found = [];
  viewer.scene_tree.find(split(path)).object.traverse((part) => part.isMesh && found.push(part));
  return found;
}

// Add an element to another one, with some properties, and return it.
function added(parent, tag, properties = {}) {
  return Object.assign(parent.appendChild(document.createElement(tag)), properties);
}

// Write a text, unless it is there already: a text that is written is laid out and painted again.
function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// A number as text, with a true minus sign and without minus zero.
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "\u2212");
}
const mm = (metres) => fixed(1e3 * metres, 1);
