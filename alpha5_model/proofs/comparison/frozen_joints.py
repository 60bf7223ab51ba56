"""Positions of the frozen joints of another model: all but the arm's own four."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot


def rest_position(robot: UrdfRobot, joint: UrdfJoint) -> float:
    """The position at which a joint is frozen [rad or m].

    This is the position nearest to zero in the joint's range, or the one to which the
    joint it mimics drives it.
    """
    leader = robot.joints.get(joint.mimic) if joint.mimic else None
    if leader is not None and leader.mimic is None:
        driven_by = rest_position(robot, leader)
        return joint.multiplier * driven_by + joint.offset

    lower = joint.lower or 0.0
    upper = joint.upper or 0.0
    return lower if lower > 0 else min(upper, 0.0)


def rest_poses(robot: UrdfRobot) -> dict[str, FloatArray]:
    """Link -> its pose (4, 4) in the root, with every joint at its rest position."""
    poses = {robot.root: np.eye(4)}
    for joint in robot.joints.values():  # each after the joint before it
        origin = poses[joint.parent] @ joint.transform
        rest = joint.motion(rest_position(robot, joint))
        poses[joint.child] = origin @ rest
    return poses
