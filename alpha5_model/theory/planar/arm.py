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
move the tip in all directions. All are arcs and segments. They are cut where they meet,
and a piece belongs to the boundary if the workspace lies on one side of it only. A
point is in the workspace if its path, seen from the first link, meets the boundary of
W' or runs inside it.

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
    instance,
)
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.theory.planar.annuli import annulus
from alpha5_model.theory.planar.arm_arguments import (
    Range,
    check_lengths,
    checked_angles,
    checked_joints,
    checked_limits,
)
from alpha5_model.theory.planar.boundary import bounds
from alpha5_model.theory.planar.curves import Arc, Curve, Edge, Segment, turned
from alpha5_model.theory.planar.first_joint import FirstJoint, extremes

#: Distances below this share of the arm's reach count as zero.
RELATIVE_TOLERANCE = 1e-9
#: Step to either side of a critical curve to see which side is inside, as a share of
#: the reach.
RELATIVE_STEP = 1e-7


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
        kinds = checked_joints(joints, values.size)
        check_lengths(values.tolist(), kinds)
        turns = checked_angles(angles, values.size)
        ranges = checked_limits(limits, kinds)
        object.__setattr__(self, "lengths", tuple(values.tolist()))
        object.__setattr__(self, "limits", ranges)
        object.__setattr__(self, "joints", kinds)
        object.__setattr__(self, "angles", turns)
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
        for length, kind, limit in zip(
            self.lengths, self.joints, self.limits, strict=True
        ):
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


def first_joint_of(arm: PlanarArm) -> FirstJoint:
    """The first joint of an arm, with its link and limits."""
    return FirstJoint(
        revolute=arm.joints[0] == "R",
        angle=arm.angles[0],
        length=arm.lengths[0],
        limit=arm.limits[0],
    )


def within_limits(arm: PlanarArm, joint: int, q: FloatArray, slack: Any) -> BoolArray:
    """Whether positions of a joint are within its limits.

    Args:
        arm: The arm.
        joint: Index of the joint.
        q: Positions (...) [rad or m]; NaN is not within.
        slack: Beyond a limit by at most this counts as within; broadcasts against q.

    Returns:
        (...) bool.
    """
    limit = arm.limits[joint]
    if limit is None:
        return ~np.isnan(q)
    low, high = limit
    over = q - low + slack
    with np.errstate(invalid="ignore"):
        if arm.joints[joint] == "R":
            over = np.mod(over, math.tau)
        return np.asarray((over >= 0.0) & (over <= high - low + 2 * slack))


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
        """Area [m^2], by Green's theorem over the boundary."""
        parts = [
            edge.curve.area_integral() * (1 if edge.inside_left else -1)
            for edge in self.edges
        ]
        return sum(parts)

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
        inside[inside] = self._contains(flat[inside], tolerance)
        return inside.reshape(p.shape[:-1])

    def _contains(self, p: FloatArray, tolerance: float) -> BoolArray:
        radius = np.linalg.norm(p, axis=1)
        rings = _rings(self.arm)
        if rings is not None:
            low, high = rings
            return np.asarray(
                (radius >= low - tolerance) & (radius <= high + tolerance)
            )

        arm, inner = self.arm, self.inner
        assert arm is not None
        assert inner is not None
        slack = np.full_like(radius, tolerance)
        if arm.joints[0] == "R":
            # As an angle on the circle of the point.
            slack /= np.maximum(radius, tolerance)
        found = np.zeros(len(p), np.bool_)
        for q, _ in first_joint_of(arm).positions_onto(p, inner.curves, tolerance):
            found |= within_limits(arm, 0, q, slack[:, None]).any(axis=1)

        # A path that never meets the boundary is wholly inside or outside: one position
        # decides.
        rest = np.flatnonzero(~found)
        if rest.size:
            middle = sum(arm.limits[0] or (0.0, 0.0)) / 2
            angle, length = first_joint_of(arm).link(middle)
            seen = turned(p[rest], -angle) - (length, 0.0)
            found[rest] = inner._contains(seen, tolerance)
        return found


def workspace(arm: PlanarArm) -> Workspace:
    """The workspace of a planar arm, exact up to rounding.

    Features closer together than 1e-7 of the reach are not distinguished.
    """
    scale = instance("arm", arm, PlanarArm).reach
    return _build(arm, RELATIVE_TOLERANCE * scale, RELATIVE_STEP * scale)


def _rings(arm: PlanarArm | None) -> Range | None:
    """Radii of a workspace that is an `annulus`; None if it is another set.

    The workspace of the tip alone (no arm) is its origin.
    """
    if arm is None:
        return 0.0, 0.0
    ranges = arm.length_ranges
    return None if ranges is None else annulus(ranges)


def _build(arm: PlanarArm | None, tolerance: float, step: float) -> Workspace:
    """The workspace of an arm; of the tip alone if there is no arm."""
    inner = None
    if arm is not None:
        shorter = arm.part(1) if arm.n > 1 else None
        inner = _build(shorter, tolerance, step)
    rings = _rings(arm)
    if rings is not None:
        return _annular(arm, inner, rings, tolerance)

    assert arm is not None
    assert inner is not None
    limit = arm.limits[0]
    if limit is not None and limit[0] == limit[1]:
        return _with_locked_joint(arm, inner, limit[0])
    critical = [c for c in _critical(arm, inner, tolerance) if c.length > tolerance]
    bare = Workspace(arm=arm, edges=(), thin=(), inner=inner)
    edges, thin = bounds(
        critical, lambda points: bare._contains(points, tolerance), tolerance, step
    )
    return replace(bare, edges=edges, thin=thin)


def _annular(
    arm: PlanarArm | None, inner: Workspace | None, rings: Range, tolerance: float
) -> Workspace:
    """A disc, a disc with a hole, or a circle, which may be a point."""
    small = Arc(center=(0.0, 0.0), radius=rings[0])
    large = Arc(center=(0.0, 0.0), radius=rings[1])
    if large.radius - small.radius <= tolerance:
        return Workspace(arm=arm, edges=(), thin=(large,), inner=inner)
    edges = [Edge(curve=large, inside_left=True)]
    if small.radius > tolerance:
        edges.append(Edge(curve=small, inside_left=False))
    return Workspace(arm=arm, edges=tuple(edges), thin=(), inner=inner)


def _with_locked_joint(arm: PlanarArm, inner: Workspace, q: float) -> Workspace:
    """The inner workspace, carried by a first joint that stays at q."""
    joint = first_joint_of(arm)
    edges = [
        Edge(curve=joint.carried(edge.curve, q), inside_left=edge.inside_left)
        for edge in inner.edges
    ]
    thin = [joint.carried(curve, q) for curve in inner.thin]
    return Workspace(arm=arm, edges=tuple(edges), thin=tuple(thin), inner=inner)


def _critical(arm: PlanarArm, inner: Workspace, tolerance: float) -> list[Curve]:
    """The critical curves of an arm, from those of the arm without its first joint."""
    joint = first_joint_of(arm)
    found: list[Curve] = []
    for curve in inner.curves:
        found += [joint.carried(curve, end) for end in joint.limit or ()]
        found += joint.swept(curve, tolerance)
    return found


def _tolerance(arm: PlanarArm | None) -> float:
    """Distance that counts as zero [m]."""
    return RELATIVE_TOLERANCE * (arm.reach if arm is not None else 1.0)
