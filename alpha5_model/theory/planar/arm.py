"""Planar arms: where their links are, and the workspace, where the tip can be, exactly.

Joint j is followed by link j, which leaves along the local x axis. Seen from link j-1 the next link
is turned by ``angles[j]``; a revolute joint adds q_j to this angle, a prismatic joint adds q_j to
the length of the link. So ``PlanarArm((5, 4, 1))`` is the notes' 3R arm, and a prismatic joint is a
link of varying length, as they put it.

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
    [Siciliano2009] Siciliano et al.: Robotics, sections 2.9.1 (three-link planar arm) and 2.10.1.
    [Haug1996] Haug, Luh, Adkins, Wang: Numerical algorithms for mapping boundaries of manipulator
        workspaces, J. Mech. Design 118(2), 1996 (boundaries as critical curves with joint limits).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import index
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    bounded,
    float_array,
    instance,
    listed,
)
from alpha5_model.errors import InputError, MissingParameterError, ShapeError
from alpha5_model.theory.planar.curves import (
    TURN,
    Arc,
    Curve,
    Edge,
    Segment,
    bounds,
    hits,
    turned,
)

#: Distances below this share of the arm's reach count as zero.
RELATIVE_TOLERANCE = 1e-9
#: Step to either side of a critical curve to see which side is inside, as a share of the reach.
RELATIVE_STEP = 1e-7


@dataclass(frozen=True)
class PlanarArm:
    """A planar arm, base at the origin.

    Attributes:
        lengths: Link lengths [m]: positive after a revolute joint, zero or more after a prismatic
            one.
        limits: (lower, upper) per joint [rad or m]; None, for one or all, where a revolute joint
            has no limits. A range of a full turn or more counts as none.
        joints: One letter per joint, ``"R"`` or ``"P"``; all revolute by default.
        angles: Constant angle of each link to the one before [rad]; zero by default.

    Raises:
        InputError: No links, a length that is negative or zero, limits the wrong way round, an
            unknown joint type.
        MissingParameterError: A prismatic joint without limits.
    """

    lengths: tuple[float, ...]
    limits: tuple[tuple[float, float] | None, ...] = ()
    joints: str = ""
    angles: tuple[float, ...] = ()

    def __init__(
        self,
        lengths: ArrayLike,
        limits: Sequence[tuple[float, float] | None] | None = None,
        joints: str | None = None,
        angles: ArrayLike | None = None,
    ) -> None:
        values = float_array("lengths", lengths, ())
        if values.ndim != 1 or values.size == 0:
            raise ShapeError("lengths", values.shape, "shape (N,), at least one link")
        n = values.size
        kinds = "R" * n if joints is None else joints
        if not isinstance(kinds, str) or len(kinds) != n or set(kinds) - {"R", "P"}:
            raise InputError("joints", joints, f"{n} letters R or P, one per link")
        for value, kind in zip(values.tolist(), kinds, strict=True):
            if value <= 0 if kind == "R" else value < 0:
                bound = "positive" if kind == "R" else "not negative"
                raise InputError("lengths", value, f"a length that is {bound}")
        turn = np.zeros(n) if angles is None else float_array("angles", angles, (n,))
        if turn.ndim != 1:
            raise ShapeError("angles", turn.shape, f"shape ({n},)")
        expected = f"one (lower, upper) or None for {n} joints"
        ranges = [None] * n if limits is None else listed("limits", limits, expected)
        if len(ranges) != n:
            raise ShapeError("limits", (len(ranges),), expected)
        checked = tuple(_range(*pair) for pair in zip(ranges, kinds, strict=True))
        object.__setattr__(self, "lengths", tuple(values.tolist()))
        object.__setattr__(self, "limits", checked)
        object.__setattr__(self, "joints", kinds)
        object.__setattr__(self, "angles", tuple(turn.tolist()))
        if not math.isfinite(4 * math.pi * self.reach * self.reach):
            raise InputError(
                "lengths", self.lengths, "an arm whose area is a finite number"
            )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lengths)

    @property
    def reach(self) -> float:
        """No point of the arm is ever farther from the base [m]."""
        rows = zip(self.joints, self.limits, strict=True)
        travel = [max(map(abs, r)) if kind == "P" and r else 0.0 for kind, r in rows]
        return sum(map(sum, zip(self.lengths, travel, strict=True)))

    @property
    def length_ranges(self) -> tuple[tuple[float, float], ...] | None:
        """Range of the distance between one revolute joint and the next (last: to the tip) [m].

        None unless the first joint is revolute, no revolute joint has limits, and every prismatic
        joint slides along its link: then the workspace depends on these ranges only.
        """
        ranges: list[list[float]] = []
        rows = zip(self.lengths, self.limits, self.joints, self.angles, strict=True)
        for length, limit, kind, angle in rows:
            low, high = limit or (0.0, 0.0)
            if limit is not None if kind == "R" else angle != 0.0 or not ranges:
                return None
            if kind == "R":
                ranges.append([0.0, 0.0])
            ranges[-1] = [
                ranges[-1][0] + (length + low),
                ranges[-1][1] + (length + high),
            ]
        return tuple(
            (max(0.0, low, -high), max(-low, high)) for low, high in map(tuple, ranges)
        )

    def part(self, start: int, stop: int | None = None) -> PlanarArm:
        """The arm of joints start to stop - 1 only, in the frame of the link before, as a slice."""
        try:
            cut = slice(index(start), None if stop is None else index(stop))
        except TypeError:
            raise InputError("start, stop", (start, stop), "whole numbers") from None
        return PlanarArm(
            self.lengths[cut], self.limits[cut], self.joints[cut], self.angles[cut]
        )

    def poses(self, q: ArrayLike) -> FloatArray:
        """Base, every link's end, and the direction there.

        Args:
            q: (..., N) [rad or m].

        Returns:
            x [m], y [m], orientation [rad]: (..., N + 1, 3); row 0 is the base, the last the tip.
        """
        position = bounded("q", float_array("q", q, (self.n,)))
        revolute = np.array([kind == "R" for kind in self.joints])
        heading = np.cumsum(
            np.where(revolute, position, 0.0) + np.array(self.angles), axis=-1
        )
        length = np.where(revolute, 0.0, position) + np.array(self.lengths)
        out = np.zeros((*position.shape[:-1], self.n + 1, 3))
        out[..., 1:, 0] = np.cumsum(length * np.cos(heading), axis=-1)
        out[..., 1:, 1] = np.cumsum(length * np.sin(heading), axis=-1)
        out[..., 1:, 2] = heading
        return out

    def forward_kinematics(self, q: ArrayLike) -> FloatArray:
        """Tip x [m], y [m] and orientation [rad], (..., 3), at q (..., N) [rad or m]."""
        return np.ascontiguousarray(self.poses(q)[..., -1, :])

    def jacobian(self, q: ArrayLike) -> FloatArray:
        """Derivative of `forward_kinematics`, (..., 3, N), at q (..., N) [rad or m]."""
        poses = self.poses(q)
        to_tip = poses[..., -1:, :2] - poses[..., :-1, :2]
        heading = poses[..., 1:, 2]
        revolute = np.array([kind == "R" for kind in self.joints])
        out = np.empty((*poses.shape[:-2], 3, self.n))
        out[..., 0, :] = np.where(revolute, -to_tip[..., 1], np.cos(heading))
        out[..., 1, :] = np.where(revolute, to_tip[..., 0], np.sin(heading))
        out[..., 2, :] = revolute
        return out

    def workspace(self) -> Workspace:
        """The set of points that the tip reaches; see `planar.workspace`."""
        return workspace(self)


def within_limits(arm: PlanarArm, joint: int, q: FloatArray, slack: Any) -> BoolArray:
    """Whether positions q of a joint lie in its limits, up to `slack` (broadcast); NaN does not."""
    limit = arm.limits[joint]
    if limit is None:
        return ~np.isnan(q)
    low, high = limit
    over = q - low + slack
    with np.errstate(invalid="ignore"):
        if arm.joints[joint] == "R":
            over = np.mod(over, math.tau)
        return np.asarray((over >= 0.0) & (over <= high - low + 2 * slack))


def _range(limit: Any, kind: str) -> tuple[float, float] | None:
    if limit is None:
        if kind == "P":
            raise MissingParameterError(
                "limits (lower, upper) of each", "a prismatic joint"
            )
        return None
    values = float_array("limits", limit, (2,))
    if values.ndim != 1:
        raise ShapeError("limits", values.shape, "a pair (lower, upper) per joint")
    lower, upper = values.tolist()
    if lower > upper:
        raise InputError("limits", (lower, upper), "lower <= upper")
    return None if kind == "R" and upper - lower >= 2 * math.pi else (lower, upper)


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
        return sum(
            e.curve.area_integral() * (1 if e.inside_left else -1) for e in self.edges
        )

    @property
    def radii(self) -> tuple[float, float]:
        """Smallest and largest distance from the base [m]."""
        points = [
            p for c in self.curves for p in _extremes(c, True, _tolerance(self.arm))
        ]
        distances = np.linalg.norm(points, axis=1).tolist()
        return (0.0 if self.contains(np.zeros(2)) else min(distances)), max(distances)

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

    def contains(self, points: ArrayLike) -> BoolArray:
        """Whether points can be reached; the boundary counts as inside.

        Args:
            points: (..., 2) [m].

        Returns:
            Booleans, (...).
        """
        p = float_array("points", points, (2,))
        tolerance, reach = _tolerance(self.arm), self.arm.reach if self.arm else 0.0
        flat = p.reshape(-1, 2)
        # Farther away than the arm is long no point is reached, and squares may overflow.
        inside = np.asarray(np.abs(flat).max(axis=1) <= reach + tolerance)
        inside[inside] = self._contains(flat[inside], tolerance)
        return inside.reshape(p.shape[:-1])

    def _contains(self, p: FloatArray, tolerance: float) -> BoolArray:
        arm, radius = self.arm, np.linalg.norm(p, axis=1)
        if (rings := _rings(arm)) is not None:
            return np.asarray(
                (radius >= rings[0] - tolerance) & (radius <= rings[1] + tolerance)
            )
        assert arm is not None
        assert self.inner is not None
        slack = np.full_like(radius, tolerance)
        if arm.joints[0] == "R":
            slack /= np.maximum(radius, tolerance)
        found = np.zeros(len(p), np.bool_)
        for q, _ in bring(arm, p, self.inner.curves, tolerance):
            found |= within_limits(arm, 0, q, slack[:, None]).any(axis=1)
        rest = np.flatnonzero(~found)
        if rest.size:
            angle, length = _placed(arm, sum(arm.limits[0] or (0.0, 0.0)) / 2)
            middle = turned(p[rest], -angle) - (length, 0.0)
            found[rest] = self.inner._contains(middle, tolerance)
        return found


def bring(
    arm: PlanarArm, points: FloatArray, curves: Iterable[Curve], tolerance: float
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Positions of the first joint, limits aside, that bring a curve to points.

    Args:
        arm: The arm.
        points: (M, 2) [m].
        curves: As the first joint carries them, in the frame of its link.
        tolerance: [m].

    Yields:
        For each curve q (M, K) [rad or m], and what is brought of the curve, (M, K, 2); NaN where
        nothing can be.
    """
    angle, length = _placed(arm, 0.0)
    # In the frame of link 1 a point runs on a circle about the joint, or along x, backwards in q.
    if arm.joints[0] == "R":
        bearing = np.arctan2(points[:, 1], points[:, 0])[:, None] - angle
        pivot, radius = np.array([[-length, 0.0]]), np.linalg.norm(points, axis=1)
        for curve in curves:
            there = hits(pivot, radius, curve, tolerance)
            yield bearing - np.arctan2(there[..., 1], there[..., 0] + length), there
    else:
        start, along = turned(points, -angle) - (length, 0.0), np.array([[1.0, 0.0]])
        for curve in curves:
            there = hits(start, along, curve, tolerance)
            yield start[:, None, 0] - there[..., 0], there


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
    table = float_array(
        "length_ranges", listed("length_ranges", length_ranges, pairs), (2,)
    )
    if table.ndim != 2 or not len(table):
        raise ShapeError("length_ranges", table.shape, pairs)
    ranges = bounded("length_ranges", table).tolist()
    outer = math.fsum(high for _, high in ranges)
    inner = max(math.fsum([low, high, *-table[:, 1]]) for low, high in ranges)
    return max(0.0, inner), outer


