"""Planar arms, and their exact workspaces: the points that the tip can reach.

Joint j is followed by link j, which leaves along the local x axis. Seen from link j-1
the next link is turned by ``angles[j]``; a revolute joint adds q_j to this angle, a
prismatic joint adds q_j to the length of the link. So ``PlanarArm((5, 4, 1))`` is the
notes' 3R arm, and a prismatic joint is a link of varying length, as they put it.

Without limits on its revolute joints the workspace is a disc, a disc with a hole, or a
circle, in closed form. In general it is built from the tip to the base. Let W' be the
workspace of the arm without its first joint. The first joint sweeps W', so the boundary
of the result is made of

- the boundary of W' with the first joint at either limit, and
- the paths on which the first joint carries the corners of that boundary, and its
  points nearest to and farthest from the pivot, where the joint moves along it.

These are the arm's critical curves: there, the joints that are not at a limit cannot
move the tip in all directions. All are arcs and segments, whose `outline` is the
boundary. A point is in the workspace if its path, seen from the first link, meets the
boundary of W' or runs inside it.

References:
    [Lecture7.1] Describing Robot Arms, section "Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, sections 2.9.1 (three-link planar arm)
        and 2.10.1.
    [Haug1996] Haug, Luh, Adkins, Wang: Numerical algorithms for mapping boundaries of
        manipulator workspaces, J. Mech. Design 118(2), 1996 (boundaries as critical
        curves with joint limits).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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
    listed,
)
from alpha5_model.errors import InputError, MissingParameterError, ShapeError
from alpha5_model.theory.arcs import (
    RELATIVE_TOLERANCE,
    Arc,
    Curve,
    Edge,
    Segment,
    enclosed_area,
    outline,
    turned,
)
from alpha5_model.theory.planar.joint import Joint, Range, extremes


@dataclass(frozen=True)
class PlanarArm:
    """A planar arm, base at the origin.

    Attributes:
        lengths: Link lengths [m]: positive after a revolute joint, zero or more after a
            prismatic one.
        limits: (lower, upper) per joint [rad or m]; None for a revolute joint without
            limits, or for all. A range of a full turn or more counts as None.
        joints: One letter per joint, ``"R"`` or ``"P"``; all revolute by default.
        angles: Constant angle of each link to the one before [rad]; zero by default.

    Raises:
        InputError: No links, a length that is negative or zero, limits the wrong way
            round, an unknown joint type.
        MissingParameterError: A prismatic joint without limits.
    """

    lengths: tuple[float, ...]
    limits: tuple[Range | None, ...] = ()
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
        number = values.size

        kinds = "R" * number if joints is None else joints
        letters = isinstance(kinds, str) and set(kinds) <= {"R", "P"}
        if not letters or len(kinds) != number:
            raise InputError("joints", joints, f"{number} letters R or P, one per link")
        for length, kind in zip(values.tolist(), kinds, strict=True):
            if kind == "R" and length <= 0:
                raise InputError("lengths", length, "a length that is positive")
            if length < 0:
                raise InputError("lengths", length, "a length that is not negative")

        expected = f"one (lower, upper) or None for {number} joints"
        pairs = [None] * number
        if limits is not None:
            pairs = listed("limits", limits, expected)
        if len(pairs) != number:
            raise ShapeError("limits", (len(pairs),), expected)
        given = [0.0] * number if angles is None else angles
        turns = float_array("angles", given, ())
        if turns.shape != (number,):
            raise ShapeError("angles", turns.shape, f"shape ({number},)")

        ranges = [_limits(pair, kind) for pair, kind in zip(pairs, kinds, strict=True)]
        object.__setattr__(self, "lengths", tuple(values.tolist()))
        object.__setattr__(self, "limits", tuple(ranges))
        object.__setattr__(self, "joints", kinds)
        object.__setattr__(self, "angles", tuple(turns.tolist()))
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
        """Sum of the greatest lengths of the links [m].

        No point that the tip reaches is farther from the base.
        """
        reach = 0.0
        rows = zip(self.lengths, self.joints, self.limits, strict=True)
        for length, kind, limit in rows:
            travel = 0.0
            if kind == "P" and limit:
                travel = max(abs(limit[0]), abs(limit[1]))
            reach += length + travel
        return reach

    @property
    def length_ranges(self) -> tuple[Range, ...] | None:
        """Range of the distance from each revolute joint to the next or the tip [m].

        The workspace depends on these ranges alone if the first joint is revolute, no
        revolute joint has limits, and every prismatic joint slides along its link.
        Otherwise this is None.
        """
        # Signed sums: a prismatic joint may slide past the revolute joint before it.
        sums: list[Range] = []
        rows = zip(self.lengths, self.limits, self.joints, self.angles, strict=True)
        for length, limit, kind, angle in rows:
            if kind == "R":
                if limit is not None:
                    return None
                sums.append((0.0, 0.0))
            elif angle != 0.0 or not sums:
                return None
            low, high = limit or (0.0, 0.0)
            least, greatest = sums[-1]
            sums[-1] = least + (length + low), greatest + (length + high)
        return tuple((max(0.0, low, -high), max(-low, high)) for low, high in sums)

    def part(self, start: int, stop: int | None = None) -> PlanarArm:
        """The arm of joints start to stop - 1, in the frame of the link before them.

        Both may be negative, as in a slice.
        """
        try:
            cut = slice(index(start), None if stop is None else index(stop))
        except TypeError:
            raise InputError("start, stop", (start, stop), "whole numbers") from None
        return PlanarArm(
            lengths=self.lengths[cut],
            limits=self.limits[cut],
            joints=self.joints[cut],
            angles=self.angles[cut],
        )

    def poses(self, q: ArrayLike) -> FloatArray:
        """Positions of the base and of every link's end, with the link's direction.

        Args:
            q: (..., N) [rad or m].

        Returns:
            x [m], y [m], orientation [rad]: (..., N + 1, 3); row 0 is the base, the
            last the tip.
        """
        position = bounded("q", float_array("q", q, (self.n,)))
        revolute = np.array([kind == "R" for kind in self.joints])
        turn = np.where(revolute, position, 0.0) + np.array(self.angles)
        heading = np.cumsum(turn, axis=-1)
        length = np.where(revolute, 0.0, position) + np.array(self.lengths)
        out = np.zeros((*position.shape[:-1], self.n + 1, 3))
        out[..., 1:, 0] = np.cumsum(length * np.cos(heading), axis=-1)
        out[..., 1:, 1] = np.cumsum(length * np.sin(heading), axis=-1)
        out[..., 1:, 2] = heading
        return out

    def forward_kinematics(self, q: ArrayLike) -> FloatArray:
        """Tip x, y [m] and orientation [rad], (..., 3), at q (..., N) [rad or m]."""
        return np.ascontiguousarray(self.poses(q)[..., -1, :])

    def workspace(self) -> Workspace:
        """The set of points that the tip reaches, exact up to rounding.

        Features closer together than 1e-7 of the reach are not distinguished.
        """
        return _build(self, self.reach)


def _limits(limit: Any, kind: str) -> Range | None:
    """Limits of one joint; None if there are none, or a revolute joint turns fully."""
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
    turns_fully = kind == "R" and upper - lower >= 2 * math.pi
    return None if turns_fully else (lower, upper)


def joint_of(arm: PlanarArm, j: int) -> Joint:
    """Joint j of an arm, counted from 0, with its link and limits."""
    return Joint(
        revolute=arm.joints[j] == "R",
        angle=arm.angles[j],
        length=arm.lengths[j],
        limit=arm.limits[j],
    )


def annulus(ranges: Sequence[Range]) -> Range:
    """Radii between which a chain of freely turning links reaches.

    The outer radius is the sum of the lengths. The inner radius is the longest length
    minus all others, or 0 if that is negative. If lengths vary, the longest link counts
    with its least length and the others with their greatest: only one link can be
    longer than all others together, so these lengths reach the least radius.

    Args:
        ranges: (least, greatest) length of each link [m].

    Returns:
        Inner and outer radius [m].
    """
    greatest = [high for _, high in ranges]
    outer = math.fsum(greatest)
    inner = max(math.fsum([low, high, *(-x for x in greatest)]) for low, high in ranges)
    return max(0.0, inner), outer


@dataclass(frozen=True, eq=False)
class Workspace:
    """The points that a planar arm's tip reaches.

    Attributes:
        arm: The arm; None for the tip itself, a point.
        edges: Boundary of the two-dimensional part.
        thin: Curves of the workspace with nothing of it on either side, such as the
            whole workspace of a one-joint arm.
        inner: Workspace of the arm without its first joint, in the frame of its first
            link.
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
        """Area [m^2]."""
        return enclosed_area(self.edges)

    @property
    def radii(self) -> tuple[float, float]:
        """Smallest and largest distance from the base [m]."""
        points: list[list[float]] = []
        for curve in self.curves:
            points += extremes(curve, revolute=True, tolerance=_tolerance(self.arm))
        distances = np.linalg.norm(points, axis=1).tolist()
        smallest = 0.0 if self.contains(np.zeros(2)) else min(distances)
        return smallest, max(distances)

    @property
    def shape(self) -> str:
        """Point, interval, arc, circle, disc, annulus or region, in small letters."""
        circles = [isinstance(c, Arc) and c.closed for c in self.curves]
        if self.edges and not self.thin and all(circles):
            # A connected set that is bounded by whole circles: at most two, concentric.
            return "disc" if len(circles) == 1 else "annulus"
        if self.edges or len(self.thin) != 1:
            return "region"

        curve = self.thin[0]
        if isinstance(curve, Segment):
            return "interval"
        if curve.radius == 0:
            return "point"
        return "circle" if curve.closed else "arc"

    def contains(self, points: ArrayLike) -> BoolArray:
        """Whether points can be reached; the boundary counts as inside.

        Args:
            points: (..., 2) [m].

        Returns:
            Booleans, (...).
        """
        p = float_array("points", points, (2,))
        flat = p.reshape(-1, 2)
        tolerance = _tolerance(self.arm)
        reach = self.arm.reach if self.arm else 0.0
        # No point beyond the arm's length is reached, and its square may overflow.
        inside = np.asarray(np.abs(flat).max(axis=1) <= reach + tolerance)
        inside[inside] = _contains(self, flat[inside], tolerance)
        return inside.reshape(p.shape[:-1])


