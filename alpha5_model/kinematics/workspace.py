"""The workspace: as published, as it is, and how much of the published one is wrong.

`boundary` gives the exact arcs, `reachable`, `distance_to_reach` and `nearest_reachable` answer for
points, `manipulability` and `singularities` for joint positions.

Joint 0 moves the tcp across the plane in proportion to its distance r from the yaw axis, joints 1
and 2 move it within the plane, in proportion to sin(gamma). The linear Jacobian of the three has
the determinant

    |det J_v| = |r| l_1 l_2 |sin gamma|                       [Siciliano2009, 3.3]

which is Yoshikawa's manipulability ``sqrt(det(J_v J_v^T))``. It vanishes where the arm is stretched
(gamma = pi), folded (gamma = 0, beyond the limits of theta_2), or the tcp is on the yaw axis
(r = 0).

References:
    [Yoshikawa1985] Manipulability of robotic mechanisms, Int. J. Robotics Research 4(2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 3.3 and 3.9.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support import checks
from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics import reach
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.kinematics.reach import (
    SIDES,
    Arc,
    boundary,
    distance_to_reach,
    in_half_plane,
    nearest_reachable,
    reachable,
)
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.printed import published

__all__ = [
    "SIDES",
    "Arc",
    "PublishedErrors",
    "SampledShare",
    "Singularities",
    "Torus",
    "boundary",
]
__all__ += [
    "cross_section_area",
    "distance_to_reach",
    "in_half_plane",
    "in_tori",
    "manipulability",
]
__all__ += ["nearest_reachable", "published_but_unreachable", "published_errors"]
__all__ += [
    "published_reachable",
    "published_tori",
    "reachable",
    "reachable_but_unpublished",
]
__all__ += ["sampled_share", "singular_elbow_angles", "singularities", "volume"]


class Torus(NamedTuple):
    """One of the document's three limits, ``(R - R_c)^2 + (z - z_c)^2 <= or >= radius^2``.

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

    Areas are of the half-plane where both poses can turn to it; volumes count the closed wedges
    too.

    Attributes:
        published_area, reachable_area: [m^2].
        unreachable_area: Published, and not reachable [m^2].
        missed_area: Reachable, and not published [m^2].
        published_volume, reachable_volume, unreachable_volume, missed_volume: The same [m^3].
    """

    published_area: float
    reachable_area: float
    unreachable_area: float
    missed_area: float
    published_volume: float
    reachable_volume: float
    unreachable_volume: float
    missed_volume: float


class SampledShare(NamedTuple):
    """A share of the reachable set, from points drawn evenly from it.

    Attributes:
        share: 0 to 1.
        standard_error: Of the share, 1 sigma; of a binomial with one success and one failure more,
            so that it is never zero.
        total: Of what it is the share, exact [m^3], or [m^2] in a half-plane.
        samples: Number of points.
    """

    share: float
    standard_error: float
    total: float
    samples: int


@cache
def published_tori() -> tuple[Torus, Torus, Torus]:
    """The three limits of Section 1.2 as printed: 39.94 mm where Table 1 has 40, d_3 negative."""
    dh, printed = parameters().dh, published().workspace
    a_2, d_0, d_3, shoulder = dh[2].a, dh[0].d, dh[3].d, (dh[0].a, dh[0].d)
    inner = math.hypot(printed.inner_offset.si + a_2, printed.inner_length.si + d_3)
    return (
        Torus("outer", shoulder, dh[1].a + math.sqrt(d_3**2 + a_2**2), True),
        Torus("inner", shoulder, inner, False),
        Torus("downward", (dh[0].a, d_0 - printed.downward_drop.si), -d_3, False),
    )


def published_reachable(positions: ArrayLike) -> BoolArray:
    """Whether a point satisfies all three inequalities of Section 1.2.

    Args:
        positions: In ``base_link``, (..., 3) [m].

    Returns:
        (...) bool.
    """
    target = float_array("positions", positions, (3,))
    return in_tori(np.hypot(target[..., 0], target[..., 1]), target[..., 2])


def cross_section_area(side: str = "both", limits: bool = True) -> float:
    """Area of the reachable part of a half-plane through the yaw axis, exact [m^2].

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union.
        limits: Respect the limits of theta_1 and theta_2.
    """
    return area(boundary(side, limits))


def area(arcs: Iterable[Arc]) -> float:
    """Area of the region that arcs and the axis R = 0 bound, by Green's theorem [m^2]."""
    return sum(arc.filled * reach.planar_arc(arc).area_integral() for arc in arcs)


