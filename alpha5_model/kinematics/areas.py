"""Area and volume of the reachable set, exact."""

from __future__ import annotations

import math
from collections.abc import Mapping

from alpha5_model.kinematics.arcs import Arc, area, first_moment
from alpha5_model.kinematics.boundaries import boundary
from alpha5_model.kinematics.half_plane import SIDES
from alpha5_model.kinematics.plane import ArmPlane


def cross_section_area(plane: ArmPlane, side: str, limits: bool) -> float:
    """Area of the reachable part of a half-plane through the yaw axis [m^2]."""
    return area(boundary(plane, side, limits))


def volume(plane: ArmPlane, limits: bool) -> float:
    """Volume of the reachable set [m^3]."""
    return revolved(
        plane, {side: boundary(plane, side, limits) for side in SIDES}, limits
    )


def revolved(
    plane: ArmPlane, arcs: Mapping[str, tuple[Arc, ...]], limits: bool = True
) -> float:
    """Volume of regions of the half-plane that are revolved about the yaw axis [m^3].

    Each pose turns through the azimuths that it can face.

    Args:
        plane: The arm's.
        arcs: Boundaries of the regions, by side.
        limits: Whether theta_0 has limits. Then only the underarm pose can face one
            wedge of azimuths, and only the overarm pose the opposite wedge.
    """
    underarm, overarm, both = (first_moment(arcs[side]) for side in SIDES)
    turn = plane.upper[0] - plane.lower[0]
    wedge = 2 * math.pi - turn if limits else 0.0
    return (2 * math.pi - 2 * wedge) * both + wedge * (underarm + overarm)
