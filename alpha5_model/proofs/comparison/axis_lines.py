"""Joint axes as lines in space: their moments, common normals, distances and angles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.comparison.poses import origin_of

X, Y, Z = np.eye(3)


class AxisLines(NamedTuple):
    """Joint axes as lines.

    Attributes:
        points: A point on each line, (..., 3) [m].
        directions: Unit vectors, (..., 3).
    """

    points: FloatArray
    directions: FloatArray

    @property
    def moments(self) -> FloatArray:
        """Moments of the lines about the origin, (..., 3) [m]."""
        return cross(self.points, self.directions)


def z_axes(frames: FloatArray) -> AxisLines:
    """The z axes of frames (..., 4, 4), as lines (..., 3)."""
    return AxisLines(points=origin_of(frames), directions=frames[..., :3, 2])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """NumPy's cross product without its overhead, (..., 3)."""
    after = [1, 2, 0]
    before = [2, 0, 1]
    product: FloatArray = (
        a[..., after] * b[..., before] - a[..., before] * b[..., after]
    )
    return product


def foot(lines: AxisLines, at: int, other: int) -> FloatArray:
    """Where the common normal of two of the axes meets the first of them, (..., 3) [m].

    Args:
        lines: The axes, (..., N, 3).
        at: Index of the first.
        other: Index of the second.
    """
    point = lines.points[..., at, :]
    direction = lines.directions[..., at, :]
    other_point = lines.points[..., other, :]
    other_direction = lines.directions[..., other, :]

    between = point - other_point
    along = _dot(direction, between)
    along_other = _dot(other_direction, between)
    cosine = _dot(direction, other_direction)
    squared_sine = np.maximum(1 - cosine * cosine, 1e-12)
    distance = (cosine * along_other - along) / squared_sine
    return np.asarray(point + distance * direction)


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.sum(a * b, -1, keepdims=True))


def axis_shape(lines: AxisLines) -> FloatArray:
    """The numbers that describe how four consecutive axes (4, 3) lie, (7,).

    Returns:
        Distance of each axis from the one before it, (3,) [m]; offset of the elbow
        along the second axis [m]; angle of each axis with the one before it, (3,), at
        most pi/2 [rad].
    """
    distances = _distances(lines)
    upper_arm = foot(lines, 2, 3) - foot(lines, 1, 0)
    direction = lines.directions[1]
    offset = upper_arm @ direction
    # The second and third axis are parallel, or nearly so: their common normal is not
    # unique.
    distances[1] = np.linalg.norm(upper_arm - offset * direction)
    return np.array([*distances, abs(offset), *twists(lines)])


def _distances(lines: AxisLines) -> FloatArray:
    """Distance of each axis (N, 3) from the one before it, (N - 1,) [m]."""
    normals = np.cross(lines.directions[:-1], lines.directions[1:])
    sines = np.linalg.norm(normals, axis=1)
    steps = np.diff(lines.points, axis=0)
    along_normals = np.sum(steps * normals, axis=1)
    return np.asarray(np.abs(along_normals) / np.maximum(sines, 1e-9))


def twists(lines: AxisLines) -> FloatArray:
    """Angle of each axis (N, 3) with the one before it, (N - 1,), up to pi/2 [rad]."""
    before = lines.directions[:-1]
    after = lines.directions[1:]
    sines = np.linalg.norm(np.cross(before, after), axis=1)
    cosines = np.sum(before * after, axis=1)
    return np.asarray(np.arctan2(sines, np.abs(cosines)))
