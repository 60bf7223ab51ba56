"""The semantic description: groups, named poses, pairs of links without a check."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

from alpha5_model._support.checks import FloatArray, choice, frozen
from alpha5_model.collision.link_pairs import disabled_pairs
from alpha5_model.description.options import check_name
from alpha5_model.description.xml import XML_HEAD, add, serialized
from alpha5_model.numbers.jaws import GRIPPERS, Gripper
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    JointRange,
    chosen_arm,
)

#: Joint positions axis_e, axis_d, axis_c, axis_b [rad].
#:
#: - ``stow``: folded in front of the base, the pose in which the arm rests in pool
#:   recordings of 2023 (hkolano/UVMS-SysID-with-EAs: 3.10, 0.078, 0.027, 1.61), a
#:   little rounded.
#: - ``home``: ready to work, upper arm 45 deg down, forearm level (the underarm pose of
#:   Figure 4).
#: - ``reach``: stretched out level.
NAMED_POSES: dict[str, tuple[float, float, float, float]] = {
    "stow": (math.pi, 0.08, 0.03, math.pi / 2),
    "home": (math.pi, math.pi / 4, 3 * math.pi / 4, math.pi / 2),
    "reach": (math.pi, math.pi / 2, math.pi, math.pi / 2),
}


def named_pose(name: str, arm: Alpha5Parameters | None = None) -> FloatArray:
    """A named pose as read-only array (4,) [rad].

    Args:
        name: ``stow``, ``home`` or ``reach``.
        arm: Record of an arm of your own, whose limits the pose keeps; None for the
            catalogue's. An angle beyond a limit becomes the limit.

    Raises:
        UnknownNameError: No pose of this name.
        InputError: ``arm`` is no record.
    """
    choice("pose", name, tuple(NAMED_POSES))
    return frozen(named_poses(chosen_arm(arm).joints)[name])


def named_poses(joints: Sequence[JointRange]) -> dict[str, tuple[float, ...]]:
    """The named poses within the limits of an arm.

    Args:
        joints: The arm's, of which ``axis_e`` to ``axis_b`` come first.

    Returns:
        Name -> joint positions [rad]. An angle beyond a limit becomes the limit.
    """
    poses = {}
    for name, pose in NAMED_POSES.items():
        positions = []
        for joint, position in zip(joints, pose, strict=False):
            positions.append(min(max(position, joint.lower), joint.upper))
        poses[name] = tuple(positions)
    return poses


def srdf(
    gripper: Gripper = "locked", arm: Alpha5Parameters | None = None, prefix: str = ""
) -> str:
    """Text of the SRDF that belongs to the URDF with this gripper and prefix.

    Args:
        gripper: ``locked`` or ``jaws``.
        arm: Record of an arm of your own, whose name and limits it has; None for the
            catalogue's.
        prefix: Prefix of every link, joint and group name, so that one robot can have
            two arms.

    Raises:
        UnknownNameError: Another gripper than ``locked`` or ``jaws``.
        InputError: ``arm`` is no record, or a prefix that XML does not keep.
    """
    choice("gripper", gripper, GRIPPERS)
    check_name("prefix", prefix)
    record = chosen_arm(arm)
    *turning, rod = record.joints
    root = ET.Element("robot", name=record.name)
    group = add(root, "group", name=f"{prefix}arm")
    add(group, "chain", base_link=f"{prefix}base_link", tip_link=f"{prefix}tcp")
    if gripper == "jaws":
        _add_gripper_group(root, rod, prefix)

    arm_names = [prefix + joint.name for joint in turning]
    for name, pose in named_poses(turning).items():
        positions = dict(zip(arm_names, pose, strict=True))
        _add_state(root, name, f"{prefix}arm", positions)
    if gripper == "jaws":
        rod_name = prefix + rod.name
        _add_state(root, "closed", f"{prefix}gripper", {rod_name: rod.lower})
        _add_state(root, "open", f"{prefix}gripper", {rod_name: rod.upper})
        add(root, "passive_joint", name=f"{prefix}finger_1_joint")
        add(root, "passive_joint", name=f"{prefix}finger_2_joint")

    for reason, pairs in disabled_pairs(record, gripper).items():
        for one, other in pairs:
            links = {"link1": prefix + one, "link2": prefix + other}
            add(root, "disable_collisions", **links, reason=reason)
    return XML_HEAD + serialized(root).replace(" />", "/>")


def _add_gripper_group(root: ET.Element, rod: JointParameters, prefix: str) -> None:
    group = add(root, "group", name=f"{prefix}gripper")
    add(group, "joint", name=prefix + rod.name)
    add(
        root,
        "end_effector",
        name=f"{prefix}jaws",
        parent_link=f"{prefix}link_4",
        group=f"{prefix}gripper",
        parent_group=f"{prefix}arm",
    )


def _add_state(
    root: ET.Element, name: str, group: str, positions: Mapping[str, float]
) -> None:
    state = add(root, "group_state", name=name, group=group)
    for joint, position in positions.items():
        add(state, "joint", name=joint, value=position)
