"""The nearest reachable point of a target, and how far off it is."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, flag, float_array
from alpha5_model.errors import InputError
from alpha5_model.kinematics.arcs import Arc
from alpha5_model.kinematics.boundaries import boundary
from alpha5_model.kinematics.half_plane import POSES, azimuth_beyond, in_half_plane
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.reachable_points import reachable
from alpha5_model.kinematics.solver import BLOCK

#: From here on only the direction of a point matters [m].
_FAR = 1e100


def distance_to_reach(
    plane: ArmPlane, positions: ArrayLike, limits: bool
) -> FloatArray:
    """Distance of points (..., 3) to the nearest reachable point, (...) [m]."""
    target = float_array("positions", positions, (3,))
    off = target - nearest_reachable(plane, target, limits)
    x, y, z = np.moveaxis(off, -1, 0)
    with np.errstate(over="ignore"):
        distance = np.asarray(np.hypot(np.hypot(x, y), z))
    if not np.isfinite(distance).all():
        largest = float(np.abs(target).max())
        raise InputError("positions", largest, "a distance that is a number")
    return distance


def nearest_reachable(
    plane: ArmPlane, positions: ArrayLike, limits: bool
) -> FloatArray:
    """The nearest reachable point of points (..., 3), (..., 3) [m]."""
    target = float_array("positions", positions, (3,))
    limits = flag("limits", limits)
    nearest = target.reshape(-1, 3).copy()
    outside = np.flatnonzero(~reachable(plane, nearest, limits, accept=None))
    for start in range(0, len(outside), BLOCK):
        rows = outside[start : start + BLOCK]
        points = nearest[rows]
        # Very far points move along their ray: squares of their distances overflow.
        largest = np.abs(points).max(axis=-1, keepdims=True)
        far = np.maximum(largest / _FAR, 1.0)
        nearest[rows] = _project(plane, points / far, limits)
    return nearest.reshape(target.shape)


class _Feet(NamedTuple):
    """K candidates for the nearest reachable point of each of N points.

    Attributes:
        points: The candidates, (K, N, 3) [m].
        squares: Their squared distances from the point, (K, N) [m^2].
    """

    points: FloatArray
    squares: FloatArray


def _project(plane: ArmPlane, points: FloatArray, limits: bool) -> FloatArray:
    """Nearest reachable points of points that are outside, (N, 3)."""
    of_poses = [_feet(plane, points, pose, limits) for pose in POSES]
    candidates = np.concatenate([feet.points for feet in of_poses])
    squares = np.concatenate([feet.squares for feet in of_poses])
    nearest: FloatArray = candidates[squares.argmin(axis=0), np.arange(len(points))]
    return nearest


def _feet(plane: ArmPlane, points: FloatArray, pose: str, limits: bool) -> _Feet:
    """Candidates in the nearest half-plane that a pose can face.

    They are the foot of the perpendicular from the point to that half-plane, if it is
    reachable, and the nearest point on each arc of the boundary.
    """
    azimuth = np.arctan2(points[:, 1], points[:, 0])
    if limits:
        azimuth -= azimuth_beyond(plane, azimuth, pose)
    cos = np.cos(azimuth)
    sin = np.sin(azimuth)

    # Coordinates in the half-plane, and the distance across it.
    x, y, z = points.T
    radius = x * cos + y * sin
    across = y * cos - x * sin

    own_foot = np.stack([radius, z], axis=-1)
    found = [own_foot]
    for arc in boundary(plane, pose, limits):
        found.append(_nearest_on_arc(arc, own_foot))
    foot_radius, foot_z = np.moveaxis(np.array(found), -1, 0)

    squares = (foot_radius - radius) ** 2 + (foot_z - z) ** 2 + across**2
    inside = in_half_plane(plane, np.maximum(radius, 0.0), z, pose, limits)
    squares[0, ~inside] = np.inf  # the point's own foot is out of reach
    feet = np.stack([foot_radius * cos, foot_radius * sin, foot_z], axis=-1)
    return _Feet(points=feet, squares=squares)


def _nearest_on_arc(arc: Arc, points: FloatArray) -> FloatArray:
    """The nearest point of an arc to points of the half-plane, (N, 2)."""
    offset = points - arc.center
    span = arc.end - arc.start
    along = (np.arctan2(offset[:, 1], offset[:, 0]) - arc.start) % math.tau
    # For a point beside the arc it is the nearer end.
    start_is_nearer = along - span >= math.tau - along
    along = np.where(start_is_nearer, 0.0, np.minimum(along, span))
    return arc.points(arc.start + along)
