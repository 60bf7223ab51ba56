"""The region that the document claims to be reachable, and how much of it is wrong.

References:
    [ReachAlpha] Manufacturer's document, Section 1.2, Figure 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support import checks
from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.half_plane import (
    POSES,
    SIDES,
    Arc,
    area,
    contains,
    critical_arcs,
    first_moment,
    trace,
)
from alpha5_model.kinematics.workspace import cross_section_area, revolved, volume
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.row import si

__all__ = [
    "PublishedErrors",
    "Torus",
    "in_tori",
    "published_but_unreachable",
    "published_errors",
    "published_reachable",
    "published_tori",
    "reachable_but_unpublished",
]


class Torus(NamedTuple):
    """One of the document's limits, ``(R - R_c)^2 + (z - z_c)^2 <= or >= radius^2``.

    Attributes:
        name: ``"outer"``, ``"inner"`` or ``"downward"``.
        center: (R_c, z_c) in the half-plane [m].
        radius: [m].
        inside: The inequality is <=.
    """

    name: str
    center: tuple[float, float]
    radius: float
    inside: bool


@dataclass(frozen=True)
class PublishedErrors:
    """The published region against the reachable set with the joint limits.

    Areas are of a half-plane to which theta_0 can turn both poses. Volumes also count
    the azimuths that it leaves to one pose.

    Attributes:
        published_area, reachable_area: [m^2].
        unreachable_area: Published, and not reachable [m^2].
        missed_area: Reachable, and not published [m^2].
        published_volume, reachable_volume, unreachable_volume, missed_volume: The same
            [m^3].
    """

    published_area: float
    reachable_area: float
    unreachable_area: float
    missed_area: float
    published_volume: float
    reachable_volume: float
    unreachable_volume: float
    missed_volume: float


@cache
def published_tori() -> tuple[Torus, Torus, Torus]:
    """The three limits of Section 1.2, as printed.

    They contain 39.94 mm, where Table 1 has 40. d_3 is negative.
    """
    return tori(si(printed_lengths(published())))


def printed_lengths(printed: Published) -> list[Quantity]:
    """The printed lengths in the formulas of the tori.

    Returns:
        a_0, d_0, a_2, d_3 of Table 1, the two lengths of its elbow, and the three
        numbers of Section 1.2.
    """
    row_0, _, row_2, row_3, _ = printed.table_1.rows
    assert isinstance(row_0.a, Quantity)
    assert isinstance(row_2.a, Quantity)
    elbow = printed.elbow
    torus = printed.workspace
    return [
        *(row_0.a, row_0.d, row_2.a, row_3.d),
        *(elbow.opposite, elbow.adjacent),
        *(torus.inner_offset, torus.inner_length, torus.downward_drop),
    ]


def tori(lengths: FloatArray) -> tuple[Torus, Torus, Torus]:
    """The three limits for other lengths, in the order of `printed_lengths` [m]."""
    a_0, d_0, a_2, d_3, opposite, adjacent, offset, length, drop = lengths
    outer = Torus(
        name="outer",
        center=(a_0, d_0),
        radius=math.hypot(opposite, adjacent) + math.hypot(d_3, a_2),
        inside=True,
    )
    inner = Torus(
        name="inner",
        center=(a_0, d_0),
        radius=math.hypot(offset + a_2, length + d_3),
        inside=False,
    )
    downward = Torus(
        name="downward", center=(a_0, d_0 - drop), radius=-d_3, inside=False
    )
    return outer, inner, downward


def published_reachable(positions: ArrayLike) -> BoolArray:
    """Whether a point satisfies all three inequalities of Section 1.2.

    Args:
        positions: In ``base_link``, (..., 3) [m].

    Returns:
        (...) bool.
    """
    target = float_array("positions", positions, (3,))
    radius = np.hypot(target[..., 0], target[..., 1])
    return in_tori(radius, target[..., 2])


def in_tori(radius: FloatArray, z: FloatArray) -> BoolArray:
    """Which points (R, z) [m] satisfy the three inequalities of Section 1.2, (...)."""
    return _satisfied(published_tori(), *checks.together(radius=radius, z=z))


def _satisfied(limits: Sequence[Torus], radius: FloatArray, z: FloatArray) -> BoolArray:
    """Which points satisfy the inequalities of tori, (...)."""
    inside = np.ones(radius.shape, np.bool_)
    for torus in limits:
        center_radius, center_z = torus.center
        with np.errstate(over="ignore"):  # infinitely far is outside as well
            squared = (radius - center_radius) ** 2 + (z - center_z) ** 2
        if torus.inside:
            inside &= squared <= torus.radius**2
        else:
            inside &= squared >= torus.radius**2
    return inside


def published_but_unreachable(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what the document claims and the arm does not reach.

    Args:
        side: As for `alpha5_model.workspace.boundary`.
    """
    return difference(
        published_tori(), checks.choice("side", side, SIDES), published=True
    )


def reachable_but_unpublished(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what the arm reaches and the document leaves out.

    Args:
        side: As for `alpha5_model.workspace.boundary`.
    """
    return difference(
        published_tori(), checks.choice("side", side, SIDES), published=False
    )


@lru_cache(maxsize=64)
def difference(
    limits: tuple[Torus, ...], side: str, published: bool
) -> tuple[Arc, ...]:
    """Boundary of what tori claim and the arm does not reach, or the other way round.

    Args:
        limits: The tori.
        side: As for `alpha5_model.workspace.boundary`.
        published: Claimed but not reached; else reached but not claimed.
    """
    geometry = Geometry.of(parameters())
    arcs = _arcs(limits)
    for pose in POSES:
        arcs += critical_arcs(geometry, pose)

    def differs(radius: FloatArray, z: FloatArray) -> BoolArray:
        claimed = _satisfied(limits, radius, z)
        reached = contains(geometry, radius, z, side, limits=True)
        return np.asarray((claimed == published) & (reached != published))

    return trace(geometry, arcs, differs)


def _arcs(limits: Sequence[Torus]) -> list[Arc]:
    """The circles of tori."""
    return [
        Arc(
            center=torus.center,
            radius=torus.radius,
            start=0.0,
            end=math.tau,
            filled=0,
            cause=torus.name,
            side="published",
        )
        for torus in limits
    ]


@cache
def published_errors() -> PublishedErrors:
    """How much of the published region cannot be reached, and what it misses."""
    geometry = Geometry.of(parameters())
    claimed = trace(geometry, _arcs(published_tori()), in_tori)
    wrong = {side: published_but_unreachable(side) for side in SIDES}
    missed = {side: reachable_but_unpublished(side) for side in SIDES}
    return PublishedErrors(
        published_area=area(claimed),
        reachable_area=cross_section_area(),
        unreachable_area=area(wrong["both"]),
        missed_area=area(missed["both"]),
        published_volume=2 * math.pi * first_moment(claimed),
        reachable_volume=volume(),
        unreachable_volume=revolved(geometry, wrong),
        missed_volume=revolved(geometry, missed),
    )
