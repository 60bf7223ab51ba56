// What the page was given, meshcat's drawing of it, and the words that every other file uses.
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

const split = (path) => path.split("/").filter((part) => part);
const matrix = (rows) => new THREE.Matrix4().set(...rows.flat());
const vector = (elements) => new THREE.Vector3().fromArray(elements);

// A new element inside another, with its properties.
function added(parent, tag, properties = {}) {
  return Object.assign(parent.appendChild(document.createElement(tag)), properties);
}

// A number with a true minus sign and no minus zero.
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "\u2212");
}
const mm = (metres) => fixed(1e3 * metres, 1);
