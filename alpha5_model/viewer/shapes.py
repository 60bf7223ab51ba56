"""Triangle meshes: the shapes of a URDF, arrows, balls, axes, solids of revolution, tubes.

Every mesh has a normal at each corner, so that the page and the picture shade it alike.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise, product
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import read_named
from alpha5_model._support.spatial import transform
from alpha5_model.description.reading import UrdfShape
from alpha5_model.errors import FileFormatError


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with normals.

    Attributes:
        vertices: (V, 3) [m].
        normals: Unit outward normals, (V, 3).
        faces: Vertex indices, counter-clockwise from outside, (F, 3).
        colors: Colour of each vertex, (V, 3) in 0 to 1, or None for one colour.
    """

    vertices: FloatArray
    normals: FloatArray
    faces: NDArray[np.uint32]
    colors: FloatArray | None = None

    def moved(self, pose: FloatArray) -> Mesh:
        """The same mesh after a rigid motion (4, 4)."""
        turn, shift = pose[:3, :3].T, pose[:3, 3]
        return replace(
            self, vertices=self.vertices @ turn + shift, normals=self.normals @ turn
        )

    def painted(self, color: ArrayLike) -> Mesh:
        """The same mesh in one colour (3,)."""
        return replace(
            self, colors=np.tile(np.asarray(color, np.float64), (len(self.vertices), 1))
        )


def drawn(shape: UrdfShape, folder: str) -> Mesh:
    """The mesh of a URDF's shape in its link's frame; relative file names start at the folder.

    Raises:
        MissingFileError, FileFormatError: A mesh that is missing or not a triangle OBJ, or another
            kind of shape.
    """
    if shape.kind == "mesh":
        mesh = read_obj(str(Path(folder, shape.file).resolve()))
    elif shape.kind == "box":
        mesh = box(shape.size)
    elif shape.kind == "cylinder":
        r, half = shape.size[0], shape.size[1] / 2
        mesh = lathe([(0.0, -half), (r, -half), (r, half), (0.0, half)])
    else:
        raise FileFormatError("URDF", f"cannot draw a {shape.kind}")
    return mesh.moved(shape.placement)


@cache
def read_obj(path: str) -> Mesh:
    """Read an OBJ of triangles with normals.

    Raises:
        MissingFileError, FileFormatError: Not there, or not made of triangles with normals.
    """
    lines = (
        read_named(path, "a mesh named by the URDF")
        .decode("utf-8", "replace")
        .splitlines()
    )
    rows = (
        [line.split()[1:4] for line in lines if line.startswith(k)]
        for k in ("v ", "vn ")
    )
    vertices, normals = (np.array(numbers, float) for numbers in rows)
    corners = [line.split()[1:] for line in lines if line.startswith("f ")]
    try:
        index = (
            np.array([[part.split("//") for part in corner] for corner in corners], int)
            - 1
        )
    except ValueError:
        index = np.empty(0)
    if index.ndim != 3 or index.shape[1:] != (3, 2):
        raise FileFormatError(path, "expected triangles with normals, f a//n b//n c//n")
    pairs, inverse = np.unique(index.reshape(-1, 2), axis=0, return_inverse=True)
    faces = inverse.reshape(-1, 3).astype(np.uint32)
    return Mesh(vertices[pairs[:, 0]], normals[pairs[:, 1]], faces)


