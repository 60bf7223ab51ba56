"""Poses of an arm and of its links: by name, and in a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy, transform
from alpha5_model.description import srdf
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.joint_tree import AT_ORIGIN
from alpha5_model.viewer.scene import WORLD, Scene


def named_poses(arm: Arm) -> dict[str, FloatArray]:
    """Named poses within the limits, as joint positions (n,), jaws closed."""
    joints = arm.parameters.joints
    closed = [joint.lower for joint in joints[4 : len(arm.joint_names)]]
    poses = srdf.named_poses(joints[:4])
    return {name: np.array([*pose, *closed]) for name, pose in poses.items()}


def with_base(arm: Arm, joints: FloatArray) -> FloatArray:
    """Joint positions (n,) as q (nq,), with a floating base at the world's origin."""
    return np.concatenate([AT_ORIGIN, joints]) if arm.floating_base else joints


def mounting(arm: Arm) -> FloatArray:
    """Pose of a fixed base in the world in which gravity points down, (4, 4).

    It has roll and pitch only: gravity does not tell a yaw. The identity for a floating
    base, and without gravity.
    """
    up = -np.array(arm.model.gravity.linear)
    if arm.floating_base or not up.any():
        return np.eye(4)
    roll = np.arctan2(up[1], up[2])
    pitch = np.arctan2(-up[0], np.hypot(up[1], up[2]))
    return transform(rotation_from_rpy([roll, pitch, 0.0]))


def gravity_in_world(arm: Arm) -> FloatArray:
    """Gravity in the world of `mounting`, (3,) [m/s^2]."""
    gravity = np.array(arm.model.gravity.linear)
    if arm.floating_base:
        return gravity
    return np.array([0.0, 0.0, -np.linalg.norm(gravity)])


def link_poses(
    arm: Arm, tree: Sequence[UrdfJoint], q: FloatArray
) -> dict[str, FloatArray]:
    """Pose of the world and of every link in the world, (4, 4), by Pinocchio.

    A fixed base is mounted as `mounting` has it.
    """
    base = mounting(arm)
    links = [tree[0].parent, *(joint.child for joint in tree)]
    poses = {WORLD: np.eye(4)}
    for link in links:
        placement = arm.forward_kinematics(q, frame=link)
        poses[link] = base @ placement.homogeneous
    return poses


def posed(scene: Scene, arm: Arm, q: FloatArray) -> Scene:
    """The scene with its arm at joint positions q (nq,)."""
    poses = link_poses(arm, scene.tree, q)
    return replace(scene, q=q[len(q) - len(scene.sliders) :], poses=poses)


def tree_of(arm: Arm, urdf: str) -> tuple[UrdfJoint, ...]:
    """The joint tree of a URDF, with the joints placed as in the arm's model.

    The arm may have other corrections than the URDF.
    """
    tree = tuple(parse_urdf(urdf).joints.values())
    poses = link_poses(arm, tree, with_base(arm, np.zeros(len(arm.joint_names))))
    return tuple(_placed(joint, poses) for joint in tree)


def _placed(joint: UrdfJoint, poses: dict[str, FloatArray]) -> UrdfJoint:
    """The joint, placed so that its child is at its pose at joint position zero."""
    parent_to_child = np.linalg.inv(poses[joint.parent]) @ poses[joint.child]
    motion_at_zero = joint.motion(joint.offset)
    return replace(joint, transform=parent_to_child @ np.linalg.inv(motion_at_zero))
