"""Arcs and segments in the plane: where they meet, and which of them bound a set.

Each is a curve with a parameter t: the polar angle on an `Arc`, the distance from the
start on a `Segment`. A point is an arc of radius zero.

`outline` finds the boundary of a set that is known to lie on some curves. Curves that
overlap are united, then cut where they meet. A piece belongs to the boundary if the set
lies on one side of it only. The workspaces of planar arms and the half-plane of the
Alpha 5 are both drawn this way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray

TURN = 2 * math.pi
#: Distances below this share of a set's size count as zero.
RELATIVE_TOLERANCE = 1e-9
#: Step to either side of a curve to see which side is inside, as a share of the size.
RELATIVE_STEP = 1e-7
#: Sine of the angle between two lines that count as parallel.
_PARALLEL = 1e-12
#: (x, y) [m].
Point = tuple[float, float]
#: Whether points (N, 2) belong to a set, (N,).
Contains = Callable[[FloatArray], BoolArray]


class Circles(NamedTuple):
    """Whole circles.

    Attributes:
        centers: (M, 2) [m].
        radii: (M,) [m].
    """

    centers: FloatArray
    radii: FloatArray

    def distances(self, points: FloatArray) -> FloatArray:
        """Signed distances of points (K, 2) from each circle, (M, K) [m]."""
        from_centers = np.linalg.norm(points - self.centers[:, None], axis=-1)
        return np.asarray(from_centers - self.radii[:, None])


class Lines(NamedTuple):
    """Straight lines without ends.

    Attributes:
        points: A point of each, (M, 2) [m].
        directions: Unit vectors, (M, 2).
    """

    points: FloatArray
    directions: FloatArray

    def distances(self, points: FloatArray) -> FloatArray:
        """Signed distances of points (K, 2) from each line, (M, K) [m]."""
        return _cross(self.directions[:, None], points - self.points[:, None])


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

    @property
    def length(self) -> float:
        """[m]."""
        return self.radius * self.span

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
        return Arc(self.center, self.radius, start, end - start)

    def moved(self, angle: float, shift: Point) -> Arc:
        """The curve, translated by a shift [m], then rotated about the origin [rad]."""
        center = _moved(self.center, angle, shift)
        return Arc(center, self.radius, self.start + angle, self.span)

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
        return Segment((x, y), self.angle, end - start)

    def moved(self, angle: float, shift: Point) -> Segment:
        """The curve, translated by a shift [m], then rotated about the origin [rad]."""
        start = _moved(self.start, angle, shift)
        return Segment(start, self.angle + angle, self.length)

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


def enclosed_area(edges: Iterable[Edge]) -> float:
    """Area of the set that edges bound [m^2], by Green's theorem."""
    return sum(
        edge.curve.area_integral() * (1 if edge.inside_left else -1) for edge in edges
    )


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


# Where curves meet
# --------------------------------------------------------------------------------------


def crossings(paths: Circles | Lines, curve: Curve, tolerance: float) -> FloatArray:
    """Points in which circles or lines meet a curve; touching counts.

    Args:
        paths: M circles or lines.
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points (M, K, 2) [m], K up to 4; NaN for those that do not exist. For a path
        that runs along the curve, they are the ends of the curve.
    """
    carrier = _carrier([curve])
    if isinstance(paths, Lines):
        if isinstance(carrier, Lines):
            points = _lines_meet(paths, carrier)
        else:
            points = _lines_meet_circles(paths, carrier, tolerance)
    elif isinstance(carrier, Lines):
        points = _lines_meet_circles(carrier, paths, tolerance)
    else:
        points = _circles_meet(paths, carrier, tolerance)

    ends = curve.point(curve.interval)
    touched = np.abs(paths.distances(ends)) <= tolerance
    if touched.any():
        points = np.concatenate(
            [points, np.where(touched[..., None], ends, np.nan)], axis=1
        )
    if curve.closed:
        return points
    beyond = np.isnan(curve.parameter(points, tolerance))
    return np.where(beyond[..., None], np.nan, points)


def _carrier(curves: Sequence[Curve]) -> Circles | Lines:
    """The circles of arcs, or the lines of segments."""
    arcs = [curve for curve in curves if isinstance(curve, Arc)]
    if arcs:
        centers = np.array([arc.center for arc in arcs])
        return Circles(centers, np.array([arc.radius for arc in arcs]))
    lines = [curve for curve in curves if isinstance(curve, Segment)]
    starts = np.array([line.start for line in lines])
    return Lines(starts, np.array([unit_vector(line.angle) for line in lines]))


