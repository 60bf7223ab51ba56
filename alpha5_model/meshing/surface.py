"""From a solid to the triangles that are written: rounded, in a fixed order, with smooth normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error
from alpha5_model.meshing.solid import Solid

#: Details below this size [mm] are merged away, so that rounding cannot fold a triangle.
_SIMPLIFY = 0.01
#: Coordinates are written in metres with this many decimals: 0.1 micrometre.
DECIMALS = 7
#: Faces that meet at a smaller angle are shaded as one smooth surface.
CREASE = np.deg2rad(32.0)


@dataclass(frozen=True, eq=False)
class Surface:
    """A closed triangle surface, outward, in its link's frame.

    Attributes:
        vertices: (n, 3) [m].
        faces: Vertex of each corner, (m, 3).
        normals: (k, 3), unit.
        corner_normals: Normal of each corner, (m, 3).
    """

    vertices: FloatArray
    faces: NDArray[np.int64]
    normals: FloatArray
    corner_normals: NDArray[np.int64]


def surface(solid: Solid) -> Surface:
    """Triangles of a solid given in mm.

    Raises:
        Alpha5Error: Rounding has opened or folded the surface.
    """
    mesh = solid.simplify(_SIMPLIFY).to_mesh64()
    rounded = np.round(np.asarray(mesh.vert_properties)[:, :3] * 1e-3, DECIMALS) + 0.0
    vertices, place = np.unique(rounded, axis=0, return_inverse=True)
    faces = place.reshape(-1)[np.asarray(mesh.tri_verts).astype(np.int64)]
    # A face whose corners became one is gone, and its neighbours close over it.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    check_closed(faces)
    faces = _ordered(faces)
    normals, corner_normals = _smooth_normals(vertices, faces)
    return Surface(vertices, faces, normals, corner_normals)


def check_closed(faces: NDArray[np.int64]) -> None:
    """Every directed edge once, and once in the other direction."""
    start, stop = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    n = faces.max() + 1
    here, there = np.sort(start * n + stop), np.sort(stop * n + start)
    if (here[1:] == here[:-1]).any() or (here != there).any():
        raise Alpha5Error("a surface is no longer closed after rounding its coordinates")


def _ordered(faces: NDArray[Any]) -> NDArray[np.int64]:
    """Each face starts at its smallest vertex, and the faces are sorted."""
    first = np.argmin(faces, axis=1)
    columns = (first[:, None] + np.arange(3)) % 3
    faces = np.take_along_axis(faces, columns, axis=1)
    return faces[np.lexsort(faces.T[::-1])].astype(np.int64)


def _smooth_normals(
    vertices: FloatArray, faces: NDArray[np.int64]
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Normals averaged over the faces around a vertex that meet without a crease.

    Weighted by the angle of the face's corner, which does not depend on the triangulation:
    [Thuermer1998] Thuermer, Wuethrich: Computing vertex normals from polygonal facets.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    cross = np.cross(sides[:, 0], -sides[:, 2])
    double_area = np.linalg.norm(cross, axis=1, keepdims=True)
    if not double_area.min() > 0:
        raise Alpha5Error("a surface has a triangle without area")
    flat = cross / double_area
    unit = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    weight = np.arccos(np.clip(-np.einsum("fcx,fcx->fc", unit, np.roll(unit, 1, axis=1)), -1, 1))

    # Directed edge (a, b) of one face is (b, a) of its neighbour.
    n = len(vertices)
    start, stop = faces, np.roll(faces, -1, axis=1)
    here = (start * n + stop).reshape(-1)
    there = (stop * n + start).reshape(-1)
    order = np.argsort(here)
    twin = order[np.searchsorted(here, there, sorter=order)]
    face, other = np.arange(len(here)) // 3, twin // 3
    smooth = np.einsum("ex,ex->e", flat[face], flat[other]) > np.cos(CREASE)
    # The corner at the edge's start is the twin's end, which is the corner after the twin's.
    after = 3 * other + (twin % 3 + 1) % 3
    edges = np.flatnonzero(smooth)
    graph = coo_array((np.ones(len(edges)), (edges, after[edges])), shape=(len(here), len(here)))
    _, group = connected_components(graph, directed=False)

    total = np.zeros((group.max() + 1, 3))
    np.add.at(total, group, (flat[:, None] * weight[..., None]).reshape(-1, 3))
    total /= np.linalg.norm(total, axis=1, keepdims=True)
    normals, index = np.unique(np.round(total, 4) + 0.0, axis=0, return_inverse=True)
    return normals, index.reshape(-1)[group].reshape(-1, 3).astype(np.int64)
