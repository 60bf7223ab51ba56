"""Arcs and segments in the plane.

Each is a curve with a parameter t: the polar angle on an `Arc`, the distance from the
start on a `Segment`. A point is an arc of radius zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray

TURN = 2 * math.pi
#: (x, y) [m].
Point = tuple[float, float]


@dataclass(frozen=True)
class Arc:
    """Part of a circle, traversed counterclockwise.

    Attributes:
        center: (x, y) [m].
        radius: [m], not negative.
        start: Polar angle at which it starts [rad].
        span: Angle that it covers [rad], 0 to 2 pi; 2 pi is the full circle.
    """

    center: Point
    radius: float
    start: float = 0.0
    span: float = TURN

    @property
    def closed(self) -> bool:
        """Whether it is a full circle."""
        return self.span >= TURN

    @property
    def interval(self) -> tuple[float, float]:
        """Range of the parameter."""
        return self.start, self.start + self.span

    def point(self, t: ArrayLike) -> FloatArray:
        """Points (..., 2) [m] at polar angles t (...) [rad]."""
        angle = np.asarray(t, dtype=np.float64)
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return np.asarray(self.center) + self.radius * direction

    def left(self, t: float) -> FloatArray:
        """Unit normal to the left of the direction of travel, to the centre, (2,)."""
        return -unit_vector(t)

    def parameter(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Parameters (...) of points (..., 2) on the circle.

        NaN for a point beyond an end of the arc by more than `tolerance` [m].
        """
        x = points[..., 0] - self.center[0]
        y = points[..., 1] - self.center[1]
        t = self.start + np.mod(np.arctan2(y, x) - self.start, TURN)
        if self.closed:
            return np.asarray(t)

        slack = tolerance / max(self.radius, tolerance)
        just_before_start = t > self.start + TURN - slack
        t = np.where(just_before_start, t - TURN, t)
        inside = t <= self.start + self.span + slack
        return np.where(inside, np.clip(t, *self.interval), np.nan)

    def piece(self, start: float, end: float) -> Arc:
        """The part between two parameters."""
        return Arc(
            center=self.center, radius=self.radius, start=start, span=end - start
        )

    def moved(self, angle: float, shift: Point) -> Arc:
        """The curve, translated by a shift [m], then rotated about the origin [rad]."""
        return Arc(
            center=_moved(self.center, angle, shift),
            radius=self.radius,
            start=self.start + angle,
            span=self.span,
        )

    @property
    def length(self) -> float:
        """[m]."""
        return self.radius * self.span

    def area_integral(self) -> float:
        """Integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        a, b = self.interval
        x, y = self.center
        r = self.radius
        sine = math.sin(b) - math.sin(a)
        cosine = math.cos(b) - math.cos(a)
        return 0.5 * (r * r * (b - a) + r * x * sine - r * y * cosine)


@dataclass(frozen=True)
class Segment:
    """A straight line.

    Attributes:
        start: Its first point, (x, y) [m].
        angle: Polar angle of its direction [rad].
        length: [m].
        closed: Never: no segment ends where it starts.
    """

    start: Point
    angle: float
    length: float

    closed = False

    @property
    def interval(self) -> tuple[float, float]:
        """Range of the parameter."""
        return 0.0, self.length

    def point(self, t: ArrayLike) -> FloatArray:
        """Points (..., 2) [m] at distances t (...) [m] from the start."""
        distance = np.asarray(t, dtype=np.float64)[..., None]
        return np.asarray(self.start) + distance * unit_vector(self.angle)

    def left(self, t: float) -> FloatArray:
        """Unit normal to the left of the direction of travel, (2,)."""
        return unit_vector(self.angle + math.pi / 2)

    def parameter(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Parameters (...) of points (..., 2) on the line.

        NaN for a point beyond an end of the segment by more than `tolerance` [m].
        """
        t = (points - np.asarray(self.start)) @ unit_vector(self.angle)
        inside = (t >= -tolerance) & (t <= self.length + tolerance)
        return np.where(inside, np.clip(t, 0.0, self.length), np.nan)

    def piece(self, start: float, end: float) -> Segment:
        """The part between two parameters."""
        x, y = self.point(start).tolist()
        return Segment(start=(x, y), angle=self.angle, length=end - start)

    def moved(self, angle: float, shift: Point) -> Segment:
        """The curve, translated by a shift [m], then rotated about the origin [rad]."""
        return Segment(
            start=_moved(self.start, angle, shift),
            angle=self.angle + angle,
            length=self.length,
        )

    def area_integral(self) -> float:
        """Integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        x, y = self.start
        return 0.5 * self.length * (x * math.sin(self.angle) - y * math.cos(self.angle))


Curve = Arc | Segment


@dataclass(frozen=True)
class Edge:
    """A piece of boundary with the set on one side.

    Attributes:
        curve: The piece.
        inside_left: Whether the set lies to the left of the direction of travel.
    """

    curve: Curve
    inside_left: bool


def unit_vector(angle: float) -> FloatArray:
    """The direction at a polar angle [rad], (2,)."""
    return np.array([math.cos(angle), math.sin(angle)])


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Points (..., 2), rotated about the origin by an angle [rad]."""
    c, s = unit_vector(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def _moved(point: Point, angle: float, shift: Point) -> Point:
    """A point, translated by a shift, then rotated about the origin."""
    x = point[0] + shift[0]
    y = point[1] + shift[1]
    c = math.cos(angle)
    s = math.sin(angle)
    return c * x - s * y, s * x + c * y
