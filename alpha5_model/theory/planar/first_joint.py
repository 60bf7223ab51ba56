"""The first joint of a planar arm: how it moves the points and curves of the rest.

The rest of the arm is given in the frame of the first link.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.theory.planar.curves import TURN, Arc, Curve, Segment, turned
from alpha5_model.theory.planar.intersections import circle_hits, line_hits


class FirstJoint(NamedTuple):
    """The first joint of an arm, and its link.

    Attributes:
        revolute: Whether it turns; otherwise it slides along its link.
        angle: Constant part of the link's direction [rad].
        length: Constant part of the link's length [m].
        limit: (lower, upper) [rad or m]; None if it has no limits.
    """

    revolute: bool
    angle: float
    length: float
    limit: tuple[float, float] | None

    def link(self, q: float) -> tuple[float, float]:
        """Direction [rad] and length [m] of the link with the joint at q."""
        if self.revolute:
            return self.angle + q, self.length + 0.0
        return self.angle + 0.0, self.length + q

    def carried(self, curve: Curve, q: float) -> Curve:
        """A curve of the rest, seen from the base with the joint at q."""
        angle, length = self.link(q)
        return curve.moved(angle, (length, 0.0))

    def swept(self, curve: Curve, tolerance: float) -> Iterator[Curve]:
        """Paths on which the joint carries the extreme points of a curve."""
        low, high = self.limit or (0.0, TURN)
        shifted = curve.moved(0.0, (self.length, 0.0))
        for x, y in extremes(shifted, self.revolute, tolerance):
            if self.revolute:
                yield Arc(
                    center=(0.0, 0.0),
                    radius=math.hypot(x, y),
                    start=math.atan2(y, x) + self.angle + low,
                    span=high - low,
                )
            else:
                travel = Segment(start=(x + low, y), angle=0.0, length=high - low)
                yield travel.moved(self.angle, (0.0, 0.0))

    def positions_onto(
        self, points: FloatArray, curves: Iterable[Curve], tolerance: float
    ) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Joint positions that bring a curve to points, whatever the limits.

        Args:
            points: Seen from the base, (M, 2) [m].
            curves: Of the rest.
            tolerance: Distance up to which a point counts as on a curve [m].

        Yields:
            For each curve, joint positions q (M, K) [rad or m] and the points of the
            curve that they bring there, (M, K, 2) [m]; NaN for those that do not exist.
        """
        angle, length = self.link(0.0)
        # Seen from the link, a point moves on a circle about the joint, or along x.
        if self.revolute:
            bearing = np.arctan2(points[:, 1], points[:, 0])[:, None] - angle
            pivot = np.array([[-length, 0.0]])
            radius = np.linalg.norm(points, axis=1)
            for curve in curves:
                there = circle_hits(pivot, radius, curve, tolerance)
                yield bearing - np.arctan2(there[..., 1], there[..., 0] + length), there
        else:
            start = turned(points, -angle) - (length, 0.0)
            along = np.array([[1.0, 0.0]])
            for curve in curves:
                there = line_hits(start, along, curve, tolerance)
                yield start[:, None, 0] - there[..., 0], there


def extremes(curve: Curve, revolute: bool, tolerance: float) -> list[list[float]]:
    """Ends of a curve, and its points where the joint moves along it.

    The joint is at the origin. It turns about the origin, or slides along x.
    """
    along = _points_moved_along(curve, revolute, tolerance)
    on_curve = ~np.isnan(curve.parameter(along, tolerance))
    return [*along[on_curve].tolist(), *curve.point(curve.interval).tolist()]


def _points_moved_along(curve: Curve, revolute: bool, tolerance: float) -> FloatArray:
    """Points of a curve's circle or line where the joint moves along it, (K, 2)."""
    none = np.empty((0, 2))
    if isinstance(curve, Segment):
        if not revolute:
            return none
        normal = curve.left(0.0)
        return np.asarray(normal @ np.asarray(curve.start) * normal)[None]

    if not revolute:
        bearing = math.pi / 2
    elif math.hypot(*curve.center) > tolerance:
        bearing = math.atan2(curve.center[1], curve.center[0])
    else:  # a circle about the joint: it moves along all of it
        return none
    return curve.point([bearing, bearing + math.pi])
