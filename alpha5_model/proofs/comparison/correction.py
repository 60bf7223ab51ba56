"""What to write so that another model's axes, limits and tool coincide with ours."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import JointParameters
from alpha5_model.proofs.comparison.alignment import LENGTH_TOLERANCE, Alignment
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.placement import mended_transforms
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of

#: Length that turns angles into distances [m/rad]: that of the arm behind the joint.
LEVER = 0.4
#: Limits are printed to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)


@dataclass(frozen=True, eq=False)
class JointCorrection:
    """How a joint of the other model has to be written to be ours.

    Its child link keeps its frame, so nothing in the link has to change.

    Attributes:
        joint: The joint as it is written.
        origin: Pose of the child in the parent, (4, 4).
        axis: In the child's frame, (3,).
        ours: Our joint; None if the joint does not move.
    """

    joint: UrdfJoint
    origin: FloatArray
    axis: FloatArray
    ours: JointParameters | None = None

    @property
    def off(self) -> float:
        """Distance of the right origin from the written one [m], by `pose_distance`."""
        return pose_distance(self.joint.transform, self.origin)

    @property
    def text(self) -> str:
        """The elements to write in place of its own; "" if they are right."""
        elements = []
        if self.off > LENGTH_TOLERANCE / 10:
            elements.append(self._origin_element)
        if not np.allclose(self.joint.axis, self.axis, atol=1e-12):
            axis = urdf_numbers(self.axis)
            elements.append(f'<axis xyz="{axis}"/>')
        limits = self.limits
        if limits:
            elements.append(f"<limit {limits}/>")

        if not elements:
            return ""
        return f"{self.joint.name}: {' '.join(elements)}"

    @property
    def _origin_element(self) -> str:
        """The origin, as URDF."""
        xyz = origin_of(self.origin)
        rpy = rpy_from_rotation(rotation_of(self.origin))
        return f'<origin xyz="{urdf_numbers(xyz)}" rpy="{urdf_numbers(rpy)}"/>'

    @property
    def limits(self) -> str:
        """Attributes to write in place of limits that are not ours; "" if all are."""
        if self.ours is None:
            return ""
        ours = self.ours
        attributes = []
        if _differs(self.joint.lower, ours.lower):
            attributes.append(f'lower="{ours.lower:.5g}"')
        if _differs(self.joint.upper, ours.upper):
            attributes.append(f'upper="{ours.upper:.5g}"')
        if seems_in_degrees(self.joint.velocity, ours.velocity):
            attributes.append(f'velocity="{ours.velocity:.5g}"')
        return " ".join(attributes)


def urdf_numbers(values: ArrayLike) -> str:
    """Numbers as the text of a URDF, to 7 decimals."""
    rounded = np.round(np.asarray(values), 7) + 0.0  # no negative zeros
    texts = [f"{x:.7f}".rstrip("0").rstrip(".") for x in rounded]
    return " ".join(texts)


def _differs(theirs: float | None, ours: float) -> bool:
    """Whether a limit is missing or is not ours [rad]."""
    return theirs is None or abs(theirs - ours) > LIMIT_TOLERANCE


def seems_in_degrees(theirs: float | None, ours: float) -> bool:
    """Whether an angle seems to be in degrees.

    It is too large for one of ours in radians, and near to ours if read in degrees.
    """
    if theirs is None or abs(theirs) < 3 * abs(ours) + math.tau / 2:
        return False
    return abs(math.radians(theirs) - ours) < 0.5 * abs(ours)


def pose_distance(one: FloatArray, other: FloatArray) -> float:
    """Distance of two poses (4, 4) [m]; their angle counts times `LEVER`."""
    shift = float(np.linalg.norm(origin_of(one) - origin_of(other)))
    return shift + LEVER * angle_between(one, other)


def angle_between(one: FloatArray, other: FloatArray) -> float:
    """Angle between two orientations, of poses (4, 4) [rad]."""
    relative = rotation_of(one).T @ rotation_of(other)
    sine = float(np.linalg.norm(relative - relative.T)) / math.sqrt(8)
    cosine = (float(np.trace(relative)) - 1) / 2
    return math.atan2(sine, cosine)


def joint_corrections(
    ours: OwnArm, written: FourJointArm, theirs: FourJointArm, alignment: Alignment
) -> tuple[JointCorrection, ...]:
    """Corrections of the four joints, base to tip.

    Args:
        ours: Our arm.
        written: The other arm as it is written.
        theirs: The other arm as it is meant, with exact multiples of pi.
        alignment: Its alignment.
    """
    transforms = mended_transforms(ours, theirs, alignment)
    poses = ours.reduced.poses(np.zeros(4)) @ transforms
    found = []
    for k, joint in enumerate(written.joints):
        parent = poses[k] @ theirs.link_poses[joint.parent]
        child = poses[k + 1]
        found.append(
            JointCorrection(
                joint=joint,
                origin=np.linalg.inv(parent) @ child,
                axis=alignment.sign[k] * joint.axis,
                ours=ours.parameters.joints[k],
            )
        )
    return tuple(found)


def tool_pose(ours: OwnArm, theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """Pose of their tool frame in our link_4, (4, 4); of ours if they have none."""
    if not theirs.tool:
        return ours.tool_pose
    wrist = mended_transforms(ours, theirs, alignment)[4]
    return np.asarray(wrist @ theirs.link_poses[theirs.tool])


def tool_correction(
    ours: OwnArm, other: UrdfRobot, theirs: FourJointArm, alignment: Alignment
) -> JointCorrection:
    """Correction of the fixed joint that carries their tool frame."""
    (joint,) = (joint for joint in other.joints.values() if joint.child == theirs.tool)
    wrist = mended_transforms(ours, theirs, alignment)[4]
    parent = wrist @ theirs.link_poses[joint.parent]
    origin = np.linalg.inv(parent) @ ours.tool_pose
    return JointCorrection(joint=joint, origin=origin, axis=joint.axis)
