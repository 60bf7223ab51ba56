"""Which points the tcp reaches, how far off others are, and the nearest reachable ones.

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

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, flag, float_array
from alpha5_model._support.spatial import wrap
from alpha5_model.errors import InputError
from alpha5_model.kinematics.geometry import Geometry, on_axis
from alpha5_model.kinematics.half_plane import (
    POSES,
    Arc,
    azimuth_beyond,
    boundary_of,
    bounded_geometry,
    branches_reaching,
    contains,
    middle_azimuth,
)
from alpha5_model.kinematics.solver import BLOCK, solve
from alpha5_model.numbers.parameters import Alpha5Parameters

#: Joint positions (M, 4) -> whether each is accepted, (M,).
Accept = Callable[[FloatArray], BoolArray]
#: Values of theta_0 that are tried on the yaw axis, where it is free.
_YAWS = 36
#: From here on only the direction of a point matters [m].
_FAR = 1e100


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
    geometry = bounded_geometry(arm)
    target = float_array("positions", positions, (3,))
    limits = flag("limits", limits)
    if accept is None:
        return np.asarray(branches_reaching(geometry, target, limits).any(axis=-1))
    if not callable(accept):
        raise InputError("accept", accept, "a function of joint positions")

    points = target.reshape(-1, 3)
    found = np.zeros(len(points), np.bool_)
    for start in range(0, len(points), BLOCK):
        rows = slice(start, start + BLOCK)
        found[rows] = _accepted(geometry, points[rows], limits, accept)
    return found.reshape(target.shape[:-1])


def _accepted(
    geometry: Geometry, points: FloatArray, limits: bool, accept: Accept
) -> BoolArray:
    """Which points (N, 3) a branch reaches in an accepted joint position, (N,)."""
    solved = solve(geometry, points, geometry.middle[3])
    reached = solved.within_limits if limits else solved.exists
    free = on_axis(points)
    yaws = np.linspace(geometry.lower[0], geometry.upper[0], _YAWS)

    found = np.zeros(len(points), np.bool_)
    for branch in range(solved.q.shape[1]):
        for yaw in (None, *yaws):
            tried = reached[:, branch] & ~found & (free | (yaw is None))
            rows = np.flatnonzero(tried)
            if not len(rows):
                continue
            q = solved.q[rows, branch]
            if yaw is not None:
                q[:, 0] = yaw
            found[rows] = _answer(accept(q), len(rows))
    return found


def _answer(answer: Any, count: int) -> BoolArray:
    """The checked answer of a user's function for so many joint positions."""
    accepted = np.asarray(answer)
    if accepted.shape != (count,) or accepted.dtype != np.bool_:
        raise InputError("accept", accepted, f"{count} times True or False")
    return accepted


