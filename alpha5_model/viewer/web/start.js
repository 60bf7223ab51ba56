// Everything is loaded: draw the scene, frame it, and export what scripts may use.
import { data } from "./data.js";
import { reach } from "./kinematics.js";
import { torques } from "./statics.js";
import { touching } from "./collision.js";
import { change, onChange, state } from "./state.js";
import { narrow } from "./page.js";
import { viewer } from "./scene.js";
import { free, look } from "./camera.js";
import { travelTo } from "./travel.js";
import { follow, ghosts } from "./target.js";
import { fold } from "./panel.js";
import { pause, play, seek, unfold } from "./motion.js";
import { picture } from "./labels.js";
import { linkText, openLink } from "./live.js";

change({}, "page");
fold(narrow.matches && document.documentElement.dataset.drawn !== "false");
unfold(window.innerHeight > (narrow.matches ? 600 : 720));
look("home", false);
openLink();
globalThis.alpha5 = {
  data, state, change, onChange, viewer, look, free, seek, play, pause, travelTo, follow, ghosts, picture, linkText,
  torques: () => torques(state, state.shown.current),
  reach: (point, branch) => reach(point, branch, state.q),
  touching: () => touching(state.poses),
};
document.documentElement.dataset.ready = "true";
