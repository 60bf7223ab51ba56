"""What the tcp can reach, exactly: inside or not, how far off, and the nearest point.

Within the limits the reachable set is no full solid of revolution: theta_0 turns 350.97 degrees, so a
wedge of azimuths is closed to the underarm pose and the opposite wedge to the overarm pose. The set is
the union of the two poses, each turned through the azimuths that it can face. A point in the closed
wedge of one pose may still be reached by the other, and the nearest point of a pose to a target in its
wedge lies in the wedge's face.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, flag, float_array
from alpha5_model.errors import InputError
from alpha5_model.kinematics.boundary import SIDES, boundary, in_half_plane
from alpha5_model.kinematics.ik.batch import reached, solve_batch
from alpha5_model.kinematics.ik.one import on_axis
from alpha5_model.kinematics.plane import arm_plane

#: Rows per block, to bound the scratch.
_BLOCK = 8192
#: Joint positions (M, 4) -> whether each will do, (M,).
Accept = Callable[[FloatArray], BoolArray]
#: Values of theta_0 that are tried on the yaw axis, where it is free.
_YAWS = 36
#: From here on only the direction of a point matters [m].
_FAR = 1e100


def reachable(positions: ArrayLike, limits: bool = True, accept: Accept | None = None) -> BoolArray:
    """Whether the tcp reaches a point: any branch of the inverse kinematics does.

    The wrist angle moves no point and plays no part.

    Args:
        positions: In ``base_link``, (..., 3) [m].
        limits: Respect the limits of theta_0, theta_1 and theta_2; without, all angles are free.
        accept: Counts a branch only if this returns True for its joint position: a function of (M, 4)
            [rad], (M,) bool, such as `alpha5_model.without_self_collision`. theta_3 is the middle of its
            range, and on the yaw axis theta_0 is tried every 10 degrees.

    Returns:
        (...) bool; the boundary belongs to the set.

    Raises:
        InputError: Not real numbers of that shape (`NonFiniteError` names a bad row), or limits that
            are neither True nor False.
    """
    target, limits = float_array("positions", positions, (3,)), flag("limits", limits)
    if accept is not None and not callable(accept):
        raise InputError("accept", accept, "a function of joint positions")
    rows = target.reshape(-1, 3)
    out = np.empty(len(rows), np.bool_)
    for start in range(0, len(rows), _BLOCK):
        part = slice(start, start + _BLOCK)
        if accept is None:
            reached(rows[part], limits).any(axis=-1, out=out[part])
        else:
            out[part] = _accepted(rows[part], limits, accept)
    return out.reshape(target.shape[:-1])


def _accepted(rows: FloatArray, limits: bool, accept: Accept) -> BoolArray:
    """Which points (N, 3) a branch reaches in a joint position that will do."""
    g = arm_plane()
    q, exists, within, _ = solve_batch(rows, np.asarray(g.middle[3]))
    flags = within if limits else exists
    yaws = np.linspace(g.lower[0], g.upper[0], _YAWS)
    free = on_axis(rows)
    found = np.zeros(len(rows), np.bool_)
    for branch in range(q.shape[1]):
        for k, yaw in enumerate((None, *yaws)):
            left = np.flatnonzero(flags[:, branch] & ~found & (free | (k == 0)))
            trial = q[left, branch]
            if yaw is not None:
                trial[:, 0] = yaw
            if len(left):
                answer = np.asarray(accept(trial))
                if answer.shape != (len(left),) or answer.dtype != np.bool_:
                    raise InputError("accept", answer, f"{len(left)} times True or False")
                found[left] = answer
    return found


def distance_to_reach(positions: ArrayLike, limits: bool = True) -> FloatArray:
    """Distance to the nearest reachable point, exactly 0 inside.

    Args:
        positions, limits: As for `reachable`.

    Returns:
        (...) [m].
    """
    target, nearest = _nearest(positions, limits)
    x, y, z = np.moveaxis(target - nearest, -1, 0)
    with np.errstate(over="ignore"):
        distance = np.asarray(np.hypot(np.hypot(x, y), z))
    if not np.isfinite(distance).all():
        raise InputError("positions", float(np.abs(target).max()), "a distance that is a number")
    return distance


def nearest_reachable(positions: ArrayLike, limits: bool = True) -> FloatArray:
    """The nearest reachable point; a reachable one is returned as it is.

    Args:
        positions, limits: As for `reachable`.

    Returns:
        (..., 3) [m].
    """
    return _nearest(positions, limits)[1]


def _nearest(positions: ArrayLike, limits: bool) -> tuple[FloatArray, FloatArray]:
    target, limits = float_array("positions", positions, (3,)), flag("limits", limits)
    rows = target.reshape(-1, 3)
    out = rows.copy()
    for start in range(0, len(rows), _BLOCK):
        part = out[start : start + _BLOCK]
        outside = np.flatnonzero(~reachable(part, limits))
        if len(outside):
            # Very far points come nearer along their ray: squares of their distances overflow.
            far = np.maximum(np.abs(part[outside]).max(axis=-1, keepdims=True) / _FAR, 1.0)
            part[outside] = _project(part[outside] / far, limits)
    return target, out.reshape(target.shape)


def _project(points: FloatArray, limits: bool) -> FloatArray:
    """Nearest reachable point of points that are outside, (N, 3)."""
    best = np.full(len(points), np.inf)
    out = np.empty_like(points)
    for side in SIDES[:2]:
        azimuth = allowed_azimuth(points, side, limits)
        cos, sin = np.cos(azimuth), np.sin(azimuth)
        # In the half-plane at that azimuth; what sticks out of it no motion within it removes.
        radius = points[:, 0] * cos + points[:, 1] * sin
        beside = points[:, 1] * cos - points[:, 0] * sin
        foot = _project_in_plane(np.stack([radius, points[:, 2]], axis=-1), side, limits)
        distance = (foot[:, 0] - radius) ** 2 + (foot[:, 1] - points[:, 2]) ** 2 + beside**2
        closer = distance < best
        best = np.where(closer, distance, best)
        found = np.stack([foot[:, 0] * cos, foot[:, 0] * sin, foot[:, 1]], axis=-1)
        out[closer] = found[closer]
    return out


def allowed_azimuth(points: FloatArray, side: str, limits: bool) -> FloatArray:
    """The azimuth nearest to each point's own that a pose can face, (N,) [rad]."""
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    if not limits:
        return azimuth
    g = arm_plane()
    middle = g.middle[0] + g.azimuth_offset - (math.pi if side == "overarm" else 0.0)
    half = (g.upper[0] - g.lower[0]) / 2
    off = azimuth - middle
    off -= math.tau * np.rint(off / math.tau)
    return np.where(np.abs(off) <= half, azimuth, middle + np.clip(off, -half, half))


def _project_in_plane(points: FloatArray, side: str, limits: bool) -> FloatArray:
    """Nearest reachable (R, z) to points with R >= 0, (N, 2)."""
    out = points.copy()
    best = np.where(
        in_half_plane(np.maximum(points[:, 0], 0.0), points[:, 1], side, limits), 0.0, np.inf
    )
    for arc in boundary(side, limits):
        offset = points - arc.center
        angle = np.arctan2(offset[:, 1], offset[:, 0])
        span = arc.end - arc.start
        along = (angle - arc.start) % math.tau
        # Beyond the arc: its nearer end.
        beyond_end = along - span < math.tau - along
        along = np.where(along <= span, along, np.where(beyond_end, span, 0.0))
        foot = arc.points(arc.start + along)
        distance = np.square(foot - points).sum(axis=-1)
        closer = distance < best
        best = np.where(closer, distance, best)
        out[closer] = foot[closer]
    return out
