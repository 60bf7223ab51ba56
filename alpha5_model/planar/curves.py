"""Arcs and segments in the plane: the pieces of which workspace boundaries are made.

Each is a curve with a parameter t: the polar angle on an `Arc`, the distance from the start on a
`Segment`. A point is an arc of radius zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray

TURN = 2 * math.pi


@dataclass(frozen=True)
class Arc:
    """Part of a circle, run through counterclockwise.

    Attributes:
        center: (x, y) [m].
        radius: [m], not negative.
        start: Polar angle at which it starts [rad].
        span: Angle that it covers [rad], 0 to 2 pi; 2 pi is the full circle.
    """

    center: tuple[float, float]
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
        """Unit normal to the left of the curve's sense: towards the centre."""
        return np.array([-math.cos(t), -math.sin(t)])

    def parameter(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Parameters of points on the circle, NaN for those off the arc by over `tolerance` [m]."""
        angle = np.arctan2(points[..., 1] - self.center[1], points[..., 0] - self.center[0])
        t = self.start + np.mod(angle - self.start, TURN)
        if self.closed:
            return np.asarray(t)
        slack = tolerance / max(self.radius, tolerance)
        t = np.where(t > self.start + TURN - slack, t - TURN, t)
        inside = t <= self.start + self.span + slack
        return np.where(inside, np.clip(t, *self.interval), np.nan)

    def piece(self, start: float, end: float) -> Arc:
        """The part between two parameters."""
        return Arc(self.center, self.radius, start, end - start)

    def moved(self, angle: float, shift: tuple[float, float]) -> Arc:
        """Translated by `shift`, then rotated about the origin by `angle`."""
        return Arc(_moved(self.center, angle, shift), self.radius, self.start + angle, self.span)

    @property
    def length(self) -> float:
        """[m]."""
        return self.radius * self.span

    def area_integral(self) -> float:
        """Line integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        a, b = self.interval
        (x, y), r = self.center, self.radius
        return 0.5 * (
            r * r * (b - a)
            + r * x * (math.sin(b) - math.sin(a))
            - r * y * (math.cos(b) - math.cos(a))
        )


@dataclass(frozen=True)
class Segment:
    """A straight line from `start`, at polar angle `angle`, `length` long."""

    start: tuple[float, float]
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
        return np.asarray(self.start) + distance * _unit(self.angle)

    def left(self, t: float) -> FloatArray:
        """Unit normal to the left of the curve's sense."""
        return _unit(self.angle + math.pi / 2)

    def parameter(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Parameters of points on the line, NaN where they lie beyond an end by `tolerance` [m]."""
        t = (points - np.asarray(self.start)) @ _unit(self.angle)
        inside = (t >= -tolerance) & (t <= self.length + tolerance)
        return np.where(inside, np.clip(t, 0.0, self.length), np.nan)

    def piece(self, start: float, end: float) -> Segment:
        """The part between two parameters."""
        x, y = self.point(start).tolist()
        return Segment((x, y), self.angle, end - start)

    def moved(self, angle: float, shift: tuple[float, float]) -> Segment:
        """Translated by `shift`, then rotated about the origin by `angle`."""
        return Segment(_moved(self.start, angle, shift), self.angle + angle, self.length)

    def area_integral(self) -> float:
        """Line integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        x, y = self.start
        return 0.5 * self.length * (x * math.sin(self.angle) - y * math.cos(self.angle))


Curve = Arc | Segment


def circle_hits(
    centers: FloatArray, radii: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Where circles meet a curve; touching counts.

    Args:
        centers: (M, 2) [m].
        radii: (M,) [m].
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points (M, 4, 2) [m], NaN where there is none. A circle that runs along the curve is
        reported at the curve's ends.
    """
    if isinstance(curve, Arc):
        meet = circle_circle(centers, radii, np.asarray(curve.center), curve.radius, tolerance)
    else:
        start = np.asarray(curve.start)
        meet = line_circle(start, _unit(curve.angle), centers, radii, tolerance)
    ends = curve.point(np.array(curve.interval))
    gap = np.abs(np.linalg.norm(ends - centers[:, None], axis=-1) - radii[:, None])
    return _within(meet, ends, gap, curve, tolerance)


def line_hits(
    starts: FloatArray, directions: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Where straight lines meet a curve; as `circle_hits`.

    Args:
        starts: A point of each line, (M, 2) [m].
        directions: Unit vectors, (M, 2).
        curve: The curve.
        tolerance: [m].

    Returns:
        Points (M, 4, 2) [m], NaN where there is none.
    """
    if isinstance(curve, Arc):
        center = np.broadcast_to(curve.center, starts.shape)
        radius = np.full(len(starts), curve.radius)
        meet = line_circle(starts, directions, center, radius, tolerance)
    else:
        meet = line_line(starts, directions, np.asarray(curve.start), _unit(curve.angle))
    ends = curve.point(np.array(curve.interval))
    normals = np.stack([-directions[:, 1], directions[:, 0]], axis=-1)
    gap = np.abs(np.einsum("mki,mi->mk", ends - starts[:, None], normals))
    return _within(meet, ends, gap, curve, tolerance)


def _within(
    meet: FloatArray, ends: FloatArray, gap: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Points that lie on the curve's extent, and its ends (2, 2) where `gap` (M, 2) is small."""
    points = np.concatenate([meet, np.broadcast_to(ends, (len(meet), 2, 2))], axis=1)
    off = np.isnan(curve.parameter(points, tolerance))
    off[:, -2:] |= gap > tolerance
    return np.where(off[..., None], np.nan, points)


def circle_circle(
    c1: FloatArray, r1: FloatArray, c2: FloatArray, r2: float, tolerance: float
) -> FloatArray:
    """Intersections of circles about c1 (M, 2) with one about c2, (M, 2, 2), NaN if none."""
    between = c2 - c1
    distance = np.linalg.norm(between, axis=1)
    apart = np.maximum(distance - (r1 + r2), np.abs(r1 - r2) - distance)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (distance**2 + r1**2 - r2**2) / (2 * distance)
        e = between / distance[:, None]
    height = np.sqrt(np.maximum(r1**2 - along**2, 0.0))
    touching = apart > 0
    np.clip(along, -r1, r1, out=along, where=touching)
    height[touching] = 0.0
    height[(apart > tolerance) | (distance <= tolerance)] = np.nan
    foot = c1 + along[:, None] * e
    side = height[:, None] * np.stack([-e[:, 1], e[:, 0]], axis=-1)
    out = np.empty((len(foot), 2, 2))
    np.add(foot, side, out=out[:, 0])
    np.subtract(foot, side, out=out[:, 1])
    # Circles about one point, one or both of them no more than a point: the point itself.
    same = (distance <= tolerance) & (r1 <= tolerance) & (r2 <= tolerance)
    np.copyto(out, c1[:, None, :], where=same[:, None, None])
    return out


def line_circle(
    starts: FloatArray, along: FloatArray, centers: FloatArray, radii: FloatArray, tol: float
) -> FloatArray:
    """Intersections of lines with circles, row by row, (M, 2, 2), NaN if none."""
    to_center = centers - starts
    s = to_center @ along if along.ndim == 1 else np.einsum("mi,mi->m", to_center, along)
    off = np.linalg.norm(to_center - s[:, None] * along, axis=1)
    half = np.sqrt(np.maximum(radii**2 - off**2, 0.0))
    half = np.where(off > radii + tol, np.nan, half)
    t = np.stack([s - half, s + half], axis=1)
    return np.asarray(
        np.broadcast_to(starts, centers.shape)[:, None, :]
        + t[..., None] * np.broadcast_to(along, centers.shape)[:, None, :]
    )


def line_line(
    starts: FloatArray, along: FloatArray, other: FloatArray, other_along: FloatArray
) -> FloatArray:
    """Intersections of lines with one other, (M, 2, 2), NaN if parallel."""
    sine = along[:, 0] * other_along[1] - along[:, 1] * other_along[0]
    sine = np.where(np.abs(sine) <= 1e-12, np.nan, sine)
    between = other - starts
    t = (between[:, 0] * other_along[1] - between[:, 1] * other_along[0]) / sine
    out = starts + t[:, None] * along
    return np.stack([out, np.full_like(out, np.nan)], axis=1)


def _unit(angle: float) -> FloatArray:
    return np.array([math.cos(angle), math.sin(angle)])


def _moved(
    point: tuple[float, float], angle: float, shift: tuple[float, float]
) -> tuple[float, float]:
    x, y = point[0] + shift[0], point[1] + shift[1]
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y
