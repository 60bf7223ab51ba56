"""Any URDF of this arm as four joints and five bodies; our own, also with other dimensions."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import moved, rotation_about, transform
from alpha5_model.description.reading import UrdfJoint, UrdfRobot, parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.inertia import combine, rotate_tensor
from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison.reading import (
    AXES,
    foot,
    last_digits,
    rest_position,
)

#: What a lighter link on the way to axis_e is: a dummy of the arm's base, not something that
#: carries it.
CARRIED_FROM = 0.02  # [kg], a tenth of link_0
#: What tool frames are called, the likeliest first.
TOOL_WORDS = ("tcp", "tool", "tip", "grasp", "effector", "eef", "ee")
X, Y, Z = np.eye(3)
DOWN = np.array(GRAVITY)  # [m/s^2]
#: Change of our dimensions, see `alpha5_model.proofs.comparison.alignment.DIMENSIONS`.
AS_IT_IS = np.zeros(8)

Joints = tuple[UrdfJoint, ...]
Pair = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class FourJointArm:
    """Four revolute joints and five bodies; every other joint is frozen, see `rest_position`.

    Body 0 moves with the root, body i with joint i-1; its frame is the child frame of that joint.

    Attributes:
        joints: The four joints, base to tip.
        placements: Pose of each joint's child in the body before it, at zero, (4, 4, 4).
        axes: Direction of each joint in its child frame, (4, 3).
        mass: Per body, (5,) [kg].
        com: Per body, in its frame, (5, 3) [m].
        inertia: Per body, at the COM, in its frame's axes, (5, 3, 3) [kg m^2].
        volume: Of all collision primitives [m^3].
        shape_centres: Their centroid per body, in its frame, (5, 3) [m]; NaN without any.
        links: Names of the links that make up each body.
        link_poses: Link -> its pose in the frame of its body, (4, 4).
        base_path: Links from the root to the one that axis_e turns in.
        carried: Links that move with the base and are not the arm's: vehicle, platform, mount,
            another arm. They are in no body.
        digits: What the digits of the printed origins leave open, see `last_digits`.
        tool: Name of the link whose frame is the tool's, see `_tool_link`; empty if none is.
    """

    joints: Joints
    placements: FloatArray
    axes: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    volume: float
    shape_centres: FloatArray
    links: tuple[tuple[str, ...], ...]
    link_poses: dict[str, FloatArray]
    base_path: tuple[str, ...]
    carried: tuple[str, ...]
    digits: tuple[float, float, float]
    tool: str

    def poses(self, q: FloatArray) -> FloatArray:
        """Poses of the bodies in the root frame, (..., 5, 4, 4), at its own angles q (..., 4)."""
        return chain_poses(self.placements, self.axes, q)

    def axis_lines(self, q: FloatArray) -> Pair:
        """A point on each axis and its direction in the root frame, (..., 4, 3), at q (..., 4)."""
        poses = self.poses(q)[..., 1:, :, :]
        return poses[..., :3, 3], (poses[..., :3, :3] @ self.axes[..., None])[..., 0]

    def gravity_regressor(
        self, q: FloatArray, gravity: FloatArray = DOWN
    ) -> FloatArray:
        """Gravity torque in air per mass and first moment of each moving body [Atkeson1986].

        Args:
            q: Its own angles, (..., 4) [rad].
            gravity: In the root frame, (3,) [m/s^2].

        Returns:
            (..., 4, 4, 4): joint, body, and (mass [kg], first moment (3,) [kg m] in the body's
            frame).
        """
        poses = self.poses(q)[..., 1:, :, :]
        rotations, points = poses[..., :3, :3], poses[..., :3, 3]
        normals = np.cross((rotations @ self.axes[..., None])[..., 0], gravity)
        out = np.empty((*q.shape, 4, 4))
        arms = points[..., None, :, :] - points[..., :, None, :]
        out[..., 0] = np.sum(arms * normals[..., :, None, :], axis=-1)
        side_by_side = np.moveaxis(rotations, -3, -2).reshape(*q.shape[:-1], 3, 12)
        out[..., 1:] = (normals @ side_by_side).reshape(*q.shape, 4, 3)
        return out * np.triu(np.ones((4, 4)))[..., None]

    def gravity_torque(self, q: FloatArray, gravity: FloatArray = DOWN) -> FloatArray:
        """Torques that hold the weight in air, (..., 4) [N m]; arguments of `gravity_regressor`."""
        numbers = np.column_stack([self.mass, self.mass[:, None] * self.com])[1:]
        return np.asarray(
            (self.gravity_regressor(q, gravity) * numbers).sum(axis=(-2, -1))
        )

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Joint-space inertia, (..., 4, 4) [kg m^2], from the bodies' Jacobians at their COMs."""
        poses, (points, axes) = self.poses(q)[..., 1:, :, :], self.axis_lines(q)
        arms = (
            moved(poses, self.com[1:])[..., None, :] - points[..., None, :, :]
        )  # body, joint
        turning = axes[..., None, :, :] * np.tril(np.ones((4, 4)))[..., None]
        jacobian = np.concatenate([np.cross(turning, arms), turning], axis=-1)
        tensors = rotate_tensor(poses[..., :3, :3], self.inertia[1:])
        momenta = [self.mass[1:, None, None] * jacobian[..., :3], turning @ tensors]
        per_body = np.concatenate(momenta, axis=-1) @ np.swapaxes(jacobian, -1, -2)
        return np.asarray(per_body.sum(axis=-3))


