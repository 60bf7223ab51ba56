// All that a person can change on the page, in one place: what a link has to restore. Angles in rad, all else in SI units.
//
// Files that change an entry call change({ entry: value }), and onChange(watcher) calls watcher(part) after that. Three
// entries have ways of their own: setPose and setJoint for q, setAim for aim, setGroup for shown.
const state = {
  q: { ...data.q }, // of each joint with a slider
  aim: data.target, // target of the tcp in base_link, or null
  density: data.water.density, // of the fluid
  current: data.water.current, // velocity of the water, in base_link if the base is fixed
  payload: { ...data.payload }, // mass, com and volume of what the arm holds, in tcp
  attitude: data.attitude, // roll and pitch of a fixed base in the world, in which gravity points down
  limits: data.sliders.slice(0, 4).map(() => null), // torques that the joints may hold, or null
  shown: {}, // group of the scene -> whether it is shown
  view: "home", // the view that is kept when the window changes; null after the user has turned it
  degrees: true, // whether angles are in degrees
  guard: false, // whether a hand stops before the arm touches itself
};
const watchers = [];
const onChange = (watcher) => watchers.push(watcher);
function change(part) {
  Object.assign(state, part);
  for (const watcher of watchers) watcher(part);
}
