"""Where another model's tool is: position and orientation, over the workspace."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.placement import mended_transforms
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of


@dataclass(frozen=True, eq=False)
class ToolDifference:
    """How far the other model's tool is from ours, in base_link, at random positions.

    Attributes:
        frame: Name of their tool link. Empty if they have none: then the point of their
            wrist was measured where Table 1's {5} would be.
        base: Name of their link that was taken for base_link. Empty if none was meant
            to be: then the joint axes place the base.
        distance: At the same joint positions, (N,) [m].
        angle: At the same joint positions, (N,) [rad].
        matched_distance: At corresponding joint positions, with signs and zeros
            matched, (N,) [m].
        matched_angle: At corresponding joint positions, (N,) [rad].
    """

    frame: str
    base: str
    distance: FloatArray
    angle: FloatArray
    matched_distance: FloatArray
    matched_angle: FloatArray

    def as_dict(self) -> dict[str, Any]:
        """The largest values, and the median of the distance, for JSON."""
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
    ours: OwnArm,
    written: FourJointArm,
    theirs: FourJointArm,
    alignment: Alignment,
    q: FloatArray,
) -> ToolDifference:
    """How far their tool is from ours.

    Args:
        ours: Our arm.
        written: The other arm as it is written.
        theirs: The other arm as it is meant.
        alignment: Its alignment.
        q: Our joint positions, (N, 4) [rad].
    """
    expected = ours.reduced.poses(q)[:, 4] @ ours.tool_pose
    base = _to_base_link(written, alignment)
    tool = tool_in_wrist(ours, theirs, written, alignment)

    same = base @ written.poses(q)[:, 4] @ tool
    matched = base @ written.poses(alignment.theirs(q))[:, 4] @ tool
    return ToolDifference(
        frame=theirs.tool,
        base=alignment.base_link if alignment.same_base else "",
        distance=_distances(same, expected),
        angle=_angles(same, expected),
        matched_distance=_distances(matched, expected),
        matched_angle=_angles(matched, expected),
    )


def _to_base_link(written: FourJointArm, alignment: Alignment) -> FloatArray:
    """transform_root_to_base_link of the other model, (4, 4)."""
    if not alignment.same_base:
        return alignment.base
    return np.asarray(np.linalg.inv(written.link_poses[alignment.base_link]))


def tool_in_wrist(
    ours: OwnArm, theirs: FourJointArm, reading: FourJointArm, alignment: Alignment
) -> FloatArray:
    """Pose of the other model's tool in its last body, (4, 4).

    Args:
        ours: Our arm.
        theirs: The other arm as it is meant.
        reading: The same, or the other arm as it is written: whose tool is returned.
        alignment: The alignment of the arm as it is meant.
    """
    if theirs.tool:
        return reading.link_poses[theirs.tool]
    wrist = mended_transforms(ours, theirs, alignment)[4]
    return np.asarray(np.linalg.inv(wrist) @ ours.tool_pose)


def _distances(one: FloatArray, other: FloatArray) -> FloatArray:
    """Distances between the origins of poses (N, 4, 4), (N,) [m]."""
    return np.asarray(np.linalg.norm(origin_of(one) - origin_of(other), axis=1))


def _angles(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angles between the orientations of poses (N, 4, 4), (N,) [rad]."""
    relative = np.swapaxes(rotation_of(one), 1, 2) @ rotation_of(other)
    skew = relative - np.swapaxes(relative, 1, 2)
    sine = np.linalg.norm(skew, axis=(1, 2)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=1, axis2=2) - 1) / 2
    return np.asarray(np.arctan2(sine, cosine))
