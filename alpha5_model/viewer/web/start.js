// Everything is loaded: place the arm, frame it, and export what scripts may use.
backdrop();
place("page");
showWater();
showPayload();
showMount();
for (const name in shown) setGroup(name, shown[name]);
fold(narrow.matches);
unfold(narrow.matches || window.innerHeight > 720);
look("home", false);
openLink();
globalThis.alpha5 = {
  state, change, onChange, viewer, data, q, holding, torques, setJoint, setPose, onPose, setGroup, seek, play, pause,
  poses: () => poses,
  look, free, reach, touching: () => touching(poses), follow, setAim, travelTo, aim: () => state.aim, ghosts, picture, record, linkText,
};
document.documentElement.dataset.ready = "true";