def chain_poses(placements: FloatArray, axes: FloatArray, q: FloatArray) -> FloatArray:
    """Poses of the root and of what each joint carries, (..., N + 1, 4, 4).

    Args:
        placements: Pose of what a joint carries in what the one before it carries, at zero,
            (N, 4, 4).
        axes: Direction of each joint in the frame that it carries, (N, 3).
        q: Angles, (..., N) [rad].
    """
    links = placements @ transform(rotation_about(axes, q))
    poses = [np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))]
    for joint in range(len(axes)):
        poses.append(poses[-1] @ links[..., joint, :, :])
    return np.stack(poses, axis=-3)


@cache
def our_arm() -> FourJointArm:
    """Our own arm, generated from the tables and read like any other."""
    robot = parse_urdf(urdf(Variant(dh_frames=True)))
    return reduce_robot(robot, tuple([robot.joints[axis] for axis in AXES]))


@lru_cache(maxsize=4)
def random_positions(count: int) -> FloatArray:
    """Joint positions of our arm within its limits, (count, 4) [rad]; always the same."""
    lower, upper = np.array([(j.lower, j.upper) for j in parameters().joints[:4]]).T
    return np.random.default_rng(0).uniform(lower, upper, (count, 4))


def our_frames(q: FloatArray, change: FloatArray = AS_IT_IS) -> FloatArray:
    """DH frames {0} to {3} of our arm, (..., 4, 4, 4), at q (..., 4), with changed dimensions.

    Their z axes are the joint axes; each stands turned by its joint already, ready for the next
    link.
    """
    rows = [(row.d, row.a, row.alpha, row.theta_offset) for row in parameters().dh[:4]]
    d, a, alpha, offset = np.array(rows).T
    twist = rotation_about(X, alpha[:3] + change[4:7])
    twist[1] = twist[1] @ rotation_about(Y, change[7])
    d[1] += change[3]
    lengths = np.column_stack([a[:3] + change[:3], np.zeros(3), d[:3]])
    placements = np.stack([np.eye(4), *transform(twist, lengths)])
    return chain_poses(placements, np.tile(Z, (4, 1)), q + offset)[..., 1:, :, :]


def zero_poses(change: FloatArray) -> FloatArray:
    """Poses of our bodies at zero, (5, 4, 4), each with its own joint, with changed dimensions."""
    poses = our_arm().poses(np.zeros(4))
    poses[1:] = our_frames(np.zeros(4), change) @ _bodies_in_frames()
    return poses


@cache
def _bodies_in_frames() -> FloatArray:
    """Poses of our bodies 1 to 4 in the DH frames of `our_frames`, (4, 4, 4)."""
    zero = np.zeros(4)
    return np.asarray(np.linalg.inv(our_frames(zero)) @ our_arm().poses(zero)[1:])


def with_dimensions(change: FloatArray) -> FourJointArm:
    """Our arm with changed dimensions; each body stays with its own joint."""
    poses = zero_poses(change)
    return replace(our_arm(), placements=np.linalg.inv(poses[:-1]) @ poses[1:])


def our_tips(q: FloatArray, change: FloatArray = AS_IT_IS) -> FloatArray:
    """Tips of our arm, (N, 3) [m], with changed dimensions; see `tip_points`."""
    frames = our_frames(q, change)
    return tip_points(frames[..., :3, 3], frames[..., :3, 2])


def tip_points(points: FloatArray, directions: FloatArray) -> FloatArray:
    """On the wrist axis, d_3 from the foot of its normal with axis_c, (N, 3) [m]."""
    return foot(points, directions, 3, 2) + parameters().dh[3].d * directions[:, 3]


