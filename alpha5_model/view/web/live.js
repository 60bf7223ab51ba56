// A live server: poses both ways, Python's camera, and what to say when its program has ended.

// Called with every command that came, after meshcat has seen it.
function heard(command) {
  if (command.type === "pose") {
    data.root = command.root;
    setPose(command.q, "python");
  } else if (command.type === "camera") {
    viewer.camera.position.set(...swap(command.eye));
    viewer.controls.target.set(...swap(command.target));
    viewer.controls.update();
    chosen = null;
  }
}

function connect(notice) {
  viewer.connect();
  viewer.connection.onclose = () => {
    notice.hidden = false;
    setTimeout(() => connect(notice), 1000);
  };
  // The next program at this address may show another arm.
  viewer.connection.onopen = () => { if (!notice.hidden) location.reload(); };
}

if (data.live) {
  connect(added(document.body, "div", {
    id: "lost",
    role: "alert",
    hidden: true,
    textContent: "The program behind this page has ended. What you move here reaches it no more; the page connects again when it is back.",
  }));
  // One message for each picture, however fast a hand is.
  let waiting = false;
  onPose((by) => {
    if (waiting || (by !== "hand" && by !== "motion")) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      if (viewer.connection.readyState !== WebSocket.OPEN) return;
      viewer.connection.send(JSON.stringify({ q: data.sliders.map((name) => q[name]) }));
    });
  });
}
