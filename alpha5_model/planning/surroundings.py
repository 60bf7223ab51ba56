"""What an arm must not touch: itself and the obstacles around it.

Boxes, cylinders and spheres are compared with the links by the exact test of
`alpha5_model.collision.self_collision`, in which each takes the place of link_0; a
sphere is its centre with a margin. Meshes are coal's
(`alpha5_model.planning.broad_phase`), unless the arm is free of a box around them.
link_0 does not move: what it touches is not compared.
"""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, frozen
from alpha5_model._support.spatial import pose
from alpha5_model.collision.bodies import CollisionBodies, collision_bodies
from alpha5_model.collision.self_collision import SHORTEST as SHORTEST_EXACT
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.collision.turning_radii import carried_radius
from alpha5_model.description.frames import base_placement
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.broad_phase import SHORTEST as SHORTEST_TO_MESH
from alpha5_model.planning.broad_phase import BroadPhase
from alpha5_model.planning.obstacles import Mesh, Obstacle, seen_from

#: A box around a mesh is larger by this for rounding, and flat nowhere [m].
_LARGER = 1e-6
#: Edges of a box for a point: far below the tolerance of any distance [m].
_POINT = (1e-9, 1e-9, 1e-9)


@dataclass(frozen=True, eq=False)
class Obstruction:
    """Where a straight line of joint positions is not free.

    Attributes:
        share: The part of the line that is proved free, from 0 to 1.
        q: The joint position there, (4,) [rad].
        names: Of the two links, or of a link and an obstacle.
        distance: Between them [m]; at most 0 if they touch.
        needed: The distance that would be enough [m].
    """

    share: float
    q: FloatArray
    names: tuple[str, str]
    distance: float
    needed: float


class Clearance(NamedTuple):
    """The least distance of a motion to obstacles.

    Attributes:
        distance: [m].
        obstacle, link: Whose it is.
        sample: Where in the motion, a row number from 0.
    """

    distance: float
    obstacle: str
    link: str
    sample: int


