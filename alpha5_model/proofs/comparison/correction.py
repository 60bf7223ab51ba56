"""What to write so that another model's axes, limits and tool stand where ours do."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.description.reading import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import JointParameters, parameters
from alpha5_model.proofs.comparison.alignment import (
    LENGTH_TOLERANCE,
    Alignment,
    mended_transforms,
)
from alpha5_model.proofs.comparison.arm import FourJointArm, our_arm

#: What an angle is worth where lengths and angles are told apart by one number [m/rad]: the length
#: of the arm behind it.
LEVER = 0.4
#: Limits are printed to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)


@dataclass(frozen=True, eq=False)
class JointCorrection:
    """How a joint of the other model has to be written to be ours.

    Its child link keeps its frame, and with it all that the link carries.

    Attributes:
        joint: The joint as it is written.
        origin: Pose of the child in the parent, (4, 4).
        axis: In the child's frame, (3,).
        ours: Our joint; None for one that does not move.
    """

    joint: UrdfJoint
    origin: FloatArray
    axis: FloatArray
    ours: JointParameters | None = None

    @property
    def off(self) -> float:
        """How far the origin is from what is written; an angle counts by `LEVER` [m]."""
        return pose_distance(self.joint.transform, self.origin)

    @property
    def text(self) -> str:
        """The elements to write in place of its own; empty if it is right as it is."""
        elements = []
        if self.off > LENGTH_TOLERANCE / 10:
            xyz, rpy = self.origin[:3, 3], rpy_from_rotation(self.origin[:3, :3])
            elements.append(f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>')
        if not np.allclose(self.joint.axis, self.axis, atol=1e-12):
            elements.append(f'<axis xyz="{numbers(self.axis)}"/>')
        if limits := self.limits:
            elements.append(f"<limit {limits}/>")
        return f"{self.joint.name}: {' '.join(elements)}" if elements else ""

    @property
    def limits(self) -> str:
        """The attributes of the limits that are not ours; empty if they are."""
        if self.ours is None:
            return ""
        lower, upper = self.joint.lower, self.joint.upper
        out = []
        if lower is None or abs(lower - self.ours.lower) > LIMIT_TOLERANCE:
            out.append(f'lower="{self.ours.lower:.5g}"')
        if upper is None or abs(upper - self.ours.upper) > LIMIT_TOLERANCE:
            out.append(f'upper="{self.ours.upper:.5g}"')
        if in_degrees(self.joint.velocity, self.ours.velocity):
            out.append(f'velocity="{self.ours.velocity:.5g}"')
        return " ".join(out)


def numbers(values: ArrayLike) -> str:
    """Numbers as a URDF has them, to 7 decimals."""
    return " ".join(
        f"{x + 0.0:.7f}".rstrip("0").rstrip(".")
        for x in np.round(np.asarray(values), 7)
    )


def in_degrees(theirs: float | None, ours: float) -> bool:
    """Whether an angle beyond any of ours is near to ours if it is read in degrees."""
    if theirs is None or abs(theirs) < 3 * abs(ours) + math.tau / 2:
        return False
    return abs(math.radians(theirs) - ours) < 0.5 * abs(ours)


def pose_distance(one: FloatArray, other: FloatArray) -> float:
    """Distance of two poses (4, 4) [m]; an angle counts by `LEVER`."""
    shift = float(np.linalg.norm(one[:3, 3] - other[:3, 3]))
    return shift + LEVER * angle_between(one, other)


def angle_between(one: FloatArray, other: FloatArray) -> float:
    """Angle between two orientations, of poses (4, 4) [rad]."""
    relative = one[:3, :3].T @ other[:3, :3]
    sine = float(np.linalg.norm(relative - relative.T)) / math.sqrt(8)
    return math.atan2(sine, (float(np.trace(relative)) - 1) / 2)


def joint_corrections(
    written: FourJointArm, theirs: FourJointArm, alignment: Alignment
) -> tuple[JointCorrection, ...]:
    """Of the four joints, base to tip.

    Args:
        written: The other arm as it is written.
        theirs: As it is meant, see `alpha5_model.proofs.comparison.reading.as_meant`.
        alignment: Of theirs.
    """
    transforms = mended_transforms(theirs, alignment)
    poses = our_arm().poses(np.zeros(4)) @ transforms
    found = []
    for k, (joint, ours) in enumerate(
        zip(written.joints, parameters().joints[:4], strict=True)
    ):
        parent = poses[k] @ theirs.link_poses[joint.parent]
        found.append(
            JointCorrection(
                joint=joint,
                origin=np.linalg.inv(parent) @ poses[k + 1],
                axis=alignment.sign[k] * joint.axis,
                ours=ours,
            )
        )
    return tuple(found)


def tool_pose(theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """Pose of their tool frame in our link_4, (4, 4): of ours if they have none."""
    if not theirs.tool:
        return our_tool()
    return np.asarray(
        mended_transforms(theirs, alignment)[4] @ theirs.link_poses[theirs.tool]
    )


def our_tool() -> FloatArray:
    """Pose of our tcp, Table 1's {5}, in link_4, (4, 4)."""
    ours = our_arm()
    return ours.link_poses[ours.tool]


def tool_correction(
    other: UrdfRobot, theirs: FourJointArm, alignment: Alignment
) -> JointCorrection:
    """Of the fixed joint that carries their tool frame."""
    (joint,) = (joint for joint in other.joints.values() if joint.child == theirs.tool)
    parent = mended_transforms(theirs, alignment)[4] @ theirs.link_poses[joint.parent]
    origin = np.linalg.inv(parent) @ our_tool()
    return JointCorrection(joint=joint, origin=origin, axis=joint.axis)
