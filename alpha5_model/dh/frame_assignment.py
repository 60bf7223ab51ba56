"""Standard DH frames from joint axes, by the common normals.

``x_j`` lies on the common normal of ``z_{j-1}`` and ``z_j`` and points from the first to the
second; the origin of {j} is where it meets ``z_j``. Where the rule leaves a choice:

- intersecting axes: ``x_j`` along ``z_{j-1} x z_j``, so alpha_j lies in (0, pi);
- parallel axes: the normal through the origin of {j-1}, so d_j is zero;
- one and the same axis: ``x_j = x_{j-1}``, same origin, so theta_j, d_j, a_j are zero;
- {0}: the world frame if its z is the first joint's axis, else the frame on that axis that makes
  theta_1 and d_1 zero;
- {N}: ``z_N`` is the z axis of the end effector, and what is left of its pose is the chain's tool.
  Where that axis is parallel to the last joint's, {N} has the end effector's origin, and on the
  same axis its x too: then nothing is left.

References:
    [Lecture7.1] Describing Robot Arms, "Frame assignment".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.8.2 (the cases where it is not unique).
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.errors import InputError, ShapeError


def frames_on_axes(
    p: FloatArray, z: FloatArray, end: FloatArray | None, tolerance: float
) -> list[FloatArray]:
    """Frames {0} ... {N} of a serial arm drawn at one configuration, (4, 4) each, in the world.

    Args:
        p: A point on each joint axis, (N, 3) [m].
        z: Unit direction of each axis, (N, 3).
        end: transform_end_effector_to_world, (4, 4); without one {N} is {N-1}.
        tolerance: Axes within this angle [rad] count as parallel, within this distance [m] as
            intersecting.
    """
    if end is not None:
        p, z = np.vstack([p, end[:3, 3]]), np.vstack([z, end[:3, 2]])
    first = _frame(p[0], _any_normal(z[0]), z[0])
    off_axis = max(math.hypot(*z[0, :2]), math.hypot(*p[0, :2]))
    if off_axis <= tolerance and z[0, 2] > 0:
        first = np.eye(4)
    elif len(p) > 1:  # {0} is {1} seen from the first axis: theta_1 = d_1 = 0
        x, _, foot = _normal(first, p[1], z[1], tolerance)
        first = _frame(foot, x, z[0])
    frames = [first]
    for point, direction in zip(p[1:], z[1:], strict=True):
        x, origin, _ = _normal(frames[-1], point, direction, tolerance)
        frames.append(_frame(origin, x, direction))
    if end is None:
        frames.append(frames[-1])
    elif np.linalg.norm(np.cross(z[-2], z[-1])) <= tolerance:
        away = np.cross(np.cross(z[-1], end[:3, 3] - p[-2]), z[-1])
        same_axis = np.linalg.norm(away) <= tolerance
        frames[-1] = _frame(end[:3, 3], (end if same_axis else frames[-1])[:3, 0], z[-1])
    return frames


def table_row(step: FloatArray) -> tuple[float, float, float, float]:
    """theta, d, a, alpha of a relative pose that has the form of A_j."""
    theta, alpha = math.atan2(step[1, 0], step[0, 0]), math.atan2(step[2, 1], step[2, 2])
    a = step[0, 3] * step[0, 0] + step[1, 3] * step[1, 0]
    return theta, float(step[2, 3]), float(a), alpha


def common_normal(
    point_1: ArrayLike, direction_1: ArrayLike, point_2: ArrayLike, direction_2: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Feet of the common normal of two lines that are not parallel.

    Args:
        point_1, direction_1: A point (3,) [m] and the direction (3,) of the first line.
        point_2, direction_2: The same of the second line.

    Returns:
        The nearest point of the first line and that of the second, (3,) each [m].
    """
    p1, z1 = float_array("point_1", point_1, (3,)), float_array("direction_1", direction_1, (3,))
    p2, z2 = float_array("point_2", point_2, (3,)), float_array("direction_2", direction_2, (3,))
    shapes = tuple(v.shape for v in (p1, z1, p2, z2))
    if set(shapes) != {(3,)}:
        raise ShapeError("points and directions", shapes, "shape (3,) each")
    cross = np.cross(z1, z2)
    square = cross @ cross
    if square == 0:
        raise InputError("direction_2", z2.tolist(), "a line that is not parallel to the first")
    between = p2 - p1
    s1 = np.cross(between, z2) @ cross / square
    s2 = np.cross(between, z1) @ cross / square
    return p1 + s1 * z1, p2 + s2 * z2


def _normal(
    previous: FloatArray, point: FloatArray, z: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Direction of x_j, origin of {j}, and the foot of the common normal on z_{j-1}."""
    origin, x_before, z_before = previous[:3, 3], previous[:3, 0], previous[:3, 2]
    cross = np.cross(z_before, z)
    sine = math.sqrt(cross @ cross)
    if sine > tolerance:
        foot_1, foot_2 = common_normal(origin, z_before, point, z)
        side = (foot_2 - foot_1) @ cross
        x = cross / sine
        return (-x if side / sine < -tolerance else x), foot_2, foot_1
    across = point - origin
    across = across - (across @ z_before) * z_before
    distance = math.sqrt(across @ across)
    x = across / distance if distance > tolerance else x_before
    return x, origin + across, origin


def _frame(origin: FloatArray, x: FloatArray, z: FloatArray) -> FloatArray:
    x = x - (x @ z) * z
    x = x / math.sqrt(x @ x)
    out = np.eye(4)
    out[:3, 0], out[:3, 1], out[:3, 2], out[:3, 3] = x, np.cross(z, x), z, origin
    return out


def _any_normal(z: FloatArray) -> FloatArray:
    """The world axis that is farthest from z, made perpendicular to it."""
    x = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = x - (x @ z) * z
    return np.asarray(x / math.sqrt(x @ x))
