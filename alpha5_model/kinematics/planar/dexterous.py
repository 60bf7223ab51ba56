"""Dexterous workspace of planar arms: the points reached with every orientation of the last link.

Pin the tip at p. The last link then turns about p, and its other end, the wrist, runs on the circle
about p whose radius is the last link's length. p is dexterous exactly if the rest of the arm reaches
that whole circle. Where the rest reaches an annulus, low <= r <= high, this is the exact condition

    |p| + l_n <= high   and   | |p| - l_n | >= low,

for a 3R arm ``l_3 + l_4 <= l_1 + l_2`` and ``|l_3 - l_4| >= |l_1 - l_2|``, with the notes' l_4 = |p|.
The notes' theorem is sufficient only. Both ask for Grashof's inequality (shortest and longest link
together not longer than the other two); the theorem wants l_3 to be the shortest link, but l_3 also
turns fully where the shortest is l_4, the ground: then the four-bar linkage is a double crank.

Isolated radii are real: with l = (5, 4, 1) the point p = 0 is dexterous and no neighbour is.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace" and "A topological perspective for
        3R-planar robots".
    [Kumar1981] Kumar, Waldron: The workspaces of a mechanical manipulator, J. Mech. Design 103, 1981.
    [McCarthy2011] McCarthy, Soh: Geometric Design of Linkages, section 2.4 (Grashof linkages).
    [Ting1989] Ting: Mobility criteria of single-loop N-bar linkages, J. Mech. Design 111(4), 1989.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array, real
from alpha5_model.errors import InputError
from alpha5_model.kinematics.planar.arm import PlanarArm
from alpha5_model.kinematics.planar.curves import TURN
from alpha5_model.kinematics.planar.workspace import annulus

#: Equality counts in every condition here; lengths this share of the whole apart count as equal.
ROUNDING = 1e-14


@dataclass(frozen=True)
class TheoremRow:
    """A row of the notes' experiment.

    Attributes:
        l_4: Distance of the pinned tip from the base.
        pair: Sum of the two shortest of l_1, l_2, l_4: the smallest l_i + l_j of the theorem.
        half: Half the sum of all four lengths, L/2; the notes' column is headed l_4/2.
        theorem: Whether the theorem holds.
        exact: Whether the last link turns fully.
    """

    l_4: float
    pair: float
    half: float
    theorem: bool
    exact: bool


@dataclass(frozen=True)
class Conditions:
    """Necessary conditions for a dexterous workspace with an interior.

    Attributes:
        satisfied: Whether all hold.
        reasons: What is missing, one sentence each; empty if satisfied.
    """

    satisfied: bool
    reasons: tuple[str, ...]


def lecture_theorem(l_1: float, l_2: float, l_3: float, l_4: float) -> bool:
    """The notes' theorem to the letter: ``l_i + l_j >= L/2`` for all i, j in {1, 2, 4}.

    i and j are different: with i = j the notes' own rows from 9 to 2 would fail. It says that l_3 may
    turn by 2 pi while the tip is pinned at distance l_4 from the base. Sufficient, not necessary; see
    `turns_fully`.

    Args:
        l_1, l_2, l_3: Link lengths, base to tip, positive.
        l_4: Distance of the tip from the base, not negative.
    """
    return theorem_row(l_1, l_2, l_3, l_4).theorem


def theorem_row(l_1: float, l_2: float, l_3: float, l_4: float) -> TheoremRow:
    """Both sides of the theorem and both verdicts for one set of lengths; see `lecture_theorem`."""
    first, second = real("l_1", l_1, 0.0, strict=True), real("l_2", l_2, 0.0, strict=True)
    third, fourth = real("l_3", l_3, 0.0, strict=True), real("l_4", l_4, 0.0)
    pair = sum(sorted((first, second, fourth))[:2])
    half = (first + second + third + fourth) / 2
    exact = turns_fully(PlanarArm((first, second, third)), fourth)
    return TheoremRow(fourth, pair, half, pair >= half * (1 - ROUNDING), exact)


def turns_fully(arm: PlanarArm, radius: float) -> bool:
    """The exact condition: whether the last link turns fully with the tip pinned at a radius.

    For any number of revolute joints without limits, and prismatic joints along their links. Where the
    last link's length varies, every orientation may use its own length.

    Args:
        arm: The arm; see `dexterous_radii`.
        radius: Distance of the tip from the base [m].
    """
    low, high, short, long = _wrist_and_link(arm)
    r = real("radius", radius, 0.0)
    # Worst orientation outwards: the wrist beyond the tip. Inwards: towards the base.
    slack = ROUNDING * (high + long)
    return r + short <= high + slack and max(abs(r - short), abs(r - long)) >= low - slack


def dexterous_radii(arm: PlanarArm) -> tuple[tuple[float, float], ...]:
    """The dexterous workspace as intervals of distance from the base, exact.

    Args:
        arm: First joint revolute, no revolute joint with limits, prismatic joints along their links.

    Returns:
        Closed intervals (least, greatest) [m], ascending, disjoint; one of zero width is an isolated
        circle, or the base itself. Empty if there is no dexterous point.

    Raises:
        InputError: An arm whose dexterous workspace is not a set of radii; `dexterity` takes any.
    """
    low, high, short, long = _wrist_and_link(arm)
    limit = high - short
    # max(|r - short|, |r - long|) >= low leaves out an open interval of r.
    gap = (long - low, short + low)
    slack = ROUNDING * (high + long)
    if limit < -slack:
        return ()
    limit = max(limit, 0.0)
    if gap[0] >= gap[1]:
        return ((0.0, limit),)
    out = []
    if gap[0] >= -slack:
        out.append((0.0, min(max(gap[0], 0.0), limit)))
    if gap[1] <= limit + slack:
        out.append((min(gap[1], limit), limit))
    return tuple(out)


def dexterous_area(arm: PlanarArm) -> float:
    """Area of the dexterous workspace [m^2]; zero where it is made of isolated circles and points."""
    return math.fsum(math.pi * (high**2 - low**2) for low, high in dexterous_radii(arm))


def necessary_conditions(arm: PlanarArm) -> Conditions:
    """The notes' necessary conditions for planar arms.

    A revolute joint without limits, and two more joints to place the end effector. They are necessary
    for a dexterous workspace with an interior: a 2R arm of equal lengths reaches its own base with
    every orientation, a single dexterous point. They are not sufficient.
    """
    reasons = []
    free = [k for k, r in zip(arm.joints, arm.limits, strict=True) if k == "R" and r is None]
    if not free:
        reasons.append("no revolute joint without limits: not every orientation occurs")
    if arm.n < 3:
        reasons.append(f"{arm.n - 1} joints beside it where placing the end effector takes two")
    return Conditions(not reasons, tuple(reasons))


def dexterity(
    arm: PlanarArm, points: ArrayLike, orientations: int = 360, samples: int = 181
) -> FloatArray:
    """Share of orientations with which points are reached, numerically, joint limits included.

    The last three joints are solved in closed form for each of evenly spaced orientations; joints
    before them are sampled evenly between their limits, both limits included. A point counts as
    dexterous where the share is 1: a range of orientations narrower than 2 pi / orientations can
    be missed, and with more than three joints some orientations are missed near the boundary.

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
    if arm.n < 3 or arm.joints[-1] != "R":
        raise InputError("arm", arm.joints, "three joints or more, the last one R")
    flat = p.reshape(-1, 2)
    phi = np.arange(orientations) * (TURN / orientations)
    found = np.zeros((len(flat), orientations), dtype=bool)
    tail = arm.part(arm.n - 3)
    wrist = flat[:, None, :] - arm.lengths[-1] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    for x, y, heading in _sampled_starts(arm, samples):
        c, s = math.cos(heading), math.sin(heading)
        local = (wrist - (x, y)) @ np.array([[c, -s], [s, c]])
        found |= _three_joint_reach(tail, local, phi - heading)
    return np.asarray(found.mean(axis=1).reshape(p.shape[:-1]))