def _circles_meet(some: Circles, other: Circles, tolerance: float) -> FloatArray:
    """Intersections of circles with one other circle, (M, 2, 2) [m]."""
    r1, r2 = some.radii, other.radii
    between = other.centers - some.centers
    distance = np.linalg.norm(between, axis=1)
    apart = np.maximum(distance - (r1 + r2), np.abs(r1 - r2) - distance)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = np.clip((distance**2 + r1**2 - r2**2) / (2 * distance), -r1, r1)
        e = between / distance[:, None]

    height = np.sqrt(r1**2 - along**2)
    height[(apart > tolerance) | (distance <= tolerance)] = np.nan
    foot = some.centers + along[:, None] * e
    side = height[:, None] * np.stack([-e[:, 1], e[:, 0]], axis=-1)
    return np.stack([foot + side, foot - side], axis=1)


def _lines_meet_circles(lines: Lines, circles: Circles, tolerance: float) -> FloatArray:
    """Intersections of lines with a circle, or of a line with circles, (M, 2, 2)."""
    to_center = circles.centers - lines.points
    s = (to_center * lines.directions).sum(axis=-1)
    off = np.linalg.norm(to_center - s[:, None] * lines.directions, axis=1)
    half = np.sqrt(np.maximum(circles.radii**2 - off**2, 0.0))
    half = np.where(off > circles.radii + tolerance, np.nan, half)
    t = np.stack([s - half, s + half], axis=1)
    return lines.points[:, None] + t[..., None] * lines.directions[:, None]


def _lines_meet(some: Lines, other: Lines) -> FloatArray:
    """Intersections of lines with one other line, (M, 1, 2); NaN if parallel."""
    sine = _cross(some.directions, other.directions)
    sine = np.where(np.abs(sine) <= _PARALLEL, np.nan, sine)
    t = _cross(other.points - some.points, other.directions) / sine
    return (some.points + t[:, None] * some.directions)[:, None]


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross product of vectors of the plane, a number."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


# The boundary of a set
# --------------------------------------------------------------------------------------


class _Run(NamedTuple):
    """Part of a curve that has the set on the same sides all along.

    Attributes:
        start, end: Parameters of its ends.
        left, right: Whether the set lies on that side.
    """

    start: float
    end: float
    left: bool
    right: bool


def outline(
    curves: Sequence[Curve], contains: Contains, size: float
) -> tuple[tuple[Edge, ...], tuple[Curve, ...]]:
    """The boundary of a set that lies on known curves.

    Args:
        curves: They may overlap.
        contains: Whether points (N, 2) belong to the set, (N,).
        size: Of the set [m]. Curves count as touching up to `RELATIVE_TOLERANCE` of
            it; pieces shorter than `RELATIVE_STEP` of it are left out.

    Returns:
        The edges, and the pieces that have the set on neither side.
    """
    step = RELATIVE_STEP * size
    united = _united(curves, RELATIVE_TOLERANCE * size)
    pieces: list[tuple[Curve, float, float]] = []
    for curve, cuts in zip(united, _cuts(united, size), strict=True):
        for start, end in pairwise(cuts):
            if (end - start) * _per_parameter(curve) > step:
                pieces.append((curve, start, end))

    middles = [(curve, (start + end) / 2) for curve, start, end in pieces]
    at = np.array([curve.point(t) for curve, t in middles])
    normal = np.array([curve.left(t) for curve, t in middles])
    left = contains(at + step * normal).tolist()
    right = contains(at - step * normal).tolist()

    runs: dict[Curve, list[_Run]] = {curve: [] for curve in united}
    for (curve, start, end), *sides in zip(pieces, left, right, strict=True):
        runs[curve].append(_Run(start, end, *sides))

    edges: list[Edge] = []
    thin: list[Curve] = []
    for curve, parts in runs.items():
        for run in _joined(parts, curve.closed):
            piece = curve.piece(run.start, run.end)
            if run.left != run.right:
                edges.append(Edge(curve=piece, inside_left=run.left))
            elif not run.left:
                thin.append(piece)
    return tuple(edges), tuple(thin)


