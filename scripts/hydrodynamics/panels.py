"""Closed meshes of even panels from the drawn solids. Lengths in mm.

The drawn meshes are good to look at, not to compute on: long slivers beside holes of 3 mm. A solid becomes a
field, the share of each cell of a grid that it fills, rounded off over `ROUNDING`, which closes bolt holes and
ring grooves. The panels are quadrilaterals of one size on a level of that field: one vertex for each cell of a
coarser grid that the surface crosses (surface nets, [Gibson1998]), moved onto the level and evened out. The level is the one
that keeps the solid's volume.

[Gibson1998] Gibson: Constrained elastic surface nets, MICCAI 1998.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

#: Width of the rounding, and cell of the field's grid [mm].
ROUNDING, CELL = 0.8, 0.75
_VOLUME = 1e-4
_ROUNDS = 12

Array = NDArray[np.float64]
Faces = NDArray[np.int64]


def panels(solid: Any, size: float) -> tuple[Array, Faces]:
    """Vertices (n, 3) [m] and quadrilaterals (m, 4), outward, of a closed mesh with the solid's volume.

    Args:
        solid: A manifold3d solid [mm].
        size: Side of a panel [mm].
    """
    low, share = _filled(solid, 4 * ROUNDING + 2 * size)
    share = gaussian_filter(share, ROUNDING / CELL)

    def field(points: Array) -> Array:
        return map_coordinates(share, ((points - low) / CELL - 0.5).T, order=1, mode="nearest")

    high, volume = low + CELL * np.array(share.shape), solid.volume()
    levels, meshes = [0.5, 0.45], []
    for _ in range(6):
        meshes.append(_surface(field, low, high, size, levels[len(meshes)]))
        off = [enclosed(*mesh) / volume - 1 for mesh in meshes[-2:]]
        if abs(off[-1]) < _VOLUME:
            break
        if len(off) == 2:
            a, b = levels[-2:]
            levels.append(b - off[1] * (b - a) / (off[1] - off[0]))
    vertices, quads = meshes[-1]
    return vertices * 1e-3, quads


def enclosed(vertices: Array, quads: Faces) -> float:
    """Volume inside a closed mesh."""
    triangles = np.vstack([quads[:, :3], quads[:, [0, 2, 3]]])
    return float(np.linalg.det(vertices[triangles]).sum()) / 6


def _surface(
    field: Callable[[Array], Array], low: Array, high: Array, size: float, level: float
) -> tuple[Array, Faces]:
    axes = [np.arange(a + 0.37 * size, b, size) for a, b in zip(low, high, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = field(nodes.reshape(-1, 3)).reshape(nodes.shape[:3]) > level
    cells = tuple(n - 1 for n in inside.shape)
    corners = [
        inside[tuple(slice(o, o + n) for o, n in zip(at, cells, strict=True))]
        for at in np.ndindex(2, 2, 2)
    ]
    mixed = np.any(corners, axis=0) & ~np.all(corners, axis=0)
    number = np.cumsum(mixed).reshape(cells) - 1
    vertices = nodes[:-1, :-1, :-1][mixed] + size / 2
    quads = []
    for axis in range(3):
        # An edge of the grid with one end inside is crossed by the quadrilateral of the four cells around it.
        b, c = (axis + 1) % 3, (axis + 2) % 3
        order = (axis, b, c)
        here = np.moveaxis(inside, order, (0, 1, 2))
        numbers = np.moveaxis(number, order, (0, 1, 2))
        leaves = here[:-1, 1:-1, 1:-1] & ~here[1:, 1:-1, 1:-1]
        enters = ~here[:-1, 1:-1, 1:-1] & here[1:, 1:-1, 1:-1]
        around = [
            numbers[:, :-1, :-1],
            numbers[:, 1:, :-1],
            numbers[:, 1:, 1:],
            numbers[:, :-1, 1:],
        ]
        quads.append(np.stack([a[leaves] for a in around], axis=1))
        quads.append(np.stack([a[enters] for a in around[::-1]], axis=1))
    faces = np.vstack(quads).astype(np.int64)
    neighbours = np.vstack([faces, faces[:, ::-1]])
    count = np.bincount(faces.ravel(), minlength=len(vertices))[:, None]
    for _ in range(_ROUNDS):
        mean = np.zeros_like(vertices)
        np.add.at(mean, neighbours, np.roll(vertices[neighbours], -1, axis=1))
        vertices = _onto(field, 0.5 * vertices + 0.5 * mean / (2 * count), level)
    return vertices, faces


def _onto(field: Callable[[Array], Array], points: Array, level: float) -> Array:
    """Points moved along the field's gradient onto its level, by Newton's steps of at most a cell."""
    for _ in range(6):
        slope = np.stack(
            [(field(points + d) - field(points - d)) / CELL for d in CELL / 2 * np.eye(3)], axis=1
        )
        steep = np.maximum((slope**2).sum(axis=1), 1e-4)
        step = ((level - field(points)) / steep)[:, None] * slope
        points = points + np.clip(step, -CELL, CELL)
    return points


def _filled(solid: Any, margin: float) -> tuple[Array, Array]:
    """The share of each cell that the solid fills, exact along z, from rays through the cells' middles."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    low = vertices.min(axis=0) - margin
    filled = np.zeros(np.ceil((vertices.max(axis=0) + margin - low) / CELL).astype(int))
    # Off the round numbers of drawings, so that no ray meets an edge.
    xs, ys = (
        low[i] + CELL * (np.arange(filled.shape[i]) + 0.5) + 1e-5 * math.sqrt(2 + i) for i in (0, 1)
    )
    floors = low[2] + CELL * np.arange(filled.shape[2])
    for a, b, c in vertices[np.asarray(mesh.tri_verts).astype(int)]:
        u, v, corners = b - a, c - a, np.array([a, b, c])
        double_area = u[0] * v[1] - u[1] * v[0]
        if double_area == 0:
            continue
        ends = corners.min(axis=0), corners.max(axis=0)
        i, i_end = np.searchsorted(xs, [end[0] for end in ends])
        j, j_end = np.searchsorted(ys, [end[1] for end in ends])
        x, y = np.meshgrid(xs[i:i_end] - a[0], ys[j:j_end] - a[1], indexing="ij")
        s, t = (x * v[1] - y * v[0]) / double_area, (u[0] * y - u[1] * x) / double_area
        hit = np.nonzero((s >= 0) & (t >= 0) & (s + t <= 1))
        z = (a[2] + s * u[2] + t * v[2])[hit]
        # What lies below an upper face counts, what lies below a lower one is taken off.
        below = np.clip((z[:, None] - floors) / CELL, 0, 1)
        filled[i + hit[0], j + hit[1]] += np.sign(double_area) * below
    return low, filled