def _wrist_and_link(arm: PlanarArm) -> tuple[float, float, float, float]:
    """Annulus that the arm without its last link reaches, and the range of the last link's length."""
    ranges = arm.length_ranges
    if ranges is None:
        raise InputError(
            "arm",
            arm,
            "revolute joints without limits, the first joint one of them, and prismatic joints "
            "along their links (planar.dexterity takes any arm)",
        )
    low, high = annulus(ranges[:-1]) if len(ranges) > 1 else (0.0, 0.0)
    return (low, high, *ranges[-1])


def _sampled_starts(arm: PlanarArm, samples: int) -> FloatArray:
    """Poses of the link before the last three joints, (K, 3)."""
    head = arm.n - 3
    if head == 0:
        return np.zeros((1, 3))
    axes = [np.linspace(*(limit or (-math.pi, math.pi)), samples) for limit in arm.limits[:head]]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, head)
    return arm.part(0, head).forward_kinematics(q)


def _three_joint_reach(arm: PlanarArm, wrist: FloatArray, phi: FloatArray) -> np.ndarray:
    """Whether joints 1 and 2 reach the wrist (..., 2) and joint 3 then the orientation phi (...)."""
    first, second = wrist_solutions(arm, wrist)
    last = phi[..., None] - math.fsum(arm.angles)
    for kind, q in zip(arm.joints, (first, second), strict=False):
        last = last - (q if kind == "R" else 0.0)
    ok = _within(first, arm, 0) & _within(second, arm, 1) & _within(last, arm, 2)
    return np.asarray(ok.any(axis=-1))


