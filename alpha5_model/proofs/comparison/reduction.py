"""Any URDF of this arm as four joints and five bodies."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import moved
from alpha5_model.description.reading import UrdfJoint, UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.inertia import combine
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.chains import Joints
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.frozen_joints import rest_position
from alpha5_model.proofs.comparison.poses import carried_to
from alpha5_model.proofs.comparison.printed_digits import Rounding, last_digits

#: A link on the way to axis_e that is lighter than this is a dummy of the arm's base, not
#: something that carries it.
CARRIED_FROM = 0.02  # [kg], a tenth of link_0
#: What tool frames are called, the likeliest first.
TOOL_WORDS = ("tcp", "tool", "tip", "grasp", "effector", "eef", "ee")


class _Placed(NamedTuple):
    """Where the links of a model are.

    Attributes:
        body: Link -> index of the body that it belongs to.
        pose: Link -> its pose in the frame of that body, (4, 4).
        placements: Pose of each joint's child in the body before it, at zero, (4, 4, 4).
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
    base: str | None = None,
) -> FourJointArm:
    """Freeze all other joints and sum up what moves together.

    Args:
        robot: The other model.
        joints: Its axis_e, axis_d, axis_c and axis_b.
        parameters: Our arm, by whose masses the base of the other one is found.
        base: The first link of the arm: the links before it are carried with the base.
            Found by its mass if None.

    Raises:
        InputError: The four joints do not follow each other from base to tip.
        UnknownNameError: ``base`` is not on the way from the root to axis_e.
    """
    placed = _place(robot, joints)
    base_path = _path(robot, joints[0].parent)
    still = [name for name in robot.links if placed.body[name] == 0]
    if base is None:
        own_base = _own_base(robot, base_path, set(still), parameters)
    else:
        choice("link on the way to axis_e", base, base_path)
        own_base = _hanging_on({base}, _joints_to(robot, still))

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
        carried=tuple(name for name in still if name not in own_base),
        digits=_digits(robot, joints, base_path, own_base),
        tool=_tool_link(robot, joints[-1].child),
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
            body[joint.child] = before
            pose[joint.child] = origin @ joint.motion(rest_position(robot, joint))
            continue

        if not names.index(joint.name) == before == len(placements):
            expected = "joints that follow each other from base to tip"
            raise InputError("map", ", ".join(names), expected)
        placements.append(origin)
        body[joint.child] = before + 1
        pose[joint.child] = np.eye(4)
    return _Placed(body=body, pose=pose, placements=np.array(placements))


def _path(robot: UrdfRobot, link: str) -> tuple[str, ...]:
    """The links from the root to this one."""
    parents = {joint.child: joint.parent for joint in robot.joints.values()}
    path = [link]
    while path[-1] in parents:
        path.append(parents[path[-1]])
    return tuple(reversed(path))


# ------------------------------------------------------------------------------- bodies


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
    """Links that move together, as one body; zeros if they have no mass together."""
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


# --------------------------------------------------------------------------------- base


def _own_base(
    robot: UrdfRobot,
    base_path: Sequence[str],
    still: set[str],
    parameters: Alpha5Parameters,
) -> set[str]:
    """Links of the arm's own base, among those that stand still with it.

    These are all links that hang on one link of the way from the root to axis_e: on the
    first link whose mass comes closest to that of link_0. A link heavier than the whole
    arm is a vehicle even if it hangs on the arm's base. If axis_e turns in such a link,
    nothing is left for link_0.
    """
    whole_arm = sum(link.mass for link in parameters.links)
    if (robot.links[base_path[-1]].mass or 0.0) > whole_arm:
        return set()

    joints = _joints_to(robot, still)
    weights = _carried_weights(robot, still, joints)
    first = _first_link(base_path, weights, parameters.links[0].mass)
    aside = still.difference(base_path)
    vehicles = {name for name in aside if weights[name] > whole_arm}
    return _hanging_on({first}, joints) - _hanging_on(vehicles, joints)


def _joints_to(robot: UrdfRobot, links: Iterable[str]) -> list[UrdfJoint]:
    """The joints that carry some links, each after the joint before it."""
    carried = set(links)
    return [joint for joint in robot.joints.values() if joint.child in carried]


def _carried_weights(
    robot: UrdfRobot, links: Iterable[str], joints: Sequence[UrdfJoint]
) -> dict[str, float]:
    """Link -> its mass and that of everything that hangs on it [kg]."""
    weights = {name: robot.links[name].mass or 0.0 for name in links}
    for joint in reversed(joints):
        weights[joint.parent] += weights[joint.child]
    return weights


def _first_link(
    base_path: Sequence[str], weights: Mapping[str, float], mass: float
) -> str:
    """The link on the way to axis_e that, with all it carries, comes closest to a mass."""
    best = base_path[0]
    for name in base_path[1:]:
        closer = abs(weights[name] - mass) < abs(weights[best] - mass)
        if closer and weights[best] - weights[name] > CARRIED_FROM:
            best = name
    return best


def _hanging_on(links: set[str], joints: Iterable[UrdfJoint]) -> set[str]:
    """These links and all that they carry; joints each after the one before it."""
    found = set(links)
    for joint in joints:
        if joint.parent in found:
            found.add(joint.child)
    return found


def _digits(
    robot: UrdfRobot, joints: Joints, base_path: Sequence[str], own_base: set[str]
) -> Rounding:
    """What the digits of the origins leave open, from the arm's own base to its wrist."""
    first = next((name for name in base_path if name in own_base), base_path[-1])
    way = _path(robot, joints[-1].child)
    behind = way[way.index(first) + 1 :]
    return last_digits(_joints_to(robot, behind))


# --------------------------------------------------------------------------------- tool


def _tool_link(robot: UrdfRobot, wrist: str) -> str:
    """The link fixed to the wrist whose name says that its frame is the tool's.

    Of several, the one with the likeliest word, then the outermost. Empty if there is none.
    """
    steps = {wrist: 0}
    for joint in robot.joints.values():
        if joint.kind == "fixed" and joint.parent in steps:
            steps[joint.child] = steps[joint.parent] + 1
    del steps[wrist]

    ranked = [(_tool_rank(name), -count, name) for name, count in steps.items()]
    rank, _, name = min(ranked, default=(len(TOOL_WORDS), 0, ""))
    return name if rank < len(TOOL_WORDS) else ""


def _tool_rank(name: str) -> int:
    """Place in `TOOL_WORDS` of the first of them that a name contains."""
    separated = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)
    words = re.split(r"[^a-z]+", separated.lower())
    if "base" in words:
        return len(TOOL_WORDS)
    found = [rank for rank, word in enumerate(TOOL_WORDS) if word in words]
    return min(found, default=len(TOOL_WORDS))
