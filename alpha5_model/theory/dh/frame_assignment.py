"""Assign frames to the joint axes of a serial arm by the Denavit-Hartenberg rule.

``x_j`` lies on the common normal of ``z_{j-1}`` and ``z_j`` and points from the first
to the second; the origin of {j} is where it meets ``z_j``. If the rule leaves a choice:

- intersecting axes: ``x_j`` along ``z_{j-1} x z_j``, so alpha_j lies in (0, pi);
- parallel axes: the normal through the origin of {j-1}, so d_j is zero;
- one and the same axis: ``x_j = x_{j-1}``, same origin, so theta_j, d_j, a_j are zero;
- {0}: the world frame if its z is the first joint's axis, else the frame on that axis
  that makes theta_1 and d_1 zero;
- {N}: ``z_N`` is the z axis of the end effector, whose pose in {N} is the chain's tool.
  If that axis is parallel to the last joint's, {N} has the end effector's origin. If it
  is the same axis, {N} also has its x, and the tool is the identity.

References:
    [Lecture7.1] Describing Robot Arms, "Frame assignment".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.8.2 (where it is not unique).
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, float_array, real
from alpha5_model._support.spatial import transform
from alpha5_model.errors import InputError


class _Normal(NamedTuple):
    """The common normal of the axes of {j-1} and {j}.

    Attributes:
        x: Its direction, which is that of x_j, (3,).
        foot_before: Its foot on z_{j-1}, (3,) [m].
        foot: Its foot on z_j, which is the origin of {j}, (3,) [m].
    """

    x: FloatArray
    foot_before: FloatArray
    foot: FloatArray


def frames_on_axes(
    p: FloatArray, z: FloatArray, end: FloatArray | None, tolerance: float
) -> list[FloatArray]:
    """Frames {0} ... {N} of a serial arm at one configuration, (4, 4) each.

    Args:
        p: A point on each joint axis, (N, 3) [m].
        z: Unit direction of each axis, (N, 3).
        end: transform_end_effector_to_world, (4, 4); without one {N} is {N-1}.
        tolerance: Axes within this angle [rad] count as parallel, within this distance
            [m] as intersecting.

    Raises:
        InputError: A tolerance with which perpendicular axes would be parallel.
    """
    tolerance = real("tolerance", tolerance, minimum=0.0)
    if tolerance >= 1.0:
        expected = "a number below 1 (rad, m), else all axes count as parallel"
        raise InputError("tolerance", tolerance, expected)
    if end is not None:
        p = np.vstack([p, end[:3, 3]])
        z = np.vstack([z, end[:3, 2]])
    frames = [_first_frame(p, z, tolerance)]
    for point, direction in zip(p[1:], z[1:], strict=True):
        normal = _normal(frames[-1], point, direction, tolerance)
        frames.append(_frame(normal.foot, normal.x, direction))
    if end is None:
        frames.append(frames[-1])
    elif np.linalg.norm(np.cross(z[-2], z[-1])) <= tolerance:
        frames[-1] = _frame_of_end(end, p[-2], frames[-1], tolerance)
    return frames


def _first_frame(p: FloatArray, z: FloatArray, tolerance: float) -> FloatArray:
    """Frame {0}: the world frame, or a frame on the first axis."""
    off_axis = max(math.hypot(*z[0, :2]), math.hypot(*p[0, :2]))
    if off_axis <= tolerance and z[0, 2] > 0:
        return np.eye(4)
    far_from_z = np.eye(3)[np.abs(z[0]).argmin()]
    first = _frame(p[0], far_from_z, z[0])
    if len(p) == 1:
        return first
    # {0} is {1} seen from the first axis: theta_1 = d_1 = 0.
    normal = _normal(first, p[1], z[1], tolerance)
    return _frame(normal.foot_before, normal.x, z[0])


def _frame_of_end(
    end: FloatArray, point: FloatArray, last: FloatArray, tolerance: float
) -> FloatArray:
    """Frame {N} if the end effector's z axis is parallel to the last joint's.

    Args:
        end: transform_end_effector_to_world, (4, 4).
        point: A point on the last joint's axis, (3,) [m].
        last: The frame by the common rule, (4, 4).
        tolerance: Distance at which the two axes are the same [m].
    """
    z = end[:3, 2]
    away = np.cross(np.cross(z, end[:3, 3] - point), z)
    same_axis = np.linalg.norm(away) <= tolerance
    x = end[:3, 0] if same_axis else last[:3, 0]
    return _frame(end[:3, 3], x, z)


def table_row(step: FloatArray) -> tuple[float, float, float, float]:
    """theta, d, a, alpha of a relative pose that has the form of A_j."""
    theta = math.atan2(step[1, 0], step[0, 0])
    alpha = math.atan2(step[2, 1], step[2, 2])
    a = step[0, 3] * step[0, 0] + step[1, 3] * step[1, 0]
    return theta, float(step[2, 3]), float(a), alpha


def common_normal(
    point_1: ArrayLike,
    direction_1: ArrayLike,
    point_2: ArrayLike,
    direction_2: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Feet of the common normal of two lines that are not parallel.

    Args:
        point_1, direction_1: A point (3,) [m] and the direction (3,) of the first line.
        point_2, direction_2: The same of the second line.

    Returns:
        The nearest point of the first line and that of the second, (3,) each [m].
    """
    p1 = array("point_1", point_1, 3)
    z1 = array("direction_1", direction_1, 3)
    p2 = array("point_2", point_2, 3)
    z2 = array("direction_2", direction_2, 3)
    cross = np.cross(z1, z2)
    square = cross @ cross
    if square == 0:
        raise InputError(
            "direction_2", z2.tolist(), "a line that is not parallel to the first"
        )
    between = p2 - p1
    s1 = np.cross(between, z2) @ cross / square
    s2 = np.cross(between, z1) @ cross / square
    return p1 + s1 * z1, p2 + s2 * z2


