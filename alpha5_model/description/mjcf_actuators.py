"""Actuators and named poses of the MuJoCo model."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from alpha5_model.description.srdf import named_poses
from alpha5_model.description.xml import Value, add
from alpha5_model.numbers.jaws import FingerJoint
from alpha5_model.numbers.parameters import JointRange

ACTUATORS = ("position", "velocity", "motor")
#: Servo stiffness [N m/rad, N/m]: tuned, not from the document.
_STIFFNESS = {
    "axis_e": 200.0,
    "axis_d": 200.0,
    "axis_c": 200.0,
    "axis_b": 5.0,
    "axis_a": 500.0,
}
#: Damping of the rod's servo [N s/m]. MuJoCo would take the critical damping from the
#: rod alone; the fingers weigh more.
_ROD_DAMPING = 8.0
#: Kind of actuator -> attribute of a keyframe that holds the targets of its servos.
_TARGETS = {"position": "ctrl", "velocity": "act"}


def add_actuators(root: ET.Element, joints: Sequence[JointRange], kind: str) -> None:
    """One actuator for each joint that has its own."""
    actuator = add(root, "actuator")
    for joint in _driven(joints):
        limits = (joint.lower, joint.upper)
        speed = (-joint.velocity, joint.velocity)
        effort = (-joint.effort, joint.effort)
        names = {"name": joint.name, "joint": joint.name}
        if kind == "motor":
            add(actuator, "motor", **names, ctrlrange=effort)
        elif kind == "position":
            add(actuator, "position", **names, **_servo(joint), ctrlrange=limits)
        else:
            # A position servo whose target moves at the commanded speed, so that it
            # holds the weight.
            add(
                actuator,
                "intvelocity",
                **names,
                **_servo(joint),
                ctrlrange=speed,
                actrange=limits,
            )


def _servo(joint: JointRange) -> dict[str, Value]:
    """Stiffness, largest force and damping of a joint's servo."""
    servo: dict[str, Value] = {
        "kp": _STIFFNESS[joint.name],
        "forcerange": (-joint.effort, joint.effort),
    }
    if joint.kind == "prismatic":
        servo["kv"] = _ROD_DAMPING
    else:
        servo["dampratio"] = "1"
    return servo


def add_keyframes(root: ET.Element, joints: Sequence[JointRange], kind: str) -> None:
    """The named poses with closed jaws and servos at rest.

    ``home`` comes first, because tools take the first one.
    """
    keyframe = add(root, "keyframe")
    driven = [joint.name for joint in _driven(joints)]
    for name, pose in sorted(named_poses(joints).items()):
        # The jaws are closed at their lower limits.
        positions = {joint.name: joint.lower for joint in joints}
        positions |= zip(positions, pose, strict=False)

        key: dict[str, Value] = {"name": name, "qpos": positions.values()}
        if kind in _TARGETS:
            # Servos are at rest if their targets are where the joints are.
            key[_TARGETS[kind]] = [positions[joint] for joint in driven]
        add(keyframe, "key", **key)


def _driven(joints: Sequence[JointRange]) -> list[JointRange]:
    """Joints with an actuator of their own."""
    return [joint for joint in joints if not isinstance(joint, FingerJoint)]