def _rings(arm: PlanarArm | None) -> tuple[float, float] | None:
    """Radii of the only boundary, None if there is another: of the tip itself or of an `annulus`."""
    ranges = () if arm is None else arm.length_ranges
    return annulus(ranges) if ranges else None if ranges is None else (0.0, 0.0)


def _build(arm: PlanarArm | None, tolerance: float, step: float) -> Workspace:
    shorter = arm.part(1) if arm is not None and arm.n > 1 else None
    inner = None if arm is None else _build(shorter, tolerance, step)
    if (rings := _rings(arm)) is not None:
        small, large = (Arc((0.0, 0.0), radius) for radius in rings)
        if large.radius - small.radius <= tolerance:  # a point, if it is too small
            return Workspace(arm, (), (large,), inner)
        hole = (Edge(small, False),) if small.radius > tolerance else ()
        return Workspace(arm, (Edge(large, True), *hole), (), inner)
    assert arm is not None
    assert inner is not None
    limit, angle = arm.limits[0], arm.angles[0]
    revolute = arm.joints[0] == "R"
    if limit is not None and limit[0] == limit[1]:  # a locked joint moves nothing
        edges = tuple(
            Edge(_carried(e.curve, arm, limit[0]), e.inside_left) for e in inner.edges
        )
        thin = tuple(_carried(curve, arm, limit[0]) for curve in inner.thin)
        return Workspace(arm, edges, thin, inner)
    candidates, (low, high) = list[Curve](), limit or (0.0, TURN)
    for curve in inner.curves:
        candidates += [_carried(curve, arm, q) for q in limit or ()]
        zero = curve.moved(0.0, (arm.lengths[0], 0.0))
        for x, y in _extremes(zero, revolute, tolerance):
            if revolute:
                start = math.atan2(y, x) + angle + low
                candidates.append(Arc((0.0, 0.0), math.hypot(x, y), start, high - low))
            else:
                travel = Segment((x + low, y), 0.0, high - low)
                candidates.append(travel.moved(angle, (0.0, 0.0)))
    critical = [c for c in candidates if c.length > tolerance]
    raw = Workspace(arm, (), (), inner)
    edges, thin = bounds(
        critical, lambda p: raw._contains(p, tolerance), tolerance, step
    )
    return replace(raw, edges=edges, thin=thin)


