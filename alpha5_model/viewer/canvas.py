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
from alpha5_model.viewer.scene import Camera

IntArray = NDArray[np.int64]
FaceArray = NDArray[np.uint32]
#: Pixels processed at once.
_BLOCK = 1 << 21
#: Colour behind everything, at the top and at the bottom, each 0 to 1.
_SKY = (1.0, 1.0, 1.0)
_GROUND = (0.80, 0.86, 0.90)
#: Least distance from an edge that counts, in pixels.
_EDGE = 1e-7
#: Triangles of a smaller area, doubled, are not drawn [square pixels].
_SLIVER = 1e-9
#: Directions to the lights, in the camera's axes (right, up, backwards).
_LIGHTS = np.array([[-0.35, 0.75, 0.56], [0.85, 0.1, 0.52]])
_STRENGTHS = np.array([0.80, 0.45])
_AMBIENT = 0.68


class _Fragments(NamedTuple):
    """Pixels inside triangles; a pixel comes once for each triangle that covers it.

    Attributes:
        pixels: Their numbers, row by row, (N,).
        distances: Of the triangle there, ahead of the camera, (N,) [m].
        corners: Vertices of the triangle, (N, 3).
        weights: Weights of the three corners at the pixel, (3, N).
    """

    pixels: IntArray
    distances: NDArray[np.float32]
    corners: FaceArray
    weights: FloatArray


class _Lines(NamedTuple):
    """Triangles cut into rows of pixels, one entry for each row of a triangle.

    Attributes:
        triangle: Number of the triangle, (L,).
        row: Row of pixels, (L,).
        first, last: First column inside, and the one after the last, (L,).
        rest, slope: Weights of the corners are ``rest + slope x`` at x, (L, 3).
    """

    triangle: IntArray
    row: IntArray
    first: IntArray
    last: IntArray
    rest: FloatArray
    slope: FloatArray


