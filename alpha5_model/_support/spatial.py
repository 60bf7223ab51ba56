"""Rotations, rigid transforms and angles as in a URDF; lengths in metres, angles in radians."""

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
    """The angle, shifted by full turns into the turn around ``middle``, elementwise."""
    a = np.asarray(angle, dtype=np.float64)
    return np.asarray(a - math.tau * np.rint((a - middle) / math.tau))


def cross_matrix(vector: ArrayLike) -> FloatArray:
    """The matrices [v]x, (..., 3, 3), of vectors (..., 3), with ``[v]x w = v x w``."""
    x, y, z = np.asarray(vector).T
    zero = 0.0 * x
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).T.swapaxes(-1, -2)


def rotation_about(axis: ArrayLike, angle: ArrayLike) -> FloatArray:
    """Rotations about unit vectors (..., 3) by angles (...), by Rodrigues' formula, (..., 3, 3)."""
    k, a = cross_matrix(axis), np.asarray(angle)[..., None, None]
    return np.asarray(np.eye(3) + np.sin(a) * k + (1.0 - np.cos(a)) * (k @ k))


def rotation_from_rpy(rpy: Sequence[float] | FloatArray) -> FloatArray:
    """``Rz(yaw) Ry(pitch) Rx(roll)``, (3, 3): URDF's fixed-axis roll, pitch, yaw."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    x = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
    y = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
    return np.array([x, y, (-sp, cp * sr, cp * cr)])


def rpy_from_rotation(r: FloatArray) -> Triple:
    """Fixed-axis roll, pitch, yaw of a rotation (3, 3); at a pitch of +-pi/2 the roll is zero."""
    across = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], across)
    if across > 1e-3:
        return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])
    yaw = (
        math.atan2(r[1, 0], r[0, 0]) if across > 1e-9 else math.atan2(-r[0, 1], r[1, 1])
    )
    # Yaw is inaccurate here: roll from what yaw leaves, so that the errors cancel.
    s, c = math.sin(yaw), math.cos(yaw)
    return math.atan2(s * r[0, 2] - c * r[1, 2], c * r[1, 1] - s * r[0, 1]), pitch, yaw


def quaternion_from_rpy(rpy: Sequence[float]) -> tuple[float, float, float, float]:
    """(x, y, z, w) of the same rotation as `rotation_from_rpy`."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(np.divide(rpy, 2)), np.cos(np.divide(rpy, 2))
    x, y = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy
    z, w = cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy
    return float(x), float(y), float(z), float(w)


def transform(
    rotation: ArrayLike | None = None, translation: ArrayLike = (0, 0, 0)
) -> FloatArray:
    """Transforms (..., 4, 4) of rotations (..., 3, 3), if any, and translations (..., 3)."""
    r = np.eye(3) if rotation is None else np.asarray(rotation)
    out = np.zeros((*r.shape[:-2], 4, 4))
    out[..., :3, :3], out[..., :3, 3], out[..., 3, 3] = r, translation, 1.0
    return out


def moved(transform: FloatArray, points: FloatArray) -> FloatArray:
    """Points (..., 3), carried by transforms (..., 4, 4)."""
    return np.asarray(
        (transform[..., :3, :3] @ points[..., None])[..., 0] + transform[..., :3, 3]
    )


def pose(xyz: ArrayLike, rpy: Sequence[float] | FloatArray) -> FloatArray:
    """Homogeneous transform (4, 4) of URDF's ``<origin>``."""
    return transform(rotation_from_rpy(rpy), xyz)


def excess_of_box(point: FloatArray, bounds: FloatArray) -> float:
    """Distance of a point (3,) from a box (3, 2); 0 inside."""
    outside = np.maximum(np.maximum(bounds[:, 0] - point, point - bounds[:, 1]), 0.0)
    return float(np.linalg.norm(outside))
