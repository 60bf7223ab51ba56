"""The exact reachable set of the tcp: its boundary as arcs, and distances from it.

Within the limits the reachable set is no full solid of revolution: theta_0 turns 350.97
degrees, so a wedge of azimuths is closed to the underarm pose and the opposite wedge to
the overarm pose. The set is the union of the two poses, each turned through the
azimuths that it can face. A point in the closed wedge of one pose may still be reached
by the other, and the nearest point of a pose to a target in its wedge lies in the
wedge's face.

All this is exact for any arm whose tool point is on the wrist axis, with its own
lengths, zeros and limits. For a tool point beside that axis the set is a union over
theta_3, which arcs do not bound. The functions then raise an error;
`alpha5_model.inverse_kinematics` is exact at each theta_3.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics.arcs import Arc
from alpha5_model.kinematics.catalogue_arm import kinematics_of
from alpha5_model.kinematics.half_plane import SIDES
from alpha5_model.kinematics.reachable_points import Accept
from alpha5_model.numbers.parameters import Alpha5Parameters

__all__ = [
    "SIDES",
    "Accept",
    "Arc",
    "boundary",
    "distance_to_reach",
    "in_half_plane",
    "nearest_reachable",
    "reachable",
]


def boundary(
    side: str = "both", limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> tuple[Arc, ...]:
    """Boundary arcs of the reachable part of a half-plane.

    The yaw axis, which closes the region at R = 0, is not listed: it is no boundary of
    the reachable set, which goes on beyond it.

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union, which holds
            at all azimuths where the range of theta_0 allows both.
        limits: Respect the limits of theta_1 and theta_2.
        arm: Record of the arm; None is the catalogue's.

    Raises:
        UnknownNameError: Another side.
        InputError: Limits that are neither True nor False, or a tool point beside the
            wrist axis.
    """
    return kinematics_of(arm).boundary(side, limits)


def in_half_plane(
    radius: FloatArray,
    z: FloatArray,
    side: str = "both",
    limits: bool = True,
    *,
    arm: Alpha5Parameters | None = None,
) -> BoolArray:
    """Which points of a half-plane can be reached, theta_0 aside.

    Args:
        radius: Distance from the yaw axis, (...) [m].
        z: Height, (...) [m].
        side, limits, arm: As for `boundary`.
    """
    return kinematics_of(arm).in_half_plane(radius, z, side, limits)


def reachable(
    positions: ArrayLike,
    limits: bool = True,
    accept: Accept | None = None,
    *,
    arm: Alpha5Parameters | None = None,
) -> BoolArray:
    """Whether the tcp reaches a point: any branch of the inverse kinematics does.

    The wrist angle moves no point and plays no part.

    Args:
        positions: In ``base_link``, (..., 3) [m].
        limits: Respect the limits of theta_0, theta_1 and theta_2; without, all angles
            are free.
        accept: Counts a branch only if this returns True for its joint position: a
            function of (M, 4) [rad], (M,) bool, such as
            `alpha5_model.without_self_collision`. theta_3 is the middle of its range,
            and on the yaw axis theta_0 is tried every 10 degrees.
        arm: Record of the arm; None is the catalogue's.

    Returns:
        (...) bool; the boundary belongs to the set.

    Raises:
        InputError: Not real numbers of that shape (`NonFiniteError` names a bad row),
            limits that are neither True nor False, or a tool point beside the wrist
            axis.
    """
    return kinematics_of(arm).reachable(positions, limits, accept)


def distance_to_reach(
    positions: ArrayLike, limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> FloatArray:
    """Distance to the nearest reachable point, exactly 0 inside.

    Args:
        positions, limits, arm: As for `reachable`.

    Returns:
        (...) [m].
    """
    return kinematics_of(arm).distance_to_reach(positions, limits)


def nearest_reachable(
    positions: ArrayLike, limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> FloatArray:
    """The nearest reachable point; a reachable one is returned as it is.

    Args:
        positions, limits, arm: As for `reachable`.

    Returns:
        (..., 3) [m].
    """
    return kinematics_of(arm).nearest_reachable(positions, limits)
