"""Area, volume and boundary of what the arm reaches, and its singularities.

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

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support import checks
from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.half_plane import (
    POSES,
    SIDES,
    Arc,
    area,
    azimuth_beyond,
    boundary,
    first_moment,
    in_half_plane,
)
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.reach import (
    Accept,
    distance_to_reach,
    nearest_reachable,
    reachable,
)
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

__all__ = [
    "SIDES",
    "Arc",
    "SampledShare",
    "Singularities",
    "boundary",
    "cross_section_area",
    "distance_to_reach",
    "in_half_plane",
    "manipulability",
    "nearest_reachable",
    "reachable",
    "sampled_share",
    "singular_elbow_angles",
    "singularities",
    "volume",
]

#: A pose can face an azimuth if it misses it by less than this [rad].
_FACED = 1e-6


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
    return area(boundary(side, limits, arm=arm))


def volume(limits: bool = True, *, arm: Alpha5Parameters | None = None) -> float:
    """Volume of the reachable set, exact [m^3].

    Args:
        limits: Respect the limits of theta_0, theta_1 and theta_2. With them, a wedge
            of azimuths belongs to the overarm pose alone, and the opposite one to the
            underarm pose alone.
        arm: As for `cross_section_area`.
    """
    arcs = {side: boundary(side, limits, arm=arm) for side in SIDES}
    return revolved(Geometry.of(chosen_arm(arm)), arcs, limits)


def revolved(
    geometry: Geometry, arcs: Mapping[str, tuple[Arc, ...]], limits: bool = True
) -> float:
    """Volume of regions of the half-plane that are revolved about the yaw axis [m^3].

    Each pose turns through the azimuths that it can face.

    Args:
        geometry: Of the arm.
        arcs: Boundaries of the regions, by side.
        limits: Whether theta_0 has limits. Then only the underarm pose can face one
            wedge of azimuths, and only the overarm pose the opposite wedge.
    """
    underarm, overarm, both = (first_moment(arcs[side]) for side in SIDES)
    turn = geometry.upper[0] - geometry.lower[0]
    wedge = 2 * math.pi - turn if limits else 0.0
    return (2 * math.pi - 2 * wedge) * both + wedge * (underarm + overarm)


class SampledShare(NamedTuple):
    """A share of the reachable set, from points drawn evenly from it.

    Attributes:
        share: 0 to 1.
        standard_error: Of the share, 1 sigma; computed with one success and one
            failure added, so that it is never zero.
        total: Exact volume of the reachable set [m^3], or its area in a half-plane
            [m^2].
        samples: Number of points.
    """

    share: float
    standard_error: float
    total: float
    samples: int


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
    record = chosen_arm(arm)
    number = checks.count("samples", samples)
    rng = checks.generator(seed)
    fixed = None if azimuth is None else checks.real("azimuth", azimuth)

    parts: list[FloatArray] = []
    missing = number
    while missing:
        around = _points_around(Geometry.of(record), 2 * missing + 16, rng, fixed)
        parts.append(around[reachable(around, arm=record)][:missing])
        missing -= len(parts[-1])
    hits = int(reachable(np.concatenate(parts), accept=accept, arm=record).sum())

    smoothed = (hits + 1) / (number + 2)
    if fixed is None:
        total = volume(arm=record)
    else:
        total = cross_section_area(_facing(Geometry.of(record), fixed), arm=record)
    return SampledShare(
        share=hits / number,
        standard_error=math.sqrt(smoothed * (1 - smoothed) / number),
        total=total,
        samples=number,
    )


def _points_around(
    geometry: Geometry, number: int, rng: np.random.Generator, azimuth: float | None
) -> FloatArray:
    """Points drawn evenly from a cylinder around the reachable set, (number, 3).

    With an azimuth they are drawn from a rectangle of its half-plane.
    """
    u, height, turn = rng.uniform(size=(3, number))
    if azimuth is None:
        share_of_radius = np.sqrt(u)  # even in volume: R^2 is uniform
        angle = 2 * math.pi * turn
    else:
        share_of_radius = u  # even in area
        angle = np.full_like(turn, azimuth)
    radius = (geometry.a_0 + geometry.longest) * share_of_radius
    z = geometry.d_0 + geometry.longest * (2 * height - 1)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)


def _facing(geometry: Geometry, azimuth: float) -> str:
    """The side of poses that can face an azimuth."""
    facing = []
    for pose in POSES:
        if abs(azimuth_beyond(geometry, azimuth, pose)) < _FACED:
            facing.append(pose)
    return facing[0] if len(facing) == 1 else "both"


class Singularities(NamedTuple):
    """Distance of joint positions from the singular sets.

    Attributes:
        stretched: theta_2 minus the angle of the stretched arm, wrapped to [-pi, pi),
            (...) [rad].
        folded: theta_2 minus the angle of the folded arm, wrapped to [-pi, pi),
            (...) [rad].
        yaw_axis: Distance of the tcp from the yaw axis in the plane of the arm,
            (...) [m]; positive in front of it. For a tool beside the wrist axis, 0 is
            the cylinder on which underarm and overarm coincide.
    """

    stretched: FloatArray
    folded: FloatArray
    yaw_axis: FloatArray

    def near(self, angle: float = 1e-6, distance: float = 1e-6) -> BoolArray:
        """Closer than ``angle`` [rad] or ``distance`` [m] to any of the sets, (...)."""
        angle = checks.real("angle", angle, 0.0)
        distance = checks.real("distance", distance, 0.0)
        elbow = np.minimum(np.abs(self.stretched), np.abs(self.folded))
        return np.asarray((elbow < angle) | (np.abs(self.yaw_axis) < distance))


class _InPlane(NamedTuple):
    """Joint positions in the plane of the arm at their theta_3, (...) each.

    Attributes:
        gamma: Angle between the links [rad].
        r: The tcp's distance from the yaw axis, positive in front of it [m].
        l_2: Length of the second link [m].
    """

    gamma: FloatArray
    r: FloatArray
    l_2: FloatArray

    @classmethod
    def of(cls, geometry: Geometry, q: FloatArray) -> _InPlane:
        """Joint positions (..., 4) [rad]."""
        c, _ = geometry.tool_in_forearm(q[..., 3])
        l_2 = np.hypot(c, geometry.z)
        gamma_offset = geometry.zeros[2] + math.pi - np.arctan2(-geometry.z, c)

        phi = q[..., 1] + geometry.phi_offset
        gamma = q[..., 2] + gamma_offset
        forearm = phi + math.pi - gamma
        r = geometry.a_0 + geometry.l_1 * np.cos(phi) + l_2 * np.cos(forearm)
        return cls(gamma=gamma, r=r, l_2=l_2)


def singularities(
    q: ArrayLike, *, arm: Alpha5Parameters | None = None
) -> Singularities:
    """How far joint positions are from the three singular sets, at their theta_3.

    Args:
        q: (..., 4) [rad].
        arm: Record of the arm; None is the catalogue's.
    """
    position = float_array("q", q, (4,))
    plausibility.check_largest("q", position, plausibility.ANGLE)
    at = _InPlane.of(Geometry.of(chosen_arm(arm)), position)
    return Singularities(
        stretched=wrap(at.gamma - math.pi), folded=wrap(at.gamma), yaw_axis=at.r
    )


def singular_elbow_angles(*, arm: Alpha5Parameters | None = None) -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad].

    The folded one is beyond the published limits.

    Args:
        arm: As for `cross_section_area`.
    """
    geometry = Geometry.of(chosen_arm(arm))
    geometry.require_tool_on_axis("singular elbow angles")
    return {
        "stretched": math.pi - geometry.gamma_offset,
        "folded": -geometry.gamma_offset,
    }


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
    record = chosen_arm(arm)
    geometry = Geometry.of(record)
    position = float_array("q", q, (4,))
    plausibility.check_largest("q", position, plausibility.ANGLE)
    if geometry.tool_on_axis:
        at = _InPlane.of(geometry, position)
        return np.asarray(np.abs(at.r * np.sin(at.gamma)) * geometry.l_1 * at.l_2)

    # theta_3 moves the tcp, too: there is no closed form.
    jacobian = Hand.of(record).chain.jacobian(position)[..., :3, :]
    square = np.linalg.det(jacobian @ np.swapaxes(jacobian, -1, -2))
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))
