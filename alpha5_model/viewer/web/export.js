// Save the picture as PNG and the motion as video, with the labels and scales over them.
let film = null;
const download = (name, address) => Object.assign(document.createElement("a"), { href: address, download: name }).click();

// Copy the free part of the window, as it was drawn last, to a canvas.
function compose(canvas) {
  const [left, top] = canvas.frame;
  const dots = dotsPerPixel();
  const pen = canvas.getContext("2d");
  pen.setTransform(dots, 0, 0, dots, -left * dots, -top * dots);
  paintScene(pen);
  for (const line of document.querySelectorAll("#leaders i")) {
    if (line.style.display === "none" || !line.ends) continue;
    const [x1, y1, x2, y2] = line.ends;
    pen.strokeStyle = getComputedStyle(line).borderTopColor;
    pen.stroke(new Path2D(`M${x1},${y1}L${x2},${y2}`));
  }
  for (const element of document.querySelectorAll("#labels > *, #scale span, #scale i")) {
    const box = element.getBoundingClientRect();
    if (!box.width) continue;
    const style = getComputedStyle(element);
    pen.fillStyle = style.backgroundColor;
    pen.fillRect(box.left, box.top, box.width, box.height);
    pen.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    pen.fillStyle = style.color;
    pen.textBaseline = "middle";
    pen.fillText(element.textContent, box.left + parseFloat(style.paddingLeft), box.top + box.height / 2);
  }
}
const dotsPerPixel = () => viewer.renderer.domElement.width / stage.width;
// The backdrop and the scene, in pixels of the window.
function paintScene(pen) {
  const { top_color: top, bottom_color: bottom, visible } = viewer.scene_tree.find(["Background"]).object;
  if (visible) {
    pen.fillStyle = pen.createLinearGradient(0, 0, 0, stage.height);
    pen.fillStyle.addColorStop(0, `rgb(${top})`);
    pen.fillStyle.addColorStop(1, `rgb(${bottom})`);
    pen.fillRect(0, 0, window.innerWidth, window.innerHeight);
  }
  pen.drawImage(viewer.renderer.domElement, stage.left, 0, stage.width, stage.height);
}
// What meshcat's programs in Python ask for: the window with the scene alone.
viewer.capture_image = () => {
  viewer.render();
  const canvas = Object.assign(document.createElement("canvas"), { width: window.innerWidth, height: window.innerHeight });
  paintScene(canvas.getContext("2d"));
  return canvas.toDataURL();
};
function sheet() {
  const frame = free();
  const dots = dotsPerPixel();
  const even = (size) => 2 * Math.floor(size * dots / 2); // video encoders need even sizes
  return Object.assign(document.createElement("canvas"), { width: even(frame[2] - frame[0]), height: even(frame[3] - frame[1]), frame });
}
function picture() {
  const canvas = sheet();
  viewer.render();
  compose(canvas);
  return canvas.toDataURL("image/png");
}

// Record the motion once, in real time; a second call stops.
function record() {
  if (film) return film.stop();
  const canvas = sheet();
  const type = ["video/webm;codecs=vp9", "video/webm", "video/mp4"].find((each) => MediaRecorder.isTypeSupported(each));
  const parts = [];
  film = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 6e6 });
  film.canvas = canvas;
  film.ondataavailable = (event) => parts.push(event.data);
  film.onstop = () => {
    film = null;
    pause();
    video.textContent = "Video";
    download(`alpha5.${type.includes("webm") ? "webm" : "mp4"}`, URL.createObjectURL(new Blob(parts, { type })));
  };
  seek(0);
  film.start();
  play();
}
// Called after every frame.
function rendered() {
  if (!film || film.state !== "recording") return;
  compose(film.canvas);
  video.textContent = `Stop (${(last - now).toFixed(0)} s)`;
  if (now < film.before) film.stop(); // the motion has started again
  else film.before = now;
}

added(byId("views"), "button", { id: "png", textContent: "PNG", title: "Keep this picture", onclick: () => download("alpha5.png", picture()) });
const video = added(byId("player"), "button", { id: "video", textContent: "Video", title: "Keep the motion as a video, in real time", onclick: record });
video.hidden = !window.MediaRecorder;
