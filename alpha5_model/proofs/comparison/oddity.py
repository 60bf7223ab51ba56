"""How odd an alignment is: how much its author would have had to get wrong."""

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

#: From this distance on, a misplaced body, tool or shape gets the full score.
FULL_SCORE_AT = 0.05  # [m]


@dataclass(frozen=True, eq=False)
class Judge:
    """Tells how odd alignments are.

    Attributes:
        ours: Our arm.
        theirs: The other arm.
        tolerances: Of the dimensions, (8,) [m, rad].
    """

    ours: OwnArm
    theirs: FourJointArm
    tolerances: FloatArray

    def oddity(self, alignment: Alignment) -> float:
        """A score of what the model's author would have had to get wrong.

        A reversed joint or a shifted zero scores 1. A wrong dimension scores 4, but 2
        if it is a distance to the other side. A base that is displaced or upside down
        scores up to 6, misplaced bodies up to 4 together, misplaced collision shapes
        the same, and a misplaced tool frame up to 6.
        """
        base = min(6.0, 30 * distance_from_base(alignment.stands))
        dimensions = self._changed_dimensions(alignment)

        transforms = body_transforms(self.ours, self.theirs, alignment)
        bodies = misplacement(self._off_bodies(transforms))
        shapes = misplacement(self._off_shapes(transforms))
        tool = misplacement(self._off_tool(transforms))
        of_axes = alignment.oddities + base + dimensions
        return of_axes + 4 * bodies + 4 * shapes + 6 * tool

    def _changed_dimensions(self, alignment: Alignment) -> float:
        """4 for each wrong dimension, but 2 for a distance to the other side."""
        wrong = np.abs(alignment.dimensions) > self.tolerances
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
        """Centroids of collision shapes of moving bodies, minus ours, (N, 3) [m]."""
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


def misplacement(off: FloatArray) -> float:
    """Mean score of points that are off by (N, 3) [m], from 0 to 1; 0 without any.

    The score of a point grows with its distance and is 1 from `FULL_SCORE_AT` on.
    """
    if not len(off):
        return 0.0
    scores = np.linalg.norm(off, axis=1) / FULL_SCORE_AT
    return float(np.minimum(1.0, scores).mean())
