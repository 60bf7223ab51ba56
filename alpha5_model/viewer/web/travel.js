// Travel: to a solution, a typed target or a named pose the arm moves as fast as its joints are rated, not at once.
//
// It follows straight joint lines by S-curves, as alpha5_model.planning does [Biagiotti2008, section 3.4]. If it would
// touch itself on the straight line, it retracts, turns and extends. Lines are looked at every LOOK rad; only Python's
// plan proves them.
const LOOK = 0.02;
const LONGEST_FRAME = 0.1; // s; while the browser stalls the arm waits, so that it never jumps
const NOTICE = 1.5; // s from the announcement of a detour to its start
const FAR = 0.35; // rad; where a drag would turn a joint by more at once, the arm follows as fast as it can
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const present = () => data.sliders.map((name) => q[name]);

// ---- what moves the arm from frame to frame: a function of the seconds since the last one, true as long as it goes on
let moving = null;
function keepMoving(step) {
  const own = moving = step;
  let last = performance.now();
  const frame = (clock) => {
    if (moving !== own) return;
    const seconds = Math.min(Math.max(clock - last, 0) / 1e3, LONGEST_FRAME);
    last = clock;
    if (step(seconds)) requestAnimationFrame(frame);
    else stay();
  };
  requestAnimationFrame(frame);
}
function stay() {
  moving = null;
  showPanelNow();
  showSolutions();
  keepInSight();
}
onPose((by) => {
  if (by === "travel" || by === "page") return;
  if (moving || by === "hand") tell("");
  moving = null;
});
const tell = (text) => { byId("travel").textContent = text; };

// ---- travel to joint positions
function travelTo(goal, name) {
  if (isBlocked(goal)) {
    place("page");
    return;
  }
  const way = calm.matches ? null : wayTo(present(), goal);
  if (way === null) {
    setPose(goal);
    keepInSight();
    tell(calm.matches ? "" : `${name}: shown at once, as no way was found on which the arm does not touch itself.`);
    return;
  }
  const lines = way.slice(1).map((end, i) => lineBetween(way[i], end));
  const duration = durationOf(lines);
  const reason = detour(way);
  tell(`${name}: ${fixed(duration, 1)} s${reason}.`);
  let time = reason ? -NOTICE : 0;
  keepMoving((seconds) => {
    time += seconds;
    setPose(time < duration ? placeOn(lines, Math.max(time, 0)) : goal, "travel");
    return time < duration;
  });
}
// Why the arm does not go the short way, or "".
function detour(way) {
  if (way.length > 2) return ", by retracting, as the arm would touch itself on the straight way";
  const turn = Math.abs(way[1][0] - way[0][0]);
  return turn > Math.PI ? `, as ${data.sliders[0]} cannot pass its stop and turns ${fixed(turn * 180 / Math.PI, 0)}\u00b0` : "";
}

// The quickest way on which the arm does not touch itself; null if there is none. One that begins or ends in a
// collision is straight.
function wayTo(from, goal) {
  const straight = [from, goal];
  if (touchesAt(from) || touchesAt(goal) || isFreeLine(from, goal)) return straight;
  const retracted = (at, [b, c]) => at.map((value, i) => i === 1 ? b : i === 2 ? c : value);
  const ways = data.travel.retracted.map((pose) => [from, retracted(from, pose), retracted(goal, pose), goal]);
  const time = (way) => durationOf(way.slice(1).map((end, i) => lineBetween(way[i], end)));
  const quickest = ways.map((way) => [time(way), way]).sort((one, other) => one[0] - other[0]);
  const found = quickest.find(([, way]) => way.slice(1).every((end, i) => isFreeLine(way[i], end)));
  return found ? found[1] : null;
}
const touchesAt = (values) => touching(forwardKinematics(named(values))).length > 0;
function isFreeLine(from, to) {
  const count = Math.ceil(Math.max(...from.map((value, i) => Math.abs(to[i] - value))) / LOOK);
  for (let i = 1; i <= count; i++) if (touchesAt(onLine(from, to, i / count))) return false;
  return true;
}
const onLine = (from, to, share) => from.map((value, i) => value + share * (to[i] - value));

// ---- lines in time
function lineBetween(from, to) {
  const lengths = from.map((value, i) => Math.abs(to[i] - value));
  const least = (bounds) => Math.min(...bounds.map((bound, i) => lengths[i] > 0 ? bound / lengths[i] : Infinity));
  const [speed, acceleration] = [least(data.travel.speed), least(data.travel.acceleration)];
  return { from, to, curve: Number.isFinite(speed) ? sCurve(speed, acceleration, acceleration / data.travel.ramp) : null };
}
// The fastest S-curve of a parameter from 0 to 1 within these bounds, at rest at both ends.
function sCurve(speed, acceleration, jerk) {
  const ramp = Math.min(acceleration / jerk, Math.sqrt(speed / jerk));
  const rise = ramp + speed / (jerk * ramp);
  if (1 / speed >= rise) return { jerk, ramp, rise, duration: rise + 1 / speed };
  const short = Math.min(acceleration / jerk, Math.cbrt(0.5 / jerk));
  const half = (short + Math.sqrt(short * short + 4 / (jerk * short))) / 2;
  return { jerk, ramp: short, rise: half, duration: 2 * half };
}
const durationOf = (lines) => lines.reduce((sum, { curve }) => sum + (curve ? curve.duration : 0), 0);
function placeOn(lines, time) {
  let since = time;
  for (const { from, to, curve } of lines) {
    if (curve && since < curve.duration) return onLine(from, to, parameter(curve, since));
    since -= curve ? curve.duration : 0;
  }
  return lines[lines.length - 1].to;
}
// The second half is the first one, backwards. Jerk sets in, ends, sets in backwards and ends.
function parameter({ jerk, ramp, rise, duration }, time) {
  if (time > duration / 2) return 1 - parameter({ jerk, ramp, rise, duration }, duration - time);
  const cubic = (begin) => Math.max(time - begin, 0) ** 3 * jerk / 6;
  return cubic(0) - cubic(ramp) - cubic(rise - ramp) + cubic(rise);
}

// ---- follow a hand: at once, or as fast as the joints are rated if the arm would jump
let wanted = null; // where the hand wants the arm
function moveWithHand(goal) {
  const jump = Math.max(...goal.map((value, i) => Math.abs(value - present()[i])));
  if (calm.matches || (!chasing() && jump < FAR)) {
    setPose(goal);
    return;
  }
  wanted = goal;
  if (chasing()) return;
  tell("The arm follows as fast as it can.");
  keepMoving(chase);
}
const chasing = () => moving === chase;
function chase(seconds) {
  const next = present().map((value, i) => {
    const most = seconds * data.travel.speed[i];
    return value + clamp(wanted[i] - value, -most, most);
  });
  if (isBlocked(next)) return false;
  setPose(next, "travel");
  const goesOn = next.some((value, i) => value !== wanted[i]);
  if (!goesOn) tell("");
  return goesOn;
}
