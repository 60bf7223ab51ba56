"""The exact dexterous workspace of planar arms without joint limits.

The conditions are derived in the documentation of `alpha5_model.theory.planar`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from alpha5_model._support.checks import instance, real
from alpha5_model.errors import InputError
from alpha5_model.theory.planar.annuli import annulus
from alpha5_model.theory.planar.arm import PlanarArm

#: Lengths that differ by less than this share of their sum count as equal; all
#: conditions hold with equality.
ROUNDING = 1e-14


@dataclass(frozen=True)
class Conditions:
    """Necessary conditions for a dexterous workspace with an interior.

    Attributes:
        satisfied: Whether all hold.
        reasons: One sentence for each condition that fails; empty if satisfied.
    """

    satisfied: bool
    reasons: tuple[str, ...]


class _Linkage(NamedTuple):
    """An arm with its tip pinned, as the part that carries the wrist and the last link.

    Attributes:
        low, high: Radii of the annulus that the arm without its last link reaches [m].
        short, long: Range of the last link's length [m].
    """

    low: float
    high: float
    short: float
    long: float

    @property
    def slack(self) -> float:
        """Difference that counts as rounding [m]."""
        return ROUNDING * (self.high + self.long)


def turns_fully(arm: PlanarArm, radius: float) -> bool:
    """Whether the last link turns fully with the tip pinned at a radius, exactly.

    The arm may have any number of revolute joints without limits, and prismatic joints
    along their links. If the last link's length varies, every orientation may use its
    own length.

    Args:
        arm: The arm; see `dexterous_radii`.
        radius: Distance of the tip from the base [m].
    """
    rest = _linkage(arm)
    r = real("radius", radius, 0.0)
    # The two worst orientations: the wrist beyond the tip, and between tip and base.
    farthest = r + rest.short
    nearest = max(abs(r - rest.short), abs(r - rest.long))
    return farthest <= rest.high + rest.slack and nearest >= rest.low - rest.slack


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
    rest = _linkage(arm)
    limit = rest.high - rest.short
    if limit < -rest.slack:
        return ()
    limit = max(limit, 0.0)

    # max(|r - short|, |r - long|) >= low leaves out an open interval of r.
    gap_start = rest.long - rest.low
    gap_end = rest.short + rest.low
    if gap_start >= gap_end:
        return ((0.0, limit),)
    radii = []
    if gap_start >= -rest.slack:
        radii.append((0.0, min(max(gap_start, 0.0), limit)))
    if gap_end <= limit + rest.slack:
        radii.append((min(gap_end, limit), limit))
    return tuple(radii)


def dexterous_area(arm: PlanarArm) -> float:
    """Area of the dexterous workspace [m^2]; zero if it is only circles and points."""
    return math.fsum(math.pi * (high**2 - low**2) for low, high in dexterous_radii(arm))


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
    turn = _total_turn(instance("arm", arm, PlanarArm))
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


def _total_turn(arm: PlanarArm) -> float:
    """Sum of the ranges of the revolute joints [rad]; infinite if one has no limits."""
    turn = 0.0
    for kind, limit in zip(arm.joints, arm.limits, strict=True):
        if kind == "R":
            turn += math.inf if limit is None else limit[1] - limit[0]
    return turn


def _linkage(arm: PlanarArm) -> _Linkage:
    """The arm without its last link, and that link.

    Raises:
        InputError: An arm whose dexterous workspace is not a set of radii.
    """
    ranges = instance("arm", arm, PlanarArm).length_ranges
    if ranges is None:
        others = "prismatic joints along their links (planar.dexterity takes any arm)"
        expected = (
            f"revolute joints without limits, the first joint one of them, and {others}"
        )
        raise InputError("arm", arm, expected)
    low, high = annulus(ranges[:-1]) if len(ranges) > 1 else (0.0, 0.0)
    short, long = ranges[-1]
    return _Linkage(low=low, high=high, short=short, long=long)
