"""`plan`: from a joint position to a target, proved free and replayed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    bounded,
    flag,
    float_array,
    frozen,
    listed,
    real,
)
from alpha5_model._support.spatial import angles_between
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.load import load
from alpha5_model.errors import (
    Alpha5Error,
    BlockedMotionError,
    InputError,
    MotionLimitError,
    UnreachableError,
)
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import (
    DEFAULT_ACCELERATION,
    Alpha5Parameters,
    chosen_arm,
)
from alpha5_model.planning.blending import blended
from alpha5_model.planning.goals import (
    POINT,
    POSE,
    Goal,
    Target,
    goals,
    joint_position,
    other_wrists,
    target_of,
)
from alpha5_model.planning.obstacles import Obstacle, checked_obstacles
from alpha5_model.planning.planned_motion import PlannedMotion, Stop
from alpha5_model.planning.replay import peaks, replayed, worst
from alpha5_model.planning.retracted import retracted_poses
from alpha5_model.planning.routes import TCP_LINE, Route, Search
from alpha5_model.planning.s_curve import JointLimits, Samples, sampled, travel_time
from alpha5_model.planning.surroundings import Obstruction, Surroundings
from alpha5_model.planning.tcp_line import TcpLine, check_free, tcp_line

#: Kept to obstacles [m].
MARGIN = 0.005
#: A motion beyond a limit is tried again in so many times its time: up to tenfold.
_TIMES = 1.1 ** np.arange(25)
#: Fewer than twice this many wrist angles are tried for a point.
_TRIED_WRISTS = 9
#: Slower joints take days for a degree [rad/s, rad/s^2].
_LEAST = 1e-8
#: Fewest samples per second [Hz].
_LEAST_RATE = 0.1
#: Name of the argument with the last target.
_TARGET = "target"
#: Longer motions are refused [s].
_LONGEST = 86_400.0


class _Timing(NamedTuple):
    """When an arm is where on its route.

    Attributes:
        samples: The motion in so many times the least time.
        shares: The part of that motion's time at which it is at each end of a line.
        away: How far it passes each end, (K,) [m].
    """

    samples: Callable[[float], Samples]
    shares: Callable[[float], FloatArray]
    away: FloatArray


class _Drive(NamedTuple):
    """What `alpha5_model.trajectory.analyse` is told of the motors."""

    supply_voltage: float | None
    current_limit: float | None


def plan(
    q0: ArrayLike,
    target: Any,
    *,
    through: Iterable[Any] = (),
    arm: Alpha5Parameters | Arm | None = None,
    obstacles: Iterable[Obstacle] = (),
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = DEFAULT_ACCELERATION,
    margin: float = MARGIN,
    self_margin: float = 0.0,
    blend: float = 0.0,
    wrist: float | None = None,
    line: bool = False,
    supply_voltage: float | None = None,
    current_limit: float | None = None,
    rate: float | None = None,
) -> PlannedMotion:
    """A motion from a joint position to a target, free of collision, within limits.

    It may lead through other targets, and rests at each unless ``blend`` is above 0.

    The path is a straight joint line to the branch that is reached first. If that line
    is not free, the path leads to another branch, or by retracted poses, with the hand
    near the yaw axis. Each line is proved free between its ends, not sampled
    (`alpha5_model.planning.surroundings`). Joints move by S-curves and rest where two
    lines meet, or pass the corner (`alpha5_model.planning.blending`). The motion is
    replayed through `alpha5_model.trajectory.analyse`; if a torque, a current or a
    voltage is beyond its limit, the motion is slowed down.

    Through several targets, each is reached from the one before by itself: the branch
    that is quickest to a target may be one from which the next target is not reached.

    This is no general planner: there may be a path although none is found. Attached
    bodies, and what the jaws hold, are not compared with obstacles.

    Args:
        q0: Where the arm is, (4,) [rad].
        target: Of the tcp, a point in base_link (3,) [m] or a pose (4, 4), also a
            ``pinocchio.SE3``, that is reached as `alpha5_model.inverse_kinematics_pose`
            says; or joint positions, (4,) [rad].
        through: Targets of these kinds on the way, in their order. A file of them is
            read by `alpha5_model.planning.read_waypoints`.
        arm: Record of the arm, None for the catalogue's, in sea water. Or an `Arm` on a
            fixed base with closed jaws, in another fluid or with a payload.
        obstacles: That the arm must not touch. What is fixed to link_0 may be touched
            by it.
        speed: Of the joints at most, one number or (4,) [rad/s]; none is faster than
            its rated speed, and None is that.
        acceleration: Of the joints at most, one number or (4,) [rad/s^2]. None is
            published.
        margin: Distance that is kept to obstacles [m]. A line past a mesh is proved
            free if it keeps 0.1 mm more.
        self_margin: Distance that the links keep to each other [m]; those next to each
            other are not compared.
        blend: How far the tcp, and any point of a link, may be from where it is at a
            corner of the path when the arm passes it [m]. The arm then need not stop
            there. It passes nearer, or rests, if bounds of the joints or something in
            the way leave no other choice. The last target is reached.
        wrist: theta_3 at the point, or at each of several [rad]; None for that before
            it, or another one if that is not free. Only for points.
        line: Move the tcp along a straight line, in the least time that speeds and
            accelerations allow. The branch changes on the yaw axis only. Only to a
            point, without ``through``; it needs toppra. theta_3 stays, or changes
            evenly to ``wrist``.
        supply_voltage: Of the motors [V]; None for that of the arm's record.
        current_limit: Of the motors' drives [A]; None for those of the arm's record.
        rate: Samples per second [Hz]. The motion is made longer by less than one step,
            so that it ends with a sample. None for 50, or fewer if it takes long.

    Returns:
        The motion, at rest at both ends, with its replay.

    Raises:
        InputError: Arguments that are not as described.
        JointLimitError: ``q0`` or the target is beyond a joint's limit.
        UnreachableError: No joint position within the limits reaches the target.
        BlockedMotionError: No way without collision was found; it names what collides.
        DiscontinuousPathError: On the straight line a joint would have to jump.
        MotionLimitError: A joint is beyond a limit at any speed.
    """
    loaded = loaded_arm(arm)
    record = loaded.parameters
    limits = _limits(record, speed, acceleration)
    start = joint_position("q0", q0, record)
    targets = [
        target_of(f"through[{number}]", given)
        for number, given in enumerate(listed("through", through, "a list of targets"))
    ]
    targets.append(target_of(_TARGET, target))
    distance = real("blend", blend, minimum=0.0)
    plausibility.check("blend", distance, plausibility.POSITION)
    _check_kinds(targets, wrist, flag("line", line), distance)

    if rate is not None:
        rate = real("rate", rate, minimum=_LEAST_RATE)
    surroundings = Surroundings(
        record,
        checked_obstacles(obstacles),
        real("margin", margin, minimum=0.0),
        real("self_margin", self_margin, minimum=0.0),
    )
    _check_start(surroundings, start)
    drive = _Drive(supply_voltage, current_limit)
    if line:
        point = targets[0].value
        route, along = _line(surroundings, start, point, wrist, loaded)
        _check_rated(route, record, limits)
        timing = _along_line(along, limits, rate)
    else:
        route = _through(surroundings, start, targets, wrist, record, limits)
        _check_rated(route, record, limits)
        timing = _at_rest(route.way, limits, rate)
        if distance > 0.0:
            timing = _passing(route.way, limits, distance, loaded, surroundings, rate)
    return _timed(route, targets, timing, loaded, drive, surroundings)


def _check_kinds(
    targets: list[Target], wrist: float | None, line: bool, blend: float
) -> None:
    """Refuse options that only points have, or no straight line.

    Raises:
        InputError: A wrist angle without a point; a line that leads to none, or to
            several, or with corners.
    """
    if line and blend > 0.0:
        raise InputError("blend", blend, "0 with a straight line, which has no corners")
    if wrist is not None and all(target.kind != POINT for target in targets):
        raise InputError("wrist", wrist, "no value: only a point leaves it open")
    if line and len(targets) > 1:
        expected = "no targets on the way of a straight line: plan one for each"
        raise InputError("through", f"{len(targets) - 1} of them", expected)
    if line and targets[0].kind != POINT:
        expected = "a point (3,) [m]: a straight line leads to one"
        raise InputError("target", targets[0].value.tolist(), expected)


def loaded_arm(arm: Alpha5Parameters | Arm | None) -> Arm:
    """The arm that a caller means.

    Raises:
        InputError: Neither a record nor an `Arm` with four joints on a fixed base, in
            still water.
    """
    if not isinstance(arm, Arm):
        return _in_sea_water(chosen_arm(arm))
    if arm.floating_base or arm.model.nv != 4 or arm.has_hydrodynamics:
        found = f"{type(arm).__name__} with nv = {arm.model.nv}"
        expected = "one with closed jaws on a fixed base, in still water"
        raise InputError("arm", found, expected)
    return arm


@lru_cache(maxsize=16)
def _in_sea_water(record: Alpha5Parameters) -> Arm:
    return load(arm=record)


def _limits(
    record: Alpha5Parameters, speed: ArrayLike | None, acceleration: ArrayLike
) -> JointLimits:
    """The bounds of the joints' motion.

    Raises:
        InputError: Neither one number nor four, or one that is not above 0.
    """
    rated = np.array([joint.velocity for joint in record.joints[:4]])
    fastest = rated
    if speed is not None:
        fastest = np.minimum(rated, _per_joint("speed", speed))
    return JointLimits(
        speed=fastest, acceleration=_per_joint("acceleration", acceleration)
    )


def _per_joint(name: str, given: ArrayLike) -> FloatArray:
    values = bounded(name, float_array(name, given, ()))
    if values.shape not in ((), (4,)) or not (values > 0.0).all():
        raise InputError(name, values.tolist(), "one number above 0, or four")
    if (values < _LEAST).any():
        expected = f"at least {_LEAST:g}, else a degree takes days"
        raise InputError(name, values.tolist(), expected)
    return np.broadcast_to(values, (4,))


def _check_start(surroundings: Surroundings, start: FloatArray) -> None:
    """Refuse a start that is not free.

    Raises:
        BlockedMotionError: It is not.
    """
    contact = surroundings.contact(start)
    if contact is not None:
        problem = "q0 is not free"
        raise _blocked_by(contact, problem)


def _line(
    surroundings: Surroundings,
    start: FloatArray,
    target: FloatArray,
    wrist: float | None,
    arm: Arm,
) -> tuple[Route, TcpLine]:
    """The straight line of the tcp.

    Raises:
        BlockedMotionError: It is not free.
    """
    angle = float(start[3]) if wrist is None else real("wrist", wrist)
    line = tcp_line(start, target, angle, arm)
    check_free(line, surroundings)
    end = line.way[-1]
    wanted = Target(kind=POINT, value=target, place=_TARGET)
    reached = goals(wanted, start, angle, arm.parameters)
    goal = min(reached, key=lambda goal: float(np.abs(goal.q - end).max()))
    ends = np.array([start, end])
    route = Route(way=ends, kind=TCP_LINE, branch=goal.branch, ends=(1,))
    return route, line


def _along_line(line: TcpLine, limits: JointLimits, rate: float | None) -> _Timing:
    return _Timing(
        samples=lambda slowed: line.sampled(limits.slower(slowed), rate),
        shares=lambda slowed: np.array([0.0, 1.0]),
        away=np.zeros(2),
    )


def _at_rest(way: FloatArray, limits: JointLimits, rate: float | None) -> _Timing:
    """Straight joint lines, at rest where two meet."""

    def shares(slowed: float) -> FloatArray:
        slower = limits.slower(slowed)
        lines = [travel_time(np.array(line), slower) for line in pairwise(way)]
        until = np.append(0.0, np.cumsum(lines))
        return until / until[-1] if until[-1] else np.ones(len(until))

    return _Timing(
        samples=lambda slowed: sampled(way, limits.slower(slowed), rate),
        shares=shares,
        away=np.zeros(len(way)),
    )


def _passing(
    way: FloatArray,
    limits: JointLimits,
    blend: float,
    arm: Arm,
    surroundings: Surroundings,
    rate: float | None,
) -> _Timing:
    """Straight joint lines whose corners are passed without a stop."""
    moves = np.append(True, (np.diff(way, axis=0) != 0.0).any(axis=1))
    if moves.sum() == 1:
        return _at_rest(way, limits, rate)
    lines = blended(way[moves], limits, blend, arm, surroundings, rate)
    # An end that stands twice in the way is passed once.
    row = np.cumsum(moves) - 1
    shares = (lines.passes / lines.passes[-1])[row]
    return _Timing(
        samples=lambda slowed: lines.sampled(slowed, rate),
        shares=lambda slowed: shares,
        away=lines.away[row],
    )


def _through(
    surroundings: Surroundings,
    start: FloatArray,
    targets: list[Target],
    wrist: float | None,
    arm: Alpha5Parameters,
    limits: JointLimits,
) -> Route:
    """A way through targets, one after the other.

    Raises:
        Alpha5Error: One cannot be reached; if there are several, or they come from a
            file, it names which.
    """
    way = [start]
    kinds = []
    branch = None
    ends = []
    for target in targets:
        angle = wrist if target.kind == POINT else None
        try:
            part = _route(surroundings, way[-1], target, angle, arm, limits)
        except Alpha5Error as error:
            if len(targets) > 1 or target.place != _TARGET:
                error.args = (f"{target.place}: {error}",)
            raise
        way += [*part.way[1:]]
        kinds.append(part.kind)
        branch = part.branch
        ends.append(len(way) - 1)
    kind = ", ".join(dict.fromkeys(kinds))
    return Route(way=np.array(way), kind=kind, branch=branch, ends=tuple(ends))


def _route(
    surroundings: Surroundings,
    start: FloatArray,
    target: Target,
    wrist: float | None,
    arm: Alpha5Parameters,
    limits: JointLimits,
) -> Route:
    """A way that is proved free.

    Raises:
        BlockedMotionError: None was found.
    """
    wrist_is_open = target.kind == POINT and wrist is None
    others: list[list[Goal]] | None = None
    choices: list[list[Goal]] = []
    try:
        choices.append(goals(target, start, wrist, arm))
    except UnreachableError:
        # A tool beside the wrist axis may reach it at another wrist angle.
        others = other_wrists(target, start, arm) if wrist_is_open else []
        if not others:
            raise

    search = Search(surroundings, start, limits)
    route = _way_to_one(surroundings, search, choices, arm)
    if route is None and wrist_is_open:
        choices += other_wrists(target, start, arm) if others is None else others
        route = _way_to_one(surroundings, search, choices, arm)
    if route is None:
        raise _blocked(surroundings, search, start, choices[0])
    return route


def _way_to_one(
    surroundings: Surroundings,
    search: Search,
    choices: list[list[Goal]],
    arm: Alpha5Parameters,
) -> Route | None:
    """A way to a goal of the first choice that has one, None if there is none."""
    free = [_free(surroundings, choice) for choice in choices]
    free = [choice for choice in free if choice]
    # Most tools reach a point at all wrist angles: a few will do.
    for choice in free[:: max(1, len(free) // _TRIED_WRISTS)]:
        route = search.straight(choice)
        if route is None:
            route = search.by_retracted(choice, retracted_poses(arm))
        if route is not None:
            return route
    return None


def _free(surroundings: Surroundings, choice: list[Goal]) -> list[Goal]:
    """The goals that touch nothing."""
    touching = surroundings.touches(np.array([goal.q for goal in choice]))
    return [goal for goal, hit in zip(choice, touching, strict=True) if not hit]


def _blocked(
    surroundings: Surroundings, search: Search, start: FloatArray, choice: list[Goal]
) -> BlockedMotionError:
    """Why no way was found."""
    found = search.obstruction
    problem = "no free way was found; on the straight line"
    if found is None:
        nearest = min(choice, key=lambda goal: float(np.abs(goal.q - start).max()))
        found = surroundings.contact(nearest.q)
        problem = "the target is not free"
    assert found is not None
    return _blocked_by(found, problem)


def _blocked_by(found: Obstruction, problem: str) -> BlockedMotionError:
    return BlockedMotionError(
        problem, found.names, found.q, found.distance, found.needed
    )


def _check_rated(route: Route, arm: Alpha5Parameters, limits: JointLimits) -> None:
    """Refuse a way on which a joint must move whose rated speed is 0.

    Raises:
        InputError: Such a way.
    """
    moves = np.ptp(route.way, axis=0).astype(bool)
    for number in np.flatnonzero(moves & (limits.speed == 0.0)):
        name = f"{arm.joints[number].name}.velocity"
        raise InputError(name, 0.0, "a speed above 0: the joint must move")


def _timed(
    route: Route,
    targets: list[Target],
    timing: _Timing,
    arm: Arm,
    drive: _Drive,
    surroundings: Surroundings,
) -> PlannedMotion:
    """The route in time, slowed down until no limit is exceeded.

    Args:
        route: The way.
        targets: That it leads through.
        timing: Its motion.
        arm: Whose motors are asked.
        drive: Of its motors.
        surroundings: In which the way is free.

    Raises:
        InputError: The motion would take more than a day.
        MotionLimitError: A limit is exceeded at any speed.
    """
    for slowed in _TIMES.tolist():
        samples = timing.samples(slowed)
        duration = float(np.ptp(samples.time))
        if not duration <= _LONGEST:
            expected = f"ones with which the motion takes at most {_LONGEST:g} s"
            raise InputError("speed, acceleration", f"{duration:g} s", expected)
        analysis = replayed(samples, arm, *drive)
        found = list(peaks(analysis))
        beyond = worst(found)
        if beyond is None:
            break
    else:
        assert beyond is not None
        raise MotionLimitError(
            beyond.joint, beyond.quantity, beyond.value, beyond.limit, beyond.unit
        )
    return PlannedMotion(
        time=frozen(samples.time),
        position=frozen(samples.position),
        velocity=frozen(samples.velocity),
        acceleration=frozen(samples.acceleration),
        way=frozen(route.way),
        kind=route.kind,
        branch=route.branch,
        stops=tuple(_stops(route, targets, timing, slowed, duration, arm)),
        slowed=slowed,
        peaks=tuple(found),
        analysis=analysis,
        _surroundings=surroundings,
    )


def _stops(
    route: Route,
    targets: list[Target],
    timing: _Timing,
    slowed: float,
    duration: float,
    arm: Arm,
) -> Iterator[Stop]:
    """Where and when a motion along a route is at its targets.

    Args:
        route: The way.
        targets: That it leads through.
        timing: Of the motion.
        slowed: In how many times the least time.
        duration: Of the motion, which a wanted rate makes a little longer [s].
        arm: For the orientation of the tcp.
    """
    shares = timing.shares(slowed)
    for target, end in zip(targets, route.ends, strict=True):
        q = route.way[end]
        error = 0.0
        if target.kind == POSE:
            reached = arm.forward_kinematics(q).homogeneous
            error = float(angles_between(reached, target.value))
        yield Stop(
            place=target.place,
            time=float(shares[end]) * duration,
            q=frozen(q),
            away=float(timing.away[end]),
            rotation_error=error,
        )