def distance_to_reach(
    positions: ArrayLike, limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> FloatArray:
    """Distance to the nearest reachable point, exactly 0 inside.

    Args:
        positions, limits, arm: As for `reachable`.

    Returns:
        (...) [m].
    """
    target = float_array("positions", positions, (3,))
    off = target - nearest_reachable(target, limits, arm=arm)
    x, y, z = np.moveaxis(off, -1, 0)
    with np.errstate(over="ignore"):
        distance = np.asarray(np.hypot(np.hypot(x, y), z))
    if not np.isfinite(distance).all():
        largest = float(np.abs(target).max())
        raise InputError("positions", largest, "a distance that is a number")
    return distance


def nearest_reachable(
    positions: ArrayLike, limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> FloatArray:
    """The nearest reachable point; a reachable one is returned as it is.

    Args:
        positions, limits, arm: As for `reachable`.

    Returns:
        (..., 3) [m].
    """
    geometry = bounded_geometry(arm)
    target = float_array("positions", positions, (3,))
    limits = flag("limits", limits)

    nearest = target.reshape(-1, 3).copy()
    inside = branches_reaching(geometry, nearest, limits).any(axis=-1)
    outside = np.flatnonzero(~inside)
    for start in range(0, len(outside), BLOCK):
        rows = outside[start : start + BLOCK]
        points = nearest[rows]
        # Very far points move along their ray: squares of their distances overflow.
        largest = np.abs(points).max(axis=-1, keepdims=True)
        far = np.maximum(largest / _FAR, 1.0)
        nearest[rows] = _projected(geometry, points / far, limits)
    return nearest.reshape(target.shape)


def reach_margin(geometry: Geometry, points: FloatArray) -> FloatArray:
    """How far points in reach are from the nearest one that is not, exactly.

    Args:
        geometry: Of the arm, whose boundary arcs have.
        points: In ``base_link``, (..., 3) [m].

    Returns:
        (...) [m]; 0 for points out of reach.
    """
    x, y, z = np.moveaxis(points, -1, 0)
    radius = np.hypot(x, y)
    off = np.abs(wrap(np.arctan2(y, x) - middle_azimuth(geometry, "underarm")))

    # Azimuths, from the one that underarm faces in mid-range, at which it alone, both
    # or none, and overarm alone can be.
    half = (geometry.upper[0] - geometry.lower[0]) / 2
    first, last = sorted((half, math.pi - half))
    between = "both" if half >= math.pi / 2 else ""
    sectors = (
        (0.0, first, "underarm"),
        (first, last, between),
        (last, math.pi, "overarm"),
    )
    margin = np.full(radius.shape, math.inf)
    for start, end, side in sectors:
        # The nearest half-plane of the sector, and the point as seen there.
        turn = np.maximum(np.maximum(start - off, off - end), 0.0)
        foot = radius * np.cos(turn)
        across = radius * np.sin(turn)
        away = np.minimum(foot, 0.0)
        if side:
            inside = contains(geometry, np.maximum(foot, 0.0), z, side, True)
            in_plane = np.stack([foot, z], axis=-1)
            away = np.where(inside, _to_boundary(geometry, in_plane, side), away)
        margin = np.minimum(margin, np.hypot(across, away))
    return margin


def _to_boundary(geometry: Geometry, points: FloatArray, side: str) -> FloatArray:
    """Distance of points (..., 2) of a half-plane from a side's boundary, (...) [m]."""
    flat = points.reshape(-1, 2)
    feet = [_nearest_on_arc(arc, flat) for arc in boundary_of(geometry, side, True)]
    distance = np.linalg.norm(np.array(feet) - flat, axis=-1).min(axis=0)
    return np.asarray(distance.reshape(points.shape[:-1]))


def _projected(geometry: Geometry, points: FloatArray, limits: bool) -> FloatArray:
    """Nearest reachable points of points (N, 3) that are outside, (N, 3).

    For each pose, candidates are in the nearest half-plane that it can face: the foot
    of the perpendicular to that half-plane, if it is reachable, and the nearest point
    on each arc of the boundary.
    """
    candidates = []
    squares = []
    for pose in POSES:
        azimuth = np.arctan2(points[:, 1], points[:, 0])
        if limits:
            azimuth -= azimuth_beyond(geometry, azimuth, pose)
        cos = np.cos(azimuth)
        sin = np.sin(azimuth)

        # Coordinates in the half-plane, and the distance across it.
        x, y, z = points.T
        radius = x * cos + y * sin
        across = y * cos - x * sin

        own_foot = np.stack([radius, z], axis=-1)
        feet = [own_foot]
        for arc in boundary_of(geometry, pose, limits):
            feet.append(_nearest_on_arc(arc, own_foot))
        foot_radius, foot_z = np.moveaxis(np.array(feet), -1, 0)

        square = (foot_radius - radius) ** 2 + (foot_z - z) ** 2 + across**2
        inside = contains(geometry, np.maximum(radius, 0.0), z, pose, limits)
        square[0, ~inside] = np.inf  # the point's own foot is out of reach
        squares.append(square)
        foot = [foot_radius * cos, foot_radius * sin, foot_z]
        candidates.append(np.stack(foot, axis=-1))

    nearest = np.concatenate(squares).argmin(axis=0)
    return np.asarray(np.concatenate(candidates)[nearest, np.arange(len(points))])


def _nearest_on_arc(arc: Arc, points: FloatArray) -> FloatArray:
    """The nearest point of an arc to points of the half-plane, (N, 2)."""
    offset = points - arc.center
    span = arc.end - arc.start
    along = (np.arctan2(offset[:, 1], offset[:, 0]) - arc.start) % math.tau
    # For a point beside the arc it is the nearer end.
    start_is_nearer = along - span >= math.tau - along
    along = np.where(start_is_nearer, 0.0, np.minimum(along, span))
    return arc.points(arc.start + along)