def _carried(curve: Curve, arm: PlanarArm, q: float) -> Curve:
    """A curve of the arm without its first joint, seen from the base with that joint at q."""
    angle, length = _placed(arm, q)
    return curve.moved(angle, (length, 0.0))


def _placed(arm: PlanarArm, q: float) -> tuple[float, float]:
    """Direction and length of link 1."""
    turn, shift = (q, 0.0) if arm.joints[0] == "R" else (0.0, q)
    return arm.angles[0] + turn, arm.lengths[0] + shift


def _extremes(curve: Curve, revolute: bool, tolerance: float) -> list[list[float]]:
    """Ends, and where the joint at the origin (turning, or sliding along x) moves along the curve."""
    points = np.empty((0, 2))
    if isinstance(curve, Segment):
        normal = curve.left(0.0)
        if revolute:
            points = (normal @ np.asarray(curve.start) * normal)[None]
    elif not revolute or math.hypot(*curve.center) > tolerance:
        bearing = (
            math.atan2(curve.center[1], curve.center[0]) if revolute else math.pi / 2
        )
        points = curve.point([bearing, bearing + math.pi])
    on = ~np.isnan(curve.parameter(points, tolerance))
    return [*points[on].tolist(), *curve.point(curve.interval).tolist()]


def _tolerance(arm: PlanarArm | None) -> float:
    return RELATIVE_TOLERANCE * (arm.reach if arm is not None else 1.0)
