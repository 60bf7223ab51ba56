"""A straight line of the tcp: continuous, proved free, in the least time.

The line is followed by inverse kinematics, in steps of `STEP` that are halved until the
tcp stays within `STRAIGHT` of it. A cubic spline of the joint positions leads from one
to the next. Between two of them it is at most ``max |q''| h^2 / 8`` from their straight
joint line, and q'' is largest at one of them. So the spline is free if the joint lines
are free with that much more room.

References:
    [Pham2018] Pham, Pham: A new approach to time-optimal path parameterization based
        on reachability analysis, IEEE Transactions on Robotics 34 (3), 2018.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import (
    BlockedMotionError,
    DiscontinuousPathError,
    SelfCollisionError,
    UnreachableError,
    needing,
)
from alpha5_model.kinematics.path import inverse_kinematics_path
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.s_curve import JointLimits, Samples, Times, sampled
from alpha5_model.planning.surroundings import Surroundings

#: How far the tcp may be from the line, promised by `alpha5_model.plan` [m].
STRAIGHT = 1e-5
#: Between two joint positions of the spline [m], and how often it may be halved.
STEP = 1e-3
_HALVINGS = 6
#: The tcp is farthest from the line near the middle between two joint positions: there
#: it may be this share of `STRAIGHT` away.
_AT_MIDDLES = 0.9
#: Fewest steps of a line.
_FEWEST = 20
#: TOPP-RA keeps bounds at places along the path, and is given this share of them:
#: between two of these places a speed was larger by up to 1e-3 of its bound.
BELOW = 0.998
#: A line is at rest if no joint moves by more [rad].
_AT_REST = 1e-12


class TcpLine:
    """A straight line of the tcp.

    Attributes:
        way: Joint positions along it, (K, 4) [rad].
    """

    def __init__(self, way: FloatArray) -> None:
        with needing("a straight line of the tcp", "pip install alpha5-model[line]"):
            from toppra import SplineInterpolator

        self.way = way
        self._share = np.linspace(0.0, 1.0, len(way))
        self._path: Any = SplineInterpolator(self._share, way)

    @property
    def deviation(self) -> FloatArray:
        """How far the spline is from the straight joint lines at most, (4,) [rad]."""
        step = self._share[1]
        bend = np.abs(self._path(self._share, 2)).max(axis=0)
        return np.asarray(bend * step**2 / 8)

    def at_middles(self) -> FloatArray:
        """The spline in the middle between two joint positions, (K - 1, 4) [rad]."""
        middles = (self._share[1:] + self._share[:-1]) / 2
        return np.asarray(self._path(middles))

    def sampled(self, limits: JointLimits, rate: float | None = None) -> Samples:
        """The fastest motion along the line, from rest to rest.

        Args:
            limits: Of the joints. One whose speed is 0 must not move.
            rate: Samples per second; None for 50, or fewer if the motion takes long.
        """
        if np.abs(self.way - self.way[0]).max() < _AT_REST:
            return sampled(self.way[[0, 0]], limits, rate)

        from toppra import algorithm, constraint

        # toppra takes no bound of 0, not even for a joint that stays.
        speed = np.where(limits.speed > 0.0, limits.speed, limits.speed.max())
        bounds = [
            constraint.JointVelocityConstraint(_both_ways(BELOW * speed)),
            constraint.JointAccelerationConstraint(
                _both_ways(BELOW * limits.acceleration)
            ),
        ]
        with _quiet():
            fastest = algorithm.TOPPRA(
                bounds,
                self._path,
                gridpoints=self._share,
                parametrizer="ParametrizeConstAccel",
            )
            motion = fastest.compute_trajectory(0.0, 0.0)
        assert motion is not None
        times = Times.of(float(motion.duration), rate)
        position = np.asarray(motion(times.at))
        velocity = np.asarray(motion(times.at, 1))
        position[[0, -1]] = self.way[[0, -1]]
        velocity[[0, -1]] = 0.0
        return times.samples(position, velocity, np.asarray(motion(times.at, 2)))


def tcp_line(start: FloatArray, target: FloatArray, wrist: float, arm: Arm) -> TcpLine:
    """The straight line from where the tcp is to a target.

    Args:
        start: Joint position, (4,) [rad].
        target: (3,) [m].
        wrist: theta_3 at the target; it changes evenly along the line [rad].
        arm: With closed jaws, on a fixed base.

    Raises:
        UnreachableError: A point of the line is out of reach.
        DiscontinuousPathError: A joint would have to jump: to another branch, or across
            the gap of axis_e.
        MissingDependencyError: toppra is not installed.
    """
    tcp = arm.forward_kinematics(start).translation
    length = float(np.linalg.norm(target - tcp))
    count = max(_FEWEST, math.ceil(length / STEP))
    for _ in range(_HALVINGS + 1):
        points = np.linspace(tcp, target, count + 1)
        wrists = np.linspace(start[3], wrist, count + 1)
        way = _joint_positions(points, start, wrists, arm.parameters)
        way[0] = start
        line = TcpLine(way)
        away = _distance_from_line(line, points, arm)
        if away.max() <= _AT_MIDDLES * STRAIGHT:
            return line
        count *= 2
    # Shorter steps do not help: the arm jumps to another branch.
    worst = int(away.argmax())
    step = float(np.abs(way[worst + 1] - way[worst]).max())
    straight = step * STRAIGHT / float(away[worst])
    raise DiscontinuousPathError(None, points[worst], step, straight)


def _joint_positions(
    points: FloatArray,
    start: FloatArray,
    wrists: FloatArray,
    arm: Alpha5Parameters,
    allow_collision: bool = False,
) -> FloatArray:
    """Joint positions along points (N, 3) of a line, (N, 4) [rad].

    Errors are those of `inverse_kinematics_path`, without the numbers of points that
    the caller did not give. What the arm touches is left to `check_free`.
    """
    try:
        return inverse_kinematics_path(
            points, start, wrists, allow_collision=allow_collision, arm=arm
        )
    except SelfCollisionError:
        return _joint_positions(points, start, wrists, arm, allow_collision=True)
    except UnreachableError as error:
        why = ", though it is on the straight line of the tcp"
        raise UnreachableError(
            error.position, error.distance, error.nearest, why
        ) from None
    except DiscontinuousPathError as error:
        raise DiscontinuousPathError(
            None, error.position, error.step, error.max_step
        ) from None


def _distance_from_line(line: TcpLine, points: FloatArray, arm: Arm) -> FloatArray:
    """How far the tcp is from a line in the middle between its points, (N,) [m]."""
    direction = points[-1] - points[0]
    direction = direction / max(np.linalg.norm(direction), 1e-300)
    tips = np.array([arm.forward_kinematics(q).translation for q in line.at_middles()])
    away = tips - points[0]
    return np.asarray(
        np.linalg.norm(away - np.outer(away @ direction, direction), axis=1)
    )


def check_free(line: TcpLine, surroundings: Surroundings) -> None:
    """Refuse a line on which the arm touches itself or an obstacle.

    Raises:
        BlockedMotionError: It names what collides.
    """
    with_room = surroundings.with_room(line.deviation)
    for start, end in pairwise(line.way):
        found = with_room.obstruction(start, end)
        if found is not None:
            problem = "the straight line of the tcp is not free"
            raise BlockedMotionError(
                problem, found.names, found.q, found.distance, found.needed
            )


def _both_ways(bound: FloatArray) -> FloatArray:
    return np.column_stack([-bound, bound])


@contextmanager
def _quiet() -> Iterator[None]:
    """toppra reports its progress as warnings."""
    logger = logging.getLogger("toppra")
    before = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(before)
