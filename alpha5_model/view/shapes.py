"""Small triangle meshes that explain: arrows, balls, axes, tubes along curves.

Every body is a `Mesh` with a normal at each corner, so that the page and the picture shade it alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model.checks import FloatArray


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

    def moved(self, transform: FloatArray) -> Mesh:
        """The same mesh after a rigid transform (4, 4)."""
        rotation = transform[:3, :3]
        return Mesh(
            self.vertices @ rotation.T + transform[:3, 3],
            self.normals @ rotation.T,
            self.faces,
            self.colors,
        )


def join(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one; colours are kept if all have them."""
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    colors = [mesh.colors for mesh in meshes if mesh.colors is not None]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate(
            [mesh.faces + np.uint32(start) for mesh, start in zip(meshes, offsets, strict=True)]
        ),
        np.concatenate(colors) if len(colors) == len(meshes) else None,
    )


def lathe(profile: ArrayLike, sides: int = 24) -> Mesh:
    """Turn a profile of (radius, z) points about z; each segment has flat normals along z.

    The profile runs with the body to its left, from the bottom up, so that normals point outward.
    """
    points = np.asarray(profile, dtype=np.float64)
    angles = np.linspace(0.0, 2 * np.pi, sides + 1)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    parts = []
    for (r0, z0), (r1, z1) in pairwise(points):
        slope = np.hypot(r1 - r0, z1 - z0)
        if slope == 0.0:
            continue
        normal = np.column_stack(
            [ring * (z1 - z0) / slope, np.full(sides + 1, (r0 - r1) / slope)],
        )
        low = np.column_stack([ring * r0, np.full(sides + 1, z0)])
        high = np.column_stack([ring * r1, np.full(sides + 1, z1)])
        i = np.arange(sides, dtype=np.uint32)
        a, b, c, d = i, i + 1, i + sides + 2, i + sides + 1
        faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
        parts.append(Mesh(np.concatenate([low, high]), np.concatenate([normal, normal]), faces))
    return join(parts)


def arrow(vector: ArrayLike, radius: float) -> Mesh:
    """An arrow from the origin along a vector (3,) [m], shaft of the given radius [m]."""
    direction = np.asarray(vector, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    head = min(5.0 * radius, 0.6 * length)
    profile = [
        (0.0, 0.0),
        (radius, 0.0),
        (radius, length - head),
        (2.2 * radius, length - head),
        (0.0, length),
    ]
    return lathe(profile).moved(_z_towards(direction))


def ball(radius: float, first: ArrayLike, second: ArrayLike, sides: int = 24) -> Mesh:
    """A sphere at the origin with octants of two colours, the drawing sign for a centre."""
    parts = []
    quarter = sides // 4
    grid = np.linspace(0.0, np.pi / 2, quarter + 1)
    azimuth, polar = np.meshgrid(grid, grid, indexing="ij")
    octant = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(quarter), np.arange(quarter), indexing="ij")
    a = (i * (quarter + 1) + j).ravel().astype(np.uint32)
    b, c, d = a + np.uint32(1), a + np.uint32(quarter + 2), a + np.uint32(quarter + 1)
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    for signs in np.ndindex(2, 2, 2):
        mirror = 1.0 - 2.0 * np.array(signs)
        points = octant * mirror
        odd = sum(signs) % 2 == 1
        color = np.asarray(second if odd else first, dtype=np.float64)
        parts.append(
            Mesh(
                radius * points,
                points,
                faces[:, ::-1] if odd else faces,
                np.tile(color, (len(points), 1)),
            )
        )
    return join(parts)


def triad(length: float, radius: float) -> Mesh:
    """Axes of a frame: x red, y green, z blue."""
    colors = np.array([[0.86, 0.16, 0.16], [0.16, 0.62, 0.2], [0.16, 0.36, 0.9]])
    parts = []
    for axis, color in zip(np.eye(3), colors, strict=True):
        part = arrow(length * axis, radius)
        parts.append(
            Mesh(part.vertices, part.normals, part.faces, np.tile(color, (len(part.vertices), 1)))
        )
    return join(parts)


def tube(points: FloatArray, radius: float, sides: int = 6) -> Mesh:
    """A thin tube along a polyline (N, 3) [m]: a line that keeps its width in every renderer."""
    parts = []
    for start, end in pairwise(points):
        step = end - start
        length = float(np.linalg.norm(step))
        if length > 0.0:
            pose = _z_towards(step)
            pose[:3, 3] = start
            # a little longer than the segment, so that corners close
            profile = [(radius, -radius / 2), (radius, length + radius / 2)]
            parts.append(lathe(profile, sides).moved(pose))
    return join(parts)


def sheet(points: FloatArray, faces: NDArray[np.uint32], normal: ArrayLike) -> Mesh:
    """A flat sheet of triangles with one normal."""
    return Mesh(points, np.tile(np.asarray(normal, dtype=np.float64), (len(points), 1)), faces)


def _z_towards(direction: FloatArray) -> FloatArray:
    z = direction / np.linalg.norm(direction)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    return pose
