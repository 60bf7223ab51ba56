"""How far points are outside of a body, on a grid. Lengths in mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from alpha5_model._support.checks import BoolArray, FloatArray

#: Edge of a cell.
CELL = 0.5
#: Farther than this from the body, distances are not known.
FARTHEST = 5.0
#: Distance of the points on the surface to which distances are measured.
_SPACING = 0.25


@dataclass(frozen=True, eq=False)
class BodyField:
    """Distances from a body; 0 inside of it.

    Attributes:
        corner: Where the grid starts, (3,).
        distances: At the points of the grid, (nx, ny, nz).
    """

    corner: FloatArray
    distances: FloatArray

    def at(self, points: FloatArray) -> FloatArray:
        """Distances of points, (n, 3) -> (n,), linear between the grid's points."""
        indices = (points - self.corner).T / CELL
        found = ndimage.map_coordinates(self.distances, indices, order=1, cval=FARTHEST)
        return np.asarray(found)

    def turned(
        self, rotation: FloatArray, corner: FloatArray, counts: FloatArray
    ) -> FloatArray:
        """Distances on a turned grid.

        Args:
            rotation: From the turned frame to the body's, (3, 3).
            corner: Where the grid starts, in the turned frame.
            counts: Its points along each axis.
        """
        start = (rotation @ corner - self.corner) / CELL
        return np.asarray(
            ndimage.affine_transform(
                self.distances,
                rotation,
                offset=start,
                output_shape=tuple(counts),
                order=1,
                cval=FARTHEST,
            )
        )


def field_of(solid: Any, generator: np.random.Generator) -> BodyField:
    """The field of a manifold3d solid."""
    triangles = corners_of(solid)
    points = triangles.reshape(-1, 3)
    corner = points.min(axis=0) - FARTHEST
    counts = np.ceil((points.max(axis=0) + FARTHEST - corner) / CELL).astype(int) + 1

    inside = _inside(triangles, corner, counts)
    steps = int(FARTHEST / CELL)
    near = ndimage.binary_dilation(inside, iterations=steps) & ~inside
    surface = surface_points(triangles, _SPACING, generator)
    tree = cKDTree(np.vstack([surface, points]))
    apart, _ = tree.query(
        corner + CELL * np.argwhere(near), distance_upper_bound=FARTHEST
    )

    distances = np.full(tuple(counts), FARTHEST)
    distances[inside] = 0.0
    distances[near] = np.minimum(apart, FARTHEST)
    return BodyField(corner=corner, distances=distances)


def corners_of(solid: Any) -> FloatArray:
    """Corners of a solid's triangles, (m, 3, 3)."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    return np.asarray(vertices[np.asarray(mesh.tri_verts)])


def surface_points(
    triangles: FloatArray, spacing: float, generator: np.random.Generator
) -> FloatArray:
    """Points at random on triangles (m, 3, 3), one for each square of the spacing."""
    first, second, third = np.moveaxis(triangles, 1, 0)
    areas = np.linalg.norm(np.cross(second - first, third - first), axis=1) / 2
    count = int(areas.sum() / spacing**2)
    chosen = generator.choice(len(triangles), count, p=areas / areas.sum())
    weights = generator.dirichlet((1.0, 1.0, 1.0), count)
    return np.einsum("nc,ncx->nx", weights, triangles[chosen])


def inner_points(triangles: FloatArray, every: int) -> FloatArray:
    """Points inside a surface, one in so many cells along each axis, (n, 3)."""
    points = triangles.reshape(-1, 3)
    corner = points.min(axis=0)
    counts = np.ceil((points.max(axis=0) - corner) / CELL).astype(int) + 1
    inside = np.argwhere(_inside(triangles, corner, counts))
    kept = (inside % every == 0).all(axis=1)
    return np.asarray(corner + CELL * inside[kept])


def _inside(triangles: FloatArray, corner: FloatArray, counts: FloatArray) -> BoolArray:
    """Which points of a grid are inside: lines from below cross oddly often."""
    # Off the grid, so that no line meets an edge.
    x = corner[0] + CELL * np.arange(counts[0]) + 1.234e-5
    y = corner[1] + CELL * np.arange(counts[1]) + 2.345e-5
    crossings = np.zeros((counts[0], counts[1], counts[2] + 1), np.int32)
    for triangle in triangles:
        rows = slice(*np.searchsorted(x, [triangle[:, 0].min(), triangle[:, 0].max()]))
        columns = slice(
            *np.searchsorted(y, [triangle[:, 1].min(), triangle[:, 1].max()])
        )
        across = np.stack(np.meshgrid(x[rows], y[columns], indexing="ij"), axis=-1)
        heights = _heights(triangle, across)
        row, column = np.nonzero(np.isfinite(heights))
        level = np.ceil((heights[row, column] - corner[2]) / CELL).astype(int)
        np.add.at(
            crossings,
            (row + rows.start, column + columns.start, np.clip(level, 0, counts[2])),
            1,
        )
    return np.asarray(crossings.cumsum(axis=2)[:, :, :-1] % 2 == 1)


def _heights(triangle: FloatArray, across: FloatArray) -> FloatArray:
    """z of a triangle over points (..., 2); NaN beside it."""
    sides = (triangle[1:] - triangle[0])[:, :2]
    area = sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]
    if abs(area) < 1e-12:
        return np.full(across.shape[:-1], np.nan)
    from_first = across - triangle[0, :2]
    x, y = from_first[..., 0], from_first[..., 1]
    second = (x * sides[1, 1] - y * sides[1, 0]) / area
    third = (sides[0, 0] * y - sides[0, 1] * x) / area
    weights = np.stack([1.0 - second - third, second, third], axis=-1)
    return np.where((weights >= 0.0).all(axis=-1), weights @ triangle[:, 2], np.nan)
