"""The region that the document claims to be reachable, and how much of it is wrong."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support import checks
from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model.kinematics.arcs import Arc, area, first_moment
from alpha5_model.kinematics.areas import cross_section_area, revolved, volume
from alpha5_model.kinematics.boundaries import critical_arcs, trace
from alpha5_model.kinematics.half_plane import POSES, SIDES, in_half_plane
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.printed import published


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
def published_tori(parameters: Alpha5Parameters) -> tuple[Torus, Torus, Torus]:
    """The three limits of Section 1.2, of an arm of these dimensions."""
    row_0, row_1, row_2, row_3 = parameters.dh[:4]
    printed = published().workspace
    shoulder = (row_0.a, row_0.d)
    inner_radius = math.hypot(
        printed.inner_offset.si + row_2.a, printed.inner_length.si + row_3.d
    )
    outer = Torus(
        name="outer",
        center=shoulder,
        radius=row_1.a + math.sqrt(row_3.d**2 + row_2.a**2),
        inside=True,
    )
    inner = Torus(name="inner", center=shoulder, radius=inner_radius, inside=False)
    downward = Torus(
        name="downward",
        center=(row_0.a, row_0.d - printed.downward_drop.si),
        radius=-row_3.d,
        inside=False,
    )
    return outer, inner, downward


def published_reachable(
    parameters: Alpha5Parameters, positions: ArrayLike
) -> BoolArray:
    """Whether points (..., 3) satisfy all three inequalities of Section 1.2, (...)."""
    target = float_array("positions", positions, (3,))
    radius = np.hypot(target[..., 0], target[..., 1])
    return in_tori(parameters, radius, target[..., 2])


def in_tori(
    parameters: Alpha5Parameters, radius: FloatArray, z: FloatArray
) -> BoolArray:
    """Which points of a half-plane satisfy the three inequalities, (...)."""
    radius, z = checks.together(radius=radius, z=z)
    inside = np.ones(radius.shape, np.bool_)
    for torus in published_tori(parameters):
        center_radius, center_z = torus.center
        with np.errstate(over="ignore"):  # infinitely far is outside as well
            squared = (radius - center_radius) ** 2 + (z - center_z) ** 2
        if torus.inside:
            inside &= squared <= torus.radius**2
        else:
            inside &= squared >= torus.radius**2
    return inside


def published_but_unreachable(
    parameters: Alpha5Parameters, side: str
) -> tuple[Arc, ...]:
    """Boundary of what the document claims and the arm does not reach."""
    return _difference(parameters, checks.choice("side", side, SIDES), True)


def reachable_but_unpublished(
    parameters: Alpha5Parameters, side: str
) -> tuple[Arc, ...]:
    """Boundary of what the arm reaches and the document leaves out."""
    return _difference(parameters, checks.choice("side", side, SIDES), False)


@cache
def _difference(
    parameters: Alpha5Parameters, side: str, published: bool
) -> tuple[Arc, ...]:
    """Boundary of what is published but not reached, or reached but not published."""
    plane = ArmPlane.from_parameters(parameters)
    arcs = _printed_arcs(parameters)
    for pose in POSES:
        arcs += critical_arcs(plane, pose)

    def contains(radius: FloatArray, z: FloatArray) -> BoolArray:
        claimed = in_tori(parameters, radius, z)
        reached = in_half_plane(plane, radius, z, side, limits=True)
        return np.asarray((claimed == published) & (reached != published))

    return trace(plane, arcs, contains)


def _printed_arcs(parameters: Alpha5Parameters) -> list[Arc]:
    """The circles of the three limits."""
    arcs = []
    for torus in published_tori(parameters):
        arc = Arc(
            center=torus.center,
            radius=torus.radius,
            start=0.0,
            end=math.tau,
            filled=0,
            cause=torus.name,
            side="published",
        )
        arcs.append(arc)
    return arcs


@cache
def published_errors(parameters: Alpha5Parameters) -> PublishedErrors:
    """How much of the published region cannot be reached, and what it misses."""
    plane = ArmPlane.from_parameters(parameters)
    claimed = trace(
        plane,
        _printed_arcs(parameters),
        lambda radius, z: in_tori(parameters, radius, z),
    )
    wrong: Mapping[str, tuple[Arc, ...]] = {
        side: published_but_unreachable(parameters, side) for side in SIDES
    }
    missed: Mapping[str, tuple[Arc, ...]] = {
        side: reachable_but_unpublished(parameters, side) for side in SIDES
    }
    return PublishedErrors(
        published_area=area(claimed),
        reachable_area=cross_section_area(plane, "both", limits=True),
        unreachable_area=area(wrong["both"]),
        missed_area=area(missed["both"]),
        published_volume=2 * math.pi * first_moment(claimed),
        reachable_volume=volume(plane, limits=True),
        unreachable_volume=revolved(plane, wrong),
        missed_volume=revolved(plane, missed),
    )
