"""Which pose reaches a half-plane through the yaw axis, R >= 0 outwards and z up.

The arm that faces the half-plane reaches it from its front (underarm). The arm that
turns away reaches it from its back (overarm, the plane of the arm mirrored).
"""

from __future__ import annotations

import math

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, choice, flag, together
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.solver import solve_batch

#: How a half-plane is reached: by one pose, or by either.
SIDES = ("underarm", "overarm", "both")
#: The two poses.
POSES = SIDES[:2]


def middle_azimuth(plane: ArmPlane, side: str) -> float:
    """Azimuth that a pose faces with theta_0 in the middle of its range [rad]."""
    turned = SIDES.index(side) * math.pi
    return plane.middle[0] + plane.azimuth_offset - turned


def azimuth_beyond(
    plane: ArmPlane, azimuth: FloatArray | float, side: str
) -> FloatArray:
    """Azimuths minus the nearest ones that a pose can face, (...) [rad]."""
    half = (plane.upper[0] - plane.lower[0]) / 2
    off = wrap(azimuth - middle_azimuth(plane, side))
    return off - np.clip(off, -half, half)


def in_half_plane(
    plane: ArmPlane,
    radius: FloatArray,
    z: FloatArray,
    side: str,
    limits: bool,
) -> BoolArray:
    """Which points of a half-plane the arm reaches, theta_0 aside, (...)."""
    choice("side", side, SIDES)
    limits = flag("limits", limits)
    radius, z = together(radius=radius, z=z)

    reached = np.zeros(radius.shape, np.bool_)
    for branch, pose in enumerate(POSES):
        if side not in (pose, "both"):
            continue
        azimuth = middle_azimuth(plane, pose)
        x = radius * math.cos(azimuth)
        y = radius * math.sin(azimuth)
        of_branches = branches_reaching(plane, np.stack([x, y, z], axis=-1), limits)
        reached |= of_branches[..., branch::2].any(axis=-1)  # with either elbow
    return reached


def branches_reaching(plane: ArmPlane, target: FloatArray, limits: bool) -> BoolArray:
    """Which branches reach targets (..., 3), with theta_3 in mid-range, (..., 4)."""
    wrist = np.asarray(plane.middle[3])
    solutions = solve_batch(target, wrist, plane.shape, angles=False)
    return solutions.within_limits if limits else solutions.exists
