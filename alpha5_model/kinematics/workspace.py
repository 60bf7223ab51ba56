"""The workspace: as published, as it is, and how much of the published one is wrong.

`boundary` gives the exact arcs. `reachable`, `distance_to_reach` and
`nearest_reachable` answer for points, `manipulability` and `singularities` for joint
positions.

Joint 0 moves the tcp across the plane in proportion to its distance r from the yaw
axis. Joints 1 and 2 move it within the plane, in proportion to sin(gamma). The linear
Jacobian of the three has the determinant

    |det J_v| = |r| l_1 l_2 |sin gamma|                       [Siciliano2009, 3.3]

which is Yoshikawa's manipulability ``sqrt(det(J_v J_v^T))``. It vanishes if the arm is
stretched (gamma = pi) or folded (gamma = 0, beyond the limits of theta_2), or the tcp
is on the yaw axis (r = 0).

References:
    [Yoshikawa1985] Manipulability of robotic mechanisms, Int. J. Robotics Research
        4(2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 3.3 and
        3.9.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics import published_region
from alpha5_model.kinematics.arcs import Arc
from alpha5_model.kinematics.catalogue_arm import catalogue, kinematics_of
from alpha5_model.kinematics.published_region import PublishedErrors, Torus
from alpha5_model.kinematics.reach import (
    SIDES,
    Accept,
    boundary,
    distance_to_reach,
    in_half_plane,
    nearest_reachable,
    reachable,
)
from alpha5_model.kinematics.sampled_shares import SampledShare
from alpha5_model.kinematics.singular import Singularities
from alpha5_model.numbers.parameters import Alpha5Parameters

__all__ = [
    "SIDES",
    "Arc",
    "PublishedErrors",
    "SampledShare",
    "Singularities",
    "Torus",
    "boundary",
    "cross_section_area",
    "distance_to_reach",
    "in_half_plane",
    "in_tori",
    "manipulability",
    "nearest_reachable",
    "published_but_unreachable",
    "published_errors",
    "published_reachable",
    "published_tori",
    "reachable",
    "reachable_but_unpublished",
    "sampled_share",
    "singular_elbow_angles",
    "singularities",
    "volume",
]


def published_tori() -> tuple[Torus, Torus, Torus]:
    """The three limits of Section 1.2, as printed.

    They contain 39.94 mm, where Table 1 has 40. d_3 is negative.
    """
    return published_region.published_tori(catalogue().parameters)


def published_reachable(positions: ArrayLike) -> BoolArray:
    """Whether a point satisfies all three inequalities of Section 1.2.

    Args:
        positions: In ``base_link``, (..., 3) [m].

    Returns:
        (...) bool.
    """
    return published_region.published_reachable(catalogue().parameters, positions)


def in_tori(radius: FloatArray, z: FloatArray) -> BoolArray:
    """Which points (R, z) [m] satisfy the three inequalities of Section 1.2, (...)."""
    return published_region.in_tori(catalogue().parameters, radius, z)


def published_errors() -> PublishedErrors:
    """How much of the published region cannot be reached, and what it misses."""
    return published_region.published_errors(catalogue().parameters)


def published_but_unreachable(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what the document claims and the arm does not reach.

    Args:
        side: As for `boundary`.
    """
    return published_region.published_but_unreachable(catalogue().parameters, side)


def reachable_but_unpublished(side: str = "both") -> tuple[Arc, ...]:
    """Boundary of what the arm reaches and the document leaves out.

    Args:
        side: As for `boundary`.
    """
    return published_region.reachable_but_unpublished(catalogue().parameters, side)


def cross_section_area(
    side: str = "both", limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> float:
    """Area of the reachable part of a half-plane through the yaw axis, exact [m^2].

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union.
        limits: Respect the limits of theta_1 and theta_2.
        arm: Record of the arm; None is the catalogue's. Its tool point must be on the
            wrist axis.
    """
    return kinematics_of(arm).cross_section_area(side, limits)


def volume(limits: bool = True, *, arm: Alpha5Parameters | None = None) -> float:
    """Volume of the reachable set, exact [m^3].

    Args:
        limits: Respect the limits of theta_0, theta_1 and theta_2. With them, a wedge
            of azimuths belongs to the overarm pose alone, and the opposite one to the
            underarm pose alone.
        arm: As for `cross_section_area`.
    """
    return kinematics_of(arm).volume(limits)


def sampled_share(
    accept: Accept,
    samples: int = 20_000,
    seed: int = 0,
    azimuth: float | None = None,
    *,
    arm: Alpha5Parameters | None = None,
) -> SampledShare:
    """Share of the reachable volume that is reached in accepted joint positions.

    With `alpha5_model.without_self_collision` it is the share that the arm reaches
    without touching itself.

    Args:
        accept: As for `reachable`.
        samples: Number of points.
        seed: Of the points.
        azimuth: Of a half-plane through the yaw axis [rad]; the share is of its area
            then.
        arm: As for `cross_section_area`.

    Raises:
        InputError: Bad input, or an answer of ``accept`` that is not one True or False
            a row.
    """
    return kinematics_of(arm).sampled_share(accept, samples, seed, azimuth)


def singularities(
    q: ArrayLike, *, arm: Alpha5Parameters | None = None
) -> Singularities:
    """How far joint positions are from the three singular sets, at their theta_3.

    Args:
        q: (..., 4) [rad].
        arm: Record of the arm; None is the catalogue's.
    """
    return kinematics_of(arm).singularities(q)


def singular_elbow_angles(*, arm: Alpha5Parameters | None = None) -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad].

    The folded one is beyond the published limits.

    Args:
        arm: As for `cross_section_area`.
    """
    return kinematics_of(arm).singular_elbow_angles()


def manipulability(q: ArrayLike, *, arm: Alpha5Parameters | None = None) -> FloatArray:
    """Yoshikawa's measure of the tcp's linear motion [Yoshikawa1985].

    It is ``sqrt(det(J_v J_v^T))``. If the tool point of your own arm is beside the
    wrist axis, J_v has a fourth column, of theta_3, and the measure vanishes only if
    that does not help.

    Args:
        q: (..., 4) [rad].
        arm: Record of the arm; None is the catalogue's.

    Returns:
        (...) [m^3]: volume of the velocity parallelepiped for unit joint speeds.
    """
    return kinematics_of(arm).manipulability(q)
