"""Arcs and segments in the plane, and what of them bounds a set.

Each is a curve with a parameter t: the polar angle on an `Arc`, the distance from the start on a
`Segment`. A point is an arc of radius zero. `bounds` unites them where they overlap and cuts them
where they meet.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray

TURN = 2 * math.pi
#: (x, y) [m].
Point = tuple[float, float]


@dataclass(frozen=True)
class Arc:
    """Part of a circle, run through counterclockwise.

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
        """Unit normal to the left of the curve's sense: towards the centre."""
        return -_unit(t)

    def parameter(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Parameters of points on the circle, NaN for those off the arc by over `tolerance` [m]."""
        angle = np.arctan2(
            points[..., 1] - self.center[1], points[..., 0] - self.center[0]
        )
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

    def moved(self, angle: float, shift: Point) -> Arc:
        """Translated by `shift`, then rotated about the origin by `angle`."""
        return Arc(
            _moved(self.center, angle, shift),
            self.radius,
            self.start + angle,
            self.span,
        )

    @property
    def length(self) -> float:
        """[m]."""
        return self.radius * self.span

    def area_integral(self) -> float:
        """Line integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        a, b = self.interval
        (x, y), r = self.center, self.radius
        sine, cosine = math.sin(b) - math.sin(a), math.cos(b) - math.cos(a)
        return 0.5 * (r * r * (b - a) + r * x * sine - r * y * cosine)


@dataclass(frozen=True)
class Segment:
    """A straight line from `start`, at polar angle `angle`, `length` long."""

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

    def moved(self, angle: float, shift: Point) -> Segment:
        """Translated by `shift`, then rotated about the origin by `angle`."""
        return Segment(
            _moved(self.start, angle, shift), self.angle + angle, self.length
        )

    def area_integral(self) -> float:
        """Line integral of (x dy - y dx) / 2 along the curve [m^2] (Green's theorem)."""
        x, y = self.start
        return 0.5 * self.length * (x * math.sin(self.angle) - y * math.cos(self.angle))


Curve = Arc | Segment


def hits(
    at: FloatArray, size: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Where circles or straight lines meet a curve; touching counts.

    Args:
        at: Centres of the circles, or a point of each line, (M, 2), or (1, 2) for all [m].
        size: Radii of the circles (M,) [m], or unit vectors along the lines, (M, 2) or (1, 2).
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points (M, K, 2) [m], NaN where there is none, K up to 4. A circle or line that runs along
        the curve is reported at the curve's ends.
    """
    circles = size.ndim == 1
    if isinstance(curve, Arc):
        center = np.array(curve.center)
        if circles:
            meet = _circle_circle(at, size, center, curve.radius, tolerance)
        else:
            meet = _line_circle(at, size, center, np.array(curve.radius), tolerance)
    elif circles:
        meet = _line_circle(
            np.array(curve.start), _unit(curve.angle), at, size, tolerance
        )
    else:
        meet = _line_line(at, size, np.array(curve.start), _unit(curve.angle))
    ends = curve.point(np.array(curve.interval))
    away = ends - at[:, None]
    far = (
        np.linalg.norm(away, axis=-1) - size[:, None]
        if circles
        else _cross(size[:, None], away)
    )
    on = np.abs(far) <= tolerance
    if on.any():
        meet = np.concatenate([meet, np.where(on[..., None], ends, np.nan)], axis=1)
    if curve.closed:
        return meet
    off = np.isnan(curve.parameter(meet, tolerance))
    return np.where(off[..., None], np.nan, meet)


def _circle_circle(
    c1: FloatArray, r1: FloatArray, c2: FloatArray, r2: float, tolerance: float
) -> FloatArray:
    """Intersections of circles with one about c2, (M, 2, 2), NaN if none."""
    between = c2 - c1
    distance = np.linalg.norm(between, axis=1)
    apart = np.maximum(distance - (r1 + r2), np.abs(r1 - r2) - distance)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = np.clip((distance**2 + r1**2 - r2**2) / (2 * distance), -r1, r1)
        e = between / distance[:, None]
    height = np.sqrt(r1**2 - along**2)
    height[(apart > tolerance) | (distance <= tolerance)] = np.nan
    foot = c1 + along[:, None] * e
    side = height[:, None] * np.stack([-e[:, 1], e[:, 0]], axis=-1)
    # Circles about one point, one or both of them no more than a point: the point itself.
    same = (distance <= tolerance) & (r1 <= tolerance) & (r2 <= tolerance)
    out = np.stack([foot + side, foot - side], axis=1)
    return np.where(same[:, None, None], c1[:, None], out)


def _line_circle(
    starts: FloatArray,
    along: FloatArray,
    centers: FloatArray,
    radii: FloatArray,
    tolerance: float,
) -> FloatArray:
    """Intersections of lines with circles, (M, 2, 2), NaN if none; there may be one of either."""
    to_center = centers - starts
    s = (to_center * along).sum(axis=-1)
    off = np.linalg.norm(to_center - s[:, None] * along, axis=1)
    half = np.sqrt(np.maximum(radii**2 - off**2, 0.0))
    half = np.where(off > radii + tolerance, np.nan, half)
    t = np.stack([s - half, s + half], axis=1)
    return np.asarray(starts[..., None, :] + t[..., None] * along[..., None, :])


def _line_line(
    p1: FloatArray, e1: FloatArray, p2: FloatArray, e2: FloatArray
) -> FloatArray:
    """Intersections of lines through p1 along e1 with one other, (M, 1, 2), NaN if parallel."""
    sine = _cross(e1, e2)
    t = _cross(p2 - p1, e2) / np.where(np.abs(sine) <= 1e-12, np.nan, sine)
    return np.asarray((p1 + t[:, None] * e1)[:, None])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _unit(angle: float) -> FloatArray:
    return np.array([math.cos(angle), math.sin(angle)])


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Points (..., 2), rotated about the origin."""
    c, s = _unit(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def _moved(point: Point, angle: float, shift: Point) -> Point:
    x, y = point[0] + shift[0], point[1] + shift[1]
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


@dataclass(frozen=True)
class Edge:
    """A piece of boundary with the workspace on one side.

    Attributes:
        curve: The piece.
        inside_left: Whether the workspace lies to the left of the curve's sense.
    """

    curve: Curve
    inside_left: bool


def _united(curves: list[Curve], tolerance: float) -> list[Curve]:
    """The same point set with every circle and every line covered once."""
    groups: dict[int, list[Curve]] = {}
    for number, curve in enumerate(curves):
        same = (g for g in groups if _same_carrier(curves[g], curve, tolerance))
        groups.setdefault(next(same, number), []).append(curve)
    out: list[Curve] = []
    for members in groups.values():
        first = members[0]
        slack = tolerance / _per_parameter(first)
        merged = list[list[float]]()
        for low, high in sorted(_span_on(first, member) for member in members):
            if merged and low <= merged[-1][1] + slack:
                merged[-1][1] = max(merged[-1][1], high)
            else:
                merged.append([low, high])
        whole = TURN if isinstance(first, Arc) else math.inf
        if len(merged) > 1 and merged[-1][1] >= merged[0][0] + whole - slack:
            merged[-1][1] = max(merged[-1][1], merged[0][1] + TURN)
            del merged[0]
        for low, high in merged:
            piece = first.piece(low, high)
            if isinstance(piece, Arc) and piece.span >= TURN - slack:
                piece = replace(piece, span=TURN)
            out.append(piece)
    return out


def _same_carrier(a: Curve, b: Curve, tolerance: float) -> bool:
    if isinstance(a, Arc) and isinstance(b, Arc):
        return (
            math.dist(a.center, b.center) <= tolerance
            and abs(a.radius - b.radius) <= tolerance
        )
    if isinstance(a, Segment) and isinstance(b, Segment):
        ends = b.point(np.array(b.interval)) - np.asarray(a.start)
        return bool((np.abs(ends @ a.left(0.0)) <= tolerance).all())
    return False


def _span_on(first: Curve, member: Curve) -> tuple[float, float]:
    """Parameter range of `member` in the parameter of a curve on the same circle or line."""
    if isinstance(first, Arc) and isinstance(member, Arc):
        start = member.start % TURN
        return start, start + member.span
    assert isinstance(first, Segment)
    ends = member.point(np.array(member.interval)) - np.asarray(first.start)
    low, high = sorted((ends @ _unit(first.angle)).tolist())
    return low, high


def bounds(
    curves: list[Curve],
    contains: Callable[[FloatArray], BoolArray],
    tolerance: float,
    step: float,
) -> tuple[tuple[Edge, ...], tuple[Curve, ...]]:
    """The boundary of a set that is known to lie on some curves.

    The curves are cut where they meet. A piece with the set on one side only is an edge.

    Args:
        curves: They may overlap.
        contains: Whether points (N, 2) belong to the set, (N,).
        tolerance: Distance up to which curves count as touching [m].
        step: Distance to either side at which `contains` is asked; shorter pieces are left out [m].

    Returns:
        The edges, and the pieces with nothing of the set on either side.
    """
    curves = _united(curves, tolerance)
    parts = [
        (number, low, high)
        for number, cuts in enumerate(_cuts(curves, tolerance, step))
        for low, high in pairwise(cuts)
        if (high - low) * _per_parameter(curves[number]) > step
    ]
    middles = [(curves[number], (low + high) / 2) for number, low, high in parts]
    at = np.array([curve.point(t) for curve, t in middles])
    normal = np.array([curve.left(t) for curve, t in middles])
    left, right = contains(at + step * normal), contains(at - step * normal)
    # Neighbouring pieces of one curve and one kind are one again: curve, start, end, sides.
    runs: list[list[tuple[float, float, bool, bool]]] = [[] for _ in curves]
    for (number, low, high), *sides in zip(
        parts, left.tolist(), right.tolist(), strict=True
    ):
        run = runs[number]
        start = run.pop()[0] if run and [*run[-1][2:]] == sides else low
        run.append((start, high, *sides))
    edges, thin = [], []
    for curve, run in zip(curves, runs, strict=True):
        if curve.closed and len(run) > 1 and run[0][2:] == run[-1][2:]:
            run[0] = (run.pop()[0], run[0][1] + TURN, *run[0][2:])
        for start, end, inside_left, inside_right in run:
            piece = curve.piece(start, end)
            if inside_left != inside_right:
                edges.append(Edge(piece, inside_left))
            elif not inside_left:
                thin.append(piece)
    return tuple(edges), tuple(thin)


def _cuts(curves: list[Curve], tolerance: float, step: float) -> list[list[float]]:
    """Parameters at which each curve begins, meets another, and ends."""
    cuts: list[list[float]] = [list(c.interval) for c in curves]
    arcs = {i: c for i, c in enumerate(curves) if isinstance(c, Arc)}
    lines = {i: c for i, c in enumerate(curves) if isinstance(c, Segment)}
    centers = np.array([c.center for c in arcs.values()]).reshape(-1, 2)
    starts = np.array([c.start for c in lines.values()]).reshape(-1, 2)
    along = np.array([_unit(c.angle) for c in lines.values()]).reshape(-1, 2)
    carriers = (
        (arcs, centers, np.array([c.radius for c in arcs.values()])),
        (lines, starts, along),
    )
    for j, other in enumerate(curves):
        for group, at, size in carriers:
            for i, points in zip(group, hits(at, size, other, tolerance), strict=True):
                t = curves[i].parameter(points, tolerance)
                cuts[i] += t[~np.isnan(t)].tolist() if i != j else []
    out = []
    for curve, meets in zip(curves, map(sorted, cuts), strict=True):
        # Closer together than a step they are one. Where curves touch, rounding makes two of one,
        # some 1e-8 to either side: their mean is exact.
        apart = np.flatnonzero(np.diff(meets) * _per_parameter(curve) > step) + 1
        means = [math.fsum(group) / len(group) for group in np.split(meets, apart)]
        out.append([meets[0], *means[1:-1], meets[-1]])
    return out


def _per_parameter(curve: Curve) -> float:
    """Length per unit of the curve's parameter [m]."""
    return curve.radius if isinstance(curve, Arc) else 1.0
