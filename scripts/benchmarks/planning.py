"""Planned motions: how many are found, how long planning takes, and whether they hold.

Each motion leads from a random joint position to a random point. The arm is free of
collision at the first, and at some branch of the second with the wrist of the first.
Two scenes: the arm alone, and beside a vehicle's hull and a post.

The motions are judged by two other routes. Each is replayed from its samples, half of
them with drives whose limits bind. Of some, coal compares all pairs of bodies at every
0.1 degree of each joint line.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import coal
import numpy as np
import pinocchio as pin
from benchmarks.timing import Row

import alpha5_model as a5
from alpha5_model.collision.coal_scene import coal_shape
from pinocchio_collision import collision_geometry
from alpha5_model.planning import Obstacle, PlannedMotion
from alpha5_model.planning.planner import MARGIN
from alpha5_model.planning.surroundings import Surroundings

COUNT = 1000
#: Motions of each scene that coal follows, and its step [rad].
FOLLOWED = 10
STEP = math.radians(0.1)
#: Half edge of the cube that points are taken from: beyond the reach [m].
REACH = 0.5
#: Drives that slow many motions down [V, A].
DRIVES: dict[str, float] = {"supply_voltage": 10.0, "current_limit": 0.6}
#: A replay may be this share above a limit: rounding.
ROUNDING = 1e-9
#: A hull with the BlueROV2's length, width and height, and a post beside it [m].
VEHICLE = (
    Obstacle.box("hull", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14)),
    Obstacle.cylinder("post", 0.03, 1.0, (0.22, 0.15, 0.0)),
)
SCENES = {"the arm alone": (), "beside a vehicle": VEHICLE}


class Case(NamedTuple):
    """A start (4,) [rad], and a point that can be reached (3,) [m]."""

    q0: np.ndarray
    point: np.ndarray


class Attempt(NamedTuple):
    """A case, the motion or why there is none, and the time that planning took [s]."""

    case: Case
    motion: PlannedMotion | None
    reason: str
    seconds: float


def missing() -> list[str]:
    """Peers that are not installed: coal comes with Pinocchio."""
    return []


def rows() -> list[Row]:
    """Measured rows of this section."""
    found = []
    for number, (scene, obstacles) in enumerate(SCENES.items()):
        cases = list(_cases(obstacles, COUNT, seed=number))
        attempts = [_attempt(case, obstacles) for case in cases]
        found += _planning(scene, attempts)
        found += _proving(scene, attempts, obstacles)
        found += _judging(scene, attempts, obstacles)
    return found


def _cases(obstacles: Sequence[Obstacle], count: int, seed: int) -> Iterator[Case]:
    """Cases that can be solved at both ends."""
    surroundings = Surroundings(a5.parameters(), obstacles, MARGIN)
    limits = a5.load().limits
    rng = np.random.default_rng(seed)
    made = 0
    while made < count:
        q0 = rng.uniform(limits.lower, limits.upper)
        point = rng.uniform(-REACH, REACH, 3)
        solutions = a5.inverse_kinematics(point, q0[3])
        ends = solutions.q[solutions.within_limits]
        if surroundings.touches(q0[None])[0] or surroundings.touches(ends).all():
            continue
        yield Case(q0=q0, point=point)
        made += 1


def _attempt(case: Case, obstacles: Sequence[Obstacle], **drives: float) -> Attempt:
    motion = None
    reason = ""
    start = time.perf_counter()
    try:
        motion = a5.plan(case.q0, case.point, obstacles=obstacles, **drives)
    except a5.Alpha5Error as error:
        reason = str(error)
    seconds = time.perf_counter() - start
    return Attempt(case=case, motion=motion, reason=reason, seconds=seconds)


def _planning(scene: str, attempts: Sequence[Attempt]) -> list[Row]:
    """Share of the cases that are solved, and time; the first call builds the scene."""
    solved = [attempt.motion is not None for attempt in attempts]
    seconds = [attempt.seconds for attempt in attempts[1:]]
    of_found = [attempt.seconds for attempt in attempts[1:] if attempt.motion]
    reasons = "; ".join(attempt.reason for attempt in attempts if attempt.reason)
    share = float(np.mean(solved))
    work = f"plan, {scene}"
    times = {
        f"median of {COUNT}": float(np.median(seconds)),
        "slowest but one in 100": float(np.quantile(of_found, 0.99)),
        "slowest motion found": max(of_found),
        "slowest answer": max(seconds),
    }
    found = [
        Row(work=work, candidate=name, seconds=time, success=share)
        for name, time in times.items()
    ]
    found[0] = replace(found[0], setup=reasons)
    return found


def _proving(
    scene: str, attempts: Sequence[Attempt], obstacles: Sequence[Obstacle]
) -> list[Row]:
    """Time to prove the lines of a motion once more."""
    surroundings = Surroundings(a5.parameters(), obstacles, MARGIN)
    proved = []
    seconds = []
    for motion in _motions(attempts):
        start = time.perf_counter()
        blocked = [surroundings.obstruction(*line) for line in pairwise(motion.way)]
        seconds.append(time.perf_counter() - start)
        proved.append(blocked == [None] * len(blocked))
    share = float(np.mean(proved))
    work = f"proof of a motion, {scene}"
    times = {"median": float(np.median(seconds)), "longest": max(seconds)}
    return [
        Row(work=work, candidate=name, seconds=time, success=share)
        for name, time in times.items()
    ]


def _judging(
    scene: str, attempts: Sequence[Attempt], obstacles: Sequence[Obstacle]
) -> list[Row]:
    """Replays within all limits, and positions that coal finds free."""
    motions = _motions(attempts)
    with_drives = _motions(
        [_attempt(attempt.case, obstacles, **DRIVES) for attempt in attempts[::2]]
    )
    replays = [(motion, {}) for motion in motions[1::2]]
    replays += [(motion, DRIVES) for motion in with_drives]
    is_free = _coal(obstacles)
    positions = np.vstack([_positions(motion) for motion in motions[:FOLLOWED]])
    return [
        _shares(
            f"{len(replays)} replays, {scene}",
            "within all limits",
            lambda: [_within_limits(motion, drive) for motion, drive in replays],
        ),
        _shares(
            f"{len(positions)} positions, {scene}",
            "free by coal",
            lambda: [is_free(q) for q in positions],
        ),
    ]


def _shares(work: str, candidate: str, answers: Callable[[], list[bool]]) -> Row:
    start = time.perf_counter()
    found = answers()
    seconds = (time.perf_counter() - start) / len(found)
    return Row(
        work=work, candidate=candidate, seconds=seconds, success=float(np.mean(found))
    )


def _motions(attempts: Sequence[Attempt]) -> list[PlannedMotion]:
    return [attempt.motion for attempt in attempts if attempt.motion is not None]


def _within_limits(motion: PlannedMotion, drive: dict[str, float]) -> bool:
    """Positions, speeds, torques, currents and voltages of a replay from samples."""
    given = a5.trajectory.motion(motion.time, motion.position, motion.velocity)
    replay = a5.trajectory.analyse(given, method="interpolate", **drive)
    joints = a5.parameters().joints[:4]
    pairs = [
        (replay.smooth.position, [joint.upper for joint in joints]),
        (-replay.smooth.position, [-joint.lower for joint in joints]),
        (np.abs(replay.smooth.velocity), [joint.velocity for joint in joints]),
        (np.abs(replay.torque), [joint.effort for joint in joints]),
    ]
    if drive:
        pairs += [
            (np.abs(replay.current_upper), drive["current_limit"]),
            (np.abs(replay.current_lower), drive["current_limit"]),
            (np.abs(replay.voltage), drive["supply_voltage"]),
        ]
    return all(
        (found <= np.multiply(most, 1 + ROUNDING)).all() for found, most in pairs
    )


def _positions(motion: PlannedMotion) -> np.ndarray:
    """Places on the lines of a motion, at most `STEP` apart, (N, 4) [rad]."""
    lines = []
    for start, end in pairwise(motion.way):
        count = math.ceil(np.abs(end - start).max() / STEP) + 1
        share = np.linspace(0.0, 1.0, count)[:, None]
        lines.append(start + share * (end - start))
    return np.vstack(lines)


def _coal(obstacles: Sequence[Obstacle]) -> Callable[[np.ndarray], bool]:
    """Whether coal finds a joint position free: all pairs, each a fresh request."""
    model = a5.load().model
    data = model.createData()
    geometry = collision_geometry(model)
    arm = range(geometry.ngeoms)
    for obstacle in obstacles:
        number = geometry.addGeometryObject(_body(obstacle))
        for link in arm:
            if geometry.geometryObjects[link].parentJoint > 0:
                geometry.addCollisionPair(pin.CollisionPair(link, number))
    objects = geometry.createData()

    def is_free(q: np.ndarray) -> bool:
        fresh = [coal.CollisionRequest() for _ in objects.collisionRequests]
        objects.collisionRequests[:] = fresh
        touches: Any = pin.computeCollisions(model, data, geometry, objects, q, True)
        return not touches

    return is_free


def _body(obstacle: Obstacle) -> pin.GeometryObject:
    shape = obstacle.shape
    rotation = pin.rpy.rpyToMatrix(np.array(shape.rpy))
    placement = pin.SE3(rotation, np.array(shape.xyz))
    return pin.GeometryObject(obstacle.name, 0, 0, placement, coal_shape(shape))
