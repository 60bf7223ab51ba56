"""A solid's surface as it is written: triangles and normals, in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from meshes.solid import Solid
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import Alpha5Error

Indices = NDArray[np.int64]
#: Details below this size [mm] are merged, so that rounding cannot fold a triangle.
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
    faces: Indices
    normals: FloatArray
    corner_normals: Indices


def surface(solid: Solid) -> Surface:
    """Triangles of a solid given in mm.

    Raises:
        Alpha5Error: Rounding has opened or folded the surface.
    """
    mesh = solid.simplify(_SIMPLIFY).to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3] * 1e-3
    triangles = np.asarray(mesh.tri_verts).astype(np.int64)

    # Adding 0.0 makes -0.0 zero.
    rounded = np.round(points, DECIMALS) + 0.0
    vertices, place = np.unique(rounded, axis=0, return_inverse=True)
    faces = _in_order(_without_empty_faces(place.reshape(-1)[triangles]))

    normals, corner_normals = _smooth_normals(vertices, faces)
    return Surface(
        vertices=vertices,
        faces=faces,
        normals=normals,
        corner_normals=corner_normals,
    )


def _without_empty_faces(faces: Indices) -> Indices:
    """The faces with three different corners; they still close the surface.

    Raises:
        Alpha5Error: They do not.
    """
    differ_from_next = faces != np.roll(faces, 1, axis=1)
    kept: Indices = faces[differ_from_next.all(axis=1)]
    check_closed(kept)
    return kept


def _in_order(faces: Indices) -> Indices:
    """The faces sorted, each from its smallest vertex on."""
    first = np.argmin(faces, axis=1)[:, None]
    columns = (first + np.arange(3)) % 3
    turned = np.take_along_axis(faces, columns, axis=1)
    return turned[np.lexsort(turned.T[::-1])].astype(np.int64)


def check_closed(faces: Indices) -> None:
    """Check that each directed edge is there once, and once in the other direction.

    Raises:
        Alpha5Error: It is not.
    """
    edges, reverses = _edges(faces)
    here = np.sort(edges)
    there = np.sort(reverses)
    is_twice = (here[1:] == here[:-1]).any()
    is_alone = (here != there).any()
    if is_twice or is_alone:
        raise Alpha5Error(
            "a surface is no longer closed after rounding its coordinates"
        )


def _edges(faces: Indices) -> tuple[Indices, Indices]:
    """A number for each directed edge, and for its reverse, (3 m,) each.

    Edge 3 i + k starts at corner k of face i.
    """
    start = faces.reshape(-1)
    stop = np.roll(faces, -1, axis=1).reshape(-1)
    n = faces.max() + 1
    return start * n + stop, stop * n + start


def _smooth_normals(vertices: FloatArray, faces: Indices) -> tuple[FloatArray, Indices]:
    """Normals averaged over the faces around a vertex that meet without a crease.

    They are weighted by the angle of the face's corner, which does not depend on the
    triangulation: [Thuermer1998] Thuermer, Wuethrich: Computing vertex normals from
    polygonal facets.

    Returns:
        Different normals, and the number of the normal of each corner, (m, 3).
    """
    flat, angles = _flat_normals_and_angles(vertices, faces)
    group = _groups_without_crease(faces, flat)
    weighted = flat[:, None] * angles[..., None]

    total = np.zeros((group.max() + 1, 3))
    np.add.at(total, group, weighted.reshape(-1, 3))
    total /= np.linalg.norm(total, axis=1, keepdims=True)

    rounded = np.round(total, 4) + 0.0
    normals, index = np.unique(rounded, axis=0, return_inverse=True)
    of_corners = index.reshape(-1)[group].reshape(-1, 3)
    return normals, of_corners.astype(np.int64)


def _flat_normals_and_angles(
    vertices: FloatArray, faces: Indices
) -> tuple[FloatArray, FloatArray]:
    """Normal of each face, (m, 3), and the angles at its corners, (m, 3).

    Raises:
        Alpha5Error: A triangle without area.
    """
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    cross = np.cross(sides[:, 0], -sides[:, 2])
    double_area = np.linalg.norm(cross, axis=1, keepdims=True)
    if not double_area.min() > 0:
        raise Alpha5Error("a surface has a triangle without area")

    unit = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    cosines = -np.einsum("fcx,fcx->fc", unit, np.roll(unit, 1, axis=1))
    return cross / double_area, np.arccos(np.clip(cosines, -1, 1))


def _groups_without_crease(faces: Indices, flat: FloatArray) -> Indices:
    """For each corner, the number of the group that has one normal, (3 m,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    # Directed edge (a, b) of one face is (b, a) of its neighbour.
    here, there = _edges(faces)
    order = np.argsort(here)
    twin = order[np.searchsorted(here, there, sorter=order)]

    face = np.arange(len(here)) // 3
    neighbour = twin // 3
    cosines = np.einsum("ex,ex->e", flat[face], flat[neighbour])
    smooth = np.flatnonzero(cosines > np.cos(CREASE))

    # The corner at the edge's start is the twin's end: the corner after the twin's.
    same_vertex = 3 * neighbour + (twin % 3 + 1) % 3
    links = (np.ones(len(smooth)), (smooth, same_vertex[smooth]))
    graph = coo_array(links, shape=(len(here), len(here)))
    # The graph need not be symmetric: its weak components count.
    _, group = connected_components(graph)
    return np.asarray(group)
