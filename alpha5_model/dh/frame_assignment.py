"""Standard DH frames from joint axes, by the common normals.

``x_j`` lies on the common normal of ``z_{j-1}`` and ``z_j`` and points from the first to the second;
the origin of {j} is where it meets ``z_j``. Where the rule leaves a choice:

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
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array, listed, real, rigid_transform
from alpha5_model.dh.link import DHLink
from alpha5_model.errors import InputError, ShapeError


def assign_frames(
    points: ArrayLike,
    directions: ArrayLike,
    sigma: Sequence[int] | None = None,
    end_effector: ArrayLike | None = None,
    q: ArrayLike | None = None,
    limits: Sequence[tuple[float, float]] | None = None,
    tolerance: float = 1e-9,
) -> tuple[tuple[DHLink, ...], FloatArray, FloatArray]:
    """The standard DH table of a serial arm drawn at one configuration.

    Args:
        points: A point on each joint axis, (N, 3) in the world [m].
        directions: Direction of each axis, (N, 3), of any length but zero.
        sigma: Joint types, 0 revolute (default) and 1 prismatic, (N,).
        end_effector: transform_end_effector_to_world, (4, 4); by default {N} is {N-1} without its
            joint, and the table ends with a row of zeros.
        q: Joint position at which the axes are drawn, (N,) [rad or m]. Then each link's offset takes
            up the rest, ``theta = q + offset``; by default the joint variable is theta or d itself.
        limits: (lower, upper) of each joint variable, (N, 2).
        tolerance: Axes within this angle [rad] count as parallel, within this distance [m] as
            intersecting. The error that this makes in the axes is of the same size.

    Returns:
        Links, base and tool of a chain whose home is the drawn configuration; its axes there are the
        given ones.

    Raises:
        InputError: No axes, a direction of zero length, shapes that do not fit.
    """
    p = float_array("points", points, (3,))
    z = float_array("directions", directions, (3,))
    if p.ndim != 2 or len(p) == 0 or z.shape != p.shape:
        raise ShapeError("points, directions", (p.shape, z.shape), "(N, 3) both, N at least 1")
    largest = np.abs(z).max(axis=1, keepdims=True)
    if (largest == 0).any():
        raise InputError("directions", z.tolist(), "directions that are not zero")
    z = z / largest  # squares of large numbers overflow
    z = z / np.linalg.norm(z, axis=1, keepdims=True)
    n = len(p)
    pairs = "(lower, upper) of each joint"
    types = [0] * n if sigma is None else listed("sigma", sigma, "0 or 1 for each joint")
    bounds = [(-math.inf, math.inf)] * n if limits is None else listed("limits", limits, pairs)
    drawn = np.zeros(n) if q is None else float_array("q", q, (n,))
    if drawn.ndim != 1:
        raise ShapeError("q", drawn.shape, f"shape ({n},)")
    if len(types) != n or len(bounds) != n:
        raise ShapeError("sigma, limits", (len(types), len(bounds)), f"{n} joints each")
    tolerance = real("tolerance", tolerance, minimum=0.0)

    end = None if end_effector is None else rigid_transform("end_effector", end_effector)
    if end is not None:
        p, z = np.vstack([p, end[:3, 3]]), np.vstack([z, end[:3, 2]])
    frames = _frames(p, z, tolerance)
    if end is None:
        frames.append(frames[-1])
    elif np.linalg.norm(np.cross(z[-2], z[-1])) <= tolerance:
        x = frames[-1][:3, 0]
        away = np.cross(np.cross(z[-1], end[:3, 3] - p[-2]), z[-1])
        if np.linalg.norm(away) <= tolerance:
            x = end[:3, 0]
        frames[-1] = _frame(end[:3, 3], x, z[-1])
    links = []
    for j in range(n):
        theta, d, a, alpha = _row(np.linalg.inv(frames[j]) @ frames[j + 1])
        offset = 0.0
        if q is not None:
            value, offset = float(drawn[j]), (d if types[j] else theta) - drawn[j]
            theta, d = (theta, value) if types[j] else (value, d)
        bound = listed("limits", bounds[j], pairs)
        if len(bound) != 2:
            raise ShapeError("limits", (len(bound),), pairs)
        links.append(DHLink(theta, d, a, alpha, types[j], offset, *bound))
    tool = np.eye(4) if end is None else np.linalg.inv(frames[n]) @ end
    return tuple(links), frames[0], _orthonormal(tool)


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


def _frames(p: FloatArray, z: FloatArray, tolerance: float) -> list[FloatArray]:
    """Frames {0} ... {K-1} on the K axes."""
    on_world_z = (
        math.hypot(*z[0, :2]) <= tolerance and z[0, 2] > 0 and math.hypot(*p[0, :2]) <= tolerance
    )
    if on_world_z:
        first = np.eye(4)
    elif len(p) == 1:
        first = _frame(p[0], _any_normal(z[0]), z[0])
    else:  # {0} is {1} seen from the first axis: theta_1 = d_1 = 0
        start = _frame(p[0], _any_normal(z[0]), z[0])
        x, _, foot = _normal(start, p[1], z[1], tolerance)
        first = _frame(foot, x, z[0])
    frames = [first]
    for point, direction in zip(p[1:], z[1:], strict=True):
        x, origin, _ = _normal(frames[-1], point, direction, tolerance)
        frames.append(_frame(origin, x, direction))
    return frames


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


def _row(step: FloatArray) -> tuple[float, float, float, float]:
    """theta, d, a, alpha of a relative pose that has the form of A_j."""
    theta, alpha = math.atan2(step[1, 0], step[0, 0]), math.atan2(step[2, 1], step[2, 2])
    a = step[0, 3] * step[0, 0] + step[1, 3] * step[1, 0]
    return theta, float(step[2, 3]), float(a), alpha


def _orthonormal(t: FloatArray) -> FloatArray:
    """The same transform with the rounding error of its rotation taken out."""
    u, _, vt = np.linalg.svd(t[:3, :3])
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = u @ vt, t[:3, 3]
    return out
