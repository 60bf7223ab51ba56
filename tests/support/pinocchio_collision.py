"""Self-collision and clearance by Pinocchio and coal: a second route.

The bodies are those of the package, as a pin.GeometryModel, and every pair is measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import coal
import pinocchio as pin

from alpha5_model._support.checks import (
    FloatArray,
    frozen,
)
from alpha5_model._support.spatial import pose
from alpha5_model.collision.coal_scene import coal_shape
from alpha5_model.collision.link_pairs import unchecked_pairs
from alpha5_model.dynamics.dimensions import DRAWN, check_dimensions
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue


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
    """The collision bodies of a model, with the memory that Pinocchio computes in.

    Each thread needs one of its own.

    Attributes:
        geometry: pin.GeometryModel with a pair of objects for each pair of links that
            is checked.
        data: pin.GeometryData.
    """

    def __init__(self, model: pin.Model, arm: Alpha5Parameters | None = None) -> None:
        """Collect the primitives of a model's links.

        Args:
            model: pin.Model of the arm; with frames ``finger_1`` and ``finger_2`` the
                jaws move, without them they are closed and part of link_4.
            arm: Record of the arm that the model is of; None for the catalogue's.
        """
        self._model = model
        self._data = model.createData()
        self.geometry = collision_geometry(model, arm)
        self.data = self.geometry.createData()
        # Pinocchio starts each search from the result of the last one, so the distance
        # at q would depend on the last call by a micrometre. coal's own request starts
        # afresh.
        self.data.distanceRequests[:] = [coal.DistanceRequest()] * len(
            self.data.distanceRequests
        )

    def in_collision(self, q: FloatArray) -> bool:
        """Whether two links that are not neighbours touch at q, (nq,)."""
        return self.clearance(q).distance <= 0.0

    def colliding_links(self, q: FloatArray) -> tuple[tuple[str, str], ...]:
        """Every pair of links that touch at q, (nq,), each once."""
        self._closest_pair(q)
        pairs = self.geometry.collisionPairs
        results = self.data.distanceResults
        touching = [
            self._links(pair)
            for pair, result in zip(pairs, results, strict=True)
            if result.min_distance <= 0.0
        ]
        return tuple(dict.fromkeys(touching))

    def clearance(self, q: FloatArray) -> Clearance:
        """The closest place at q, (nq,), to a micrometre."""
        index = self._closest_pair(q)
        result = self.data.distanceResults[index]
        return Clearance(
            distance=float(result.min_distance),
            links=self._links(self.geometry.collisionPairs[index]),
            points=frozen([result.getNearestPoint1(), result.getNearestPoint2()]),
        )

    def _closest_pair(self, q: FloatArray) -> int:
        # Distances are used, not coal's faster collision test, which starts from the
        # contact of the last call and has missed an overlap of 0.03 mm.
        pin.updateGeometryPlacements(
            self._model, self._data, self.geometry, self.data, q
        )
        return int(pin.computeDistances(self.geometry, self.data))

    def _links(self, pair: Any) -> tuple[str, str]:
        return self._link(pair.first), self._link(pair.second)

    def _link(self, number: int) -> str:
        """Name of the link that has a collision object."""
        frame = self.geometry.geometryObjects[number].parentFrame
        return str(self._model.frames[frame].name)


def collision_geometry(
    model: pin.Model, arm: Alpha5Parameters | None = None
) -> pin.GeometryModel:
    """Primitives of the links of a pin.Model, with the pairs to be checked.

    They are the package's own, with the model's gripper; a URDF has fewer and larger
    ones. Links that touch beyond the joint limits only are checked, too; an SRDF
    leaves these out.

    Args:
        model: pin.Model of the arm.
        arm: Record of the arm that the model is of; None for the catalogue's.

    Returns:
        pin.GeometryModel.

    Raises:
        InputError: ``arm`` is no record, or the model has other dimensions.
    """
    record = chosen_arm(arm)
    check_dimensions(model, "its bodies", DRAWN, None if is_catalogue(record) else arm)
    gripper = "jaws" if model.existFrame("finger_1") else "locked"
    geometry = pin.GeometryModel()
    for link, shapes in collision_primitives(gripper, record.spacer).items():
        for number, shape in enumerate(shapes):
            name = f"{link}_{number}"
            geometry.addGeometryObject(_object(model, link, name, shape))
    _add_pairs(geometry, model, record)
    return geometry


def _add_pairs(
    geometry: pin.GeometryModel, model: pin.Model, arm: Alpha5Parameters
) -> None:
    """Add the pairs of bodies to be checked."""
    left_out = {
        frozenset(pair) for pairs in unchecked_pairs(arm).values() for pair in pairs
    }
    links = [model.frames[body.parentFrame].name for body in geometry.geometryObjects]
    for one, other in combinations(range(len(links)), 2):
        pair = frozenset((links[one], links[other]))
        if len(pair) == 2 and pair not in left_out:
            geometry.addCollisionPair(pin.CollisionPair(one, other))


def _object(
    model: pin.Model, link: str, name: str, shape: Primitive
) -> pin.GeometryObject:
    """A shape in the frame of its link."""
    number = model.getFrameId(link)
    frame = model.frames[number]
    return pin.GeometryObject(
        name,
        frame.parentJoint,
        number,
        frame.placement * pin.SE3(pose(shape.xyz, shape.rpy)),
        coal_shape(shape),
    )
