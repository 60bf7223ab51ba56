"""Dexterous workspace of planar arms: the lecture's theorem and what replaces it."""

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
from alpha5_model.theory.planar.arm import (
    PlanarArm,
    Workspace,
    annulus,
    bring,
    within_limits,
    workspace,
)
from alpha5_model.theory.planar.curves import TURN, Arc, Curve, Edge, Segment, turned

__all__ = ["Arc", "Conditions", "Curve", "DexterityMap", "Edge", "PlanarArm", "Segment"]
__all__ += [
    "TheoremRow",
    "Workspace",
    "annulus",
    "dexterity",
    "dexterity_map",
    "dexterous_area",
]
__all__ += [
    "dexterous_radii",
    "lecture_theorem",
    "necessary_conditions",
    "theorem_radii",
]
__all__ += ["theorem_row", "turns_fully", "workspace"]

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


@dataclass(frozen=True, eq=False)
class DexterityMap:
    """Dexterity over a square grid on the workspace's bounding box.

    Attributes:
        x, y: Grid lines, (I,) and (J,) [m].
        share: Share of orientations reached at (x[i], y[j]), (J, I); 0 outside the workspace.
        spacing: Distance between grid lines [m].
        orientations: How many were tried: gaps narrower than 2 pi / orientations can be missed.
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


def lecture_theorem(l_1: float, l_2: float, l_3: float, l_4: float) -> bool:
    """The notes' theorem to the letter: ``l_i + l_j >= L/2`` for all i, j in {1, 2, 4}.

    i and j are different: with i = j the notes' own rows from 9 to 2 would fail. It says that l_3
    may turn by 2 pi while the tip is pinned at distance l_4 from the base. Sufficient, not
    necessary; see `turns_fully`.

    Args:
        l_1, l_2, l_3: Link lengths, base to tip, positive.
        l_4: Distance of the tip from the base, not negative.
    """
    return theorem_row(l_1, l_2, l_3, l_4).theorem


def theorem_row(l_1: float, l_2: float, l_3: float, l_4: float) -> TheoremRow:
    """Both sides of the theorem and both verdicts for one set of lengths; see `lecture_theorem`."""
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    fourth = real("l_4", l_4, 0.0)
    pair = sum(sorted((first, second, fourth))[:2])
    half = (first + second + third + fourth) / 2
    exact = turns_fully(PlanarArm((first, second, third)), fourth)
    return TheoremRow(fourth, pair, half, pair >= half * (1 - ROUNDING), exact)


def theorem_radii(l_1: float, l_2: float, l_3: float) -> tuple[float, float] | None:
    """The l_4 for which the theorem holds: ``|l_1 - l_2| + l_3 <= l_4 <= l_1 + l_2 - l_3``.

    Returns:
        Least and greatest l_4, or None if there is none.
    """
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    low, high = abs(first - second) + third, first + second - third
    return (low, max(low, high)) if low <= high + ROUNDING * low else None


def turns_fully(arm: PlanarArm, radius: float) -> bool:
    """The exact condition: whether the last link turns fully with the tip pinned at a radius.

    For any number of revolute joints without limits, and prismatic joints along their links. Where
    the last link's length varies, every orientation may use its own length.

    Args:
        arm: The arm; see `dexterous_radii`.
        radius: Distance of the tip from the base [m].
    """
    low, high, short, long = _wrist_and_link(arm)
    r = real("radius", radius, 0.0)
    # Worst orientation outwards: the wrist beyond the tip. Inwards: towards the base.
    slack = ROUNDING * (high + long)
    return (
        r + short <= high + slack and max(abs(r - short), abs(r - long)) >= low - slack
    )


def dexterous_radii(arm: PlanarArm) -> tuple[tuple[float, float], ...]:
    """The dexterous workspace as intervals of distance from the base, exact.

    Args:
        arm: First joint revolute, no revolute joint with limits, prismatic joints along their
            links.

    Returns:
        Closed intervals (least, greatest) [m], ascending, disjoint; one of zero width is an
        isolated circle, or the base itself. Empty if there is no dexterous point.

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
    """Area of the dexterous workspace [m^2]; zero if it consists of isolated circles and points."""
    return math.fsum(math.pi * (high**2 - low**2) for low, high in dexterous_radii(arm))


