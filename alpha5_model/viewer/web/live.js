// The live server: poses in both directions, Python's camera, and a notice when the program has ended.

// Called with every command after meshcat has handled it.
function onCommand(command) {
  if (command.type === "pose" && isPose(command.q)) {
    data.root = command.root;
    setPose(command.q, "python");
  } else if (command.type === "refused") {
    say("refused", `Python refused this: ${command.reason}.`);
  } else if (command.type === "curve") {
    feed(command);
  } else if (command.type === "slider") {
    dial(command);
  } else if (command.type === "camera") {
    viewer.camera.position.set(...swap(command.eye));
    viewer.controls.target.set(...swap(command.target));
    viewer.controls.update();
    change({ view: null });
  }
}

function connect(notice) {
  viewer.connect();
  viewer.connection.onclose = () => {
    notice.hidden = false;
    setTimeout(() => connect(notice), 1000);
  };
  // A new program at this address may show another arm.
  viewer.connection.onopen = () => { if (!notice.hidden) location.reload(); };
}

if (data.live) {
  connect(added(document.body, "div", {
    id: "lost",
    role: "alert",
    hidden: true,
    textContent: "The program behind this page has ended. What you move here reaches it no more; the page connects again when it is back.",
  }));
  // The page may drive a real arm: send only positions within the limits, even if Python showed others.
  const inside = () => data.sliders.map((name) => {
    const { lower, upper } = joints.find((joint) => joint.name === name);
    return clamp(q[name], lower, upper);
  });
  // Send at most one message for each frame.
  let waiting = false;
  onPose((by) => {
    if (by === "hand") say("refused", "");
    if (waiting || !["hand", "motion", "travel"].includes(by)) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      if (viewer.connection.readyState !== WebSocket.OPEN) return;
      viewer.connection.send(JSON.stringify({ q: inside() }));
      if (by === "hand" && joints.some((joint) => limit(joint) !== undefined)) setPose(inside(), "page");
    });
  });
}
