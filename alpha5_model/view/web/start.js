// All is there: place the arm, and hand out what a script may use.
place("page");
if (shown["see-through"]) setGroup("see-through", true);
globalThis.alpha5 = { viewer, data, q, holding, setJoint, setPose, onPose, setGroup, seek, play, pause, poses: () => poses };
document.documentElement.dataset.ready = "true";