def join(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one; colours are kept if all have them."""
    starts = np.cumsum(
        [0, *(len(mesh.vertices) for mesh in meshes[:-1])], dtype=np.uint32
    )
    colors = [mesh.colors for mesh in meshes if mesh.colors is not None]
    parts = [
        (m.vertices, m.normals, m.faces + n)
        for m, n in zip(meshes, starts, strict=True)
    ]
    vertices, normals, faces = (
        np.concatenate(part) for part in zip(*parts, strict=True)
    )
    painted = np.concatenate(colors) if len(colors) == len(meshes) else None
    return Mesh(vertices, normals, faces, painted)


def lathe(profile: ArrayLike, sides: int = 24) -> Mesh:
    """Turn a profile of (radius, z) points about z; each segment has flat normals along z.

    The profile runs with the body to its left, from the bottom up, so that normals point outward.
    """
    angles = np.linspace(0.0, 2 * np.pi, sides + 1)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)

    def circle(radius: float, z: float) -> FloatArray:
        return np.column_stack([radius * ring, np.full(sides + 1, z)])

    parts = []
    for (r0, z0), (r1, z1) in pairwise(np.asarray(profile, np.float64)):
        slope = np.hypot(r1 - r0, z1 - z0)
        if slope > 0.0:
            vertices = np.concatenate([circle(r0, z0), circle(r1, z1)])
            normals = np.tile(circle((z1 - z0) / slope, (r0 - r1) / slope), (2, 1))
            parts.append(Mesh(vertices, normals, _grid(2, sides + 1)))
    return join(parts)


def quads(corners: FloatArray, normals: ArrayLike) -> Mesh:
    """Flat quadrilaterals: corners (N, 4, 3), counter-clockwise; normals (N, 3) or (3,)."""
    each = np.broadcast_to(np.asarray(normals, np.float64), (len(corners), 3))
    faces = _triangles(4 * np.arange(len(corners)), 1, 2, 3)
    return Mesh(corners.reshape(-1, 3), np.repeat(each, 4, axis=0), faces)


def box(size: ArrayLike) -> Mesh:
    """A box about the origin with edges along the axes, (3,) [m]."""
    side = np.array([[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]]) / 2
    # Mirroring at the origin reverses the sense of a face, so its corners are reversed too.
    corners = np.array(
        [np.roll(s * side[::s], k, axis=1) for s in (1, -1) for k in range(3)]
    )
    return quads(corners * np.asarray(size), 2.0 * corners.mean(axis=1))


def arrow(vector: ArrayLike, radius: float) -> Mesh:
    """An arrow from the origin along a vector (3,) [m], shaft of the given radius [m]."""
    direction = np.asarray(vector, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    neck = length - min(5.0 * radius, 0.6 * length)
    outline = [
        (0.0, 0.0),
        (radius, 0.0),
        (radius, neck),
        (2.2 * radius, neck),
        (0.0, length),
    ]
    return lathe(outline).moved(_z_towards(direction))


def ball(radius: float, first: ArrayLike, second: ArrayLike, sides: int = 24) -> Mesh:
    """A sphere at the origin with octants of two colours, the usual symbol for a centre of mass."""
    angles = np.linspace(0.0, np.pi / 2, sides // 4 + 1)
    azimuth, polar = (
        angle.ravel() for angle in np.meshgrid(angles, angles, indexing="ij")
    )
    across = np.sin(polar)
    octant = np.column_stack(
        [across * np.cos(azimuth), across * np.sin(azimuth), np.cos(polar)]
    )
    faces = _grid(len(angles), len(angles))
    parts = []
    for signs in product((1.0, -1.0), repeat=3):
        points, odd = octant * signs, np.prod(signs) < 0
        part = Mesh(radius * points, points, faces[:, ::-1] if odd else faces)
        parts.append(part.painted(second if odd else first))
    return join(parts)


def triad(length: float, radius: float) -> Mesh:
    """Axes of a frame: x red, y green, z blue."""
    colors = np.array([[0.86, 0.16, 0.16], [0.16, 0.62, 0.2], [0.16, 0.36, 0.9]])
    axes = zip(length * np.eye(3), colors, strict=True)
    return join([arrow(axis, radius).painted(color) for axis, color in axes])


def tube(points: FloatArray, radius: float, sides: int = 6) -> Mesh:
    """A thin tube along a polyline (N, 3) [m]: a line that keeps its width in every renderer."""
    parts = []
    for start, end in pairwise(points):
        length = float(np.linalg.norm(end - start))
        if length > 0.0:
            # a little longer than the segment, so that corners close
            profile = [(radius, -radius / 2), (radius, length + radius / 2)]
            parts.append(lathe(profile, sides).moved(_z_towards(end - start, start)))
    return join(parts)


def _grid(rows: int, columns: int) -> NDArray[np.uint32]:
    """Triangles between vertices in a grid, numbered row by row."""
    first = np.arange(rows * columns).reshape(rows, columns)[:-1, :-1]
    return _triangles(first.ravel(), 1, columns + 1, columns)


def _triangles(first: NDArray[np.intp], b: int, c: int, d: int) -> NDArray[np.uint32]:
    """Two triangles for each quadrilateral with corners at ``first`` (N,) and b, c, d after it."""
    pair = np.array([[0, b, c], [0, c, d]], np.uint32)
    return (first[:, None, None].astype(np.uint32) + pair).reshape(-1, 3)


def _z_towards(
    direction: FloatArray, origin: ArrayLike = (0.0, 0.0, 0.0)
) -> FloatArray:
    """Pose (4, 4) of a frame at a point with its z axis along a direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    return transform(np.column_stack([x, np.cross(z, x), z]), origin)