def _build(arm: PlanarArm | None, size: float) -> Workspace:
    """The workspace of an arm; of the tip alone if there is no arm."""
    tolerance = RELATIVE_TOLERANCE * size
    inner = None
    if arm is not None:
        inner = _build(arm.part(1) if arm.n > 1 else None, size)
    bare = Workspace(arm=arm, edges=(), thin=(), inner=inner)
    rings = _rings(arm)
    if rings is not None:
        return _annular(bare, rings, tolerance)

    assert arm is not None
    assert inner is not None
    joint = joint_of(arm, 0)
    critical: list[Curve] = []
    for curve in inner.curves:
        critical += [joint.carried(curve, end) for end in joint.limit or ()]
        critical += joint.swept(curve, tolerance)
    critical = [curve for curve in critical if curve.length > tolerance]

    low, high = joint.limit or (-math.pi, math.pi)
    if low == high or not critical:  # the joint moves nothing
        middle = (low + high) / 2
        edges = [
            Edge(joint.carried(edge.curve, middle), edge.inside_left)
            for edge in inner.edges
        ]
        thin = [joint.carried(curve, middle) for curve in inner.thin]
        return replace(bare, edges=tuple(edges), thin=tuple(thin))

    bounding, hairs = outline(
        critical, lambda points: _contains(bare, points, tolerance), size
    )
    return replace(bare, edges=bounding, thin=hairs)


