"""Distances of an arm's links to a mesh, by coal's broad phase.

Each link has a dynamic tree of its shapes, which never changes, and the mesh is moved
against it. Each question is a fresh request: one that starts from the answer of the
last has missed overlaps. ``DynamicAABBTreeArrayCollisionManager`` gives wrong answers
and is not used. With coal 3.0.3 all its broad phases give wrong distances of a sphere:
its last distance instead of the least one.

References:
    [Pan2012] Pan, Chitta, Manocha: FCL: A general purpose library for collision and
        proximity queries, ICRA 2012 (dynamic AABB trees).
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import inverse, pose
from alpha5_model.collision.bodies import Body, CollisionBodies, body_poses
from alpha5_model.collision.coal_scene import coal_shape
from alpha5_model.collision.turning_radii import carried_radius, corners_around
from alpha5_model.planning.obstacles import Mesh

#: A line that comes nearer to the margin than this is not proved free [m]. Steps along
#: a line that passes at this distance are as short, and each takes 0.1 ms.
SHORTEST = 1e-4


class BroadPhase:
    """A mesh and the moving links of an arm. Threads may share it."""

    def __init__(self, bodies: CollisionBodies, mesh: Mesh) -> None:
        """Collect the shapes.

        Args:
            bodies: Of the arm; the first is fixed and not compared.
            mesh: In the frame of the first body.
        """
        self._bodies = bodies
        self._mesh = mesh
        self._moving = range(1, len(bodies.bodies))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the links that are compared."""
        return self._bodies.names[1:]

    @cached_property
    def rates(self) -> FloatArray:
        """How fast joints move any point of each link at most, (B-1, B-1) [m/rad]."""
        rates = np.zeros((len(self._moving), len(self._moving)))
        for link in self._moving:
            joint = link
            while joint > 0:
                rates[link - 1, joint - 1] = carried_radius(self._bodies, link, joint)
                joint = self._bodies.bodies[joint].parent
        return rates

    def distances(self, angles: FloatArray) -> FloatArray:
        """Distance of each moving link, at most 0 if it touches, (B-1,) [m].

        Args:
            angles: Of all bodies but the first, (B-1,) [rad].
        """
        return self._distances(angles, np.full(len(self._moving), math.inf))

    def touches(self, angles: FloatArray, margin: float) -> BoolArray:
        """Whether a link comes within a margin [m] at angles (N, B-1), (N,)."""
        enough = np.full(len(self._moving), margin)
        hits = [(self._distances(row, enough) <= margin).any() for row in angles]
        return np.array(hits, np.bool_)

    def nearest(self, angles: FloatArray) -> tuple[float, str]:
        """The least distance [m] at angles (B-1,), and the link that has it."""
        distances = self.distances(angles)
        link = int(distances.argmin())
        return float(distances[link]), self.names[link]

    def free_shares(
        self, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        """How much of straight lines of angles is proved free of the mesh.

        As `alpha5_model.collision.self_collision.SelfCollision.free_shares`, but a line
        that comes within `SHORTEST` of the margin ends there.

        Args:
            start, end: (N, B-1) [rad].
            margin: [m], at least 0.

        Returns:
            From 0 to 1, which is all of a line, (N,).
        """
        lines = zip(start, end, strict=True)
        return np.array([self._free_share(one, other, margin) for one, other in lines])

    def _free_share(self, start: FloatArray, end: FloatArray, margin: float) -> float:
        rates = self.rates @ np.abs(end - start)
        share = 0.0
        while True:
            # A link that is farther off than it moves on the rest of the line is free.
            enough = rates * (1.0 - share) + margin
            angles = start + share * (end - start)
            room = self._distances(angles, enough) - margin
            if room.min() <= SHORTEST:
                return share
            with np.errstate(divide="ignore"):
                step = float((room / rates).min())
            if step > 1.0 - share:
                return 1.0
            share += step

    def _distances(self, angles: FloatArray, enough: FloatArray) -> FloatArray:
        """As `distances`; inf for a link that is farther off than is enough, (B-1,)."""
        poses = body_poses(self._bodies, angles)
        distances = np.full(len(self._moving), math.inf)
        for number in self._moving:
            if self._apart(number, poses[number]) <= enough[number - 1]:
                distances[number - 1] = self._distance(number, poses[number])
        return distances

    def _distance(self, number: int, link: FloatArray) -> float:
        """Distance of the mesh from a link, whose pose is given [m]."""
        import coal

        moved = coal.CollisionObject(self._geometry, _coal_pose(inverse(link)))
        question = coal.DistanceCallBackDefault()
        tree, _ = self._trees[number - 1]
        tree.distance(moved, question)
        return float(question.data.result.min_distance)

    def _apart(self, number: int, link: FloatArray) -> float:
        """A lower bound of a link's distance: of a ball from the mesh's box [m]."""
        low, high = self._box
        centre, radius = self._balls[number - 1]
        placed = link[:3, :3] @ centre + link[:3, 3]
        beyond = np.maximum(np.maximum(low - placed, placed - high), 0.0)
        return math.hypot(*beyond) - radius

    @cached_property
    def _box(self) -> tuple[FloatArray, FloatArray]:
        """Two corners of a box around the mesh."""
        vertices = self._mesh.vertices
        return vertices.min(axis=0), vertices.max(axis=0)

    @cached_property
    def _balls(self) -> list[tuple[FloatArray, float]]:
        """Centre and radius of a ball around each moving link, in its frame."""
        return [_ball(self._bodies.bodies[number]) for number in self._moving]

    @cached_property
    def _geometry(self) -> Any:
        """The mesh as coal takes it."""
        import coal

        made = coal.BVHModelOBBRSS()
        made.beginModel(len(self._mesh.triangles), len(self._mesh.vertices))
        made.addVertices(self._mesh.vertices)
        made.addTriangles(self._mesh.triangles)
        made.endModel()
        return made

    @cached_property
    def _trees(self) -> list[tuple[Any, list[Any]]]:
        """coal's tree of the shapes of each moving link, in its frame, and these."""
        return [_tree(self._bodies.bodies[number]) for number in self._moving]


def _ball(link: Body) -> tuple[FloatArray, float]:
    corners = np.vstack([corners_around(shape) for shape in link.shapes])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    radius = float(np.linalg.norm(corners - centre, axis=1).max())
    return centre, radius


def _tree(link: Body) -> tuple[Any, list[Any]]:
    """A link's tree. It does not keep its shapes alive: the list does."""
    import coal

    tree = coal.DynamicAABBTreeCollisionManager()
    placed = []
    for shape in link.shapes:
        at = _coal_pose(pose(shape.xyz, shape.rpy))
        placed.append(coal.CollisionObject(coal_shape(shape), at))
        tree.registerObject(placed[-1])
    tree.setup()
    return tree, placed


def _coal_pose(placement: FloatArray) -> Any:
    import coal

    return coal.Transform3s(placement[:3, :3], placement[:3, 3])