def reduce_robot(
    robot: UrdfRobot, joints: Joints, base: str | None = None
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
    names = [joint.name for joint in joints]
    body, pose, placements = (
        {robot.root: 0},
        {robot.root: np.eye(4)},
        list[FloatArray](),
    )
    parents = {joint.child: joint.parent for joint in robot.joints.values()}
    for joint in robot.joints.values():  # each after the joint before it
        at, before = pose[joint.parent] @ joint.transform, body[joint.parent]
        if joint.name in names:
            if not names.index(joint.name) == before == len(placements):
                expected = "joints that follow each other from base to tip"
                raise InputError("map", ", ".join(names), expected)
            placements.append(at)
            body[joint.child], pose[joint.child] = before + 1, np.eye(4)
        else:
            body[joint.child] = before
            pose[joint.child] = at @ joint.motion(rest_position(robot, joint))
    base_path, way = (
        _path(parents, link) for link in (joints[0].parent, joints[-1].child)
    )
    if base is not None:
        choice("link on the way to axis_e", base, base_path)
    still = [name for name in robot.links if body[name] == 0]
    own = _own_base(robot, base_path, set(still), base)
    first = next((name for name in base_path if name in own), base_path[-1])
    between = {*way[way.index(first) + 1 :]}
    groups = [
        [n for n in robot.links if body[n] == i and (i or n in own)] for i in range(5)
    ]
    mass, com, inertia = np.zeros(5), np.zeros((5, 3)), np.zeros((5, 3, 3))
    for i, group in enumerate(groups):
        seen = [carried(robot.links[n], pose[n]) for n in group if robot.links[n].mass]
        if sum(body[0] for body in seen) != 0.0:
            mass[i], com[i], inertia[i] = combine(*zip(*seen, strict=True))
    volume = sum(robot.links[name].volume for group in groups for name in group)
    digits = last_digits([j for j in robot.joints.values() if j.child in between])
    return FourJointArm(
        joints=joints,
        placements=np.array(placements),
        axes=np.array([joint.axis for joint in joints]),
        mass=mass,
        com=com,
        inertia=inertia,
        volume=volume,
        shape_centres=np.array([_shape_centre(robot, pose, group) for group in groups]),
        links=tuple(map(tuple, groups)),
        link_poses=pose,
        base_path=base_path,
        carried=tuple(name for name in still if name not in own),
        digits=digits,
        tool=_tool_link(robot, joints[-1].child),
    )


def _shape_centre(
    robot: UrdfRobot, pose: Mapping[str, FloatArray], group: list[str]
) -> FloatArray:
    """Centroid of the collision primitives of links that move together, (3,) [m]; NaN if none."""
    links = [robot.links[name] for name in group if robot.links[name].volume > 0]
    if not links:
        return np.full(3, math.nan)
    centres = [moved(pose[link.name], link.shape_centre) for link in links]
    return np.average(centres, axis=0, weights=[link.volume for link in links])


def _tool_link(robot: UrdfRobot, wrist: str) -> str:
    """The link fixed to the wrist's whose name says that its frame is the tool's; empty if none.

    Of several the one with the likeliest word, then the outermost.
    """
    steps = {wrist: 0}
    for joint in robot.joints.values():
        if joint.kind == "fixed" and joint.parent in steps:
            steps[joint.child] = steps[joint.parent] + 1
    ranked = [
        (_tool_rank(name), -count, name) for name, count in steps.items() if count
    ]
    rank, _, name = min(ranked, default=(len(TOOL_WORDS), 0, ""))
    return name if rank < len(TOOL_WORDS) else ""


def _tool_rank(name: str) -> int:
    """Place in `TOOL_WORDS` of the first of them in a name."""
    words = re.split(r"[^a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower())
    found = [
        rank
        for rank, word in enumerate(TOOL_WORDS)
        if word in words and "base" not in words
    ]
    return min(found, default=len(TOOL_WORDS))


def carried(body: Any, pose: FloatArray) -> tuple[Any, FloatArray, FloatArray]:
    """Mass, COM and tensor of bodies, carried to where they stand with poses (..., 4, 4)."""
    return (
        body.mass,
        moved(pose, body.com),
        rotate_tensor(pose[..., :3, :3], body.inertia),
    )


def _path(parents: Mapping[str, str], link: str) -> tuple[str, ...]:
    """The links from the root to this one."""
    path = [link]
    while path[-1] in parents:
        path.append(parents[path[-1]])
    return tuple(reversed(path))


def _own_base(
    robot: UrdfRobot, way: tuple[str, ...], still: set[str], base: str | None
) -> set[str]:
    """Links of the arm's own base, among those that stand still with it.

    All that hangs on one link of the way from the root to axis_e: on the link where the mass comes
    closest to that of link_0, the first such one. What is heavier than the whole arm is a vehicle
    also where it hangs on the arm's base; if axis_e turns in it, nothing is left for link_0.
    """
    links = parameters().links
    whole = sum(link.mass for link in links)
    outwards = [joint for joint in robot.joints.values() if joint.child in still]
    if base is not None:
        return _hanging_on({base}, outwards)
    weights = {name: robot.links[name].mass or 0.0 for name in still}
    for joint in reversed(outwards):
        weights[joint.parent] += weights[joint.child]
    best = way[0]
    for at in way[1:]:
        closer = abs(weights[at] - links[0].mass) < abs(weights[best] - links[0].mass)
        if closer and weights[best] - weights[at] > CARRIED_FROM:
            best = at
    if (robot.links[way[-1]].mass or 0.0) > whole:
        return set()
    heavy = {at for at in still.difference(way) if weights[at] > whole}
    return _hanging_on({best}, outwards) - _hanging_on(heavy, outwards)


def _hanging_on(links: set[str], outwards: Iterable[UrdfJoint]) -> set[str]:
    """These links and all that they carry; joints each after the one before it."""
    found = set(links)
    for joint in outwards:
        if joint.parent in found:
            found.add(joint.child)
    return found
