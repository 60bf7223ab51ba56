"""Does the arm hit itself, and how far is it from doing so? Pinocchio and coal on the primitives.

Pairs of links that turn against each other at a joint are left out, as in ``urdf/alpha5.srdf``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import coal
import pinocchio as pin

from alpha5_model.checks import FloatArray, frozen
from alpha5_model.description.srdf import srdf
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH


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
    """Primitives of the links of a pin.Model as pin.GeometryModel, with the pairs to be checked.

    Both are Pinocchio's own reading of the URDF and the SRDF with the model's gripper.
    """
    jaws = model.existFrame("finger_1")
    urdf = Path(JAWS_URDF_PATH if jaws else URDF_PATH).read_text(encoding="utf-8")
    geometry = pin.buildGeomFromUrdfString(model, urdf, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairsFromXML(model, geometry, srdf("jaws" if jaws else "locked"))
    return geometry
