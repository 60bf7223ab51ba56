"""The workspace of a planar arm: where its tip can be, exactly.

Without limits on its revolute joints the workspace is a disc, a disc with a hole, or a circle, in
closed form. In general it is built from the tip to the base. Let W' be the workspace of the arm
without its first joint. The first joint sweeps W', so the boundary of the result is made of

- the boundary of W' with the first joint at either limit, and
- the paths on which the first joint carries those points of that boundary where it moves along it
  (the boundary's nearest and farthest points from the pivot), and its corners.

These are the arm's critical curves: the configurations where the joints that are not at a limit
cannot move the tip in all directions. All are arcs and segments. They are cut where they meet, and
a piece belongs to the boundary if the workspace lies on one side of it only. A point is in the
workspace if its path, seen from the first link, meets the boundary of W' or runs inside it.

References:
    [Lecture7.1] Describing Robot Arms, section "Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.10.1.
    [Haug1996] Haug, Luh, Adkins, Wang: Numerical algorithms for mapping boundaries of manipulator
        workspaces, J. Mech. Design 118(2), 1996 (boundaries as critical curves with joint limits).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array, instance, listed
from alpha5_model.errors import ShapeError
from alpha5_model.planar.arrangement import Edge, bounds
from alpha5_model.planar.curves import TURN, Arc, Curve, Segment, circle_hits, line_hits
from alpha5_model.planar.linkage import Linkage, within_limits

#: Distances below this share of the arm's reach count as zero.
RELATIVE_TOLERANCE = 1e-9
#: Step to either side of a critical curve to see which side is inside, as a share of the reach.
RELATIVE_STEP = 1e-7


@dataclass(frozen=True, eq=False)
class Workspace:
    """The points that a planar arm's tip reaches.

    Attributes:
        arm: The arm; None for the tip itself, a point.
        edges: Boundary of the two-dimensional part.
        thin: Curves that belong to the workspace and have nothing on either side, as the whole
            workspace of a one-joint arm.
        inner: Workspace of the arm without its first joint, in the frame of its first link.
    """

    arm: PlanarArm | None
    edges: tuple[Edge, ...]
    thin: tuple[Curve, ...]
    inner: Workspace | None

    @property
    def curves(self) -> tuple[Curve, ...]:
        """All boundary curves, thin ones included."""
        return (*(edge.curve for edge in self.edges), *self.thin)

    @property
    def area(self) -> float:
        """Area [m^2], by Green's theorem over the boundary."""
        return sum(e.curve.area_integral() * (1 if e.inside_left else -1) for e in self.edges)

    @property
    def radii(self) -> tuple[float, float]:
        """Smallest and largest distance from the base [m]."""
        tolerance = _tolerance(self.arm)
        distances: list[float] = []
        for curve in self.curves:
            ends = curve.point(np.array(curve.interval))
            distances += np.linalg.norm(ends, axis=-1).tolist()
            distances += [math.hypot(*p) for p in _tangent_points(curve, True, tolerance)]
        inside = bool(self.contains(np.zeros(2)))
        return (0.0 if inside else min(distances)), max(distances)

    @property
    def shape(self) -> str:
        """``point``, ``interval``, ``arc``, ``circle``, ``disc``, ``annulus`` or ``region``."""
        full = [isinstance(c, Arc) and c.closed for c in self.curves]
        if self.edges and not self.thin and all(full):
            # Of one piece and bounded by whole circles only: these are concentric, and two at most.
            return "disc" if len(full) == 1 else "annulus"
        if not self.edges and len(self.thin) == 1:
            curve = self.thin[0]
            if isinstance(curve, Segment):
                return "interval"
            return "point" if curve.radius == 0 else "circle" if curve.closed else "arc"
        return "region"

    def contains(self, points: ArrayLike) -> np.ndarray:
        """Whether points can be reached; the boundary counts as inside.

        Args:
            points: (..., 2) [m].

        Returns:
            Booleans, (...).
        """
        p = float_array("points", points, (2,))
        tolerance = _tolerance(self.arm)
        flat = p.reshape(-1, 2)
        # Farther away than the arm is long no point is reached, and squares may overflow.
        inside: np.ndarray = (
            np.abs(flat).max(axis=1) <= (self.arm.reach if self.arm else 0.0) + tolerance
        )
        inside[inside] = self._contains(flat[inside], tolerance)
        return inside.reshape(p.shape[:-1])

    def _contains(self, p: FloatArray, tolerance: float) -> np.ndarray:
        arm = self.arm
        if arm is None:
            return np.asarray(np.linalg.norm(p, axis=1) <= tolerance)
        ranges = arm.length_ranges
        if ranges is not None:
            low, high = annulus(ranges)
            r = np.linalg.norm(p, axis=1)
            return np.asarray((r >= low - tolerance) & (r <= high + tolerance))
        assert self.inner is not None
        length, angle = arm.lengths[0], arm.angles[0]
        half_way = sum(arm.limits[0] or (0.0, 0.0)) / 2
        found = np.zeros(len(p), dtype=bool)
        if arm.joints[0] == "R":
            # In the frame of link 1 the target runs on a circle about the pivot, backwards in q.
            radius, bearing = np.linalg.norm(p, axis=1), np.arctan2(p[:, 1], p[:, 0]) - angle
            pivot = np.array([-length, 0.0])
            centers = np.broadcast_to(pivot, p.shape)
            slack = tolerance / np.maximum(radius, tolerance)
            for curve in self.inner.curves:
                hits = circle_hits(centers, radius, curve, tolerance) - pivot
                q = bearing[:, None] - np.arctan2(hits[..., 1], hits[..., 0])
                found |= within_limits(arm, 0, q, slack[:, None]).any(axis=1)
            phi = bearing - half_way
            middle = pivot + radius[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
        else:
            # It runs along a straight line, backwards along x.
            c, s = math.cos(angle), math.sin(angle)
            start = p @ np.array([[c, -s], [s, c]]) - (length, 0.0)
            along = np.broadcast_to((1.0, 0.0), p.shape)
            for curve in self.inner.curves:
                q = start[:, None, 0] - line_hits(start, along, curve, tolerance)[..., 0]
                found |= within_limits(arm, 0, q, tolerance).any(axis=1)
            middle = start - (half_way, 0.0)
        rest = np.flatnonzero(~found)
        if rest.size:
            found[rest] = self.inner._contains(middle[rest], tolerance)
        return found


class PlanarArm(Linkage):
    """A planar arm: `Linkage`, and its workspace."""

    def workspace(self) -> Workspace:
        """The set of points that the tip reaches; see `planar.workspace`."""
        return workspace(self)


def workspace(arm: PlanarArm) -> Workspace:
    """The workspace of a planar arm, exact up to rounding.

    Features closer together than 1e-7 of the reach are not told apart.
    """
    scale = instance("arm", arm, PlanarArm).reach
    return _build(arm, RELATIVE_TOLERANCE * scale, RELATIVE_STEP * scale)


def annulus(length_ranges: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Radii between which a chain of freely turning links reaches.

    The outer radius is the sum of the lengths, the inner one the longest less all others, if that
    is positive. With lengths that vary: the longest at its least, the others at their greatest;
    only one link can exceed the sum of the others, so no choice of lengths does better.

    Args:
        length_ranges: (least, greatest) length of each link [m].

    Returns:
        Inner and outer radius [m].
    """
    pairs = "(least, greatest) length of each link"
    table = float_array("length_ranges", listed("length_ranges", length_ranges, pairs), (2,))
    if table.ndim != 2 or not len(table):
        raise ShapeError("length_ranges", table.shape, pairs)
    ranges = table.tolist()
    outer = math.fsum(high for _, high in ranges)
    inner = max(
        low - math.fsum(r[1] for k, r in enumerate(ranges) if k != j)
        for j, (low, _) in enumerate(ranges)
    )
    return max(0.0, inner), outer


def _build(arm: PlanarArm | None, tolerance: float, step: float) -> Workspace:
    if arm is None:
        return Workspace(None, (), (Arc((0.0, 0.0), 0.0),), None)
    inner = _build(arm.part(1) if arm.n > 1 else None, tolerance, step)
    ranges = arm.length_ranges
    if ranges is not None:
        low, high = annulus(ranges)
        if high - low <= tolerance:  # a point, if high is too small
            return Workspace(arm, (), (Arc((0.0, 0.0), high),), inner)
        circles = [Edge(Arc((0.0, 0.0), high), True)]
        if low > tolerance:
            circles.append(Edge(Arc((0.0, 0.0), low), False))
        return Workspace(arm, tuple(circles), (), inner)
    limit, angle = arm.limits[0], arm.angles[0]
    revolute = arm.joints[0] == "R"
    if limit is not None and limit[0] == limit[1]:  # a locked joint moves nothing
        edges = tuple(Edge(_carried(e.curve, arm, limit[0]), e.inside_left) for e in inner.edges)
        thin = tuple(_carried(curve, arm, limit[0]) for curve in inner.thin)
        return Workspace(arm, edges, thin, inner)
    candidates: list[Curve] = []
    for curve in inner.curves:
        candidates += [_carried(curve, arm, q) for q in limit or ()]
        zero = curve.moved(0.0, (arm.lengths[0], 0.0))
        points = _tangent_points(zero, revolute, tolerance)
        points += zero.point(np.array(zero.interval)).tolist()
        for x, y in points:
            if revolute:
                low, high = limit or (0.0, TURN)
                start = math.atan2(y, x) + angle + low
                candidates.append(Arc((0.0, 0.0), math.hypot(x, y), start, high - low))
            else:
                assert limit is not None
                travel = Segment((x + limit[0], y), 0.0, limit[1] - limit[0])
                candidates.append(travel.moved(angle, (0.0, 0.0)))
    critical = [c for c in candidates if c.length > tolerance]
    raw = Workspace(arm, (), (), inner)
    edges, thin = bounds(critical, lambda p: raw._contains(p, tolerance), tolerance, step)
    return replace(raw, edges=edges, thin=thin)


def _carried(curve: Curve, arm: PlanarArm, q: float) -> Curve:
    """A curve of the arm without its first joint, seen from the base with that joint at q."""
    revolute = arm.joints[0] == "R"
    turn, shift = (q, 0.0) if revolute else (0.0, q)
    return curve.moved(arm.angles[0] + turn, (arm.lengths[0] + shift, 0.0))


def _tangent_points(curve: Curve, revolute: bool, tolerance: float) -> list[list[float]]:
    """Where the joint at the origin (turning, or sliding along x) moves along the curve."""
    if isinstance(curve, Arc):
        bearing = math.atan2(curve.center[1], curve.center[0]) if revolute else math.pi / 2
        if revolute and math.hypot(*curve.center) <= tolerance:
            return []
        points = curve.point(np.array([bearing, bearing + math.pi]))
    elif revolute:
        normal = curve.left(0.0)
        points = (normal @ np.asarray(curve.start) * normal)[None]
    else:
        return []
    on = ~np.isnan(curve.parameter(points, tolerance))
    return [p for p, keep in zip(points.tolist(), on, strict=True) if keep]


def _tolerance(arm: PlanarArm | None) -> float:
    return RELATIVE_TOLERANCE * (arm.reach if arm is not None else 1.0)
