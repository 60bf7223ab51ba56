"""Any URDF of this arm as four joints and five rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.rounding import last_digits
from alpha5_model.description.urdf_reading import UrdfJoint, UrdfRobot
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.fluids import GRAVITY
from alpha5_model.inertia import combine, rotate_tensor
from alpha5_model.parameters import parameters
from alpha5_model.published.tables import JOINT_NAMES
from alpha5_model.spatial import cross_matrix

AXES = JOINT_NAMES[:4]
#: What a lighter link on the way to axis_e is: a dummy of the arm's base, not something that carries it.
CARRIED_FROM = 0.02  # [kg], a tenth of link_0


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
        base_path: Links from the root to the one that axis_e turns in.
        digits: What the digits of the printed origins leave open, see `last_digits`.
        carried: Links that move with the base and are not the arm's: vehicle, platform, mount, another
            arm. They are in no body.
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
    base_path: tuple[str, ...]
    carried: tuple[str, ...]
    digits: tuple[float, float, float]
    without_inertial: tuple[str, ...]
    collision_meshes: tuple[str, ...]

    def poses(self, q: FloatArray) -> FloatArray:
        """Poses of the five bodies in the root frame, (..., 5, 4, 4), at its own angles q (..., 4)."""
        poses = [np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))]
        for joint, (placement, axis) in enumerate(zip(self.placements, self.axes, strict=True)):
            k, angle = cross_matrix(axis), q[..., joint, None, None]
            turn = np.zeros((*q.shape[:-1], 4, 4))
            turn[..., :3, :3] = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)
            turn[..., 3, 3] = 1.0
            poses.append(poses[-1] @ placement @ turn)
        return np.stack(poses, axis=-3)

    def axis_lines(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A point on each axis and its direction in the root frame, (..., 4, 3) each, at q (..., 4)."""
        poses = self.poses(q)[..., 1:, :, :]
        return poses[..., :3, 3], (poses[..., :3, :3] @ self.axes[..., None])[..., 0]

    def gravity_torque(self, q: FloatArray) -> FloatArray:
        """Torque of the weight in air about each axis, (..., 4) [N m]; gravity points down at the root."""
        points, directions = self.axis_lines(q)
        poses = self.poses(q)[..., 1:, :, :]
        com = (poses[..., :3, :3] @ self.com[1:, :, None])[..., 0] + poses[..., :3, 3]
        weights = self.mass[1:, None] * -np.array(GRAVITY)
        arms = com[..., None, :, :] - points[..., :, None, :]  # joint, body
        torques = np.sum(np.cross(arms, weights) * directions[..., :, None, :], axis=-1)
        return np.asarray(np.triu(torques).sum(axis=-1))


def foot(points: FloatArray, directions: FloatArray, at: int, other: int) -> FloatArray:
    """Foot of the common normal of two axes on the first of them, (3,)."""
    u, w, r = directions[at], directions[other], points[at] - points[other]
    b = u @ w
    out: FloatArray = points[at] + (b * (w @ r) - u @ r) / max(1 - b * b, 1e-12) * u
    return out


def reduce_robot(
    robot: UrdfRobot, joints: tuple[UrdfJoint, ...], base: str | None = None
) -> FourJointArm:
    """Freeze all other joints and sum up what moves together.

    Args:
        robot: The other model.
        joints: Its axis_e, axis_d, axis_c and axis_b.
        base: The first link of the arm: what lies before it is carried with the base. Found by its
            mass if None.

    Raises:
        InputError: The four joints do not follow each other from base to tip.
        UnknownNameError: ``base`` is not on the way from the root to axis_e.
    """
    index = {joint.name: i for i, joint in enumerate(joints, start=1)}
    body = {robot.root: 0}
    paths: dict[str, tuple[str, ...]] = {robot.root: (robot.root,)}
    pose = {robot.root: np.eye(4)}
    placements: list[FloatArray] = []
    for joint in robot.joints.values():  # each after the joint before it
        before, at = body[joint.parent], pose[joint.parent] @ joint.transform
        paths[joint.child] = (*paths[joint.parent], joint.child)
        if joint.name not in index:
            body[joint.child], pose[joint.child] = (
                before,
                at @ joint.motion(rest_position(robot, joint)),
            )
            continue
        if index[joint.name] != before + 1 or len(placements) != before:
            order = ", ".join(j.name for j in joints)
            raise InputError("map", order, "joints that follow each other from base to tip")
        placements.append(at)
        body[joint.child], pose[joint.child] = before + 1, np.eye(4)
    base_path = paths[joints[0].parent]
    if base is not None and base not in base_path:
        raise UnknownNameError("link on the way to axis_e", base, base_path)
    still = [name for name in robot.links if body[name] == 0]
    own = _own_base(robot, base_path, {name: paths[name] for name in still}, base)
    carried = tuple(name for name in still if name not in own)
    way = paths[joints[-1].child]
    between = way[way.index(next((n for n in base_path if n in own), base_path[-1])) + 1 :]
    mass, com, inertia, volume = np.zeros(5), np.zeros((5, 3)), np.zeros((5, 3, 3)), np.zeros(5)
    groups = tuple(
        tuple(name for name in robot.links if body[name] == i and name not in carried)
        for i in range(5)
    )
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
    arm = [name for names in groups for name in names]
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
        base_path=base_path,
        carried=carried,
        digits=last_digits(j for j in robot.joints.values() if j.child in between),
        without_inertial=tuple(n for n in arm if robot.links[n].mass is None),
        collision_meshes=tuple(m for n in arm for m in robot.links[n].meshes),
    )


def _own_base(
    robot: UrdfRobot,
    base_path: tuple[str, ...],
    still: dict[str, tuple[str, ...]],
    base: str | None,
) -> set[str]:
    """Links of the arm's own base, among those that stand still with it and the paths to them.

    All that hangs on one link of the way from the root to axis_e: on the link where the mass comes
    closest to that of link_0, the first such one. What is heavier than the whole arm is a vehicle
    also where it hangs on the arm's base; if axis_e turns in it, nothing is left for link_0.
    """
    links = parameters().links
    whole = sum(link.mass for link in links)
    below = {at: {name for name, path in still.items() if at in path} for at in still}
    if base is not None:
        return below[base]
    weights = {at: sum(robot.links[n].mass or 0.0 for n in names) for at, names in below.items()}
    best = base_path[0]
    for at in base_path[1:]:
        closer = abs(weights[at] - links[0].mass) < abs(weights[best] - links[0].mass)
        if closer and weights[best] - weights[at] > CARRIED_FROM:
            best = at
    if (robot.links[base_path[-1]].mass or 0.0) > whole:
        return set()
    heavy = [below[at] for at in below if at not in base_path and weights[at] > whole]
    return below[best].difference(*heavy)


def rest_position(robot: UrdfRobot, joint: UrdfJoint) -> float:
    leader = robot.joints.get(joint.mimic) if joint.mimic else None
    if leader is not None and leader.mimic is None:
        return joint.multiplier * rest_position(robot, leader) + joint.offset
    return (
        max(joint.lower or 0.0, 0.0) if (joint.lower or 0.0) > 0 else min(joint.upper or 0.0, 0.0)
    )
