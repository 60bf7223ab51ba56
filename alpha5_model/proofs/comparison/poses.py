"""Parts of poses, and what poses do to bodies."""

from __future__ import annotations

import math

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.inertia import rotate_tensor


def rotation_of(pose: FloatArray) -> FloatArray:
    """The rotation (..., 3, 3) of a pose (..., 4, 4)."""
    return pose[..., :3, :3]


def origin_of(pose: FloatArray) -> FloatArray:
    """The origin (..., 3) of a pose (..., 4, 4) [m]."""
    return pose[..., :3, 3]


def tilt_of(pose: FloatArray) -> float:
    """Angle between z of a pose (4, 4) and z of its parent [rad]."""
    x, y, z = rotation_of(pose)[:, 2]
    return math.atan2(math.hypot(x, y), z)


def carried_to(
    pose: FloatArray, com: FloatArray, inertia: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """COMs and tensors of bodies, expressed in another frame.

    Args:
        pose: Pose of the bodies' frame in the other frame, (..., 4, 4).
        com: (..., 3) [m].
        inertia: At the COM, (..., 3, 3) [kg m^2].
    """
    return moved(pose, com), rotate_tensor(rotation_of(pose), inertia)
