"""Distances of the arm's bodies by coal, pair by pair, from a URDF and an SRDF."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
from own_shapes_urdf import urdf_with_own_shapes

from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH

#: Gripper -> links that touch beyond the joint limits only.
BEYOND_LIMITS = {
    "locked": [("link_0", "link_3"), ("link_2", "link_4")],
    "jaws": [
        ("link_0", "link_3"),
        ("link_1", "link_4"),
        ("link_2", "link_4"),
        ("link_2", "finger_1"),
        ("link_2", "finger_2"),
    ],
}


def without_pair(srdf: str, one: str, other: str) -> str:
    """An SRDF that does not leave out two links."""
    line = f'<disable_collisions link1="{one}" link2="{other}" reason="Never"/>'
    assert line in srdf
    return srdf.replace(line, "")


class CoalReference:
    """The URDF with the package's shapes as Pinocchio reads it, and the SRDF's pairs.

    Links that touch beyond the joint limits only are compared, though the SRDF leaves
    them out.

    Attributes:
        model: pin.Model; the fingers follow axis_a.
        links: Names of the two links of each pair of bodies that is compared.
    """

    def __init__(self, gripper: str = "locked") -> None:
        path = JAWS_URDF_PATH if gripper == "jaws" else URDF_PATH
        self.model = pin.buildModelFromUrdf(str(path), True)
        self._geometry = pin.buildGeomFromUrdfString(
            self.model, urdf_with_own_shapes(gripper), pin.GeometryType.COLLISION
        )
        self._geometry.addAllCollisionPairs()
        srdf = Path(path).with_suffix(".srdf").read_text("utf-8")
        for links in BEYOND_LIMITS[gripper]:
            srdf = without_pair(srdf, *links)
        pin.removeCollisionPairsFromXML(self.model, self._geometry, srdf)
        self._data = self.model.createData()
        self._objects = self._geometry.createData()
        # A search that starts from the last answer depends on it.
        requests = self._objects.distanceRequests
        requests[:] = [coal.DistanceRequest()] * len(requests)
        names = [
            str(self.model.frames[body.parentFrame].name)
            for body in self._geometry.geometryObjects
        ]
        self.links = [
            (names[pair.first], names[pair.second])
            for pair in self._geometry.collisionPairs
        ]

    def distance(self, q: np.ndarray) -> float:
        """The least signed distance at q (nq,) [m]."""
        return float(self._objects.distanceResults[self._nearest(q)].min_distance)

    def link_distances(self, q: np.ndarray) -> dict[tuple[str, str], float]:
        """The least signed distance of each pair of links at q (nq,) [m]."""
        self._nearest(q)
        least: dict[tuple[str, str], float] = {}
        results = self._objects.distanceResults
        for links, result in zip(self.links, results, strict=True):
            least[links] = min(least.get(links, np.inf), result.min_distance)
        return least

    def _nearest(self, q: np.ndarray) -> int:
        """Number of the nearest pair of bodies."""
        pin.updateGeometryPlacements(
            self.model, self._data, self._geometry, self._objects, q
        )
        return int(pin.computeDistances(self._geometry, self._objects))