def _rings(arm: PlanarArm | None) -> Range | None:
    """Radii of a workspace that is an `annulus`; None if it is another set.

    The workspace of the tip alone (no arm) is its origin.
    """
    if arm is None:
        return 0.0, 0.0
    ranges = arm.length_ranges
    return None if ranges is None else annulus(ranges)


def _annular(bare: Workspace, rings: Range, tolerance: float) -> Workspace:
    """A disc, a disc with a hole, or a circle, which may be a point."""
    small, large = (Arc(center=(0.0, 0.0), radius=radius) for radius in rings)
    if large.radius - small.radius <= tolerance:
        return replace(bare, thin=(large,))
    edges = [Edge(curve=large, inside_left=True)]
    if small.radius > tolerance:
        edges.append(Edge(curve=small, inside_left=False))
    return replace(bare, edges=tuple(edges))


def _contains(space: Workspace, p: FloatArray, tolerance: float) -> BoolArray:
    """Whether points (N, 2) are reached, from the boundary of the inner workspace."""
    radius = np.linalg.norm(p, axis=1)
    rings = _rings(space.arm)
    if rings is not None:
        low, high = rings
        return np.asarray((radius >= low - tolerance) & (radius <= high + tolerance))

    arm, inner = space.arm, space.inner
    assert arm is not None
    assert inner is not None
    joint = joint_of(arm, 0)
    slack = np.full_like(radius, tolerance)
    if joint.revolute:
        # As an angle on the circle of the point.
        slack /= np.maximum(radius, tolerance)
    found = np.zeros(len(p), np.bool_)
    for curve in inner.curves:
        q, _ = joint.positions_onto(p, curve, tolerance)
        found |= joint.within_limits(q, slack[:, None]).any(axis=1)

    # A path that never meets the boundary is wholly inside or outside: one position
    # decides.
    rest = np.flatnonzero(~found)
    if rest.size:
        angle, length = joint.link(sum(joint.limit or (0.0, 0.0)) / 2)
        seen = turned(p[rest], -angle) - (length, 0.0)
        found[rest] = _contains(inner, seen, tolerance)
    return found


def _tolerance(arm: PlanarArm | None) -> float:
    """Distance that counts as zero [m]."""
    return RELATIVE_TOLERANCE * (arm.reach if arm is not None else 1.0)
