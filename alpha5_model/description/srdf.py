"""The semantic description: groups, named poses, and the pairs of links that need no collision check."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from itertools import pairwise

from alpha5_model._support.checks import FloatArray, choice, frozen
from alpha5_model.description.bodies import XML_HEAD, add, serialized
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.tables import BODY_NAMES

#: Joint positions axis_e, axis_d, axis_c, axis_b [rad].
#:
#: - ``stow``: folded in front of the base, the pose in which the arm rests in pool recordings of 2023
#:   (hkolano/UVMS-SysID-with-EAs: 3.10, 0.078, 0.027, 1.61), a little rounded.
#: - ``home``: ready to work, upper arm 45 deg down, forearm level (the underarm pose of Figure 4).
#: - ``reach``: stretched out level.
NAMED_POSES: dict[str, tuple[float, float, float, float]] = {
    "stow": (math.pi, 0.08, 0.03, math.pi / 2),
    "home": (math.pi, math.pi / 4, 3 * math.pi / 4, math.pi / 2),
    "reach": (math.pi, math.pi / 2, math.pi, math.pi / 2),
}

Pairs = tuple[tuple[str, str], ...]
#: Pairs that turn against each other at a joint; their collision bodies overlap there.
ADJACENT_PAIRS: Pairs = (
    *pairwise(BODY_NAMES),
    ("link_4", "finger_1"),
    ("link_4", "finger_2"),
)
#: Fingers that touch when the jaws close.
CLOSING_PAIRS: Pairs = (("finger_1", "finger_2"),)
#: Pairs that no joint position brings together: links 1 and 3 are held apart by link 2.
NEVER_PAIRS: Pairs = (
    ("link_1", "link_3"),
    ("link_3", "finger_1"),
    ("link_3", "finger_2"),
)
#: All of them: reason in the words of SRDF -> pairs.
UNCHECKED_PAIRS = {
    "Adjacent": ADJACENT_PAIRS,
    "Default": CLOSING_PAIRS,
    "Never": NEVER_PAIRS,
}


def named_pose(name: str) -> FloatArray:
    """A named pose as read-only array (4,) [rad].

    Raises:
        UnknownNameError: No pose of this name.
    """
    return frozen(NAMED_POSES[choice("pose", name, tuple(NAMED_POSES))])


def srdf(gripper: str = "locked") -> str:
    """Text of the SRDF that belongs to the URDF with this gripper.

    Raises:
        UnknownNameError: Another gripper than ``locked`` or ``jaws``.
    """
    jaws = choice("gripper", gripper, GRIPPERS) == "jaws"
    *arm, rod = parameters(()).joints
    root = ET.Element("robot", name="alpha5")
    add(add(root, "group", name="arm"), "chain", base_link="base_link", tip_link="tcp")
    states = [(name, "arm", arm, [*q]) for name, q in NAMED_POSES.items()]
    if jaws:
        add(add(root, "group", name="gripper"), "joint", name=rod.name)
        ends = {"parent_link": "link_4", "group": "gripper", "parent_group": "arm"}
        add(root, "end_effector", name="jaws", **ends)
        for name, end in (("closed", rod.lower), ("open", rod.upper)):
            states.append((name, "gripper", [rod], [end]))
    for name, group, joints, q in states:
        state = add(root, "group_state", name=name, group=group)
        for joint, position in zip(joints, q, strict=True):
            add(state, "joint", name=joint.name, value=position)
    for finger in ("finger_1", "finger_2") if jaws else ():
        add(root, "passive_joint", name=f"{finger}_joint")
    for reason, pairs in UNCHECKED_PAIRS.items():
        for one, other in pairs:
            if jaws or not any(name.startswith("finger") for name in (one, other)):
                add(root, "disable_collisions", link1=one, link2=other, reason=reason)
    return XML_HEAD + serialized(root).replace(" />", "/>")
