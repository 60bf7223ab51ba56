"""Does the arm hit itself, and how far is it from doing so? Pinocchio and coal on the primitives.

Pairs of links that turn against each other at a joint are left out, as in ``urdf/alpha5.srdf``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import coal
import pinocchio as pin

from alpha5_model.checks import FloatArray, frozen
from alpha5_model.description.poses import ADJACENT_PAIRS, CLOSING_PAIRS, NEVER_PAIRS
from alpha5_model.meshing.collision_shapes import collision_primitives
from alpha5_model.meshing.primitive import Primitive
from alpha5_model.spatial import pose


@dataclass(frozen=True, eq=False)
class Clearance:
    """The place where the arm is closest to itself.

    Attributes:
        distance: [m]; below 0 it is the depth of penetration.
        links: Names of the two links.
        points: The closest point of each, (2, 3), in the world [m].
    """

    distance: float
    links: tuple[str, str]
    points: FloatArray


class CollisionModel:
    """The collision bodies of a model, with Pinocchio's scratch memory: one for each thread.

    Attributes:
        geometry: pin.GeometryModel with a pair of objects for each pair of links that is checked.
        data: pin.GeometryData.
    """

    def __init__(self, model: Any) -> None:
        """Collect the primitives of a model's links.

        Args:
            model: pin.Model of the arm; with frames ``finger_1`` and ``finger_2`` the jaws move, without
                them they are closed and part of link_4.
        """
        self._model = model
        self._data = model.createData()
        self.geometry = collision_geometry(model)
        self.data = self.geometry.createData()
        # Pinocchio has each search start where the last one ended: then the answer at q, a micrometre
        # of it, depends on what was asked before. coal's own request starts afresh.
        self.data.distanceRequests[:] = [coal.DistanceRequest()] * len(self.data.distanceRequests)

    def in_collision(self, q: FloatArray) -> bool:
        """Whether two links that are not neighbours touch at q, (nq,)."""
        return self.clearance(q).distance <= 0.0

    def colliding_links(self, q: FloatArray) -> tuple[tuple[str, str], ...]:
        """Every pair of links that touch at q, (nq,), each once."""
        self._closest_pair(q)
        results = zip(self.geometry.collisionPairs, self.data.distanceResults, strict=True)
        pairs = [self._links(pair) for pair, result in results if result.min_distance <= 0.0]
        return tuple(dict.fromkeys(pairs))

    def clearance(self, q: FloatArray) -> Clearance:
        """The closest place at q, (nq,), to a micrometre."""
        index = self._closest_pair(q)
        result = self.data.distanceResults[index]
        return Clearance(
            float(result.min_distance),
            self._links(self.geometry.collisionPairs[index]),
            frozen([result.getNearestPoint1(), result.getNearestPoint2()]),
        )

    def _closest_pair(self, q: FloatArray) -> int:
        # Distances, not coal's quicker yes or no: that one starts from the contact of the last call and
        # was seen to miss an overlap of 0.03 mm.
        pin.updateGeometryPlacements(self._model, self._data, self.geometry, self.data, q)
        return int(pin.computeDistances(self.geometry, self.data))

    def _links(self, pair: Any) -> tuple[str, str]:
        objects = self.geometry.geometryObjects
        one, other = (
            self._model.frames[objects[i].parentFrame].name for i in (pair.first, pair.second)
        )
        return one, other


def collision_geometry(model: Any) -> Any:
    """Primitives of the links of a pin.Model as pin.GeometryModel, with the pairs to be checked."""
    gripper = "jaws" if model.existFrame("finger_1") else "locked"
    geometry = pin.GeometryModel()
    members: dict[str, list[int]] = {}
    for link, shapes in collision_primitives(gripper).items():
        index = model.getFrameId(link)
        frame = model.frames[index]
        members[link] = [
            geometry.addGeometryObject(
                pin.GeometryObject(
                    f"{link}_{i}",
                    frame.parentJoint,
                    index,
                    frame.placement * pin.SE3(pose(shape.xyz, shape.rpy)),
                    _coal_shape(shape),
                )
            )
            for i, shape in enumerate(shapes)
        ]
    excluded = {frozenset(pair) for pair in (*ADJACENT_PAIRS, *CLOSING_PAIRS, *NEVER_PAIRS)}
    links = list(members)
    for i, one in enumerate(links):
        for other in links[i + 1 :]:
            if frozenset((one, other)) not in excluded:
                for a in members[one]:
                    for b in members[other]:
                        geometry.addCollisionPair(pin.CollisionPair(a, b))
    return geometry


def _coal_shape(shape: Primitive) -> Any:
    kinds = {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}
    return kinds[shape.kind](*shape.size)
