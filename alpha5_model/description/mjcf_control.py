"""What moves the MuJoCo model: servos or motors, the coupling of the jaws, and where it starts."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from alpha5_model.description.poses import NAMED_POSES
from alpha5_model.description.xml_text import Value, add
from alpha5_model.jaws import FingerJoint
from alpha5_model.parameters import JointRange

ACTUATORS = ("position", "velocity", "motor")
#: Servo stiffness [N m/rad, N/m]: tuned, not from the document.
_STIFFNESS = {"axis_e": 200.0, "axis_d": 200.0, "axis_c": 200.0, "axis_b": 5.0, "axis_a": 500.0}
#: MuJoCo would take the critical damping of the rod from the rod alone; the fingers weigh more [N s/m].
_ROD_DAMPING = 8.0


def add_equality(root: ET.Element, joints: list[JointRange]) -> None:
    """The fingers follow the rod."""
    equality = add(root, "equality")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            line = (joint.offset, joint.multiplier, 0.0, 0.0, 0.0)
            pair = {"joint1": joint.name, "joint2": joint.leader}
            # stiffer than MuJoCo's default, with which servo and fingers excite each other
            add(equality, "joint", **pair, polycoef=line, solref="0.005 1")


def add_actuators(root: ET.Element, joints: list[JointRange], kind: str) -> None:
    """One actuator per joint that has its own."""
    actuator = add(root, "actuator")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            continue
        limits, effort = (joint.lower, joint.upper), (-joint.effort, joint.effort)
        common: dict[str, Value] = {"name": joint.name, "joint": joint.name}
        if kind == "motor":
            add(actuator, "motor", **common, ctrlrange=effort)
            continue
        common |= {"kp": _STIFFNESS[joint.name], "forcerange": effort}
        common |= {"kv": _ROD_DAMPING} if joint.kind == "prismatic" else {"dampratio": "1"}
        if kind == "position":
            add(actuator, "position", **common, ctrlrange=limits)
        else:  # a position servo whose target moves at the speed asked for: it holds against weight
            speeds = (-joint.velocity, joint.velocity)
            add(actuator, "intvelocity", **common, ctrlrange=speeds, actrange=limits)


def add_keyframes(root: ET.Element, joints: list[JointRange], kind: str) -> None:
    """The named poses, jaws closed, servos at rest."""
    keyframe = add(root, "keyframe")
    for name, pose in NAMED_POSES.items():
        # The jaws are closed at their lower limits.
        at = [*pose, *(joint.lower for joint in joints[len(pose) :])]
        own = [x for x, j in zip(at, joints, strict=True) if not isinstance(j, FingerJoint)]
        # servos start at rest: their targets are where the joints are
        targets = {} if kind == "motor" else {"ctrl" if kind == "position" else "act": own}
        add(keyframe, "key", name=name, qpos=at, **targets)
