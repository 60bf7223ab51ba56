"""Shapes that fill the room around a body as far as they may. Lengths in mm."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from scipy import ndimage
from scipy.spatial.transform import Rotation
from shapes.body_field import CELL, BodyField

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.geometry.primitives import Primitive

#: Boxes that are grown in each orientation.
_BOXES = 1000
#: Intervals along each axis in which cylinders are grown, and cylinders in each.
_INTERVALS = 50
_DISCS = 6
#: Steps by which the faces of a box move outwards, in cells, and how often.
_STEPS = (12, 6, 3, 2, 1, 1)
_ROUNDS = 45
#: By how much the radius of one of the body's own cylinders grows.
_WIDER = (0.05, 1.0, 2.0, 2.7)
#: Frames of the body's own shapes that differ by less are one [rad].
_SAME = 0.03


def grown_shapes(
    field: BodyField,
    own: Iterable[Primitive],
    points: FloatArray,
    most: float,
    generator: np.random.Generator,
) -> Iterator[list[Primitive]]:
    """Lists of shapes that are nowhere farther from a body than ``most``.

    Args:
        field: Distances from the body.
        own: Shapes that enclose the body, in whose directions others are grown.
        points: Of the body, (n, 3), around which they are grown.
        most: Largest distance from the body.
        generator: Of random numbers.
    """
    shapes = list(own)
    yield list(_grown_cylinders(field, shapes, most))
    yield list(_balls(field, most))
    for rotation in _orientations(shapes):
        turned = points @ rotation
        corner = turned.min(axis=0) - most - CELL
        counts = np.ceil((turned.max(axis=0) + most - corner) / CELL).astype(int) + 1
        too_far = field.turned(rotation, corner, counts) > most
        room = _Room(rotation=rotation, corner=corner, too_far=too_far)
        start = generator.choice(len(points), _BOXES)
        indices = np.round((turned[start] - corner) / CELL).astype(int)
        yield list(room.boxes(indices, generator))
        yield list(room.cylinders(indices, generator))


def _orientations(shapes: list[Primitive]) -> list[FloatArray]:
    """Frames of the shapes, and those half-way between the axes of the first."""
    frames = [Rotation.from_euler("xyz", shape.rpy) for shape in shapes]
    halves = [frames[0] * Rotation.from_euler(axis, np.pi / 4) for axis in "xyz"]
    found: list[FloatArray] = []
    for frame in (*frames, *halves):
        matrix = frame.as_matrix()
        if not any(_is_same(matrix, other) for other in found):
            found.append(matrix)
    return found


def _is_same(one: FloatArray, other: FloatArray) -> bool:
    """Whether the axes of two frames are the same lines, in whatever order."""
    cosines = np.abs(one.T @ other)
    return bool(((cosines < _SAME) | (cosines > np.cos(_SAME))).all())


def _grown_cylinders(
    field: BodyField, own: list[Primitive], most: float
) -> Iterator[Primitive]:
    """The body's own cylinders, wider and as long as they may be."""
    for shape in own:
        if shape.kind != "cylinder":
            continue
        radius, length = shape.size
        for wider in _WIDER:
            for longer in np.arange(0.1, 2.0 * most, CELL):
                grown = replace(shape, size=(radius + wider, length + longer))
                if field.at(_rim(grown)).max() > most:
                    break
                yield grown


def _rim(cylinder: Primitive) -> FloatArray:
    """Points on both edges of a cylinder, and along its side."""
    radius, length = cylinder.size
    angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    height = np.linspace(-length / 2, length / 2, 25)
    turn, along = np.meshgrid(angle, height)
    local = np.stack([radius * np.cos(turn), radius * np.sin(turn), along], axis=-1)
    rotation = Rotation.from_euler("xyz", cylinder.rpy)
    return np.asarray(rotation.apply(local.reshape(-1, 3)) + cylinder.xyz)


def _balls(field: BodyField, most: float) -> Iterator[Primitive]:
    """The largest balls around points."""
    room = ndimage.distance_transform_edt(field.distances <= most)
    is_largest = (room == ndimage.maximum_filter(room, 9)) & (room > 6.0)
    for index in np.argwhere(is_largest):
        yield Primitive(
            kind="sphere",
            size=(float(room[tuple(index)] - 1.0) * CELL,),
            xyz=tuple((field.corner + CELL * index).tolist()),
        )


