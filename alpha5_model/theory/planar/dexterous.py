"""The dexterous workspace of planar arms, and the lecture notes' theorem.

Without joint limits it is exact; the documentation of `alpha5_model.theory.planar`
derives the conditions. With limits, orientations are tried.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    count,
    float_array,
    instance,
    real,
)
from alpha5_model.errors import InputError
from alpha5_model.theory.arcs import TURN, Arc, Curve, Segment, turned
from alpha5_model.theory.planar.arm import PlanarArm, annulus, joint_of

#: Lengths that differ by less than this share of their sum count as equal; all
#: conditions hold with equality.
ROUNDING = 1e-14
#: Distance, as a share of the reach, and angle [rad] that count as zero.
_TOLERANCE = 1e-9
#: Points that outline each boundary curve of a map.
_OUTLINE = 181


# Without joint limits
# --------------------------------------------------------------------------------------


def _pinned(arm: PlanarArm) -> tuple[float, float, float, float]:
    """Radii that the arm without its last link reaches, and that link's range [m].

    Raises:
        InputError: An arm whose dexterous workspace is not a set of radii.
    """
    ranges = instance("arm", arm, PlanarArm).length_ranges
    if ranges is None:
        raise InputError(
            "arm",
            arm,
            "revolute joints without limits, the first joint one of them, and "
            "prismatic joints along their links (planar.dexterity takes any arm)",
        )
    low, high = annulus(ranges[:-1]) if len(ranges) > 1 else (0.0, 0.0)
    return low, high, *ranges[-1]


def turns_fully(arm: PlanarArm, radius: float) -> bool:
    """Whether the last link turns fully with the tip pinned at a radius, exactly.

    The arm may have any number of revolute joints without limits, and prismatic joints
    along their links. If the last link's length varies, every orientation may use its
    own length.

    Args:
        arm: The arm; see `dexterous_radii`.
        radius: Distance of the tip from the base [m].
    """
    low, high, short, long = _pinned(arm)
    slack = ROUNDING * (high + long)
    r = real("radius", radius, 0.0)
    # The two worst orientations: the wrist beyond the tip, and between tip and base.
    farthest = r + short
    nearest = max(abs(r - short), abs(r - long))
    return farthest <= high + slack and nearest >= low - slack


def dexterous_radii(arm: PlanarArm) -> tuple[tuple[float, float], ...]:
    """The dexterous workspace as intervals of distance from the base, exact.

    Args:
        arm: First joint revolute, no revolute joint with limits, prismatic joints along
            their links.

    Returns:
        Closed intervals (least, greatest) [m], ascending, disjoint; one of zero width
        is an isolated circle, or the base itself. Empty if there is no dexterous point.

    Raises:
        InputError: An arm whose dexterous workspace is not a set of radii; `dexterity`
            takes any.
    """
    low, high, short, long = _pinned(arm)
    slack = ROUNDING * (high + long)
    limit = high - short
    if limit < -slack:
        return ()
    limit = max(limit, 0.0)

    # max(|r - short|, |r - long|) >= low leaves out an open interval of r.
    gap_start = long - low
    gap_end = short + low
    if gap_start >= gap_end:
        return ((0.0, limit),)
    radii = []
    if gap_start >= -slack:
        radii.append((0.0, min(max(gap_start, 0.0), limit)))
    if gap_end <= limit + slack:
        radii.append((min(gap_end, limit), limit))
    return tuple(radii)


def dexterous_area(arm: PlanarArm) -> float:
    """Area of the dexterous workspace [m^2]; zero if it is only circles and points."""
    return math.fsum(math.pi * (high**2 - low**2) for low, high in dexterous_radii(arm))


# The notes' conditions and theorem
# --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Conditions:
    """Necessary conditions for a dexterous workspace with an interior.

    Attributes:
        satisfied: Whether all hold.
        reasons: One sentence for each condition that fails; empty if satisfied.
    """

    satisfied: bool
    reasons: tuple[str, ...]


def necessary_conditions(arm: PlanarArm) -> Conditions:
    """Necessary conditions for a dexterous workspace with an interior, for planar arms.

    The ranges of the revolute joints must add up to a full turn, since the orientation
    is the sum of their angles. Two more joints must place the end effector. The notes
    have another first condition, a revolute joint without limits. It is not necessary:
    with +-2.967 rad on every joint the notes' arm (5, 4, 1) has a dexterous workspace
    of 155.8. (`alpha5_model.audit` estimates it from random points.) The conditions
    concern the interior: a 2R arm of equal lengths reaches its own base with every
    orientation, which is a single point. They are not sufficient.
    """
    turn = 0.0
    limits = instance("arm", arm, PlanarArm).limits
    for kind, limit in zip(arm.joints, limits, strict=True):
        if kind == "R":
            turn += math.inf if limit is None else limit[1] - limit[0]

    reasons = []
    if turn < math.tau * (1 - ROUNDING):
        reasons.append(
            f"the revolute joints together turn {turn:.4g} rad, less than 2 pi: "
            "not every orientation occurs"
        )
    if arm.n < 3:
        reasons.append(
            f"{arm.n - 1} more, beside it, where placing the end effector takes two"
        )
    return Conditions(satisfied=not reasons, reasons=tuple(reasons))


@dataclass(frozen=True)
class TheoremRow:
    """A row of the notes' experiment.

    Attributes:
        l_4: Distance of the pinned tip from the base.
        pair: Sum of the two shortest of l_1, l_2, l_4: the smallest l_i + l_j of the
            theorem.
        half: Half the sum of all four lengths, L/2; the notes' column is headed l_4/2.
        theorem: Whether the theorem holds.
        exact: Whether the last link turns fully.
    """

    l_4: float
    pair: float
    half: float
    theorem: bool
    exact: bool


def lecture_theorem(l_1: float, l_2: float, l_3: float, l_4: float) -> bool:
    """The notes' theorem to the letter: ``l_i + l_j >= L/2`` for all i, j in {1, 2, 4}.

    It promises that l_3 can turn by 2 pi while the tip is pinned at distance l_4 from
    the base. The condition is sufficient, not necessary; see `turns_fully`. i and j are
    different: with i = j the notes' own rows from 9 to 2 would fail.

    Args:
        l_1, l_2, l_3: Link lengths, base to tip, positive.
        l_4: Distance of the tip from the base, not negative.
    """
    return theorem_row(l_1, l_2, l_3, l_4).theorem


def theorem_row(l_1: float, l_2: float, l_3: float, l_4: float) -> TheoremRow:
    """Both sides of the theorem, its verdict and the exact one.

    See `lecture_theorem`.
    """
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    fourth = real("l_4", l_4, 0.0)
    pair = sum(sorted((first, second, fourth))[:2])
    half = (first + second + third + fourth) / 2
    return TheoremRow(
        l_4=fourth,
        pair=pair,
        half=half,
        theorem=pair >= half * (1 - ROUNDING),
        exact=turns_fully(PlanarArm((first, second, third)), fourth),
    )


def theorem_radii(l_1: float, l_2: float, l_3: float) -> tuple[float, float] | None:
    """The range of l_4 for which the theorem holds.

    It is ``|l_1 - l_2| + l_3 <= l_4 <= l_1 + l_2 - l_3``.

    Returns:
        Least and greatest l_4, or None if there is none.
    """
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    low = abs(first - second) + third
    high = first + second - third
    return (low, max(low, high)) if low <= high + ROUNDING * low else None


def _lengths(**lengths: float) -> list[float]:
    """Link lengths, each positive."""
    return [real(name, length, 0.0, strict=True) for name, length in lengths.items()]


# With joint limits
# --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class DexterityMap:
    """Dexterity over a square grid on the workspace's bounding box.

    Attributes:
        x, y: Grid lines, (I,) and (J,) [m].
        share: Share of orientations reached at (x[i], y[j]), (J, I); 0 outside the
            workspace.
        spacing: Distance between grid lines [m].
        orientations: Number of orientations tried: gaps narrower than 2 pi /
            orientations can be missed.
    """

    x: FloatArray
    y: FloatArray
    share: FloatArray
    spacing: float
    orientations: int

    @property
    def area(self) -> float:
        """Area of the dexterous workspace, in whole grid squares [m^2]."""
        return float((self.share == 1).sum()) * self.spacing**2


def dexterity_map(
    arm: PlanarArm, resolution: int = 81, orientations: int = 120, samples: int = 31
) -> DexterityMap:
    """Dexterity over the whole workspace.

    Args:
        arm: See `dexterity`.
        resolution: Grid lines along the longer side of the workspace's bounding box, 2
            or more.
        orientations, samples: See `dexterity`.
    """
    if count("resolution", resolution) < 2:
        raise InputError("resolution", resolution, "at least 2 grid lines")
    space = instance("arm", arm, PlanarArm).workspace()
    outlines = [
        curve.point(np.linspace(*curve.interval, _OUTLINE)) for curve in space.curves
    ]
    corners = np.concatenate(outlines)
    low = corners.min(axis=0)
    high = corners.max(axis=0)
    spacing = float((high - low).max()) / (resolution - 1)
    x = np.arange(low[0], high[0] + spacing, spacing)
    y = np.arange(low[1], high[1] + spacing, spacing)

    grid = np.stack(np.meshgrid(x, y), axis=-1)
    inside = space.contains(grid)
    share = np.zeros(inside.shape)
    share[inside] = dexterity(arm, grid[inside], orientations, samples)
    return DexterityMap(
        x=x, y=y, share=share, spacing=spacing, orientations=orientations
    )


def dexterity(
    arm: PlanarArm, points: ArrayLike, orientations: int = 360, samples: int = 181
) -> FloatArray:
    """Share of orientations with which points are reached within the joint limits.

    Evenly spaced orientations are tried. For each, the last three joints are solved in
    closed form; joints before them are sampled evenly from limit to limit. A point
    counts as dexterous if the share is 1. A range of orientations narrower than 2 pi /
    orientations can be missed, and with more than three joints some orientations are
    missed near the boundary.

    Args:
        arm: Three joints or more, the last one revolute.
        points: (..., 2) [m].
        orientations: Number of orientations.
        samples: Number of positions of each joint before the last three.

    Returns:
        0 to 1, (...).

    Raises:
        InputError: Fewer than three joints, or a last joint that slides.
    """
    p = float_array("points", points, (2,))
    if instance("arm", arm, PlanarArm).n < 3 or arm.joints[-1] != "R":
        raise InputError("arm", arm.joints, "three joints or more, the last one R")
    orientations = count("orientations", orientations)
    samples = count("samples", samples)
    flat = p.reshape(-1, 2)
    # No point beyond the arm's length is reached, and its square may overflow.
    near = np.abs(flat).max(axis=1) <= (1 + 1e-8) * arm.reach
    phi = np.arange(orientations) * (TURN / orientations)
    last_link = arm.lengths[-1] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    wrist = flat[near, None, :] - last_link

    found = np.zeros((len(flat), orientations), dtype=bool)
    tail = arm.part(arm.n - 3)
    for x, y, heading in _sampled_starts(arm, samples):
        seen = turned(wrist - (x, y), -heading)
        found[near] |= _three_joints_reach(tail, seen, phi - heading)
    return np.asarray(found.mean(axis=1).reshape(p.shape[:-1]))


def _sampled_starts(arm: PlanarArm, samples: int) -> FloatArray:
    """Poses of the link before the last three joints, (K, 3)."""
    head = arm.n - 3
    if head == 0:
        return np.zeros((1, 3))
    axes = [
        np.linspace(*(limit or (-math.pi, math.pi)), samples)
        for limit in arm.limits[:head]
    ]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, head)
    return arm.part(0, head).forward_kinematics(q)


def _three_joints_reach(
    arm: PlanarArm, wrist: FloatArray, phi: FloatArray
) -> BoolArray:
    """Whether three joints reach poses, (M, K) bool.

    Args:
        arm: The arm of three joints.
        wrist: Where joint 3 has to be, (M, K, 2) [m]: joints 1 and 2 bring it there.
        phi: Direction of the last link, (K,) [rad].
    """
    joints = [joint_of(arm, j) for j in range(3)]
    first, second, _ = joints
    # Where the second joint carries the end of its link, in the frame of link 1.
    path: Curve = Arc(center=(0.0, 0.0), radius=second.length)
    if not second.revolute:
        low, high = second.limit or (0.0, 0.0)
        travel = Segment((second.length + low, 0.0), angle=0.0, length=high - low)
        path = travel.moved(second.angle, (0.0, 0.0))

    points = wrist.reshape(-1, 2)
    q_1, there = first.positions_onto(points, path, _TOLERANCE * arm.reach)
    if second.revolute:
        q_2 = np.arctan2(there[..., 1], there[..., 0]) - second.angle
    else:
        q_2 = turned(there, -second.angle)[..., 0] - second.length
    direction = np.broadcast_to(phi, wrist.shape[:-1]).reshape(-1, 1)
    q_3 = direction - math.fsum(arm.angles)
    for joint, q in ((first, q_1), (second, q_2)):
        if joint.revolute:
            q_3 = q_3 - q

    reached = np.ones(q_1.shape, dtype=bool)
    for joint, q in zip(joints, (q_1, q_2, q_3), strict=True):
        reached &= joint.within_limits(q, _TOLERANCE)
    return np.asarray(reached.any(axis=-1).reshape(wrist.shape[:-1]))
