"""Rotations, rigid transforms and angles with URDF's conventions, in m and rad."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Placement:
    """Pose of a child frame in its parent.

    Attributes:
        parent: Name of the parent frame.
        xyz: Origin [m].
        rpy: Fixed-axis roll, pitch, yaw [rad].
    """

    parent: str
    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


def wrap(angle: ArrayLike, middle: float = 0.0) -> FloatArray:
    """Angles, shifted by full turns to within half a turn of ``middle``."""
    a = np.asarray(angle, dtype=np.float64)
    return np.asarray(a - math.tau * np.rint((a - middle) / math.tau))


def cross_matrix(vector: ArrayLike) -> FloatArray:
    """The matrices [v]x, (..., 3, 3), of vectors (..., 3), with ``[v]x w = v x w``."""
    x, y, z = np.asarray(vector).T
    zero = 0.0 * x
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).T.swapaxes(-1, -2)


def rotation_about(axis: ArrayLike, angle: ArrayLike) -> FloatArray:
    """Rotations (..., 3, 3) about unit vectors (..., 3) by angles (...): Rodrigues."""
    k = cross_matrix(axis)
    a = np.asarray(angle)[..., None, None]
    return np.asarray(np.eye(3) + np.sin(a) * k + (1.0 - np.cos(a)) * (k @ k))


def rotation_from_rpy(rpy: Sequence[float] | FloatArray) -> FloatArray:
    """``Rz(yaw) Ry(pitch) Rx(roll)``, (3, 3): URDF's fixed-axis roll, pitch, yaw."""
    sr, sp, sy = np.sin(rpy)
    cr, cp, cy = np.cos(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_rotation(r: FloatArray) -> Triple:
    """Fixed-axis roll, pitch, yaw of a rotation (3, 3).

    At a pitch of +-pi/2 the roll is zero.
    """
    cos_pitch = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], cos_pitch)
    if cos_pitch > 1e-9:
        yaw = math.atan2(r[1, 0], r[0, 0])
    else:
        yaw = math.atan2(-r[0, 1], r[1, 1])
    if cos_pitch > 1e-3:
        return math.atan2(r[2, 1], r[2, 2]), pitch, yaw

    # Yaw is inaccurate here. Roll is computed from the rest of the rotation after this
    # yaw, so that the errors cancel.
    sin_yaw = math.sin(yaw)
    cos_yaw = math.cos(yaw)
    sin_roll = sin_yaw * r[0, 2] - cos_yaw * r[1, 2]
    cos_roll = cos_yaw * r[1, 1] - sin_yaw * r[0, 1]
    return math.atan2(sin_roll, cos_roll), pitch, yaw


def quaternion_from_rpy(rpy: Sequence[float]) -> tuple[float, float, float, float]:
    """(x, y, z, w) of the same rotation as `rotation_from_rpy`."""
    half = np.divide(rpy, 2)
    sr, sp, sy = np.sin(half)
    cr, cp, cy = np.cos(half)
    x = sr * cp * cy - cr * sp * sy
    y = cr * sp * cy + sr * cp * sy
    z = cr * cp * sy - sr * sp * cy
    w = cr * cp * cy + sr * sp * sy
    return float(x), float(y), float(z), float(w)


def transform(
    rotation: ArrayLike | None = None, translation: ArrayLike = (0, 0, 0)
) -> FloatArray:
    """Transforms (..., 4, 4) from rotations (..., 3, 3) and translations (..., 3)."""
    r = np.eye(3) if rotation is None else np.asarray(rotation)
    out = np.zeros((*r.shape[:-2], 4, 4))
    out[..., :3, :3] = r
    out[..., :3, 3] = translation
    out[..., 3, 3] = 1.0
    return out


def inverse(transform: FloatArray) -> FloatArray:
    """The inverses of rigid transforms (..., 4, 4)."""
    turned_back = np.swapaxes(transform[..., :3, :3], -1, -2)
    out = np.zeros(transform.shape)
    out[..., :3, :3] = turned_back
    out[..., :3, 3] = -(turned_back @ transform[..., :3, 3:])[..., 0]
    out[..., 3, 3] = 1.0
    return out


def moved(transform: FloatArray, points: FloatArray) -> FloatArray:
    """Points (..., 3) after transforms (..., 4, 4)."""
    rotated = (transform[..., :3, :3] @ points[..., None])[..., 0]
    return np.asarray(rotated + transform[..., :3, 3])


def pose(xyz: ArrayLike, rpy: Sequence[float] | FloatArray) -> FloatArray:
    """Homogeneous transform (4, 4) of URDF's ``<origin>``."""
    return transform(rotation_from_rpy(rpy), xyz)


def angles_between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angles between the orientations of poses (..., 4, 4), (...) [rad]."""
    relative = np.swapaxes(one[..., :3, :3], -1, -2) @ other[..., :3, :3]
    skew = relative - np.swapaxes(relative, -1, -2)
    sine = np.linalg.norm(skew, axis=(-2, -1)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2
    return np.asarray(np.arctan2(sine, cosine))


def excess_of_box(point: FloatArray, bounds: FloatArray) -> float:
    """Distance of a point (3,) from a box (3, 2); 0 inside."""
    below = bounds[:, 0] - point
    above = point - bounds[:, 1]
    outside = np.maximum(np.maximum(below, above), 0.0)
    return float(np.linalg.norm(outside))
