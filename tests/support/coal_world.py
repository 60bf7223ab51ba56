"""Collision of an arm with itself and with obstacles: all pairs, by Pinocchio and coal.

The bodies are those of the URDF, their poses Pinocchio's, and each pair of shapes is a
fresh request. Nothing of the package's own tests of collision is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import coal
import numpy as np
import pinocchio as pin
from pinocchio_collision import collision_geometry

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning import Mesh, Obstacle


def obstacle_geometry(obstacle: Obstacle) -> tuple[Any, pin.SE3]:
    """Shape and pose of an obstacle."""
    shape = obstacle.shape
    if isinstance(shape, Mesh):
        made = coal.BVHModelOBBRSS()
        made.beginModel(len(shape.triangles), len(shape.vertices))
        for corners in shape.triangles:
            made.addTriangle(*shape.vertices[corners])
        made.endModel()
        return made, pin.SE3.Identity()
    kinds = {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}
    placement = pin.SE3(rotation_from_rpy(shape.rpy), np.array(shape.xyz))
    return kinds[shape.kind](*shape.size), placement


class CoalWorld:
    """An arm with closed jaws and obstacles, on a base_link that is the world."""

    def __init__(
        self, record: Alpha5Parameters | None = None, obstacles: Sequence[Obstacle] = ()
    ) -> None:
        self.model = a5.load(arm=record).model
        self.data = self.model.createData()
        self.geometry = collision_geometry(self.model, record)
        own = range(self.geometry.ngeoms)
        for obstacle in obstacles:
            shape, placement = obstacle_geometry(obstacle)
            body = pin.GeometryObject(obstacle.name, 0, 0, placement, shape)
            number = self.geometry.addGeometryObject(body)
            for link in own:
                if self.geometry.geometryObjects[link].parentJoint > 0:
                    pair = pin.CollisionPair(link, number)
                    self.geometry.addCollisionPair(pair)
        self.objects = self.geometry.createData()
        pairs = self.geometry.collisionPairs
        self._obstacle_pairs = [k for k, p in enumerate(pairs) if p.second >= len(own)]

    def distances(self, q: np.ndarray) -> np.ndarray:
        """Of all pairs at q (4,)."""
        count = len(self.objects.distanceRequests)
        self.objects.distanceRequests[:] = [coal.DistanceRequest()] * count
        pin.updateGeometryPlacements(
            self.model, self.data, self.geometry, self.objects, q
        )
        pin.computeDistances(self.geometry, self.objects)
        return np.array([r.min_distance for r in self.objects.distanceResults])

    def obstacle_distance(self, q: np.ndarray) -> float:
        """The least one to an obstacle at q (4,)."""
        return float(self.distances(q)[self._obstacle_pairs].min())

    def touches(self, q: np.ndarray) -> bool:
        """Whether any pair touches at q (4,)."""
        count = len(self.objects.collisionRequests)
        self.objects.collisionRequests[:] = [coal.CollisionRequest()] * count
        return bool(
            pin.computeCollisions(
                self.model, self.data, self.geometry, self.objects, q, True
            )
        )


def samples(start: np.ndarray, end: np.ndarray, step: float) -> np.ndarray:
    """Joint positions on a straight line, of which no joint steps farther (N, 4)."""
    count = int(np.ceil(np.abs(end - start).max() / step)) + 1
    share = np.linspace(0.0, 1.0, max(count, 2))
    return start + share[:, None] * (end - start)
