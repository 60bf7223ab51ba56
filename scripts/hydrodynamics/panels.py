"""Closed meshes of even triangles from the drawn solids. Lengths in mm.

A drawn mesh is good to look at, not to compute on: it has slivers beside holes of 3 mm.
It is meshed again with triangles of one size [Botsch2004]; edges and holes stay.
Chords across a rounding take from the solid, those in a hole add to it. The vertices
then move along their normals by the same share of the distance at which the triangles'
middles lie off the solid, until the solid's volume is met.

[Botsch2004] Botsch, Kobbelt: A remeshing approach to multiresolution modeling, SGP
    2004.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Edges with a larger bend are kept [deg].
CREASE = 30.0
#: Smaller details are left out [mm].
DETAIL = 0.01
#: Rounds of remeshing.
ROUNDS = 8
#: A middle further off, in sizes, lies beside a detail that the panels leave out, and
#: counts as so far off.
_BESIDE = 0.1
#: How far a triangle across a rounding lies off on the average, over how far its middle
#: does.
_MEAN = 0.75
#: Share of the triangles that may cross others, beside bolt holes smaller than they
#: are.
_CROSSED = 0.005

Array = NDArray[np.float64]
Faces = NDArray[np.int64]


def panels(solid: Any, size: float) -> tuple[Array, Faces]:
    """Vertices (n, 3) [m] and triangles (m, 3), outward, of a mesh around a solid.

    Args:
        solid: A manifold3d solid [mm].
        size: Side of a triangle [mm].

    Raises:
        ValueError: The mesh is not closed, or crosses itself: another size may do.
    """
    import pymeshlab  # late: a development tool

    drawn = pymeshlab.Mesh(*corners(solid.simplify(DETAIL)))
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(drawn)
    meshes.meshing_merge_close_vertices(threshold=pymeshlab.PureValue(DETAIL))
    meshes.meshing_isotropic_explicit_remeshing(
        iterations=ROUNDS,
        targetlen=pymeshlab.PureValue(size),
        featuredeg=CREASE,
        checksurfdist=False,
    )
    meshes.meshing_merge_close_vertices(threshold=pymeshlab.PureValue(DETAIL))
    state = meshes.get_topological_measures()
    meshes.compute_selection_by_self_intersections_per_face()
    mesh = meshes.current_mesh()
    crossed = mesh.selected_face_number()
    closed = state["is_mesh_two_manifold"] and not state["boundary_edges"]
    if not closed or crossed > _CROSSED * mesh.face_number():
        raise ValueError(f"panels of {size} mm: not closed, or {crossed} that cross")
    vertices = mesh.vertex_matrix()
    faces = mesh.face_matrix().astype(np.int64)
    return _fitted(vertices, faces, drawn, solid.volume(), size) * 1e-3, faces


def corners(solid: Any) -> tuple[Array, Faces]:
    """Vertices (n, 3) [mm] and triangles (m, 3) of a solid."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3]
    return vertices, np.asarray(mesh.tri_verts).astype(np.int64)


def enclosed(vertices: Array, faces: Faces) -> float:
    """Volume inside a closed mesh."""
    return float(np.linalg.det(vertices[faces]).sum()) / 6


def _fitted(
    vertices: Array, faces: Faces, drawn: Any, volume: float, size: float
) -> Array:
    """The vertices moved along their normals until the mesh has the wanted volume."""
    step = _steps(vertices, faces, drawn, size)
    part = 0.0
    for _ in range(3):  # the volume is all but linear in it
        missing = volume - enclosed(vertices + part * step, faces)
        gain = enclosed(vertices + (part + 0.1) * step, faces) - volume + missing
        part += 0.1 * missing / gain
    if not 0 < part < 2:  # roundings and holes cancel
        part = _MEAN
    return np.asarray(vertices + part * step)


def _steps(vertices: Array, faces: Faces, drawn: Any, size: float) -> Array:
    """How far the mesh lies off the drawn one at each vertex, along its normal, (n, 3).

    Each is the mean over the triangles' middles around the vertex, by their areas.
    """
    import pymeshlab

    triangles = vertices[faces]
    first_side = triangles[:, 1] - triangles[:, 0]
    second_side = triangles[:, 2] - triangles[:, 0]
    normals = np.cross(first_side, second_side)
    areas = np.linalg.norm(normals, axis=1, keepdims=True)

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(drawn)
    meshes.add_mesh(pymeshlab.Mesh(triangles.mean(axis=1)))
    meshes.compute_scalar_by_distance_from_another_mesh_per_vertex(
        measuremesh=1, refmesh=0
    )
    off = meshes.mesh(1).vertex_scalar_array()[:, None]
    moves = -np.clip(off, -_BESIDE * size, _BESIDE * size) * normals

    sums = np.zeros((2, *vertices.shape))
    for corner in faces.T:
        np.add.at(sums[0], corner, moves)
        np.add.at(sums[1], corner, np.broadcast_to(areas, moves.shape))
    return np.asarray(sums[0] / sums[1])