class Canvas:
    """Pixels seen through a camera, with a depth for each.

    Args:
        camera: Where it is seen from.
        width, height: In pixels.

    Attributes:
        width, height: In pixels.
        axes: The camera's axes in rows, (3, 3).
        focal: Distance of the eye from the picture, in pixels.
        color: Red, green and blue of each pixel, 0 to 1, (height * width, 3).
    """

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.width = width
        self.height = height
        self.axes = camera.axes()
        self.focal = height / 2 / np.tan(np.deg2rad(camera.field_of_view) / 2)
        backdrop = np.linspace(_SKY, _GROUND, height, dtype=np.float32)
        self.color = np.repeat(backdrop, width, axis=0)
        self._eye = camera.eye
        self._depth = np.full(width * height, np.inf, dtype=np.float32)

    def project(self, points: FloatArray) -> FloatArray:
        """Column, row and distance ahead [m] of points in the world, (N, 3)."""
        local = (points - self._eye) @ self.axes.T
        right = local[:, 0]
        up = local[:, 1]
        ahead = -local[:, 2]
        scale = self.focal / ahead
        column = self.width / 2 + right * scale
        row = self.height / 2 - up * scale
        return np.stack([column, row, ahead], axis=1)

    def clear_depth(self) -> None:
        """Let what follows be drawn over everything so far."""
        self._depth[:] = np.inf

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
        depth = self._depth[touched]
        layer = self.color[touched]
        if opacity < 1.0:
            depth = depth.copy()
            layer = layer.copy()
        for found in self._fragments(screen, faces, two_sided):
            pixels = found.pixels - touched.start
            np.minimum.at(depth, pixels, found.distances)
            nearest = depth[pixels] == found.distances
            layer[pixels[nearest]] = np.einsum(
                "kn,nkc->nc", found.weights[:, nearest], colors[found.corners[nearest]]
            )
        if opacity < 1.0:
            background = self.color[touched]
            background += (layer - background) * np.float32(opacity)

    def _rows_of(self, screen: FloatArray) -> slice:
        """The pixels in rows that some points cover."""
        rows = screen[:, 1]
        top, bottom = _spans(rows.min(), rows.max(), self.height)
        start = int(top)
        end = max(start, int(bottom))
        return slice(start * self.width, end * self.width)

    def _fragments(
        self, screen: FloatArray, faces: FaceArray, two_sided: bool
    ) -> Iterator[_Fragments]:
        """Pixels inside the triangles, so many at once that they fit in memory.

        Args:
            screen: Corners of the triangles by `project`, (V, 3).
            faces: (F, 3).
            two_sided: Whether triangles are seen from behind too.
        """
        faces, corners, affine = _visible(screen, faces, two_sided)
        nearness = 1.0 / corners[..., 2]
        lines = self._lines(corners, affine)
        blocks = np.cumsum(np.maximum(lines.last - lines.first, 0)) // _BLOCK
        for block in np.unique(blocks):
            chosen = np.flatnonzero(blocks == block)
            within, column = _counted(lines.first[chosen], lines.last[chosen])
            line = chosen[within]
            triangle = lines.triangle[line]
            x = column + 0.5
            weights = np.stack(
                [lines.rest[line, k] + lines.slope[line, k] * x for k in range(3)]
            )
            # The inverse of the distance is linear on the screen, the distance is not.
            inverse = sum(weights[k] * nearness[triangle, k] for k in range(3))
            yield _Fragments(
                pixels=lines.row[line] * self.width + column,
                distances=(1.0 / inverse).astype(np.float32),
                corners=faces[triangle],
                weights=weights,
            )

    def _lines(self, corners: FloatArray, affine: FloatArray) -> _Lines:
        """Cut triangles into rows of pixels.

        Args:
            corners: Pixel column, pixel row and distance of the corners, (F, 3, 3).
            affine: Columns and rows of the corners, and ones, (F, 3, 3).
        """
        # A corner's weight is 1 there and 0 at the others, and linear in x and y.
        by_x, by_y, constant = np.linalg.inv(affine).swapaxes(0, 1)
        rows = corners[..., 1]
        top, bottom = _spans(rows.min(axis=1), rows.max(axis=1), self.height)
        triangle, row = _counted(top, bottom)
        rest = constant[triangle] + by_y[triangle] * (row + 0.5)[:, None]
        slope = by_x[triangle]

        # A pixel is inside if no weight is negative.
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = -rest / slope
        left = np.where(slope > 0.0, zero, -np.inf).max(axis=1)
        right = np.where(slope < 0.0, zero, np.inf).min(axis=1)
        outside = ((slope == 0.0) & (rest < -1e-9)).any(axis=1)
        first, last = _spans(left, np.where(outside, -np.inf, right), self.width)
        return _Lines(
            triangle=triangle, row=row, first=first, last=last, rest=rest, slope=slope
        )


def _visible(
    screen: FloatArray, faces: FaceArray, two_sided: bool
) -> tuple[FaceArray, FloatArray, FloatArray]:
    """The triangles that the camera sees.

    Returns:
        Their faces (F, 3); columns, rows and distances of their corners (F, 3, 3);
        columns, rows and ones (F, 3, 3).
    """
    corners = screen[faces]
    ones = np.ones_like(corners[..., :1])
    affine = np.concatenate([corners[..., :2], ones], axis=2)
    area = np.linalg.det(affine)
    # Rows grow downwards: a triangle seen from outside has a negative area.
    seen_area = np.abs(area) if two_sided else -area
    ahead = corners[..., 2].min(axis=1) > 0.0
    visible = (seen_area > _SLIVER) & ahead
    return faces[visible], corners[visible], affine[visible]


def _spans(low: ArrayLike, high: ArrayLike, limit: int) -> tuple[IntArray, IntArray]:
    """First pixel with its centre from ``low`` on, first after ``high``, 0 to limit."""
    # A centre on a shared edge belongs to both sides, however it is rounded.
    first = np.ceil(np.subtract(low, 0.5 + _EDGE))
    last = np.floor(np.add(high, 0.5 + _EDGE))
    return _pixel_indices(first, limit), _pixel_indices(last, limit)


def _pixel_indices(values: FloatArray, limit: int) -> IntArray:
    return np.clip(values, 0, limit).astype(np.int64)


def _counted(first: IntArray, last: IntArray) -> tuple[IntArray, IntArray]:
    """Every number of some ranges, from first (N,) up to last (N,).

    Returns:
        Index of the range of each number, and the numbers.
    """
    size = np.maximum(last - first, 0)
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
    return np.asarray(np.clip(lit + highlight, 0.0, 1.0))
