"""The obstacles of the world around an arm whose vehicle may be anywhere in it.

The exact test of `alpha5_model.collision.self_collision` takes an obstacle in place of
link_0. Here the obstacle stays, and the arm, or a part of the vehicle, is moved to
where the vehicle is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import inverse, moved, pose
from alpha5_model.collision.bodies import Body, CollisionBodies, collision_bodies
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.collision.turning_radii import corners_around
from alpha5_model.description.frames import base_placement
from alpha5_model.errors import InputError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.obstacles import Mesh, Obstacle
from alpha5_model.planning.surroundings import instead_of_link_0, without_radius


class _Compared(NamedTuple):
    """Two things whose distance is asked for.

    Attributes:
        scene: Their shapes. An obstacle of the world is the first body, in its own
            frame, and carries link_0.
        radius: Of spheres, which the scene has as points [m].
        from_world: Maps the world to the obstacle's frame, (4, 4).
        half: Half edges of the box around the obstacle, (3,) [m].
        ball: Around what link_0 carries, at any angles: its centre in link_0, (3,), and
            its radius [m].
    """

    scene: SelfCollision
    radius: float
    from_world: FloatArray
    half: FloatArray
    ball: tuple[FloatArray, float]

    def least_possible(self, link_0: FloatArray) -> FloatArray:
        """Lower bounds of the distance at poses of link_0 in the obstacle, (N,) [m]."""
        centre, radius = self.ball
        beyond = np.maximum(np.abs(moved(link_0, centre)) - self.half, 0.0)
        return np.asarray(np.linalg.norm(beyond, axis=1) - radius - self.radius)


class World:
    """The obstacles of the world, and the arm with the hull of its vehicle among them.

    Bases are poses of base_link in the world, (N, 4, 4); joint positions q at each of
    them are (N, R, 4) [rad].
    """

    def __init__(
        self,
        arm: Alpha5Parameters,
        hull: tuple[Obstacle, ...],
        obstacles: tuple[Obstacle, ...],
    ) -> None:
        """Collect the shapes.

        Args:
            arm: Its record.
            hull: Of the vehicle, in base_link.
            obstacles: In the world.

        Raises:
            InputError: One of them is a mesh.
        """
        bodies = collision_bodies(arm)
        placement = base_placement(arm)
        self._link_0 = pose(placement.xyz, placement.rpy)
        self._arm: list[_Compared] = []
        self._vehicle: list[_Compared] = []

        parts = [(bodies.bodies[0].shapes, 0.0)]
        for obstacle in hull:
            part = _primitive("hull", obstacle).moved(inverse(self._link_0))
            shape, radius = without_radius(part)
            parts.append(((shape,), radius))

        for obstacle in obstacles:
            placed = _primitive("obstacles", obstacle)
            from_world = inverse(pose(placed.xyz, placed.rpy))
            shape, radius = without_radius(placed.moved(from_world))
            beside_arm = _Compared(
                scene=SelfCollision(instead_of_link_0(bodies, obstacle.name, shape)),
                radius=radius,
                from_world=from_world,
                half=corners_around(shape).max(axis=0),
                ball=_ball_around_links(bodies),
            )
            self._arm.append(beside_arm)
            for shapes, own_radius in parts:
                beside_part = beside_arm._replace(
                    scene=SelfCollision(_two_bodies(obstacle.name, shape, shapes)),
                    radius=radius + own_radius,
                    ball=_ball_around(shapes),
                )
                self._vehicle.append(beside_part)

    def blocks_vehicle(self, bases: FloatArray, margin: float) -> BoolArray:
        """Whether hull or link_0 come within a margin [m] of an obstacle, (N,)."""
        fixed = np.zeros((len(bases), 1, 1))
        asked = np.ones((len(bases), 1), np.bool_)
        return self._blocked(self._vehicle, bases, fixed, asked, margin)[:, 0]

    def blocks_arm(
        self, bases: FloatArray, q: FloatArray, asked: BoolArray, margin: float
    ) -> BoolArray:
        """Whether moving links come within a margin of an obstacle, (N, R).

        Args:
            bases: (N, 4, 4).
            q: (N, R, 4).
            asked: Others are not tested, and count as free, (N, R).
            margin: [m].
        """
        return self._blocked(self._arm, bases, q, asked, margin)

    def vehicle_clearance(self, bases: FloatArray) -> FloatArray:
        """Distance of hull and link_0 from the obstacles, (N,) [m].

        None of them may touch; inf without obstacles.
        """
        fixed = np.zeros((len(bases), 1, 1))
        return self._clearance(self._vehicle, bases, fixed)

    def arm_clearance(self, bases: FloatArray, q: FloatArray) -> FloatArray:
        """Least distance of the moving links from the obstacles, (N,) [m].

        None of them may touch; inf without obstacles.
        """
        return self._clearance(self._arm, bases, q)

    def _blocked(
        self,
        compared: list[_Compared],
        bases: FloatArray,
        angles: FloatArray,
        asked: BoolArray,
        margin: float,
    ) -> BoolArray:
        hits = np.zeros(asked.shape, np.bool_)
        for thing in compared:
            left = asked & ~hits
            rows = np.flatnonzero(left.any(axis=1))
            within = np.full(len(rows), margin)
            for row, scene in self._scenes(thing, bases, rows, within):
                reach = margin + thing.radius
                hits[row] |= scene.touches(angles[row], reach, left[row])
        return hits

    def _clearance(
        self, compared: list[_Compared], bases: FloatArray, angles: FloatArray
    ) -> FloatArray:
        least = np.full(len(bases), math.inf)
        rows = np.arange(len(bases))
        for thing in compared:
            for row, scene in self._scenes(thing, bases, rows, least):
                enough = least[row] + thing.radius
                found = least_distance(scene, angles[row], enough)
                least[row] = found - thing.radius
        return least

    def _scenes(
        self,
        thing: _Compared,
        bases: FloatArray,
        rows: np.ndarray,
        within: FloatArray,
    ) -> Iterator[tuple[int, SelfCollision]]:
        """The shapes as they are at rows where they may be within distances (N,)."""
        link_0 = thing.from_world @ bases[rows] @ self._link_0
        near = np.flatnonzero(thing.least_possible(link_0) <= within)
        for number in near.tolist():
            yield int(rows[number]), thing.scene.carried(link_0[number])


def least_distance(scene: SelfCollision, angles: FloatArray, most: float) -> float:
    """The least distance at rows of angles (R, B-1) of bodies that do not touch [m].

    A distance takes far longer than the question whether it is less than another one,
    so only rows that are nearer than those before are measured.

    Args:
        scene: What is compared.
        angles: (R, B-1) [rad].
        most: The answer if no row is nearer [m].
    """
    while len(angles):
        if math.isfinite(most):
            angles = angles[scene.touches(angles, most)]
            if not len(angles):
                break
        most = min(most, scene.distance(angles[:1]).item())
        angles = angles[1:]
    return most


def _two_bodies(
    name: str, obstacle: Primitive, shapes: tuple[Primitive, ...]
) -> CollisionBodies:
    """An obstacle and shapes in link_0, which it carries; their angle is 0."""
    fixed = Body(name=name, parent=-1, placement=np.eye(4), shapes=(obstacle,))
    part = Body(name="vehicle", parent=0, placement=np.eye(4), shapes=shapes)
    return CollisionBodies(bodies=(fixed, part), pairs=((0, 1),))


def _ball_around(shapes: tuple[Primitive, ...]) -> tuple[FloatArray, float]:
    """Centre (3,) and radius of a ball around shapes [m]."""
    corners = np.vstack([corners_around(shape) for shape in shapes])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return centre, float(np.linalg.norm(corners - centre, axis=1).max())


def _ball_around_links(bodies: CollisionBodies) -> tuple[FloatArray, float]:
    """A ball about the origin of link_0 that holds the links at any angles."""
    chain = [0.0]
    radius = 0.0
    for body in bodies.bodies[1:]:
        origin = chain[body.parent] + float(np.linalg.norm(body.placement[:3, 3]))
        chain.append(origin)
        corners = np.vstack([corners_around(shape) for shape in body.shapes])
        farthest = float(np.linalg.norm(corners, axis=1).max())
        radius = max(radius, origin + farthest)
    return np.zeros(3), radius


def _primitive(argument: str, obstacle: Obstacle) -> Primitive:
    """The shape of an obstacle.

    Raises:
        InputError: It is a mesh.
    """
    if isinstance(obstacle.shape, Mesh):
        expected = "boxes, cylinders and spheres: put one around the mesh"
        raise InputError(argument, f"the mesh {obstacle.name}", expected)
    return obstacle.shape
