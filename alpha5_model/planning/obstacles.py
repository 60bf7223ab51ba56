"""Fixed bodies beside the arm: a vehicle's hull, a post, the sea bed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    bounded,
    float_array,
    frozen,
    instance,
    listed,
    real,
)
from alpha5_model._support.spatial import inverse, moved, pose, rotation_from_rpy
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.plausibility import POOL, POSITION

_ORIGIN = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in base_link.

    Attributes:
        vertices: (V, 3) [m].
        triangles: Numbers of three vertices each, (T, 3).
    """

    vertices: FloatArray
    triangles: np.ndarray


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A fixed body that the arm must not touch. Make it by one of the four methods.

    A mesh is its surface: nothing is inside it. A motion that starts outside of a
    closed mesh stays outside, because it does not cross the surface.

    Attributes:
        name: For messages.
        shape: In base_link.

    Warns:
        ImplausibleWarning: It is nowhere thinner than 2 m, a mesh 20 m, or all of it is
            more than 2 m away from base_link; or angles that are likely in degrees.
    """

    name: str
    shape: Primitive | Mesh

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError("name", self.name, "the obstacle's name, a text")
        if not isinstance(self.shape, Primitive | Mesh):
            expected = "a shape from Obstacle.box, cylinder, sphere or mesh"
            raise InputError("shape", self.shape, expected)
        _warn_of_millimetres(self.name, self.shape)

    @classmethod
    def box(
        cls,
        name: str,
        edges: ArrayLike,
        xyz: ArrayLike = _ORIGIN,
        rpy: ArrayLike = _ORIGIN,
    ) -> Obstacle:
        """A box.

        Args:
            name: For messages.
            edges: Along its x, y and z, (3,) [m].
            xyz: Its centre in base_link, (3,) [m].
            rpy: Fixed-axis roll, pitch, yaw, (3,) [rad].

        Raises:
            InputError: Not finite numbers of these shapes, or an edge not above 0.
        """
        size = tuple(array("edges", edges, 3).tolist())
        for number, edge in enumerate(size):
            real(f"edges[{number}]", edge, minimum=0.0, strict=True)
        return cls(name, _primitive("box", size, xyz, rpy))

    @classmethod
    def cylinder(
        cls,
        name: str,
        radius: float,
        length: float,
        xyz: ArrayLike = _ORIGIN,
        rpy: ArrayLike = _ORIGIN,
    ) -> Obstacle:
        """A cylinder along its own z.

        Args:
            name: For messages.
            radius, length: [m].
            xyz: Its centre in base_link, (3,) [m].
            rpy: Fixed-axis roll, pitch, yaw, (3,) [rad].

        Raises:
            InputError: Not finite numbers of these shapes, or a size not above 0.
        """
        size = (
            real("radius", radius, minimum=0.0, strict=True),
            real("length", length, minimum=0.0, strict=True),
        )
        return cls(name, _primitive("cylinder", size, xyz, rpy))

    @classmethod
    def sphere(cls, name: str, radius: float, xyz: ArrayLike = _ORIGIN) -> Obstacle:
        """A sphere.

        Args:
            name: For messages.
            radius: [m].
            xyz: Its centre in base_link, (3,) [m].

        Raises:
            InputError: Not finite numbers of these shapes, or a radius not above 0.
        """
        size = (real("radius", radius, minimum=0.0, strict=True),)
        return cls(name, _primitive("sphere", size, xyz, np.zeros(3)))

    @classmethod
    def mesh(
        cls,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        xyz: ArrayLike = _ORIGIN,
        rpy: ArrayLike = _ORIGIN,
    ) -> Obstacle:
        """A surface of triangles.

        Args:
            name: For messages.
            vertices: In the mesh's frame, (V, 3) [m].
            triangles: Numbers of three vertices each, from 0, (T, 3).
            xyz: Origin of the mesh's frame in base_link, (3,) [m].
            rpy: Fixed-axis roll, pitch, yaw of that frame, (3,) [rad].

        Raises:
            InputError: Not finite numbers of these shapes, no triangle, or numbers of
                vertices that do not exist.
        """
        points = bounded("vertices", float_array("vertices", vertices, (3,)))
        if points.ndim != 2:
            raise ShapeError("vertices", points.shape, "shape (V, 3)")
        numbers = float_array("triangles", triangles, (3,))
        if numbers.ndim != 2 or not len(numbers):
            raise ShapeError("triangles", numbers.shape, "shape (T, 3), T at least 1")

        known = (numbers >= 0) & (numbers < len(points)) & (numbers % 1 == 0)
        if not known.all():
            worst = float(numbers[~known][0])
            expected = f"whole numbers from 0 to {len(points) - 1}"
            raise InputError("triangles", worst, expected)

        frame = pose(array("xyz", xyz, 3), plausibility.angles("rpy", rpy))
        corners = numbers.astype(np.intp)
        corners.flags.writeable = False
        return cls(name, Mesh(vertices=frozen(moved(frame, points)), triangles=corners))


def seen_from(frame: FloatArray, shape: Primitive | Mesh) -> Primitive | Mesh:
    """A shape of base_link in another frame, whose pose (4, 4) in base_link is given.

    Args:
        frame: Its columns are unit vectors.
        shape: In base_link.
    """
    to_frame = inverse(frame)
    if isinstance(shape, Primitive):
        return shape.moved(to_frame)
    vertices = frozen(moved(to_frame, shape.vertices))
    return Mesh(vertices=vertices, triangles=shape.triangles)


def _warn_of_millimetres(name: str, shape: Primitive | Mesh) -> None:
    """Warn of a body that is too thick, or too far away, to be meant in metres.

    The sea bed is wide, and its middle may be far away: what counts is its thickness
    and its distance. A mesh may be a pool around the arm.
    """
    thickness = POSITION
    if isinstance(shape, Mesh):
        low = shape.vertices.min(axis=0)
        high = shape.vertices.max(axis=0)
        half = (high - low) / 2
        beside = -(low + high) / 2
        thickness = POOL
    else:
        half = np.array(_half_edges(shape))
        beside = -rotation_from_rpy(shape.rpy).T @ np.array(shape.xyz)
    away = float(np.linalg.norm(np.maximum(np.abs(beside) - half, 0.0)))
    plausibility.check(f"thickness of {name}", 2 * float(half.min()), thickness)
    plausibility.check(f"distance of {name} from its frame's origin", away, POSITION)


def _half_edges(shape: Primitive) -> tuple[float, ...]:
    """Half the edges of the box around a shape, in its own frame [m]."""
    if shape.kind == "box":
        return tuple(edge / 2 for edge in shape.size)
    radius = shape.size[0]
    if shape.kind == "sphere":
        return (radius, radius, radius)
    return (radius, radius, shape.size[1] / 2)


def _primitive(
    kind: str, size: tuple[float, ...], xyz: ArrayLike, rpy: ArrayLike
) -> Primitive:
    return Primitive(
        kind=kind,
        size=size,
        xyz=tuple(array("xyz", xyz, 3).tolist()),
        rpy=tuple(plausibility.angles("rpy", rpy).tolist()),
    )


def checked_obstacles(
    obstacles: Iterable[Obstacle], name: str = "obstacles"
) -> tuple[Obstacle, ...]:
    """Obstacles whose names differ.

    Args:
        obstacles: What was given.
        name: Of the argument.

    Raises:
        InputError: Something else than obstacles, or a name twice.
    """
    expected = "a list of Obstacle"
    given = tuple(listed(name, obstacles, expected))
    names = set()
    for number, obstacle in enumerate(given):
        own_name = instance(f"{name}[{number}]", obstacle, Obstacle).name
        if own_name in names:
            raise InputError(name, own_name, "names that differ")
        names.add(own_name)
    return given
