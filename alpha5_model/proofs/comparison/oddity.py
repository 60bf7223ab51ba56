"""How unlikely an alignment is, by what somebody must have changed in the model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.base_link import distance_from_base
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import DISTANCES, OwnArm
from alpha5_model.proofs.comparison.placement import body_transforms
from alpha5_model.proofs.comparison.poses import origin_of

#: Bodies, tools and shapes that lie farther off than this count as much as they can.
ELSEWHERE = 0.05  # [m]


@dataclass(frozen=True, eq=False)
class Judge:
    """Tells how unlikely alignments are.

    Attributes:
        ours: Our arm.
        theirs: The other arm.
        within: Changes of the dimensions that are none, (8,) [m, rad].
    """

    ours: OwnArm
    theirs: FourJointArm
    within: FloatArray

    def oddity(self, alignment: Alignment) -> float:
        """How unlikely an alignment is: what somebody must have changed in the model.

        A turned sign or a shifted zero counts one, a wrong dimension four, one to the
        other side two, and a base that stands elsewhere or upside down up to six.
        Bodies elsewhere count up to four together, and so do collision shapes; a tool
        frame counts up to six.
        """
        base = min(6.0, 30 * distance_from_base(alignment.stands))
        dimensions = self._changed_dimensions(alignment)

        transforms = body_transforms(self.ours, self.theirs, alignment)
        bodies = _elsewhere(self._off_bodies(transforms))
        shapes = _elsewhere(self._off_shapes(transforms))
        tool = _elsewhere(self._off_tool(transforms))
        odd = alignment.oddities + base + dimensions
        return odd + 4 * bodies + 4 * shapes + 6 * tool

    def _changed_dimensions(self, alignment: Alignment) -> float:
        """Four for each wrong dimension; two for a distance to the other side."""
        wrong = np.abs(alignment.dimensions) > self.within
        lengths = [row.a for row in self.ours.parameters.dh[:3]]
        # One joint mounted the wrong way round makes its distance negative.
        opposite = np.multiply(-2, lengths)
        distances = alignment.dimensions[DISTANCES]
        mirrored = np.isclose(distances, opposite, atol=5e-3)
        return float(4 * wrong.sum() - 2 * mirrored.sum())

    def _off_bodies(self, transforms: FloatArray) -> FloatArray:
        """Their COMs minus ours, from body 2 on, if they have a mass, (N, 3) [m]."""
        coms = moved(transforms, self.theirs.com)
        off = coms - self.ours.reduced.com
        solid = self.theirs.mass > 0
        solid[:2] = False
        return np.asarray(off[solid])

    def _off_shapes(self, transforms: FloatArray) -> FloatArray:
        """Their centroids minus ours of the shapes of moving bodies, (N, 3) [m]."""
        centres = moved(transforms, self.theirs.shape_centres)
        off = centres - self.ours.reduced.shape_centres
        known = np.isfinite(off[:, 0])
        known[0] = False
        return np.asarray(off[known])

    def _off_tool(self, transforms: FloatArray) -> FloatArray:
        """Their tool minus ours, (1, 3) [m], or (0, 3) if they have none."""
        if not self.theirs.tool:
            return np.zeros((0, 3))
        frame = self.theirs.link_poses[self.theirs.tool]
        tool = moved(transforms[4], origin_of(frame))
        return np.asarray(tool[None] - origin_of(self.ours.tool_pose))


def _elsewhere(off: FloatArray) -> float:
    """How far off points (N, 3) are on average, from 0 to 1; 0 without any."""
    if not len(off):
        return 0.0
    shares = np.linalg.norm(off, axis=1) / ELSEWHERE
    return float(np.minimum(1.0, shares).mean())
