// Save the picture as PNG and the motion as video, with the labels and scales over them.
let film = null;
const download = (name, address) => Object.assign(document.createElement("a"), { href: address, download: name }).click();

// Copy the free part of the window, as it was drawn last, to a canvas.
function compose(canvas) {
  const [left, top] = canvas.frame;
  const drawn = viewer.renderer.domElement;
  const dots = drawn.width / window.innerWidth;
  const pen = canvas.getContext("2d");
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.drawImage(drawn, left * dots, top * dots, canvas.width, canvas.height, 0, 0, canvas.width, canvas.height);
  pen.setTransform(dots, 0, 0, dots, -left * dots, -top * dots);
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
function sheet() {
  const frame = free();
  const dots = viewer.renderer.domElement.width / window.innerWidth;
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