class _Room:
    """Where shapes may be, on a grid along the axes of a frame."""

    def __init__(
        self, rotation: FloatArray, corner: FloatArray, too_far: BoolArray
    ) -> None:
        self._rotation = rotation
        self._rpy = rpy_from_rotation(rotation)
        self._corner = corner
        self._too_far = too_far
        padded = np.pad(too_far.astype(np.int64), ((1, 0),) * 3)
        self._counted = padded.cumsum(0).cumsum(1).cumsum(2)

    def boxes(
        self, start: FloatArray, generator: np.random.Generator
    ) -> Iterator[Primitive]:
        """Boxes around points of the grid, (n, 3), grown face by face at random."""
        free = ~self._too_far[tuple(start.T)]
        low = start[free]
        high = start[free]
        for step in _STEPS:
            for _ in range(_ROUNDS):
                face = generator.integers(6, size=len(low))
                low, high, _ = self._moved(low, high, face, step)
        # Then each face as far as it goes.
        for number in range(6):
            moves = np.ones(len(low), bool)
            while moves.any():
                face = np.full(len(low), number)
                low, high, moves = self._moved(low, high, face, 1)

        for first, last in np.unique(np.stack([low, high], axis=1), axis=0):
            middle = self._corner + CELL * (first + last) / 2
            yield Primitive(
                kind="box",
                size=tuple((CELL * (last - first)).tolist()),
                xyz=tuple((self._rotation @ middle).tolist()),
                rpy=self._rpy,
            )

    def _moved(
        self, low: FloatArray, high: FloatArray, face: FloatArray, step: int
    ) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Boxes after moving a face of each, if it can; and which have moved."""
        rows = np.arange(len(low))
        axis = face % 3
        is_high = face >= 3
        last = np.array(self._too_far.shape) - 1
        lower = low.copy()
        higher = high.copy()
        lower[rows, axis] -= np.where(is_high, 0, step)
        higher[rows, axis] += np.where(is_high, step, 0)
        lower = np.maximum(lower, 0)
        higher = np.minimum(higher, last)

        changed = ((lower != low) | (higher != high)).any(axis=1)
        moves = changed & (self._count(lower, higher) == 0)
        low = np.where(moves[:, None], lower, low)
        high = np.where(moves[:, None], higher, high)
        return low, high, moves

    def _count(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Points of each box that are too far from the body."""
        total = np.zeros(len(low), np.int64)
        ends = np.stack([low, high + 1])
        for corner in np.ndindex(2, 2, 2):
            x, y, z = (ends[end, :, axis] for axis, end in enumerate(corner))
            sign = (-1) ** (3 - sum(corner))
            total += sign * self._counted[x, y, z]
        return total

    def cylinders(
        self, places: FloatArray, generator: np.random.Generator
    ) -> Iterator[Primitive]:
        """The widest cylinders over intervals between places of the grid, (n, 3)."""
        for axis in range(3):
            counted = np.cumsum(self._too_far, axis=axis, dtype=np.int32)
            for _ in range(_INTERVALS):
                low, high = np.sort(generator.choice(places[:, axis], 2))
                if high - low < 4 or low == 0:
                    continue
                before = np.take(counted, low - 1, axis)
                free = np.take(counted, high, axis) == before
                for centre, radius in _largest_discs(free):
                    yield self._cylinder(axis, centre, radius, (low, high))

    def _cylinder(
        self, axis: int, centre: FloatArray, radius: float, interval: tuple[int, int]
    ) -> Primitive:
        """The longest cylinder of a radius, in cells, that has an interval in it."""
        places = np.indices(np.delete(self._too_far.shape, axis))
        apart = np.hypot(*(places - centre.reshape(2, 1, 1)))
        of_levels = np.moveaxis(self._too_far, axis, 0)[:, apart <= radius]
        blocked = np.flatnonzero(of_levels.any(axis=1))
        low = blocked[blocked < interval[0]].max(initial=-1) + 1
        high = blocked[blocked > interval[1]].min(initial=len(of_levels)) - 1

        middle = np.insert(centre.astype(float), axis, (low + high) / 2)
        # Its z is the frame's axis.
        turned = self._rotation @ _axis_as_z(axis)
        return Primitive(
            kind="cylinder",
            size=(float(radius) * CELL, float(high - low) * CELL),
            xyz=tuple((self._rotation @ (self._corner + CELL * middle)).tolist()),
            rpy=rpy_from_rotation(turned),
        )


def _largest_discs(free: BoolArray) -> Iterator[tuple[FloatArray, float]]:
    """Centres and radii of the largest discs in a plane of the grid, in cells."""
    if not free.any():
        return
    room = ndimage.distance_transform_edt(free)
    is_largest = (room == ndimage.maximum_filter(room, 9)) & (room > 6.0)
    centres = np.argwhere(is_largest)
    order = np.argsort(-room[tuple(centres.T)], kind="stable")
    for centre in centres[order][:_DISCS]:
        yield centre, float(room[tuple(centre)] - 1.0)


def _axis_as_z(axis: int) -> FloatArray:
    """The rotation that brings z to an axis, by a cycle of the axes."""
    return np.roll(np.eye(3), axis - 2, axis=0)
