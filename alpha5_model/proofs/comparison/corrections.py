"""What to write in the other file so that its joints, limits and tool are ours."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import angles_between, rpy_from_rotation
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters, JointParameters
from alpha5_model.numbers.pose import tool_of
from alpha5_model.proofs.comparison.described import Described
from alpha5_model.proofs.comparison.reduced import Reduced, our_arm
from alpha5_model.proofs.comparison.result import Correction

#: Length that turns angles into distances [m/rad]: that of the arm behind the joint.
LEVER = 0.4
#: A smaller shift of an origin is rounding of the advice itself.
WRITTEN_TO = 1e-6  # [m]
#: Limits are printed to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)
#: Mass [kg] and radius of gyration [m] of a link that moves and has no body. MuJoCo
#: wants an inertia there; this one changes no body of the arm beyond its tolerance.
TOKEN_MASS, TOKEN_RADIUS = 1e-8, 0.003


@dataclass(frozen=True, eq=False)
class RightJoint:
    """How a joint of the other model has to be to be ours.

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
        """Distance of the right origin from the written one [m].

        An angle counts as the distance that it makes at `LEVER`.
        """
        shift = self.joint.transform[:3, 3] - self.origin[:3, 3]
        turned = angle_between(self.joint.transform, self.origin)
        return float(np.linalg.norm(shift) + LEVER * turned)

    @property
    def correction(self) -> Correction | None:
        """The elements to write in place of its own; None if they are right."""
        elements: dict[str, Mapping[str, str]] = {}
        if self.ours is not None and self.joint.kind != "revolute":
            elements["joint"] = {"type": "revolute"}
        if self.off > WRITTEN_TO:
            elements["origin"] = origin_attributes(self.origin)
        if not np.allclose(self.joint.axis, self.axis, atol=1e-12):
            elements["axis"] = {"xyz": urdf_numbers(self.axis)}
        limits = {} if self.ours is None else wrong_limits(self.joint, self.ours)
        if limits:
            elements["limit"] = limits
        if not elements:
            return None
        return Correction(kind="joint", name=self.joint.name, elements=elements)


def right_joints(
    other: UrdfRobot, theirs: Reduced, described: Described, record: Alpha5Parameters
) -> tuple[RightJoint, ...]:
    """How the four joints have to be, base to tip.

    Args:
        other: The other model as it is written.
        theirs: It as it is meant, reduced.
        described: It in our terms.
        record: Our arm.
    """
    bodies = our_arm(record).zero_poses() @ described.placed
    found = []
    for k, joint in enumerate(theirs.joints):
        parent = bodies[k] @ theirs.link_poses[joint.parent]
        found.append(
            RightJoint(
                joint=other.joints[joint.name],
                origin=np.linalg.inv(parent) @ bodies[k + 1],
                axis=described.sign[k] * joint.axis,
                ours=record.joints[k],
            )
        )
    return tuple(found)


def right_tool(
    other: UrdfRobot, theirs: Reduced, described: Described, record: Alpha5Parameters
) -> RightJoint | None:
    """How the fixed joint to their tool frame has to be; None without such a frame.

    Args:
        other, theirs, described, record: As of `right_joints`.
    """
    if not theirs.tool:
        return None
    (joint,) = (one for one in other.joints.values() if one.child == theirs.tool)
    parent = described.placed[4] @ theirs.link_poses[joint.parent]
    origin = np.linalg.inv(parent) @ tool_of(record).matrix
    return RightJoint(joint=joint, origin=origin, axis=joint.axis)


def wrong_limits(joint: UrdfJoint, ours: JointParameters) -> dict[str, str]:
    """Attributes to write in place of limits that are not ours.

    An effort that is there is left alone: nobody publishes the right one.
    """
    attributes = {}
    for name in ("lower", "upper"):
        written = getattr(joint, name)
        own = getattr(ours, name)
        if written is None or abs(written - own) > LIMIT_TOLERANCE:
            attributes[name] = f"{own:.5g}"
    if not joint.velocity or velocity_differs(joint.velocity, ours.velocity):
        attributes["velocity"] = f"{ours.velocity:.5g}"
    if not joint.effort:
        attributes["effort"] = f"{ours.effort:.5g}"
    return attributes


def velocity_differs(written: float, ours: float) -> bool:
    """Whether a velocity is not ours to 10 % [rad/s]."""
    return abs(written - ours) > 0.1 * ours


def seems_in_degrees(written: float | None, ours: float) -> bool:
    """Whether an angle seems to be in degrees.

    It is too large for one of ours in radians, and near to ours if read in degrees.
    """
    if written is None or abs(written) < 3 * abs(ours) + math.tau / 2:
        return False
    return abs(math.radians(written) - ours) < 0.5 * abs(ours)


def token_inertial(link: str, mass: float = 0.0) -> Correction:
    """The inertial of a link that moves and has no body, or only a mass [kg]."""
    moment = f"{(mass or TOKEN_MASS) * TOKEN_RADIUS**2:.6g}"
    tensor = dict.fromkeys(("ixx", "iyy", "izz"), moment)
    tensor |= dict.fromkeys(("ixy", "ixz", "iyz"), "0")
    elements = {
        "mass": {"value": f"{mass or TOKEN_MASS:.9g}"},
        "origin": {"xyz": "0 0 0", "rpy": "0 0 0"},
        "inertia": tensor,
    }
    return Correction("link", link, elements)


def origin_attributes(pose: FloatArray) -> dict[str, str]:
    """The attributes of an ``<origin>`` of this pose (4, 4)."""
    return {
        "xyz": urdf_numbers(pose[:3, 3]),
        "rpy": urdf_numbers(rpy_from_rotation(pose[:3, :3])),
    }


def urdf_numbers(values: ArrayLike) -> str:
    """Numbers as the text of a URDF, to 7 decimals."""
    rounded = np.round(np.asarray(values), 7) + 0.0  # no negative zeros
    texts = [f"{x:.7f}".rstrip("0").rstrip(".") for x in rounded]
    return " ".join(texts)


def angle_between(one: FloatArray, other: FloatArray) -> float:
    """Angle between two orientations, of poses (4, 4) [rad]."""
    return float(angles_between(one, other))