def wrist_solutions(arm: PlanarArm, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions of an arm's first two joints that bring the end of link 2 to points.

    Limits are not asked for. The four cases (RR, RP, PR, PP) intersect the path on which joint 1
    carries the target, seen from link 1, with the path of the end of link 2.

    Args:
        arm: Two joints or more; the others do not matter.
        points: (..., 2) [m].

    Returns:
        q_1 and q_2, (..., 2) each, one column per solution, NaN where there is none. Directions that
        are free (the target on the pivot) come out as one of many.
    """
    (l_1, l_2), (b_1, b_2), kinds = arm.lengths[:2], arm.angles[:2], arm.joints[:2]
    x, y = points[..., 0], points[..., 1]
    sign = np.array([1.0, -1.0])
    tolerance = 1e-9 * max(arm.reach, l_1 + l_2)
    with np.errstate(invalid="ignore", divide="ignore"):
        if kinds[0] == "R":
            r, bearing = np.hypot(x, y)[..., None], np.arctan2(y, x)[..., None]
            if kinds[1] == "R":  # the law of cosines
                cosine = (r**2 - l_1**2 - l_2**2) / (2 * l_1 * l_2)
                slack = tolerance * (l_1 + l_2) / (l_1 * l_2)
                elbow = np.where(np.abs(cosine) <= 1 + slack, np.clip(cosine, -1, 1), np.nan)
                turn = sign * np.arccos(elbow)
                tip_x, tip_y = l_1 + l_2 * np.cos(turn), l_2 * np.sin(turn)
                second = turn - b_2
            else:  # l_1 + (l_2 + q) u has length r
                along, across = l_1 * math.cos(b_2), l_1 * math.sin(b_2)
                square = r**2 - across**2
                root = np.where(square < 0, np.where(square > -2 * tolerance * r, 0.0, np.nan), 1.0)
                length = -along + sign * root * np.sqrt(np.maximum(square, 0.0))
                tip_x, tip_y = l_1 + length * math.cos(b_2), length * math.sin(b_2)
                second = length - l_2
            first = bearing - np.arctan2(tip_y, tip_x) - b_1
            return first, second + np.zeros_like(first)
        c, s = math.cos(b_1), math.sin(b_1)
        local_x, local_y = (c * x + s * y)[..., None], (c * y - s * x)[..., None]
        if kinds[1] == "R":
            sine = local_y / l_2
            sine = np.where(np.abs(sine) <= 1 + tolerance / l_2, np.clip(sine, -1, 1), np.nan)
            turn = np.where(sign > 0, np.arcsin(sine), math.pi - np.arcsin(sine))
            return local_x - l_2 * np.cos(turn) - l_1, turn - b_2
        length = local_y / math.sin(b_2) if abs(math.sin(b_2)) > 1e-9 else local_y * np.nan
        pair = length + np.zeros(2)
        return local_x - pair * math.cos(b_2) - l_1, pair - l_2


def _within(q: FloatArray, arm: PlanarArm, joint: int) -> np.ndarray:
    """Whether positions lie in a joint's limits; NaN does not."""
    limit = arm.limits[joint]
    if limit is None:
        return ~np.isnan(q)
    low, high = limit
    if arm.joints[joint] == "P":
        return np.asarray((q >= low - 1e-9) & (q <= high + 1e-9))
    with np.errstate(invalid="ignore"):
        return np.asarray(np.mod(q - low + 1e-9, TURN) <= high - low + 2e-9)
