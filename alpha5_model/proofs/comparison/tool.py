"""Where another model's tool is: position and orientation, over the workspace."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.comparison.alignment import Alignment, mended_transforms
from alpha5_model.proofs.comparison.arm import FourJointArm, our_arm
from alpha5_model.proofs.comparison.correction import our_tool


@dataclass(frozen=True, eq=False)
class ToolDifference:
    """How far the other model's tool is from ours, both in base_link, over random positions.

    Attributes:
        frame: Name of their link that was measured; empty if none is a tool: then the point of
            their wrist where Table 1's {5} would be.
        base: Name of their link that was taken for base_link; empty if none was meant to be: then
            the base is where their axes put it.
        distance: At the same joint positions, (N,) [m].
        angle: At the same joint positions, (N,) [rad].
        matched_distance: At positions that mean the same once signs and zeros are matched,
            (N,) [m].
        matched_angle: As that, (N,) [rad].
    """

    frame: str
    base: str
    distance: FloatArray
    angle: FloatArray
    matched_distance: FloatArray
    matched_angle: FloatArray

    def as_dict(self) -> dict[str, Any]:
        """The largest, and the median of the distance, for JSON."""
        return {
            "frame": self.frame,
            "base": self.base,
            "distance_m": self.distance.max(),
            "median_distance_m": np.median(self.distance),
            "angle_rad": self.angle.max(),
            "matched_distance_m": self.matched_distance.max(),
            "matched_angle_rad": self.matched_angle.max(),
        }


def measure_tool(
    written: FourJointArm, theirs: FourJointArm, alignment: Alignment, q: FloatArray
) -> ToolDifference:
    """Measure it.

    Args:
        written: The other arm as it is written.
        theirs: As it is meant, with its alignment.
        alignment: Of theirs.
        q: Our joint positions, (N, 4) [rad].
    """
    ours = our_arm().poses(q)[:, 4] @ our_tool()
    base: Any = alignment.base
    if alignment.same_base:
        base = np.linalg.inv(written.link_poses[alignment.base_link])
    tool: Any = np.linalg.inv(mended_transforms(theirs, alignment)[4]) @ our_tool()
    if theirs.tool:
        tool = written.link_poses[theirs.tool]

    def apart(there: FloatArray) -> tuple[FloatArray, FloatArray]:
        poses = base @ written.poses(there)[:, 4] @ tool
        shift = np.linalg.norm(poses[:, :3, 3] - ours[:, :3, 3], axis=1)
        return shift, _angles(poses, ours)

    distance, angle = apart(q)
    matched_distance, matched_angle = apart(alignment.theirs(q))
    return ToolDifference(
        frame=theirs.tool,
        base=alignment.base_link if alignment.same_base else "",
        distance=distance,
        angle=angle,
        matched_distance=matched_distance,
        matched_angle=matched_angle,
    )


def _angles(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angles between the orientations of poses (N, 4, 4), (N,) [rad]."""
    relative = np.swapaxes(one[:, :3, :3], 1, 2) @ other[:, :3, :3]
    skew = relative - np.swapaxes(relative, 1, 2)
    sine = np.linalg.norm(skew, axis=(1, 2)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=1, axis2=2) - 1) / 2
    return np.asarray(np.arctan2(sine, cosine))