def _normal(
    previous: FloatArray, point: FloatArray, z: FloatArray, tolerance: float
) -> _Normal:
    """The common normal of the z axis of {j-1} and the axis of {j}."""
    z_before = previous[:3, 2]
    cross = np.cross(z_before, z)
    sine = math.sqrt(cross @ cross)
    if sine <= tolerance:
        return _normal_of_parallels(previous, point, sine, tolerance)
    foot_before, foot = common_normal(previous[:3, 3], z_before, point, z)
    side = (foot - foot_before) @ cross
    x = cross / sine
    if side / sine < -tolerance:
        x = -x
    return _Normal(x=x, foot_before=foot_before, foot=foot)


def _normal_of_parallels(
    previous: FloatArray, point: FloatArray, sine: float, tolerance: float
) -> _Normal:
    """One of the common normals of parallel axes.

    It is the normal at the origin of {j-1}. If the origin is so far from the point that
    the small tilt between the axes would move the foot by more than the tolerance, it
    is the normal at the point.

    Args:
        previous: Frame {j-1}, (4, 4).
        point: On the axis of {j}, (3,) [m].
        sine: Of the tilt between the axes.
        tolerance: [m].
    """
    origin = previous[:3, 3]
    z_before = previous[:3, 2]
    across = point - origin
    along = across @ z_before
    across = across - along * z_before
    distance = math.sqrt(across @ across)
    x = across / distance if distance > tolerance else previous[:3, 0]
    if sine * abs(along) > tolerance:
        return _Normal(x=x, foot_before=point - across, foot=point)
    return _Normal(x=x, foot_before=origin, foot=origin + across)


def _frame(origin: FloatArray, x: FloatArray, z: FloatArray) -> FloatArray:
    """A frame with this origin and z, and with x in the plane of x and z, (4, 4)."""
    x = x - (x @ z) * z
    x = x / math.sqrt(x @ x)
    return transform(np.column_stack([x, np.cross(z, x), z]), origin)


def unit_vectors(name: str, value: ArrayLike, axes: int = 1) -> FloatArray:
    """Directions scaled to length 1, (..., 3).

    Args:
        name: Of the argument, for messages.
        value: Directions, none of them zero, (..., 3).
        axes: Number of axes of the array.

    Raises:
        InputError: Anything else.
    """
    v = float_array(name, value, (3,))
    largest = np.abs(v).max(axis=-1, keepdims=True)
    if v.ndim != axes or not largest.all():
        one, many = "one direction that is not zero", "directions that are not zero"
        raise InputError(name, value, one if axes == 1 else many)
    v = v / largest  # squares of large numbers overflow
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
