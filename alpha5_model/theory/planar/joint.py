"""A joint of a planar arm with its link: how it moves what the rest of the arm reaches.

The rest of the arm is given in the frame of the link.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.theory.arcs import (
    TURN,
    Arc,
    Circles,
    Curve,
    Lines,
    Segment,
    crossings,
    turned,
)

#: Least and greatest value, of a joint or a length.
Range = tuple[float, float]


class Joint(NamedTuple):
    """A joint and its link.

    Attributes:
        revolute: Whether it turns; otherwise it slides along its link.
        angle: Constant part of the link's direction [rad].
        length: Constant part of the link's length [m].
        limit: (lower, upper) [rad or m]; None if it has no limits.
    """

    revolute: bool
    angle: float
    length: float
    limit: Range | None

    def link(self, q: float) -> tuple[float, float]:
        """Direction [rad] and length [m] of the link with the joint at q."""
        if self.revolute:
            return self.angle + q, self.length
        return self.angle, self.length + q

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
                start = math.atan2(y, x) + self.angle + low
                yield Arc((0.0, 0.0), math.hypot(x, y), start, high - low)
            else:
                travel = Segment((x + low, y), angle=0.0, length=high - low)
                yield travel.moved(self.angle, (0.0, 0.0))

    def positions_onto(
        self, points: FloatArray, curve: Curve, tolerance: float
    ) -> tuple[FloatArray, FloatArray]:
        """Joint positions that bring a curve to points, whatever the limits.

        Args:
            points: Seen from the base, (M, 2) [m].
            curve: Of the rest.
            tolerance: Distance up to which a point counts as on the curve [m].

        Returns:
            Joint positions q (M, K) [rad or m] and the points of the curve that they
            bring there, (M, K, 2) [m]; NaN for those that do not exist.
        """
        # Seen from the link, a point moves on a circle about the joint, or along x.
        if self.revolute:
            pivots = np.broadcast_to((-self.length, 0.0), points.shape)
            circles = Circles(pivots, np.linalg.norm(points, axis=1))
            there = crossings(circles, curve, tolerance)
            bearing = np.arctan2(points[:, 1], points[:, 0])[:, None] - self.angle
            seen = np.arctan2(there[..., 1], there[..., 0] + self.length)
            return bearing - seen, there

        start = turned(points, -self.angle) - (self.length, 0.0)
        along = np.broadcast_to((1.0, 0.0), points.shape)
        there = crossings(Lines(start, along), curve, tolerance)
        return start[:, None, 0] - there[..., 0], there

    def within_limits(self, q: FloatArray, slack: Any) -> BoolArray:
        """Whether positions are within the limits.

        Args:
            q: Positions (...) [rad or m]; NaN is not within.
            slack: Beyond a limit by at most this counts as within; broadcasts against
                q.

        Returns:
            (...) bool.
        """
        if self.limit is None:
            return ~np.isnan(q)
        low, high = self.limit
        over = q - low + slack
        with np.errstate(invalid="ignore"):
            if self.revolute:
                over = np.mod(over, TURN)
            return np.asarray((over >= 0.0) & (over <= high - low + 2 * slack))


def extremes(curve: Curve, revolute: bool, tolerance: float) -> list[list[float]]:
    """Ends of a curve, and its points where a joint at the origin moves along it.

    The joint turns about the origin, or slides along x.
    """
    along = np.empty((0, 2))
    if isinstance(curve, Arc):
        bearing = math.pi / 2
        if revolute:
            bearing = math.atan2(curve.center[1], curve.center[0])
        # About its own centre the joint moves along all of a circle.
        if not revolute or math.hypot(*curve.center) > tolerance:
            along = curve.point([bearing, bearing + math.pi])
    elif revolute:
        normal = curve.left(0.0)
        along = (normal @ np.asarray(curve.start) * normal)[None]

    on_curve = ~np.isnan(curve.parameter(along, tolerance))
    return [*along[on_curve].tolist(), *curve.point(curve.interval).tolist()]
