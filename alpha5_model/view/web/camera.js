// The camera. meshcat's camera sits in a frame turned so that its y axis is up.
const swap = ([x, y, z]) => [x, z, -y];
viewer.camera.fov = data.camera.field_of_view;
// A little further away than a picture: the arm will move.
const eye = vector(data.camera.eye).sub(vector(data.camera.target)).multiplyScalar(1.15).add(vector(data.camera.target));
viewer.camera.position.set(...swap(eye.toArray()));
viewer.controls.target.set(...swap(data.camera.target));
// Centre the arm in what the panel leaves free.
const resize = viewer.set_3d_pane_size.bind(viewer);
viewer.set_3d_pane_size = (...size) => {
  resize(...size);
  const [w, h] = [window.innerWidth, window.innerHeight];
  viewer.camera.setViewOffset(w, h, w > 760 ? -160 : 0, data.motion ? 20 : 0, w, h);
  viewer.set_dirty();
};
viewer.set_3d_pane_size();