class _Compared(Protocol):
    """What is compared with the arm: itself, or one obstacle.

    Attributes:
        shortest: A line is proved free if it keeps more than this beyond a margin [m].
    """

    shortest: float

    def touches(self, angles: FloatArray, margin: float) -> BoolArray:
        """Whether they come within a margin at angles (N, 4), (N,)."""

    def free_shares(
        self, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        """How much of lines (N, 4) is proved free, (N,)."""

    def nearest_pair(self, q: FloatArray) -> tuple[float, tuple[str, str]]:
        """The least distance at q (4,), and whose it is."""


class Surroundings:
    """An arm with closed jaws, and the obstacles around it. Threads may share it.

    The arm keeps a margin to obstacles, and another one to itself.

    Attributes:
        obstacles: Their names.
        margin: Kept to obstacles [m].
    """

    def __init__(
        self,
        arm: Alpha5Parameters,
        obstacles: Iterable[Obstacle] = (),
        margin: float = 0.0,
        self_margin: float = 0.0,
    ) -> None:
        given = tuple(obstacles)
        self.obstacles = tuple(obstacle.name for obstacle in given)
        self.margin = margin
        self._arm = arm
        self._compared: list[tuple[_Compared, float]] = [(_itself(arm), self_margin)]
        for obstacle in given:
            self._compared.append((_beside(arm, obstacle), margin))

    def touches(self, q: FloatArray) -> BoolArray:
        """Whether the arm touches itself or comes within the margin, q (N, 4), (N,)."""
        hits = np.zeros(len(q), np.bool_)
        for compared, margin in self._compared:
            free = np.flatnonzero(~hits)
            hits[free] = compared.touches(q[free], margin)
        return hits

    def obstruction(self, start: FloatArray, end: FloatArray) -> Obstruction | None:
        """Where the straight line from ``start`` to ``end``, (4,) each, is not free.

        Returns:
            None if all of it is proved free.
        """
        for compared, margin in self._compared:
            share = compared.free_shares(start[None], end[None], margin).item()
            if share < 1.0:
                q = start + share * (end - start)
                distance, names = compared.nearest_pair(q)
                return Obstruction(
                    share=share,
                    q=q,
                    names=names,
                    distance=distance,
                    needed=margin + compared.shortest,
                )
        return None

    def displacement(self, strayed: FloatArray) -> FloatArray:
        """How far joints that are off by angles move any point of a link at most, [m].

        A joint that is off by an angle moves no point by more than the angle times the
        point's distance from its axis.

        Args:
            strayed: (..., 4) [rad].
        """
        return strayed @ _farthest(self._arm)

    def with_room(self, strayed: FloatArray) -> Surroundings:
        """The same with room for joints beside a line.

        Args:
            strayed: How far each joint may be from the line, (4,) [rad].
        """
        room = float(self.displacement(strayed))
        wider = copy(self)
        wider.margin += room
        wider._compared = [
            (compared, margin + room) for compared, margin in self._compared
        ]
        return wider

    def contact(self, q: FloatArray) -> Obstruction | None:
        """What the arm touches, or comes within the margin of, at q (4,)."""
        for compared, margin in self._compared:
            if compared.touches(q[None], margin).any():
                distance, names = compared.nearest_pair(q)
                return Obstruction(
                    share=0.0, q=q, names=names, distance=distance, needed=margin
                )
        return None

    def nearest(self, q: FloatArray) -> tuple[float, tuple[str, str]]:
        """The least distance at q (4,) [m], and the names of what is so near."""
        return min(compared.nearest_pair(q) for compared, _ in self._compared)

    def clearance(self, q: FloatArray) -> Clearance | None:
        """The least distance to an obstacle at q (N, 4); None without obstacles."""
        least = None
        for compared, _ in self._compared[1:]:
            for sample, row in enumerate(q):
                distance, (obstacle, link) = compared.nearest_pair(row)
                if least is None or distance < least.distance:
                    least = Clearance(
                        distance=distance, obstacle=obstacle, link=link, sample=sample
                    )
        return least


class _ExactBodies:
    """Bodies that the exact test compares, with a radius around the first one [m]."""

    shortest = SHORTEST_EXACT

    def __init__(self, bodies: SelfCollision, radius: float = 0.0) -> None:
        self._bodies = bodies
        self._radius = radius

    def touches(self, angles: FloatArray, margin: float) -> BoolArray:
        return self._bodies.touches(angles, margin + self._radius)

    def free_shares(
        self, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        return self._bodies.free_shares(start, end, margin + self._radius)

    def nearest_pair(self, q: FloatArray) -> tuple[float, tuple[str, str]]:
        contact = self._bodies.nearest(q)
        return contact.distance - self._radius, self._bodies.links(contact)


class _MeshBody:
    """A mesh that coal compares, if the arm is not free of a box around it."""

    shortest = SHORTEST_TO_MESH

    def __init__(self, name: str, bodies: BroadPhase, box: SelfCollision) -> None:
        self._name = name
        self._bodies = bodies
        self._box = box

    def touches(self, angles: FloatArray, margin: float) -> BoolArray:
        hits = self._box.touches(angles, margin)
        hits[hits] = self._bodies.touches(angles[hits], margin)
        return hits

    def free_shares(
        self, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        shares = self._box.free_shares(start, end, margin)
        left = np.flatnonzero(shares < 1.0)
        reached = start[left] + shares[left, None] * (end[left] - start[left])
        of_the_rest = self._bodies.free_shares(reached, end[left], margin)
        # One that is free to its end is exactly 1.
        shares[left] = 1.0 - (1.0 - shares[left]) * (1.0 - of_the_rest)
        return shares

    def nearest_pair(self, q: FloatArray) -> tuple[float, tuple[str, str]]:
        distance, link = self._bodies.nearest(q)
        return distance, (self._name, link)


def _itself(arm: Alpha5Parameters) -> _Compared:
    return _ExactBodies(self_collision(arm))


@lru_cache(maxsize=256)
def _beside(arm: Alpha5Parameters, obstacle: Obstacle) -> _Compared:
    """An obstacle beside an arm, made once."""
    bodies = _bodies_of(arm)
    placement = base_placement(arm)
    shape = seen_from(pose(placement.xyz, placement.rpy), obstacle.shape)
    if isinstance(shape, Mesh):
        box = instead_of_link_0(bodies, obstacle.name, _box_around(shape))
        return _MeshBody(obstacle.name, BroadPhase(bodies, shape), SelfCollision(box))

    compared, radius = without_radius(shape)
    with_obstacle = instead_of_link_0(bodies, obstacle.name, compared)
    return _ExactBodies(SelfCollision(with_obstacle), radius)


def without_radius(shape: Primitive) -> tuple[Primitive, float]:
    """A box or cylinder as it is and 0, or a sphere's centre and its radius [m]."""
    if shape.kind != "sphere":
        return shape, 0.0
    (radius,) = shape.size
    return replace(shape, kind="box", size=_POINT), radius


@lru_cache(maxsize=16)
def _bodies_of(arm: Alpha5Parameters) -> CollisionBodies:
    return collision_bodies(arm)


@lru_cache(maxsize=16)
def _farthest(arm: Alpha5Parameters) -> FloatArray:
    """Distance from each joint's axis of the farthest point that it moves, (4,) [m]."""
    bodies = _bodies_of(arm)
    joints = range(1, len(bodies.bodies))
    return frozen(
        [
            max(carried_radius(bodies, link, joint) for link in joints if link >= joint)
            for joint in joints
        ]
    )


def instead_of_link_0(
    bodies: CollisionBodies, name: str, shape: Primitive
) -> CollisionBodies:
    """An obstacle and the moving links, each of which is compared with it."""
    obstacle = replace(bodies.bodies[0], name=name, shapes=(shape,))
    pairs = tuple((0, link) for link in range(1, len(bodies.bodies)))
    return CollisionBodies(bodies=(obstacle, *bodies.bodies[1:]), pairs=pairs)


def _box_around(mesh: Mesh) -> Primitive:
    low = mesh.vertices.min(axis=0)
    high = mesh.vertices.max(axis=0)
    edges = high - low + _LARGER
    centre = (low + high) / 2
    return Primitive(kind="box", size=tuple(edges.tolist()), xyz=tuple(centre.tolist()))
