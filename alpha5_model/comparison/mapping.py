"""Reduce any URDF of this arm to its four joints and five rigid bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfJoint, UrdfRobot
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.inertia import combine, rotate_tensor
from alpha5_model.published.tables import JOINT_NAMES
from alpha5_model.spatial import rotation_about

AXES = JOINT_NAMES[:4]


@dataclass(frozen=True, eq=False)
class FourJointArm:
    """Four revolute joints and five bodies; every other joint is frozen.

    Body 0 moves with the root, body i with joint i-1; its frame is the child frame of that joint. A
    frozen joint stands at the value nearest to zero in its range, and a mimic joint follows, so
    that the jaws are closed.

    Attributes:
        joints: The four joints, base to tip.
        placements: Pose of each joint's child in the body before it, at zero, (4, 4, 4).
        axes: Direction of each joint in its child frame, (4, 3).
        mass: Per body, (5,) [kg].
        com: Per body, in its frame, (5, 3) [m].
        inertia: Per body, at the COM, in its frame's axes, (5, 3, 3) [kg m^2].
        volume: Per body, of the collision primitives, (5,) [m^3].
        links: Names of the links that make up each body.
        link_poses: Link -> its pose in the frame of its body, (4, 4).
        without_inertial: Names of the links without ``<inertial>``.
        collision_meshes: File names of collision meshes, whose volume is not counted.
    """

    joints: tuple[UrdfJoint, ...]
    placements: FloatArray
    axes: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    volume: FloatArray
    links: tuple[tuple[str, ...], ...]
    link_poses: dict[str, FloatArray]
    without_inertial: tuple[str, ...]
    collision_meshes: tuple[str, ...]

    def poses(self, q: FloatArray) -> FloatArray:
        """Poses of the five bodies in the root frame, (5, 4, 4), at its own joint angles q (4,)."""
        poses = [np.eye(4)]
        for placement, axis, angle in zip(self.placements, self.axes, q, strict=True):
            turn = np.eye(4)
            turn[:3, :3] = rotation_about(axis, angle)
            poses.append(poses[-1] @ placement @ turn)
        return np.array(poses)


def map_joints(robot: UrdfRobot, names: Mapping[str, str] | None = None) -> tuple[UrdfJoint, ...]:
    """The joints of another model that are axis_e, axis_d, axis_c and axis_b.

    Args:
        robot: The other model.
        names: Ours -> theirs; what is missing is found by name (also behind a prefix), and if no
            name fits and the model has exactly four revolute joints in a row, by order.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints mapped to one, or no unambiguous mapping.
    """
    given = dict(names or {})
    for ours, theirs in given.items():
        if ours not in AXES:
            raise UnknownNameError("joint", ours, AXES)
        if theirs not in robot.joints:
            raise UnknownNameError("joint of the other model", theirs, robot.joints)
    moving = [j for j in robot.joints.values() if j.kind in ("revolute", "continuous")]
    independent = [j for j in moving if j.mimic is None]
    by_name = {
        axis: [j.name for j in moving if j.name == axis]
        or [j.name for j in moving if j.name.endswith(axis)]
        for axis in AXES
    }
    found = dict(given)
    for axis in AXES:
        if axis not in found and len(by_name[axis]) == 1:
            found[axis] = by_name[axis][0]
    if not found and len(independent) == 4:
        found = {axis: joint.name for axis, joint in zip(AXES, independent, strict=True)}
    missing = [axis for axis in AXES if axis not in found]
    if missing:
        joints = ", ".join(j.name for j in moving) or "none"
        example = ",".join(f"{axis}=NAME" for axis in missing)
        raise InputError(
            "map", example, f"a joint for each of {', '.join(missing)} out of: {joints}"
        )
    for axis, name in found.items():
        twice = [other for other in found if other != axis and found[other] == name]
        if twice:
            raise InputError("map", f"{axis}={name},{twice[0]}={name}", "four different joints")
    joints_found = tuple(robot.joints[found[axis]] for axis in AXES)
    for joint in joints_found:
        if joint.kind not in ("revolute", "continuous"):
            raise InputError("map", joint.name, "a revolute joint")
    return joints_found


def reduce_robot(robot: UrdfRobot, joints: tuple[UrdfJoint, ...]) -> FourJointArm:
    """Freeze all other joints and sum up what moves together.

    Raises:
        InputError: The four joints do not follow each other from base to tip.
    """
    index = {joint.name: i for i, joint in enumerate(joints, start=1)}
    body = {robot.root: 0}
    pose = {robot.root: np.eye(4)}
    placements: list[FloatArray] = []
    for joint in robot.joints.values():  # each after the joint before it
        before, at = body[joint.parent], pose[joint.parent] @ joint.transform
        if joint.name not in index:
            body[joint.child], pose[joint.child] = before, at @ _frozen(robot, joint)
            continue
        if index[joint.name] != before + 1 or len(placements) != before:
            order = ", ".join(j.name for j in joints)
            raise InputError("map", order, "joints that follow each other from base to tip")
        placements.append(at)
        body[joint.child], pose[joint.child] = before + 1, np.eye(4)
    mass, com, inertia, volume = np.zeros(5), np.zeros((5, 3)), np.zeros((5, 3, 3)), np.zeros(5)
    groups = tuple(tuple(name for name in robot.links if body[name] == i) for i in range(5))
    for i, names in enumerate(groups):
        volume[i] = sum(robot.links[name].volume for name in names)
        heavy = [name for name in names if (robot.links[name].mass or 0.0) != 0.0]
        masses = [robot.links[name].mass or 0.0 for name in heavy]
        if not heavy or sum(masses) == 0.0:
            continue
        mass[i], com[i], inertia[i] = combine(
            masses,
            [pose[n][:3, :3] @ robot.links[n].com + pose[n][:3, 3] for n in heavy],
            [rotate_tensor(pose[n][:3, :3], robot.links[n].inertia) for n in heavy],
        )
    return FourJointArm(
        joints=joints,
        placements=np.array(placements),
        axes=np.array([joint.axis for joint in joints]),
        mass=mass,
        com=com,
        inertia=inertia,
        volume=volume,
        links=groups,
        link_poses=pose,
        without_inertial=tuple(n for n, link in robot.links.items() if link.mass is None),
        collision_meshes=tuple(m for link in robot.links.values() for m in link.meshes),
    )


def _frozen(robot: UrdfRobot, joint: UrdfJoint) -> FloatArray:
    out = np.eye(4)
    if joint.kind == "prismatic":
        out[:3, 3] = joint.axis * _rest(robot, joint)
    elif joint.kind in ("revolute", "continuous"):
        out[:3, :3] = rotation_about(joint.axis, _rest(robot, joint))
    return out


def _rest(robot: UrdfRobot, joint: UrdfJoint) -> float:
    leader = robot.joints.get(joint.mimic) if joint.mimic else None
    if leader is not None and leader.mimic is None:
        return joint.multiplier * _rest(robot, leader) + joint.offset
    return (
        max(joint.lower or 0.0, 0.0) if (joint.lower or 0.0) > 0 else min(joint.upper or 0.0, 0.0)
    )
