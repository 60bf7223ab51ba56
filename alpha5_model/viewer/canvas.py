"""A small software renderer: triangles to pixels with NumPy.

A triangle is cut into the rows of pixels that it crosses, and each row into the pixels
whose centre is inside. A depth for each pixel decides which triangle is seen there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.viewer.scene import LOOK, Camera

IntArray = NDArray[np.int64]
FaceArray = NDArray[np.uint32]
#: Rows of triangles, and pixels in them, computed at once: they fit in a cache.
_LINES = 8192
_PIXELS = 32768
#: Least distance from an edge that counts, in pixels.
_EDGE = 1e-7
#: Triangles of a smaller area, doubled, are not drawn [square pixels].
_SLIVER = 1e-9
#: Directions to the lights, in the camera's axes (right, up, backwards).
_LIGHTS = np.array([[-0.35, 0.75, 0.56], [0.85, 0.1, 0.52]])
_STRENGTHS = np.array([0.80, 0.45])
_AMBIENT = 0.68


class _Triangles(NamedTuple):
    """Triangles that the camera sees; k is one of the corners, F one of the triangles.

    Attributes:
        corners: Numbers of the corners, (3, F).
        y: Pixel rows of the corners, (3, F).
        by_x, by_y, constant: A corner's weight at column x and row y is
            ``by_x x + by_y y + constant``, (3, F) each.
    """

    corners: IntArray
    y: FloatArray
    by_x: FloatArray
    by_y: FloatArray
    constant: FloatArray


class _Lines(NamedTuple):
    """Triangles cut into rows of pixels, one entry for each row of a triangle.

    Attributes:
        pixel: Number of the first pixel inside, row by row, (L,).
        size: How many pixels are inside, (L,).
        nearness: 1 / distance of the triangle there, at the first pixel, and what it
            grows by with each further pixel, (2, L).
        color: The same of red, green and blue, (2, 3, L).
    """

    pixel: IntArray
    size: IntArray
    nearness: NDArray[np.float32]
    color: NDArray[np.float32]


class _Fragments(NamedTuple):
    """Pixels inside triangles; a pixel comes once for each triangle that covers it.

    Attributes:
        pixels: Their numbers, row by row, (N,).
        nearness: 1 / distance of the triangle there, ahead of the camera, (N,) [1/m].
        lines: The line of each, (N,).
        steps: Pixels from the start of the line, (N,).
        color: Of the lines, see `_Lines`.
    """

    pixels: IntArray
    nearness: NDArray[np.float32]
    lines: IntArray
    steps: NDArray[np.float32]
    color: NDArray[np.float32]

    def shown_in(self, layer: NDArray[np.float32], which: NDArray[np.bool_]) -> None:
        """Give the pixels of some fragments their colours, in a layer (P, 3)."""
        pixels = self.pixels[which]
        lines = self.lines[which]
        steps = self.steps[which]
        for channel in range(3):
            start, slope = self.color[:, channel]
            layer[pixels, channel] = start[lines] + slope[lines] * steps


class Window(NamedTuple):
    """A part of a canvas: its first columns and rows, and those after the last."""

    left: int
    top: int
    right: int
    bottom: int


class Canvas:
    """Pixels seen through a camera, with a depth for each.

    Args:
        camera: Where it is seen from.
        width, height: In pixels.
        window: The part that can be drawn into; all if None.

    Attributes:
        width, height: In pixels.
        axes: The camera's axes in rows, (3, 3).
        focal: Distance of the eye from the picture, in pixels.
        window: The part that can be drawn into.
        color: Red, green and blue of each pixel of the window, 0 to 1, (P, 3).
    """

    def __init__(
        self, camera: Camera, width: int, height: int, window: Window | None = None
    ) -> None:
        self.width = width
        self.height = height
        self.axes = camera.axes()
        self.focal = _focal(camera, height)
        self.window = window or Window(left=0, top=0, right=width, bottom=height)
        self._camera = camera
        self._columns = self.window.right - self.window.left
        rows = backdrop(height)[self.window.top : self.window.bottom]
        self.color = np.repeat(rows, self._columns, axis=0)
        # Nothing is infinitely far.
        self._nearness = np.zeros(len(self.color), dtype=np.float32)

    def project(self, points: FloatArray) -> FloatArray:
        """Column, row and distance ahead [m] of points in the world, (N, 3)."""
        return project(self._camera, self.width, self.height, points)

    def clear_depth(self) -> None:
        """Let what follows be drawn over everything so far."""
        self._nearness[:] = 0.0

    def draw(
        self,
        points: FloatArray,
        colors: FloatArray,
        faces: FaceArray,
        opacity: float = 1.0,
        two_sided: bool = False,
    ) -> None:
        """Draw triangles.

        Args:
            points: Corners in the world, (V, 3) [m].
            colors: Of the corners, (V, 3), 0 to 1.
            faces: (F, 3).
            opacity: Below 1 the background shines through, once, however many layers
                there are.
            two_sided: Whether triangles are seen from behind too.
        """
        screen = self.project(points)
        touched = self._rows_of(screen)
        nearness = self._nearness[touched]
        layer = self.color[touched]
        if opacity < 1.0:
            nearness = nearness.copy()
            layer = layer.copy()
        for found in self._fragments(screen, colors, faces, two_sided):
            local = found._replace(pixels=found.pixels - touched.start)
            np.maximum.at(nearness, local.pixels, local.nearness)
            local.shown_in(layer, nearness[local.pixels] == local.nearness)
        if opacity < 1.0:
            background = self.color[touched]
            background += (layer - background) * np.float32(opacity)

    def _rows_of(self, screen: FloatArray) -> slice:
        """The pixels in rows that some points cover."""
        rows = screen[:, 1]
        top, bottom = _spans(
            rows.min(), rows.max(), self.window.top, self.window.bottom
        )
        start = int(top) - self.window.top
        end = int(bottom) - self.window.top
        return slice(start * self._columns, end * self._columns)

    def _fragments(
        self,
        screen: FloatArray,
        colors: FloatArray,
        faces: FaceArray,
        two_sided: bool,
    ) -> Iterator[_Fragments]:
        """Pixels inside the triangles, so many at once that they fit in memory.

        Args:
            screen: Corners of the triangles by `project`, (V, 3).
            colors: Of the corners, (V, 3).
            faces: (F, 3).
            two_sided: Whether triangles are seen from behind too.
        """
        triangles = _visible(screen, faces, two_sided)
        # The distance is not linear on the screen, its inverse is.
        at_corners = np.vstack([1.0 / screen[:, 2], colors.T])
        tops, bottoms = _spans(
            _least(triangles.y),
            -_least(-triangles.y),
            self.window.top,
            self.window.bottom,
        )
        for some in _blocks(bottoms - tops, _LINES):
            triangle, row = _counted(tops[some], bottoms[some])
            lines = self._lines(triangles, some[triangle], row, at_corners)
            for part in _blocks(lines.size, _PIXELS):
                yield _fragments_of(lines, part)

    def _lines(
        self,
        triangles: _Triangles,
        triangle: IntArray,
        row: IntArray,
        at_corners: FloatArray,
    ) -> _Lines:
        """The parts of rows of pixels that are inside triangles.

        Args:
            triangles: Those that are seen.
            triangle: One of them for each line, (L,).
            row: A row of pixels for each line, (L,).
            at_corners: Nearness, red, green and blue of all corners, (4, V).
        """
        window = self.window
        slope = triangles.by_x[:, triangle]
        rest = triangles.constant[:, triangle]
        rest += triangles.by_y[:, triangle] * (row + 0.5)

        # A pixel is inside if no weight is negative. The weight of a corner that is
        # opposite to a level edge is positive in all rows of the triangle.
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = -rest / slope
        left = -_least(-np.where(slope > 0.0, zero, -np.inf))
        right = _least(np.where(slope < 0.0, zero, np.inf))
        first, last = _spans(left, right, window.left, window.right)

        some = np.flatnonzero(last > first)
        first = first[some]
        slope = slope[:, some]
        values = at_corners[:, triangles.corners[:, triangle[some]]]
        at_first = rest[:, some] + slope * (first + 0.5)
        both = np.stack([_sum(at_first * values), _sum(slope * values)])
        growth: NDArray[np.float32] = both.astype(np.float32)
        return _Lines(
            pixel=(row[some] - window.top) * self._columns + first - window.left,
            size=last[some] - first,
            nearness=growth[:, 0],
            color=growth[:, 1:],
        )


def _fragments_of(lines: _Lines, which: IntArray) -> _Fragments:
    """The pixels of some lines."""
    size = lines.size[which]
    starts = np.cumsum(size) - size
    counter = np.arange(size.sum())
    nearness, slope = lines.nearness[:, which]
    steps = (counter - np.repeat(starts, size)).astype(np.float32)
    return _Fragments(
        pixels=counter + np.repeat(lines.pixel[which] - starts, size),
        nearness=np.repeat(nearness, size) + np.repeat(slope, size) * steps,
        lines=np.repeat(which, size),
        steps=steps,
        color=lines.color,
    )


def project(camera: Camera, width: int, height: int, points: FloatArray) -> FloatArray:
    """Column, row and distance ahead [m] of points in a picture of a size, (N, 3)."""
    local = (points - camera.eye) @ camera.axes().T
    right = local[:, 0]
    up = local[:, 1]
    ahead = -local[:, 2]
    scale = _focal(camera, height) / ahead
    column = width / 2 + right * scale
    row = height / 2 - up * scale
    return np.stack([column, row, ahead], axis=1)


def _focal(camera: Camera, height: int) -> float:
    """Distance of the eye from a picture of a height, in pixels."""
    return float(height / 2 / np.tan(np.deg2rad(camera.field_of_view) / 2))


def backdrop(height: int) -> NDArray[np.float32]:
    """Colours behind everything, of rows from the top down, (height, 3)."""
    top, bottom = LOOK["backdrop"]["light"]
    return np.linspace(top, bottom, height, dtype=np.float32)


def _visible(screen: FloatArray, faces: FaceArray, two_sided: bool) -> _Triangles:
    """The triangles that the camera sees.

    Args:
        screen: Corners by `Canvas.project`, (V, 3).
        faces: (F, 3).
        two_sided: Whether triangles are seen from behind too.
    """
    corners = faces.T.astype(np.int64)
    x, y, ahead = screen.T[:, corners]
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    # Rows grow downwards: a triangle seen from outside has a negative area.
    seen_area = np.abs(area) if two_sided else -area
    visible = np.flatnonzero((seen_area > _SLIVER) & (_least(ahead) > 0.0))

    x = x[:, visible]
    y = y[:, visible]
    # A corner's weight is 1 there and 0 at the others, and linear in x and y.
    x_next, x_last = np.roll(x, -1, axis=0), np.roll(x, -2, axis=0)
    y_next, y_last = np.roll(y, -1, axis=0), np.roll(y, -2, axis=0)
    return _Triangles(
        corners=corners[:, visible],
        y=y,
        by_x=(y_next - y_last) / area[visible],
        by_y=(x_last - x_next) / area[visible],
        constant=(x_next * y_last - x_last * y_next) / area[visible],
    )


def _least(values: FloatArray) -> FloatArray:
    """Least of three rows, (3, N) to (N,)."""
    # Faster than a minimum along a short axis.
    return np.asarray(np.minimum(np.minimum(values[0], values[1]), values[2]))


def _sum(values: FloatArray) -> FloatArray:
    """Sums over the corners, (C, 3, N) to (C, N)."""
    return np.asarray(values[:, 0] + values[:, 1] + values[:, 2])


def _spans(
    low: ArrayLike, high: ArrayLike, least: int, most: int
) -> tuple[IntArray, IntArray]:
    """First pixel with its centre from ``low`` on, and the first after ``high``.

    Both are ``least`` to ``most``.
    """
    # A centre on a shared edge belongs to both sides, however it is rounded.
    first = np.ceil(np.subtract(low, 0.5 + _EDGE))
    last = np.floor(np.add(high, 0.5 + _EDGE))
    return _pixel_indices(first, least, most), _pixel_indices(last, least, most)


def _pixel_indices(values: FloatArray, least: int, most: int) -> IntArray:
    return np.clip(values, least, most).astype(np.int64)


def _blocks(sizes: IntArray, most: int) -> list[IntArray]:
    """Places of successive sizes (N,), apart where their sum passes multiples."""
    block = np.cumsum(sizes) // most
    return np.split(np.arange(len(block)), np.flatnonzero(np.diff(block)) + 1)


def _counted(first: IntArray, last: IntArray) -> tuple[IntArray, IntArray]:
    """Every number of some ranges, from first (N,) up to last (N,).

    Returns:
        Index of the range of each number, and the numbers.
    """
    size = last - first
    which = np.repeat(np.arange(len(size)), size)
    starts = np.cumsum(size) - size
    return which, np.arange(len(which)) + np.repeat(first - starts, size)


def shade(
    normals: FloatArray, colors: FloatArray, axes: FloatArray, shine: float
) -> FloatArray:
    """Colours (N, 3) of lit surfaces, with a highlight after Blinn and Phong.

    Args:
        normals: Unit, in the world, (N, 3).
        colors: Of the surface, (N, 3).
        axes: The camera's axes in rows.
        shine: Strength of the highlight, 0 to 1.
    """
    towards_lights = _LIGHTS / np.linalg.norm(_LIGHTS, axis=1, keepdims=True)
    halfway = np.add(towards_lights, (0.0, 0.0, 1.0))
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    in_camera = normals @ axes.T
    light = np.maximum(in_camera @ towards_lights.T, 0.0)
    facing = np.maximum(in_camera @ halfway.T, 0.0)

    lit = colors * (_AMBIENT + light @ _STRENGTHS)[:, None]
    highlight = 0.5 * shine * (facing**24 @ _STRENGTHS)[:, None]
    return np.asarray(np.minimum(lit + highlight, 1.0))