def necessary_conditions(arm: PlanarArm) -> Conditions:
    """Necessary conditions for a dexterous workspace with an interior, for planar arms.

    The ranges of the revolute joints add up to a full turn, for the orientation is the sum of their
    angles, and two joints beside one of them place the end effector. The notes ask for a revolute
    joint without limits in place of the first, which is not necessary: with +-2.967 rad on every
    joint the notes' arm (5, 4, 1) has a dexterous workspace of 155.8. Both speak of an interior: a
    2R arm of equal lengths reaches its own base with every orientation, a single dexterous point.
    They are not sufficient.
    """
    reasons = []
    rows = zip(instance("arm", arm, PlanarArm).joints, arm.limits, strict=True)
    turn = sum(
        math.inf if r is None else r[1] - r[0] for kind, r in rows if kind == "R"
    )
    if turn < math.tau * (1 - ROUNDING):
        short = f"the revolute joints together turn {turn:.4g} rad, less than 2 pi"
        reasons.append(f"{short}: not every orientation occurs")
    if arm.n < 3:
        reasons.append(
            f"{arm.n - 1} more, beside it, where placing the end effector takes two"
        )
    return Conditions(not reasons, tuple(reasons))


def _wrist_and_link(arm: PlanarArm) -> tuple[float, float, float, float]:
    """Annulus that the arm without its last link reaches, and the last link's range of length."""
    ranges = instance("arm", arm, PlanarArm).length_ranges
    if ranges is None:
        others = "prismatic joints along their links (planar.dexterity takes any arm)"
        expected = (
            f"revolute joints without limits, the first joint one of them, and {others}"
        )
        raise InputError("arm", arm, expected)
    low, high = annulus(ranges[:-1]) if len(ranges) > 1 else (0.0, 0.0)
    return (low, high, *ranges[-1])


def _lengths(**lengths: float) -> list[float]:
    return [real(name, length, 0.0, strict=True) for name, length in lengths.items()]


def dexterity_map(
    arm: PlanarArm, resolution: int = 81, orientations: int = 120, samples: int = 31
) -> DexterityMap:
    """Dexterity over the whole workspace.

    Args:
        arm: See `dexterity`.
        resolution: Grid lines along the longer side of the workspace's bounding box, 2 or more.
        orientations, samples: See `dexterity`.
    """
    if count("resolution", resolution) < 2:
        raise InputError("resolution", resolution, "at least 2 grid lines")
    space = workspace(arm)
    points = np.concatenate(
        [c.point(np.linspace(*c.interval, 181)) for c in space.curves]
    )
    low, high = points.min(axis=0), points.max(axis=0)
    spacing = float((high - low).max()) / (resolution - 1)
    x, y = (np.arange(a, b + spacing, spacing) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    inside = space.contains(grid)
    share = np.zeros(inside.shape)
    share[inside] = dexterity(arm, grid[inside], orientations, samples)
    return DexterityMap(x, y, share, spacing, orientations)


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
    if instance("arm", arm, PlanarArm).n < 3 or arm.joints[-1] != "R":
        raise InputError("arm", arm.joints, "three joints or more, the last one R")
    orientations, samples = (
        count("orientations", orientations),
        count("samples", samples),
    )
    flat = p.reshape(-1, 2)
    phi = np.arange(orientations) * (TURN / orientations)
    found = np.zeros((len(flat), orientations), dtype=bool)
    tail = arm.part(arm.n - 3)
    near = (
        np.abs(flat).max(axis=1) <= (1 + 1e-8) * arm.reach
    )  # of others squares may overflow
    wrist = flat[near, None, :] - arm.lengths[-1] * np.stack(
        [np.cos(phi), np.sin(phi)], axis=-1
    )
    for x, y, heading in _sampled_starts(arm, samples):
        local = turned(wrist - (x, y), -heading)
        found[near] |= _three_joint_reach(tail, local, phi - heading)
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


def _three_joint_reach(arm: PlanarArm, wrist: FloatArray, phi: FloatArray) -> BoolArray:
    """Whether joints 1 and 2 reach the wrist (..., 2), and joint 3 the orientation phi (...)."""
    length, angle = arm.lengths[1], arm.angles[1]
    path: Curve = Arc((0.0, 0.0), length)
    if slides := arm.joints[1] == "P":
        low, high = arm.limits[1] or (0.0, 0.0)
        path = Segment((length + low, 0.0), 0.0, high - low).moved(angle, (0.0, 0.0))
    ((first, there),) = bring(arm, wrist.reshape(-1, 2), [path], 1e-9 * arm.reach)
    bend = np.arctan2(there[..., 1], there[..., 0]) - angle
    second = turned(there, -angle)[..., 0] - length if slides else bend
    last = np.broadcast_to(phi, wrist.shape[:-1]).reshape(-1, 1) - math.fsum(arm.angles)
    for kind, q in zip(arm.joints, (first, second), strict=False):
        last = last - q if kind == "R" else last
    one, two, three = (
        within_limits(arm, j, q, 1e-9) for j, q in enumerate((first, second, last))
    )
    return np.asarray((one & two & three).any(axis=-1).reshape(wrist.shape[:-1]))
