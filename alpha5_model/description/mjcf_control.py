"""What moves the MuJoCo model: servos or motors, the coupling of the jaws, and where it starts."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from alpha5_model.description.number_text import numbers_text
from alpha5_model.description.poses import NAMED_POSES
from alpha5_model.jaws import FingerJoint
from alpha5_model.parameters import JointRange

ACTUATORS = ("position", "velocity", "motor")
#: Servo stiffness [N m/rad, N/m]: tuned, not from the document.
_STIFFNESS = {"axis_e": 200.0, "axis_d": 200.0, "axis_c": 200.0, "axis_b": 5.0, "axis_a": 500.0}
#: MuJoCo would take the critical damping of the rod from the rod alone; the fingers weigh more [N s/m].
_ROD_DAMPING = 8.0


def add_equality(root: ET.Element, joints: list[JointRange]) -> None:
    """The fingers follow the rod."""
    equality = ET.SubElement(root, "equality")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            line = numbers_text(joint.offset, joint.multiplier, 0.0, 0.0, 0.0)
            pair = {"joint1": joint.name, "joint2": joint.leader, "polycoef": line}
            # stiffer than MuJoCo's default, with which servo and fingers excite each other
            ET.SubElement(equality, "joint", {**pair, "solref": "0.005 1"})


def add_actuators(root: ET.Element, joints: list[JointRange], kind: str) -> None:
    """One actuator per joint that has its own."""
    actuator = ET.SubElement(root, "actuator")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            continue
        limits = numbers_text(joint.lower, joint.upper)
        speeds = numbers_text(-joint.velocity, joint.velocity)
        effort = numbers_text(-joint.effort, joint.effort)
        common = {"name": joint.name, "joint": joint.name}
        if kind == "motor":
            ET.SubElement(actuator, "motor", {**common, "ctrlrange": effort})
            continue
        servo = {**common, "kp": numbers_text(_STIFFNESS[joint.name]), "forcerange": effort}
        servo |= (
            {"kv": numbers_text(_ROD_DAMPING)} if joint.kind == "prismatic" else {"dampratio": "1"}
        )
        if kind == "position":
            ET.SubElement(actuator, "position", {**servo, "ctrlrange": limits})
        else:  # a position servo whose target moves at the speed asked for: it holds against weight
            ET.SubElement(
                actuator, "intvelocity", {**servo, "ctrlrange": speeds, "actrange": limits}
            )


def add_keyframes(root: ET.Element, joints: list[JointRange], kind: str) -> None:
    """The named poses, jaws closed, servos at rest."""
    keyframe = ET.SubElement(root, "keyframe")
    for name, pose in NAMED_POSES.items():
        at = {joint.name: joint.lower for joint in joints}  # the jaws closed
        at |= {joint.name: angle for joint, angle in zip(joints, pose, strict=False)}
        for joint in joints:
            if isinstance(joint, FingerJoint):
                at[joint.name] = joint.offset + joint.multiplier * at[joint.leader]
        key = {"name": name, "qpos": numbers_text(*(at[joint.name] for joint in joints))}
        if kind != "motor":  # servos start at rest: their targets are where the joints are
            targets = numbers_text(
                *(at[joint.name] for joint in joints if not isinstance(joint, FingerJoint))
            )
            key["ctrl" if kind == "position" else "act"] = targets
        ET.SubElement(keyframe, "key", key)
