"""A straight line of the tcp: continuous, proved free, in the least time.

The line is followed in steps of `STEP` by inverse kinematics. A cubic spline of the
joint positions leads from one to the next. Between two of them it is at most
``max |q''| h^2 / 8`` from their straight joint line, and q'' is largest at one of them.
So the spline is free if the joint lines are free with that much more room.

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
from alpha5_model.errors import BlockedMotionError, needing
from alpha5_model.kinematics.path import inverse_kinematics_path
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.s_curve import (
    MOST_SAMPLES,
    JointLimits,
    Samples,
    sampled,
)
from alpha5_model.planning.s_curve import STEP as TIME_STEP
from alpha5_model.planning.surroundings import Surroundings

#: Between two joint positions of the spline [m].
STEP = 1e-3
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

    def sampled(self, limits: JointLimits) -> Samples:
        """The fastest motion along the line, from rest to rest.

        A joint whose speed is 0 must not move.
        """
        if np.abs(self.way - self.way[0]).max() < _AT_REST:
            return sampled(self.way[[0, 0]], limits)

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
        duration = float(motion.duration)
        count = min(math.ceil(duration / TIME_STEP), MOST_SAMPLES) + 1
        time = np.linspace(0.0, duration, count)
        position = np.asarray(motion(time))
        velocity = np.asarray(motion(time, 1))
        position[[0, -1]] = self.way[[0, -1]]
        velocity[[0, -1]] = 0.0
        return Samples(
            time=time,
            position=position,
            velocity=velocity,
            acceleration=np.asarray(motion(time, 2)),
        )


def tcp_line(
    start: FloatArray,
    tcp: FloatArray,
    target: FloatArray,
    wrist: float,
    arm: Alpha5Parameters,
) -> TcpLine:
    """The straight line from where the tcp is to a target.

    Args:
        start: Joint position, (4,) [rad].
        tcp: Where the tcp is at it, (3,) [m].
        target: (3,) [m].
        wrist: theta_3 at the target; it changes evenly along the line [rad].
        arm: Record of the arm.

    Raises:
        UnreachableError: A point of the line is out of reach, or only in collision.
        DiscontinuousPathError: A joint would have to jump: to another branch, or across
            the gap of axis_e.
        MissingDependencyError: toppra is not installed.
    """
    length = float(np.linalg.norm(target - tcp))
    count = max(_FEWEST, math.ceil(length / STEP)) + 1
    points = np.linspace(tcp, target, count)
    wrists = np.linspace(start[3], wrist, count)
    way = inverse_kinematics_path(points, start, wrists, arm=arm)
    way[0] = start
    return TcpLine(way)


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
            raise BlockedMotionError(problem, found.names, found.q, found.distance)


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