def _joined(runs: list[_Run], closed: bool) -> list[_Run]:
    """Neighbouring runs of a curve with the set on the same sides are one."""
    joined: list[_Run] = []
    for run in runs:
        if joined and joined[-1][2:] == run[2:]:
            joined[-1] = joined[-1]._replace(end=run.end)
        else:
            joined.append(run)
    # On a closed curve the last run is the first one's neighbour.
    if closed and len(joined) > 1 and joined[0][2:] == joined[-1][2:]:
        last = joined.pop()
        joined[0] = joined[0]._replace(start=last.start, end=joined[0].end + TURN)
    return joined


def _cuts(curves: list[Curve], size: float) -> list[list[float]]:
    """Ascending parameters at which each curve begins, meets another, and ends."""
    tolerance = RELATIVE_TOLERANCE * size
    cuts = [list(curve.interval) for curve in curves]
    for kind in (Arc, Segment):
        numbers = [i for i, curve in enumerate(curves) if isinstance(curve, kind)]
        if not numbers:
            continue
        paths = _carrier([curves[i] for i in numbers])
        for j, other in enumerate(curves):
            meeting = crossings(paths, other, tolerance)
            for i, points in zip(numbers, meeting, strict=True):
                if i != j:
                    t = curves[i].parameter(points, tolerance)
                    cuts[i] += t[~np.isnan(t)].tolist()

    step = RELATIVE_STEP * size
    return [
        _distinct(sorted(parameters), step / _per_parameter(curve))
        for curve, parameters in zip(curves, cuts, strict=True)
    ]


def _distinct(parameters: list[float], step: float) -> list[float]:
    """Ascending parameters, those closer together than a step replaced by their mean.

    If curves touch, rounding splits one cut into two, some 1e-8 to either side: their
    mean is exact. The ends stay.
    """
    apart = np.flatnonzero(np.diff(parameters) > step) + 1
    means = [math.fsum(group) / len(group) for group in np.split(parameters, apart)]
    return [parameters[0], *means[1:-1], parameters[-1]]


def _united(curves: Sequence[Curve], tolerance: float) -> list[Curve]:
    """The same set of points without any overlap."""
    groups: list[list[Curve]] = []
    for curve in curves:
        for group in groups:
            if _same_carrier(group[0], curve, tolerance):
                group.append(curve)
                break
        else:
            groups.append([curve])

    united: list[Curve] = []
    for members in groups:
        first = members[0]
        slack = tolerance / _per_parameter(first)
        spans = sorted(_span_on(first, member) for member in members)
        for low, high in _merged(spans, slack, isinstance(first, Arc)):
            piece = first.piece(low, high)
            if isinstance(piece, Arc) and piece.span >= TURN - slack:
                piece = replace(piece, span=TURN)
            united.append(piece)
    return united


def _same_carrier(a: Curve, b: Curve, tolerance: float) -> bool:
    """Whether two curves lie on one circle or one line."""
    if isinstance(a, Arc) and isinstance(b, Arc):
        same_center = math.dist(a.center, b.center) <= tolerance
        return same_center and abs(a.radius - b.radius) <= tolerance
    if isinstance(a, Segment) and isinstance(b, Segment):
        off = _carrier([a]).distances(b.point(b.interval))
        return bool((np.abs(off) <= tolerance).all())
    return False


def _span_on(first: Curve, member: Curve) -> tuple[float, float]:
    """Range of a curve in the parameter of another one on the same circle or line."""
    if isinstance(member, Arc):
        start = member.start % TURN
        return start, start + member.span
    assert isinstance(first, Segment)
    ends = member.point(member.interval) - np.asarray(first.start)
    low, high = sorted((ends @ unit_vector(first.angle)).tolist())
    return low, high


def _merged(
    spans: list[tuple[float, float]], slack: float, circular: bool
) -> list[list[float]]:
    """The union of ascending ranges of a parameter, as ranges that do not overlap."""
    merged: list[list[float]] = []
    for low, high in spans:
        if merged and low <= merged[-1][1] + slack:
            merged[-1][1] = max(merged[-1][1], high)
        else:
            merged.append([low, high])

    # On a circle the last range may reach the first ones, a turn later.
    while circular and len(merged) > 1 and merged[-1][1] >= merged[0][0] + TURN - slack:
        merged[-1][1] = max(merged[-1][1], merged[0][1] + TURN)
        del merged[0]
    return merged


def _per_parameter(curve: Curve) -> float:
    """Length per unit of the curve's parameter [m]."""
    return curve.radius if isinstance(curve, Arc) else 1.0