def first_moment(arcs: Iterable[Arc]) -> float:
    """Integral of R over the region, ``oint R^2 / 2 dz`` [m^3].

    Times 2 pi it is the volume of the solid of revolution (Pappus).
    """
    total = 0.0
    for arc in arcs:
        c, r, t = arc.center[0], arc.radius, np.array([arc.start, arc.end])
        s = np.sin(t)
        start, end = c * c * s + c * r * (t + s * np.cos(t)) + r * r * (s - s**3 / 3)
        total += arc.filled * r / 2 * float(end - start)
    return total


def volume(limits: bool = True) -> float:
    """Volume of the reachable set, exact [m^3].

    Args:
        limits: Respect the limits of theta_0, theta_1 and theta_2. With them, a wedge of azimuths
            belongs to the overarm pose alone, and the opposite one to the underarm pose alone.
    """
    return _revolved({side: boundary(side, limits) for side in SIDES}, limits)


def sampled_share(
    accept: reach.Accept,
    samples: int = 20_000,
    seed: int = 0,
    azimuth: float | None = None,
) -> SampledShare:
    """Share of the reachable volume that is reached in accepted joint positions.

    With `alpha5_model.without_self_collision` it is the share that the arm reaches without touching
    itself.

    Args:
        accept: As for `reachable`.
        samples: Number of points.
        seed: Of the points.
        azimuth: Of a half-plane through the yaw axis [rad]; the share is of its area then.

    Raises:
        InputError: Bad input, or an answer of ``accept`` that is not one True or False a row.
    """
    number, rng = checks.count("samples", samples), checks.generator(seed)
    fixed = None if azimuth is None else checks.real("azimuth", azimuth)
    g = arm_plane()
    parts: list[FloatArray] = []
    while (found := sum(map(len, parts))) < number:
        # Even in volume: R^2 is uniform; even in area: R is.
        u, height, turn = rng.uniform(size=(3, 2 * (number - found) + 16))
        radius = (g.a_0 + g.longest) * (np.sqrt(u) if fixed is None else u)
        angle = 2 * math.pi * turn if fixed is None else np.full_like(turn, fixed)
        z = g.d_0 + g.longest * (2 * height - 1)
        points = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
        parts.append(points[reachable(points)][: number - found])
    hits = int(reachable(np.concatenate(parts), accept=accept).sum())
    if fixed is None:
        total = volume()
    else:
        open_to = [
            side for side in SIDES[:2] if abs(reach.azimuth_beyond(fixed, side)) < 1e-6
        ]
        total = cross_section_area(open_to[0] if len(open_to) == 1 else "both")
    smoothed = (hits + 1) / (number + 2)
    error = math.sqrt(smoothed * (1 - smoothed) / number)
    return SampledShare(hits / number, error, total, number)


@cache
def published_errors() -> PublishedErrors:
    """How much of the published region cannot be reached, and what it misses."""
    printed = reach.trace(_printed_arcs(), in_tori)
    wrong = {side: published_but_unreachable(side) for side in SIDES}
    missed = {side: reachable_but_unpublished(side) for side in SIDES}
    areas = (
        area(printed),
        cross_section_area(),
        area(wrong["both"]),
        area(missed["both"]),
    )
    volumes = volume(), _revolved(wrong), _revolved(missed)
    return PublishedErrors(*areas, 2 * math.pi * first_moment(printed), *volumes)


