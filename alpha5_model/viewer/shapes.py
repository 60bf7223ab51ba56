"""Triangle meshes: shapes of a URDF, solids of revolution, arrows, balls, tubes.

Every mesh has a normal at each corner, so that the page and the picture shade it alike.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import read_named
from alpha5_model._support.spatial import transform
from alpha5_model.description.urdf_robot import UrdfShape
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
        rotation = pose[:3, :3]
        translation = pose[:3, 3]
        return replace(
            self,
            vertices=self.vertices @ rotation.T + translation,
            normals=self.normals @ rotation.T,
        )

    def painted(self, color: ArrayLike) -> Mesh:
        """The same mesh in one colour (3,)."""
        color = np.asarray(color, np.float64)
        return replace(self, colors=np.tile(color, (len(self.vertices), 1)))


def drawn(shape: UrdfShape, folder: str) -> Mesh:
    """The mesh of a URDF's shape in its link's frame.

    Args:
        shape: The shape.
        folder: Where relative file names start.

    Raises:
        MissingFileError, FileFormatError: A mesh that is missing or not a triangle OBJ,
            or another kind of shape.
    """
    if shape.kind == "mesh":
        mesh = read_obj(str(Path(folder, shape.file).resolve()))
    else:
        mesh = primitive(shape.kind, shape.size)
    return mesh.moved(shape.placement)


def primitive(kind: str, size: Sequence[float]) -> Mesh:
    """A box, cylinder or sphere about the origin.

    Args:
        kind: Which of them.
        size: Edges; radius and length; or radius [m].

    Raises:
        FileFormatError: Another kind.
    """
    if kind == "box":
        return box(size)
    if kind == "cylinder":
        radius, length = size
        return cylinder(radius, length)
    if kind == "sphere":
        (radius,) = size
        return sphere(radius)
    raise FileFormatError("URDF", f"cannot draw a {kind}")


def faceted(vertices: FloatArray, triangles: NDArray[Any]) -> Mesh:
    """Triangles with flat faces, seen from both sides.

    Args:
        vertices: (V, 3) [m].
        triangles: Numbers of three vertices each, (T, 3).
    """
    corners = vertices[np.concatenate([triangles, triangles[:, ::-1]])]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    # A triangle without an area has no normal, and is not seen.
    normals = np.divide(across, lengths, out=np.zeros_like(across), where=lengths > 0)
    return Mesh(
        vertices=corners.reshape(-1, 3),
        normals=np.repeat(normals, 3, axis=0),
        faces=np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3),
    )


@cache
def read_obj(path: str) -> Mesh:
    """Read an OBJ of triangles; its materials are not looked for.

    Raises:
        MissingFileError, FileFormatError: Not there, or without triangles.
    """
    content = read_named(path, "a mesh named by the URDF")
    try:
        mesh = trimesh.load_mesh(io.BytesIO(content), file_type="obj", process=False)
        normals = np.array(mesh.vertex_normals)
        faces = mesh.faces.astype(np.uint32)
    except Exception as error:  # trimesh promises no type
        raise FileFormatError(path, f"cannot be read as a mesh ({error})") from None
    if not len(faces):
        raise FileFormatError(path, "has no triangles")
    return Mesh(vertices=np.array(mesh.vertices), normals=normals, faces=faces)


def join(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one; colours are kept if all have them."""
    faces = []
    colors = []
    count = 0
    for mesh in meshes:
        faces.append(mesh.faces + np.uint32(count))
        count += len(mesh.vertices)
        if mesh.colors is not None:
            colors.append(mesh.colors)
    one_color = any(mesh.colors is None for mesh in meshes)
    return Mesh(
        vertices=np.concatenate([mesh.vertices for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        faces=np.concatenate(faces),
        colors=None if one_color else np.concatenate(colors),
    )


def lathe(profile: ArrayLike, sides: int = 24) -> Mesh:
    """Turn a profile of (radius, z) points about z; each segment is flat along z.

    The profile runs with the body to its left, from the bottom up, so that normals
    point outward.
    """
    angles = np.linspace(0.0, 2 * np.pi, sides + 1)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)

    def circle(radius: float, z: float) -> FloatArray:
        return np.column_stack([radius * directions, np.full(sides + 1, z)])

    rings = []
    for (r0, z0), (r1, z1) in pairwise(np.asarray(profile, np.float64)):
        length = np.hypot(r1 - r0, z1 - z0)
        if length:
            normals = circle((z1 - z0) / length, (r0 - r1) / length)
            ring = Mesh(
                vertices=np.concatenate([circle(r0, z0), circle(r1, z1)]),
                normals=np.tile(normals, (2, 1)),
                faces=_grid(2, sides + 1),
            )
            rings.append(ring)
    return join(rings)


def cylinder(radius: float, length: float) -> Mesh:
    """A closed cylinder about z with its middle at the origin."""
    half = length / 2
    return lathe([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])


def quads(corners: FloatArray, normals: ArrayLike) -> Mesh:
    """Quadrilaterals: corners (N, 4, 3), counter-clockwise; normals (N, 3) or (3,)."""
    each = np.broadcast_to(np.asarray(normals, np.float64), (len(corners), 3))
    return Mesh(
        vertices=corners.reshape(-1, 3),
        normals=np.repeat(each, 4, axis=0),
        faces=_triangles(4 * np.arange(len(corners)), 1, 2, 3),
    )


def box(size: ArrayLike) -> Mesh:
    """A box about the origin with edges along the axes, (3,) [m]."""
    side = np.array([[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]]) / 2
    # Mirroring at the origin turns a face inside out, so its corners are taken in
    # reverse.
    opposite = -side[::-1]
    faces = []
    for face in (side, opposite):
        faces += [np.roll(face, axis, axis=1) for axis in range(3)]
    corners = np.array(faces)
    return quads(corners * np.asarray(size), 2.0 * corners.mean(axis=1))


def arrow(vector: ArrayLike, radius: float) -> Mesh:
    """An arrow from the origin along a vector (3,) [m], radius of the shaft [m]."""
    direction = np.asarray(vector, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    neck = length - min(5.0 * radius, 0.6 * length)
    profile = [
        (0.0, 0.0),
        (radius, 0.0),
        (radius, neck),
        (2.2 * radius, neck),
        (0.0, length),
    ]
    return lathe(profile).moved(_z_towards(direction))


def ball(radius: float, first: ArrayLike, second: ArrayLike, sides: int = 24) -> Mesh:
    """A sphere with octants of two colours, the usual symbol for a centre of mass."""
    parts = [
        octant.painted(second if mirrored else first)
        for octant, mirrored in _octants(radius, sides)
    ]
    return join(parts)


def sphere(radius: float, sides: int = 24) -> Mesh:
    """A sphere about the origin."""
    return join([octant for octant, _ in _octants(radius, sides)])


def _octants(radius: float, sides: int) -> Iterator[tuple[Mesh, bool]]:
    """The eight parts of a sphere, and whether each is a mirror image of the first."""
    angles = np.linspace(0.0, np.pi / 2, sides // 4 + 1)
    azimuths, polars = np.meshgrid(angles, angles, indexing="ij")
    azimuth = azimuths.ravel()
    polar = polars.ravel()
    across = np.sin(polar)
    octant = np.column_stack(
        [across * np.cos(azimuth), across * np.sin(azimuth), np.cos(polar)]
    )
    faces = _grid(len(angles), len(angles))
    for signs in product((1.0, -1.0), repeat=3):
        points = octant * signs
        # An odd number of mirrors turns the triangles inside out.
        mirrored = np.prod(signs) < 0
        part = Mesh(
            vertices=radius * points,
            normals=points,
            faces=faces[:, ::-1] if mirrored else faces,
        )
        yield part, bool(mirrored)


def triad(length: float, radius: float) -> Mesh:
    """Axes of a frame: x red, y green, z blue."""
    x, y, z = length * np.eye(3)
    red = (0.86, 0.16, 0.16)
    green = (0.16, 0.62, 0.2)
    blue = (0.16, 0.36, 0.9)
    return join(
        [
            arrow(x, radius).painted(red),
            arrow(y, radius).painted(green),
            arrow(z, radius).painted(blue),
        ]
    )


def tube(points: FloatArray, radius: float, sides: int = 6) -> Mesh:
    """A thin tube along a polyline (N, 3) [m]: a line of the same width everywhere."""
    parts = []
    for start, end in pairwise(points):
        length = float(np.linalg.norm(end - start))
        if length:
            # A little longer than the segment, so that corners close.
            profile = [(radius, -radius / 2), (radius, length + radius / 2)]
            parts.append(lathe(profile, sides).moved(_z_towards(end - start, start)))
    return join(parts)


def _grid(rows: int, columns: int) -> NDArray[np.uint32]:
    """Triangles between vertices in a grid, numbered row by row."""
    vertices = np.arange(rows * columns).reshape(rows, columns)
    first = vertices[:-1, :-1].ravel()
    return _triangles(first, 1, columns + 1, columns)


def _triangles(first: NDArray[np.intp], b: int, c: int, d: int) -> NDArray[np.uint32]:
    """Two triangles for each quadrilateral.

    Args:
        first: Number of its first corner, (N,).
        b, c, d: Numbers of the other corners, counted from the first.
    """
    pair = np.array([[0, b, c], [0, c, d]], np.uint32)
    return (first[:, None, None].astype(np.uint32) + pair).reshape(-1, 3)


def _z_towards(
    direction: FloatArray, origin: ArrayLike = (0.0, 0.0, 0.0)
) -> FloatArray:
    """Pose (4, 4) of a frame at a point with its z axis along a direction."""
    z = direction / np.linalg.norm(direction)
    least_along_z = int(np.argmin(np.abs(z)))
    x = np.cross(np.eye(3)[least_along_z], z)
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    return transform(np.column_stack([x, y, z]), origin)
