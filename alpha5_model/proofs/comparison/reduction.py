"""Reduce any URDF of this arm to four joints and five bodies."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import moved
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.inertia import combine
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.chains import Joints
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.frozen_joints import rest_position
from alpha5_model.proofs.comparison.own_base import (
    hanging_on,
    joints_to,
    own_base_links,
    path_to,
)
from alpha5_model.proofs.comparison.poses import carried_to
from alpha5_model.proofs.comparison.printed_digits import Rounding, last_digits
from alpha5_model.proofs.comparison.tool_words import tool_link


class _Placed(NamedTuple):
    """Where the links of a model are, each in the frame of its body.

    Attributes:
        body: Link -> index of the body that it belongs to.
        pose: Link -> its pose in the frame of that body, (4, 4).
        placements: Pose of each joint's child in the body before it, at zero,
            (4, 4, 4).
    """

    body: dict[str, int]
    pose: dict[str, FloatArray]
    placements: FloatArray


class _Body(NamedTuple):
    """Mass [kg], COM (3,) [m] and tensor at the COM (3, 3) [kg m^2] of a body."""

    mass: float
    com: FloatArray
    inertia: FloatArray


def reduce_robot(
    robot: UrdfRobot,
    joints: Joints,
    parameters: Alpha5Parameters,
    first_link: str | None = None,
) -> FourJointArm:
    """Freeze all other joints and sum up the links that move together.

    Args:
        robot: The other model.
        joints: Its axis_e, axis_d, axis_c and axis_b.
        parameters: Our arm, by whose masses the base of the other one is found.
        first_link: The first link of the arm. Those before it, and all else that hangs
            on them, are foreign: vehicle, mount, another arm. Found by its mass if
            None.

    Raises:
        InputError: The four joints do not follow each other from base to tip.
        UnknownNameError: ``first_link`` is not on the way from the root to axis_e.
    """
    placed = _place(robot, joints)
    base_path = path_to(robot, joints[0].parent)
    still = [name for name in robot.links if placed.body[name] == 0]
    if first_link is not None:
        choice("link on the way to axis_e", first_link, base_path)
        own_base = hanging_on({first_link}, joints_to(robot, still))
    else:
        own_base = own_base_links(robot, base_path, set(still), parameters)

    groups = _groups(robot, placed, own_base)
    bodies = [_sum(robot, placed.pose, group) for group in groups]
    centres = [_shape_centre(robot, placed.pose, group) for group in groups]
    names = itertools.chain.from_iterable(groups)
    return FourJointArm(
        joints=joints,
        placements=placed.placements,
        axes=np.array([joint.axis for joint in joints]),
        mass=np.array([body.mass for body in bodies]),
        com=np.array([body.com for body in bodies]),
        inertia=np.array([body.inertia for body in bodies]),
        volume=sum(robot.links[name].volume for name in names),
        shape_centres=np.array(centres),
        links=tuple(map(tuple, groups)),
        link_poses=placed.pose,
        base_path=base_path,
        foreign_links=tuple(name for name in still if name not in own_base),
        digits=_digits(robot, joints, base_path, own_base),
        tool=tool_link(robot, joints[-1].child),
    )


def _place(robot: UrdfRobot, joints: Joints) -> _Placed:
    """Give each link to the body that it moves with."""
    names = [joint.name for joint in joints]
    body = {robot.root: 0}
    pose = {robot.root: np.eye(4)}
    placements: list[FloatArray] = []
    for joint in robot.joints.values():  # each after the joint before it
        before = body[joint.parent]
        origin = pose[joint.parent] @ joint.transform
        if joint.name not in names:
            rest = joint.motion(rest_position(robot, joint))
            body[joint.child] = before
            pose[joint.child] = origin @ rest
            continue

        place = names.index(joint.name)
        if not place == before == len(placements):
            expected = "joints that follow each other from base to tip"
            raise InputError("map", ", ".join(names), expected)
        placements.append(origin)
        body[joint.child] = before + 1
        pose[joint.child] = np.eye(4)
    return _Placed(body=body, pose=pose, placements=np.array(placements))


def _groups(robot: UrdfRobot, placed: _Placed, own_base: set[str]) -> list[list[str]]:
    """Names of the links of each of the five bodies, in the order of the file."""
    groups: list[list[str]] = [[] for _ in range(5)]
    for name in robot.links:
        body = placed.body[name]
        if body > 0 or name in own_base:
            groups[body].append(name)
    return groups


def _sum(
    robot: UrdfRobot, pose: Mapping[str, FloatArray], group: Sequence[str]
) -> _Body:
    """Links that move together, as one body; zeros if their masses add up to zero."""
    masses, coms, inertias = [], [], []
    for name in group:
        link = robot.links[name]
        if link.mass:
            com, inertia = carried_to(pose[name], link.com, link.inertia)
            masses.append(link.mass)
            coms.append(com)
            inertias.append(inertia)

    if sum(masses) == 0.0:
        return _Body(mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))
    mass, com, inertia = combine(masses, coms, inertias)
    return _Body(mass=mass, com=com, inertia=inertia)


def _shape_centre(
    robot: UrdfRobot, pose: Mapping[str, FloatArray], group: Sequence[str]
) -> FloatArray:
    """Centroid of the collision primitives of links that move together, (3,) [m].

    NaN if there are none.
    """
    links = [robot.links[name] for name in group if robot.links[name].volume > 0]
    if not links:
        return np.full(3, math.nan)
    centres = [moved(pose[link.name], link.shape_centre) for link in links]
    volumes = [link.volume for link in links]
    return np.average(centres, axis=0, weights=volumes)


def _digits(
    robot: UrdfRobot, joints: Joints, base_path: Sequence[str], own_base: set[str]
) -> Rounding:
    """How much the digits of the joint origins leave open, from base to wrist."""
    first_link = next((name for name in base_path if name in own_base), base_path[-1])
    way = path_to(robot, joints[-1].child)
    links_behind = way[way.index(first_link) + 1 :]
    return last_digits(joints_to(robot, links_behind))