def published_but_unreachable(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what the document claims and no joint position within the limits reaches.

    Args:
        side: As for `boundary`.
    """
    return _difference(checks.choice("side", side, SIDES), True)


def reachable_but_unpublished(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what can be reached and the document leaves out.

    Args:
        side: As for `boundary`.
    """
    return _difference(checks.choice("side", side, SIDES), False)


@cache
def _difference(side: str, published: bool) -> tuple[Arc, ...]:
    """Boundary of what one of the two has, published or reached, and the other lacks."""
    arcs = _printed_arcs() + [
        arc for pose in SIDES[:2] for arc in reach.critical_arcs(pose)
    ]
    return reach.trace(
        arcs,
        lambda R, z: (
            (in_tori(R, z) == published) & (in_half_plane(R, z, side) != published)
        ),
    )


def _printed_arcs() -> list[Arc]:
    tori = published_tori()
    return [
        Arc(t.center, t.radius, 0.0, math.tau, 0, t.name, "published") for t in tori
    ]


def in_tori(radius: FloatArray, z: FloatArray) -> BoolArray:
    """Which points of a half-plane (R, z) [m] satisfy the three inequalities of Section 1.2."""
    radius, z = checks.together(radius=radius, z=z)
    inside = np.ones(radius.shape, np.bool_)
    for torus in published_tori():
        with np.errstate(over="ignore"):  # infinitely far is outside as well
            squared = (radius - torus.center[0]) ** 2 + (z - torus.center[1]) ** 2
        inside &= (
            squared <= torus.radius**2 if torus.inside else squared >= torus.radius**2
        )
    return inside


def _revolved(arcs: dict[str, tuple[Arc, ...]], limits: bool = True) -> float:
    """Volume of what arcs bound, by the poses that an azimuth is open to [m^3]."""
    underarm, overarm, both = (first_moment(arcs[side]) for side in SIDES)
    g = arm_plane()
    wedge = 2 * math.pi - (g.upper[0] - g.lower[0]) if limits else 0.0
    return (2 * math.pi - 2 * wedge) * both + wedge * (underarm + overarm)


class Singularities(NamedTuple):
    """Distance of joint positions from the singular sets.

    Attributes:
        stretched: theta_2 less the angle of the stretched arm, wrapped to [-pi, pi), (...) [rad].
        folded: theta_2 less the angle of the folded arm, wrapped to [-pi, pi), (...) [rad].
        yaw_axis: Distance of the tcp from the yaw axis in the plane of the arm, (...) [m]; positive
            in front of it.
    """

    stretched: FloatArray
    folded: FloatArray
    yaw_axis: FloatArray

    def near(self, angle: float = 1e-6, distance: float = 1e-6) -> BoolArray:
        """Closer than ``angle`` [rad] or ``distance`` [m] to any of the three sets, (...)."""
        angle, distance = (
            checks.real("angle", angle, 0.0),
            checks.real("distance", distance, 0.0),
        )
        elbow = np.minimum(np.abs(self.stretched), np.abs(self.folded))
        return np.asarray((elbow < angle) | (np.abs(self.yaw_axis) < distance))


def singularities(q: ArrayLike) -> Singularities:
    """How far joint positions are from the three singular sets.

    Args:
        q: (..., 4) [rad].
    """
    gamma, r = _plane_coordinates(q)
    return Singularities(wrap(gamma - math.pi), wrap(gamma), r)


def singular_elbow_angles() -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad]; the folded one is beyond its limits."""
    g = arm_plane()
    return {"stretched": math.pi - g.gamma_offset, "folded": -g.gamma_offset}


def manipulability(q: ArrayLike) -> FloatArray:
    """Yoshikawa's measure of the tcp's linear motion, ``sqrt(det(J_v J_v^T))`` [Yoshikawa1985].

    Args:
        q: (..., 4) [rad].

    Returns:
        (...) [m^3]: volume of the velocity parallelepiped for unit joint speeds.
    """
    g = arm_plane()
    gamma, r = _plane_coordinates(q)
    return np.asarray(np.abs(r * np.sin(gamma)) * (g.l_1 * g.l_2))


def _plane_coordinates(q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """gamma [rad] and the tcp's signed distance from the yaw axis [m], each (...)."""
    g = arm_plane()
    position = float_array("q", q, (4,))
    phi, gamma = position[..., 1] + g.phi_offset, position[..., 2] + g.gamma_offset
    return gamma, g.a_0 + g.l_1 * np.cos(phi) + g.l_2 * np.cos(phi + math.pi - gamma)
