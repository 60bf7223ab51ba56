// Commands that build and move the scene, from this file or from a live server.
const geometries = {}; // meshes by identifier; one that several shapes share comes with the first of them
let unframed = false; // whether an object has come since the camera was placed
const handle = viewer.handle_command.bind(viewer);
const decode = viewer.handle_command_bytearray.bind(viewer);

// A command that cannot be read or drawn leaves the page as it is.
viewer.handle_command_bytearray = (bytes) => {
  try {
    decode(bytes);
  } catch (error) {
    console.warn(`A command could not be carried out: ${error.message}`);
  }
};

viewer.handle_command = (command) => {
  const { geometries: sent = [], materials = [] } = command.type === "set_object" ? command.object : {};
  for (const geometry of sent) {
    if (geometry.data) geometries[geometry.uuid] = geometry.data;
    else geometry.data = geometries[geometry.uuid];
  }
  // Transparent shapes touch bodies in places: draw them as if they were nearer.
  for (const each of materials) {
    Object.assign(each, { polygonOffset: each.opacity < 1, polygonOffsetFactor: -1, polygonOffsetUnits: -4 });
  }
  handle(command);
  if (command.type === "set_object" && split(command.path)[2] === "bodies") {
    for (const part of meshes(command.path)) part.material = litAtVertices(part.material);
  }
  if (command.type === "set_property" && command.property === "visible") {
    const group = split(command.path)[2];
    if (group in shown) setGroup(group, command.value);
  }
  if (command.type === "set_object" && globalThis.alpha5 && !unframed) {
    unframed = true;
    requestAnimationFrame(() => { unframed = false; if (state.view) look(state.view, false); });
  }
  onCommand(command);
};

for (const command of data.commands) {
  viewer.handle_command_bytearray(Uint8Array.from(atob(command), (c) => c.charCodeAt(0)));
}
