"""The fewest shapes that contain given points, made as small as they may be [mm]."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.geometry.primitives import Primitive

#: Points must be as deep in a shape, because a surface bulges between its points.
DEPTH = 0.01
#: By how much shapes overlap where each has its own points.
_OVERLAP = 0.6
#: By how much the radius of a tightened shape exceeds that of its farthest point.
_WIDER = 0.05
#: So many of the largest shapes around each point are candidates.
_LARGEST = 20
#: Weight of a shape's volume, as a share of the largest, beside the number of shapes.
_VOLUME_WEIGHT = 1e-2
#: Of the search for the fewest shapes [s].
_TIME_LIMIT = 60.0


def beyond(shape: Primitive, points: FloatArray) -> FloatArray:
    """How far points (n, 3) are beyond the farthest face; below 0 inside, (n,)."""
    local = _local(shape, points)
    if shape.kind == "box":
        return np.asarray((np.abs(local) - np.array(shape.size) / 2).max(axis=1))
    if shape.kind == "sphere":
        return np.asarray(np.linalg.norm(local, axis=1) - shape.size[0])
    radius, length = shape.size
    beside = np.hypot(local[:, 0], local[:, 1]) - radius
    return np.maximum(beside, np.abs(local[:, 2]) - length / 2)


def _local(shape: Primitive, points: FloatArray) -> FloatArray:
    rotation = Rotation.from_euler("xyz", shape.rpy).as_matrix()
    return np.asarray((points - np.array(shape.xyz)) @ rotation)


def volume(shape: Primitive) -> float:
    """Of a shape [mm^3]."""
    if shape.kind == "box":
        return float(np.prod(shape.size))
    if shape.kind == "sphere":
        return float(4.0 / 3.0 * np.pi * shape.size[0] ** 3)
    radius, length = shape.size
    return float(np.pi * radius**2 * length)


def largest(shapes: Iterable[Primitive], points: FloatArray) -> list[Primitive]:
    """The shapes that are among the largest around some point, by points in them."""
    candidates = list(shapes)
    inside = _contained(candidates, points)
    counts = np.zeros(len(points), int)
    chosen = []
    for number in np.argsort(-inside.sum(axis=1), kind="stable"):
        its_points = inside[number]
        if (counts[its_points] < _LARGEST).any():
            counts[its_points] += 1
            chosen.append(candidates[number])
    return chosen


def _contained(shapes: list[Primitive], points: FloatArray) -> BoolArray:
    """Which points are in which shape, (S, n)."""
    rows = [beyond(shape, points) <= -DEPTH for shape in shapes]
    return np.array(rows, bool).reshape(len(shapes), len(points))


class Cover:
    """Shapes of which the fewest are to contain points.

    Attributes:
        points: All points, (n, 3).
    """

    def __init__(self, shapes: list[Primitive], points: FloatArray) -> None:
        self._shapes = shapes
        self.points = np.empty((0, 3))
        self._inside = np.empty((len(shapes), 0), bool)
        self.add(points)

    def add(self, points: FloatArray) -> None:
        """Points (n, 3) that must be contained, too."""
        inside = _contained(self._shapes, points)
        if not inside.any(axis=0).all():
            missing = points[~inside.any(axis=0)]
            raise RuntimeError(
                f"no shape contains {len(missing)} points, as {missing[0]}"
            )
        self.points = np.vstack([self.points, points])
        self._inside = np.hstack([self._inside, inside])

    def fewest(self) -> list[Primitive]:
        """The fewest shapes that contain all points; among these, small ones."""
        sizes = np.array([volume(shape) for shape in self._shapes])
        numbers, needed = _without_what_follows(self._inside, sizes)
        weights = 1.0 + _VOLUME_WEIGHT * sizes[numbers] / sizes.max()
        answer = milp(
            weights,
            constraints=LinearConstraint(
                csr_array(needed.T.astype(float)), 1.0, np.inf
            ),
            integrality=np.ones(len(numbers)),
            bounds=Bounds(0.0, 1.0),
            options={"time_limit": _TIME_LIMIT},
        )
        if answer.x is None:
            raise RuntimeError(f"no cover was found: {answer.message}")
        return [self._shapes[number] for number in numbers[answer.x > 0.5]]


def _without_what_follows(
    inside: BoolArray, sizes: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Numbers of the shapes that matter, and which points that matter they contain.

    A point is contained if another one is, whose shapes all contain it. A shape is not
    needed if another contains all its points.
    """
    # Of shapes with the same points, the smallest comes first.
    numbers = np.argsort(sizes, kind="stable")
    needed = inside[numbers]
    for _ in range(3):
        needed = np.unique(needed, axis=1)
        needed = needed[:, ~_contains_another(needed.T)]
        needed, first = np.unique(needed, axis=0, return_index=True)
        numbers = numbers[first]
        matters = ~_contains_another(~needed)
        needed, numbers = needed[matters], numbers[matters]
    return numbers, needed


def _contains_another(rows: BoolArray) -> BoolArray:
    """Which rows, all different, are True wherever some other row is, (n,)."""
    there = rows.astype(np.float32)
    beside = there @ (1.0 - there).T == 0.0
    np.fill_diagonal(beside, False)
    return np.asarray(beside.any(axis=0))


def tightened(shapes: list[Primitive], points: FloatArray) -> list[Primitive]:
    """The shapes, each no larger than the points need that no other shape contains."""
    tight = list(shapes)
    for number in np.argsort([-volume(shape) for shape in shapes], kind="stable"):
        others = tight[:number] + tight[number + 1 :]
        alone = ~_contained(others, points).any(axis=0)
        if alone.any():
            tight[number] = _around(tight[number], points[alone])
    return tight


def _around(shape: Primitive, points: FloatArray) -> Primitive:
    """The part of a shape around points in it, with an overlap; its axes stay."""
    local = _local(shape, points)
    if shape.kind == "sphere":
        radius = float(np.linalg.norm(local, axis=1).max()) + _WIDER
        return replace(shape, size=(min(radius, shape.size[0]),))
    if shape.kind == "cylinder":
        radius = float(np.hypot(local[:, 0], local[:, 1]).max()) + _WIDER
        radius = min(radius, shape.size[0])
        half = np.array([radius, radius, shape.size[1] / 2])
    else:
        half = np.array(shape.size) / 2
    low = np.maximum(local.min(axis=0) - _OVERLAP, -half)
    high = np.minimum(local.max(axis=0) + _OVERLAP, half)
    if shape.kind == "cylinder":
        low[:2] = -half[:2]
        high[:2] = half[:2]
    middle = Rotation.from_euler("xyz", shape.rpy).apply((low + high) / 2)
    size = high - low
    return replace(
        shape,
        size=(radius, size[2]) if shape.kind == "cylinder" else tuple(size.tolist()),
        xyz=tuple((np.array(shape.xyz) + middle).tolist()),
    )
