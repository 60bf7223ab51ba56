"""Building blocks on the solids of manifold3d, in mm, and a solid's surface as it is written, in metres."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import Alpha5Error, needing

#: A manifold3d solid: closed, outward, exact in its booleans.
Solid = Any
Indices = NDArray[np.int64]
#: Corners of a full circle of 20 mm radius; the chord stays within 0.04 mm of the arc.
SEGMENTS = 56
_ROUND = 1.0  # smaller edges are broken by one chamfer, larger ones rounded in three steps or more
#: Details below this size [mm] are merged away, so that rounding cannot fold a triangle.
_SIMPLIFY = 0.01
#: Coordinates are written in metres with this many decimals: 0.1 micrometre.
DECIMALS = 7
#: Faces that meet at a smaller angle are shaded as one smooth surface.
CREASE = np.deg2rad(32.0)
#: Roll, pitch, yaw [deg] that turn z to an axis.
AXES = {"x": (0.0, 90.0, 0.0), "y": (-90.0, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def kernel() -> Any:
    """The manifold3d module.

    Raises:
        MissingDependencyError: It is not installed; only drawing new meshes needs it.
    """
    with needing("drawing the meshes", "pip install manifold3d"):
        import manifold3d
    return manifold3d


def cylinder(
    radius: float,
    low: float,
    high: float,
    axis: str = "z",
    edges: tuple[float, float] = (0.0, 0.0),
    grooves: Iterable[tuple[float, float, float]] = (),
    segments: int = SEGMENTS,
) -> Solid:
    """A cylinder on an axis through the origin, with rounded edges and ring grooves.

    Args:
        radius: Outer radius.
        low, high: Heights of its faces.
        edges: Rounding at the low and the high face.
        grooves: Each (height of its middle, width, depth), walls sloped by 30 deg from the radius.
    """
    outline = [(0.0, low), *_corner(radius, low, edges[0], -1.0)]
    for middle, width, depth in sorted(grooves):
        half, slope = width / 2, depth * math.tan(math.pi / 6)
        outline += [(radius, middle - half), (radius - depth, middle - half + slope)]
        outline += [(radius - depth, middle + half - slope), (radius, middle + half)]
    outline += [*reversed(_corner(radius, high, edges[1], 1.0)), (0.0, high)]
    return (
        kernel().CrossSection([np.array(outline)]).revolve(segments).rotate(AXES[axis])
    )


def _corner(
    radius: float, height: float, edge: float, side: float
) -> list[tuple[float, float]]:
    """Points of the outline's corner, from the face outwards."""
    if edge == 0.0:
        return [(radius, height)]
    steps = 1 if edge <= _ROUND else max(3, round(edge / 1.5))
    angles = [math.pi / 2 * i / steps for i in range(steps + 1)]
    r, h = radius - edge, height - side * edge
    return [(r + edge * math.sin(a), h + side * edge * math.cos(a)) for a in angles]


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A box between two corners."""
    return kernel().Manifold.cube(np.subtract(high, low)).translate(low)


def prism(outline: ArrayLike, low: float, high: float, edge: float) -> Solid:
    """A convex outline of (x, y) points between two heights, its long edges broken by ``edge``."""
    k = kernel()
    section = k.CrossSection([np.asarray(outline, float)])
    outer = section.extrude(high - low - 2 * edge).translate([0, 0, low + edge])
    inner = section.offset(-edge, k.JoinType.Miter, 2.0)
    return k.Manifold.batch_hull(
        [outer, inner.extrude(high - low).translate([0, 0, low])]
    )


def loft(outlines: Sequence[FloatArray], heights: Sequence[float]) -> Solid:
    """The solid through outlines with the same number of (x, y) points, counter-clockwise."""
    k = kernel()
    n, last = len(outlines[0]), len(outlines) - 1
    vertices = np.column_stack([np.vstack(outlines), np.repeat(heights, n)])
    caps, top = (np.asarray(k.triangulate([outlines[i]])) + n * i for i in (0, last))
    here = np.arange(n)
    there = (here + 1) % n
    side = np.column_stack([here, there, there + n, here, there + n, here + n]).reshape(
        -1, 3
    )
    faces = np.vstack([caps[:, ::-1], top, *(side + n * i for i in range(last))])
    return k.Manifold(k.Mesh64(vertices, faces.astype(np.uint64)))


def union(solids: Iterable[Solid]) -> Solid:
    """All of them together."""
    k = kernel()
    return k.Manifold.batch_boolean(list(solids), k.OpType.Add)


def circle_of(solid: Solid, count: int, radius: float, start: float = 0.0) -> Solid:
    """Copies of a solid, equally spaced on a circle about z; ``start`` in degrees."""
    first = solid.translate([radius, 0, 0])
    return union(first.rotate([0, 0, start + 360.0 * i / count]) for i in range(count))


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
    rounded = np.round(np.asarray(mesh.vert_properties)[:, :3] * 1e-3, DECIMALS) + 0.0
    vertices, place = np.unique(rounded, axis=0, return_inverse=True)
    faces = place.reshape(-1)[np.asarray(mesh.tri_verts).astype(np.int64)]
    # A face whose corners became one is gone, and its neighbours close over it.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    check_closed(faces)
    # Each face starts at its smallest vertex, and the faces are sorted.
    columns = (np.argmin(faces, axis=1)[:, None] + np.arange(3)) % 3
    faces = np.take_along_axis(faces, columns, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])].astype(np.int64)
    return Surface(vertices, faces, *_smooth_normals(vertices, faces))


def _edges(faces: Indices) -> tuple[Indices, Indices]:
    """A number for each directed edge, and for its reverse, (3 m,) each."""
    start, stop, n = (
        faces.reshape(-1),
        np.roll(faces, -1, axis=1).reshape(-1),
        faces.max() + 1,
    )
    return start * n + stop, stop * n + start


def check_closed(faces: Indices) -> None:
    """Every directed edge once, and once in the other direction."""
    here, there = map(np.sort, _edges(faces))
    if (here[1:] == here[:-1]).any() or (here != there).any():
        raise Alpha5Error(
            "a surface is no longer closed after rounding its coordinates"
        )


def _smooth_normals(vertices: FloatArray, faces: Indices) -> tuple[FloatArray, Indices]:
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
    weight = np.arccos(
        np.clip(-np.einsum("fcx,fcx->fc", unit, np.roll(unit, 1, axis=1)), -1, 1)
    )

    # Directed edge (a, b) of one face is (b, a) of its neighbour.
    here, there = _edges(faces)
    order = np.argsort(here)
    twin = order[np.searchsorted(here, there, sorter=order)]
    face, other = np.arange(len(here)) // 3, twin // 3
    smooth = np.einsum("ex,ex->e", flat[face], flat[other]) > np.cos(CREASE)
    # The corner at the edge's start is the twin's end, which is the corner after the twin's.
    after = 3 * other + (twin % 3 + 1) % 3
    edges = np.flatnonzero(smooth)
    graph = coo_array(
        (np.ones(len(edges)), (edges, after[edges])), shape=(len(here), len(here))
    )
    _, group = connected_components(graph, directed=False)

    total = np.zeros((group.max() + 1, 3))
    np.add.at(total, group, (flat[:, None] * weight[..., None]).reshape(-1, 3))
    total /= np.linalg.norm(total, axis=1, keepdims=True)
    normals, index = np.unique(np.round(total, 4) + 0.0, axis=0, return_inverse=True)
    return normals, index.reshape(-1)[group].reshape(-1, 3).astype(np.int64)
