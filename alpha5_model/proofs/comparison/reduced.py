"""Reduce a model, theirs or ours, to four joints and five bodies."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import moved, rotation_about, transform
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfLink, UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.inertia import combine, rotate_tensor, tensor_at_origin
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.digits import Rounding, last_digits
from alpha5_model.proofs.comparison.model import path_to, rest_position

X, Y, Z = np.eye(3)
#: A link before the arm's base that is lighter than this is a dummy and belongs to the
#: base; a heavier one is foreign.
LEAST_FOREIGN_MASS = 0.02  # [kg], a tenth of link_0
#: A link whose grams are the base's to this is no vehicle of as many kilograms.
SAME_MASS = 5e-3


@dataclass(frozen=True, eq=False)
class FourJoints:
    """Four revolute joints and five bodies.

    Attributes:
        placements: Pose of each joint's child in the body before it, at zero,
            (4, 4, 4).
        axes: Unit vectors in the child's frame, (4, 3).
        mass: (5,) [kg].
        com: In the body's frame, (5, 3) [m].
        inertia: At the COM, (5, 3, 3) [kg m^2].
    """

    placements: FloatArray
    axes: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray

    @cached_property
    def model(self) -> Any:
        """The pin.Model; its joints are named axis_e to axis_b."""
        model = pin.Model()
        parent = 0
        for k in range(4):
            turning = pin.JointModelRevoluteUnaligned(*self.axes[k].tolist())
            placement = pin.SE3(self.placements[k])
            parent = model.addJoint(parent, turning, placement, f"joint_{k}")
            model.inertias[parent] = self._body(k + 1)
        return model

    def _body(self, k: int) -> Any:
        """The pin.Inertia of a body, which need not be a possible one."""
        mass = float(self.mass[k])
        if not mass:
            return pin.Inertia.Zero()
        about_origin = tensor_at_origin(mass, self.com[k], self.inertia[k])
        xx, xy, yy, xz, yz, zz = about_origin[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
        moment = mass * self.com[k]
        parameters = np.array([mass, *moment, xx, xy, yy, xz, yz, zz])
        return pin.Inertia.FromDynamicParameters(parameters)

    def zero_poses(self) -> FloatArray:
        """Poses of the bodies in the root at zero, (5, 4, 4)."""
        poses = [np.eye(4)]
        for placement in self.placements:
            poses.append(poses[-1] @ placement)
        return np.array(poses)

    def wrist_poses(self, q: FloatArray) -> FloatArray:
        """Poses of the last body in the root at q (N, 4) [rad], (N, 4, 4)."""
        data = self.model.createData()
        poses = []
        for row in q:
            pin.forwardKinematics(self.model, data, row)
            poses.append(data.oMi[4].homogeneous)
        return np.array(poses)

    def gravity_torque(
        self, q: FloatArray, gravity: Sequence[float] | FloatArray = GRAVITY
    ) -> FloatArray:
        """Torques that hold the weight in air, (N, 4) [N m].

        Args:
            q: Positions, (N, 4) [rad].
            gravity: In the root, (3,) [m/s^2].
        """
        self.model.gravity.linear = np.asarray(gravity, float)
        data = self.model.createData()
        torques = [
            pin.computeGeneralizedGravity(self.model, data, row).copy() for row in q
        ]
        return np.array(torques)

    def gravity_regressor(self, q: FloatArray) -> FloatArray:
        """Gravity torque per mass and first moment of each moving body [Atkeson1986].

        Args:
            q: Positions, (N, 4) [rad].

        Returns:
            By position, joint, body 1 to 4, and mass or first moment, (N, 4, 4, 4).
        """
        self.model.gravity.linear = np.asarray(GRAVITY, float)
        data = self.model.createData()
        still = np.zeros(4)
        rows = []
        for row in q:
            of_body = pin.computeJointTorqueRegressor(
                self.model, data, row, still, still
            ).reshape(4, 4, 10)
            rows.append(of_body[:, :, :4].copy())
        return np.array(rows)

    def mass_matrices(self, q: FloatArray) -> FloatArray:
        """Mass matrices at q (N, 4) [rad], (N, 4, 4) [kg m^2]."""
        data = self.model.createData()
        return np.array([pin.crba(self.model, data, row).copy() for row in q])


class Dimensions(NamedTuple):
    """Lengths and twists between neighbouring axes, as in Table 1, and their errors.

    Attributes:
        a_0, a_1, a_2: Distances along the common normals [m].
        d_1: Offset of the elbow along axis_d [m].
        alpha_0, alpha_1, alpha_2: Angles about the common normals [rad].
        beta_1: Tilt of axis_c against axis_d in the plane of the arm [rad]. These two
            axes are parallel, so alpha_1 alone cannot describe every error.
    """

    a_0: float
    a_1: float
    a_2: float
    d_1: float
    alpha_0: float
    alpha_1: float
    alpha_2: float
    beta_1: float


def dimensions_of(record: Alpha5Parameters) -> Dimensions:
    """The dimensions of our arm."""
    first, second, third = record.dh[:3]
    return Dimensions(
        a_0=first.a,
        a_1=second.a,
        a_2=third.a,
        d_1=second.d,
        alpha_0=first.alpha,
        alpha_1=second.alpha,
        alpha_2=third.alpha,
        beta_1=0.0,
    )


def our_arm(
    record: Alpha5Parameters, dimensions: Dimensions | None = None
) -> FourJoints:
    """Our arm, or one with other dimensions; each body moves with its own joint.

    The frame of link_i + 1 is frame {i} of Table 1, turned by its own joint.
    """
    own = dimensions or dimensions_of(record)
    offsets = [row.theta_offset for row in record.dh[:4]]
    turns = transform(rotation_about(Z, offsets))
    twist_0 = rotation_about(X, own.alpha_0)
    twist_1 = rotation_about(X, own.alpha_1) @ rotation_about(Y, own.beta_1)
    twist_2 = rotation_about(X, own.alpha_2)
    steps = [
        np.eye(4),
        transform(twist_0, (own.a_0, 0, record.dh[0].d)),
        transform(twist_1, (own.a_1, 0, own.d_1)),
        transform(twist_2, (own.a_2, 0, record.dh[2].d)),
    ]
    return FourJoints(
        placements=np.array(steps) @ turns,
        axes=np.tile(Z, (4, 1)),
        mass=np.array([link.mass for link in record.links]),
        com=np.array([link.com for link in record.links]),
        inertia=np.array([link.inertia for link in record.links]),
    )


@dataclass(frozen=True, eq=False)
class Reduced(FourJoints):
    """Another model with all other joints frozen, and without what carries the arm.

    Attributes:
        joints: Its axis_e, axis_d, axis_c and axis_b.
        links: Names of the links of each body; those without a mass too.
        link_poses: Link -> its pose in the frame of its body, (4, 4). The frame of body
            0 is the root.
        base_path: Links from the root to the one that axis_e turns in.
        foreign: Links that do not move against the root and are not the arm's.
        way: The joints from the arm's base to the wrist.
        digits: Rounding of their origins.
        tool: Link fixed to the last body that is named like a tool; empty if none.
        volume: Of the collision primitives of the arm [m^3].
        shape_centres: Their centroid in each body's frame, (5, 3) [m]; NaN without any.
    """

    joints: tuple[UrdfJoint, ...]
    links: tuple[tuple[str, ...], ...]
    link_poses: dict[str, FloatArray]
    base_path: tuple[str, ...]
    foreign: tuple[str, ...]
    way: tuple[UrdfJoint, ...]
    digits: Rounding
    tool: str
    volume: float
    shape_centres: FloatArray


def reduce(
    robot: UrdfRobot,
    joints: tuple[UrdfJoint, ...],
    record: Alpha5Parameters,
    first_link: str | None = None,
) -> Reduced:
    """Freeze all other joints and sum up the links that move together.

    Args:
        robot: The other model.
        joints: Its axis_e, axis_d, axis_c and axis_b.
        record: Our arm, by whose masses the base of the other one is found.
        first_link: The first link of the arm. Those before it, and all else that hangs
            on them, are foreign: vehicle, mount, another arm. Found by its mass if
            None.

    Raises:
        InputError: The four joints do not follow each other from base to tip.
        UnknownNameError: ``first_link`` is not on the way from the root to axis_e.
    """
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

    base_path = path_to(robot, joints[0].parent)
    still = [name for name in robot.links if body[name] == 0]
    if first_link is not None:
        choice("link on the way to axis_e", first_link, base_path)
        base = _hanging_on({first_link}, _joints_to(robot, still))
    else:
        moving = [name for name in robot.links if body[name] > 0]
        unit = _unit_of_mass(robot, moving, record)
        base = _base_links(robot, base_path, set(still), record, unit)

    groups: list[list[str]] = [[] for _ in range(5)]
    for name in robot.links:
        if body[name] > 0 or name in base:
            groups[body[name]].append(name)
    bodies = [_sum(robot, pose, group) for group in groups]
    centres = [_shape_centre(robot, pose, group) for group in groups]

    way = path_to(robot, joints[-1].child)
    first = next((name for name in base_path if name in base), base_path[-1])
    behind_first = _joints_to(robot, way[way.index(first) + 1 :])
    return Reduced(
        placements=np.array(placements),
        axes=np.array([joint.axis for joint in joints]),
        mass=np.array([mass for mass, _, _ in bodies]),
        com=np.array([com for _, com, _ in bodies]),
        inertia=np.array([inertia for _, _, inertia in bodies]),
        joints=joints,
        links=tuple(map(tuple, groups)),
        link_poses=pose,
        base_path=base_path,
        foreign=tuple(name for name in still if name not in base),
        way=tuple(behind_first),
        digits=last_digits(behind_first),
        tool=_tool_link(robot, joints[-1].child),
        volume=sum(robot.links[name].volume for name in itertools.chain(*groups)),
        shape_centres=np.array(centres),
    )


def _sum(
    robot: UrdfRobot, pose: Mapping[str, FloatArray], group: Sequence[str]
) -> tuple[float, FloatArray, FloatArray]:
    """Mass, COM and tensor of links that move together; zeros without any mass."""
    masses, coms, inertias = [], [], []
    for name in group:
        link = robot.links[name]
        if link.mass:
            masses.append(link.mass)
            coms.append(moved(pose[name], link.com))
            inertias.append(rotate_tensor(pose[name][:3, :3], link.inertia))
    if sum(masses) == 0.0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    return combine(masses, coms, inertias)


def _shape_centre(
    robot: UrdfRobot, pose: Mapping[str, FloatArray], group: Sequence[str]
) -> FloatArray:
    """Centroid of the collision primitives of links that move together, (3,) [m]."""
    links = [robot.links[name] for name in group if robot.links[name].volume > 0]
    if not links:
        return np.full(3, math.nan)
    centres = [moved(pose[link.name], link.shape_centre) for link in links]
    return np.average(centres, axis=0, weights=[link.volume for link in links])


# --- Base and tool --------------------------------------------------------------------


def _unit_of_mass(
    robot: UrdfRobot, moving: Iterable[str], record: Alpha5Parameters
) -> float:
    """1000 if the masses that move are in grams, else 1."""
    theirs = sum(robot.links[name].mass or 0.0 for name in moving)
    ours = sum(link.mass for link in record.links[1:])
    return 1e3 if theirs > 100 * ours else 1.0


def _base_links(
    robot: UrdfRobot,
    base_path: Sequence[str],
    still: set[str],
    record: Alpha5Parameters,
    unit: float,
) -> set[str]:
    """Links of the arm's own base, among those that do not move against it.

    The base begins at the link on the way from the root to axis_e that, with all that
    hangs on it, comes closest to the mass of link_0. All that hangs on this link
    belongs to the base, except vehicles: a link heavier than the whole arm is one. If
    axis_e turns in a vehicle, the base has no links.

    Args:
        robot: The other model.
        base_path: Links from the root to the one that axis_e turns in.
        still: All links that do not move against the root.
        record: Our arm.
        unit: How many of their masses' units are 1 kg.
    """
    whole_arm = sum(link.mass for link in record.links)
    base_mass = record.links[0].mass
    weight = {name: _weight(robot.links[name], base_mass, unit) for name in still}
    if weight[base_path[-1]] > whole_arm:
        return set()

    joints = _joints_to(robot, still)
    for joint in reversed(joints):
        weight[joint.parent] += weight[joint.child]

    first = base_path[0]
    for name in base_path[1:]:
        off = abs(weight[name] - base_mass)
        least_off = abs(weight[first] - base_mass)
        if off < least_off and weight[first] - weight[name] > LEAST_FOREIGN_MASS:
            first = name
    aside = still.difference(base_path)
    vehicles = {name for name in aside if weight[name] > whole_arm}
    base = _hanging_on({first}, joints) - _hanging_on(vehicles, joints)
    missing = base_mass - sum(robot.links[name].mass or 0.0 for name in base)
    in_grams = set()
    for name in vehicles:
        if math.isclose(weight[name], 1e3 * missing, rel_tol=SAME_MASS):
            in_grams.add(name)
    return base | _hanging_on(in_grams, joints)


def _weight(link: UrdfLink, base_mass: float, unit: float) -> float:
    """Mass of a link [kg], read in grams if it then is that of the arm's base."""
    mass = link.mass or 0.0
    in_grams = math.isclose(mass, 1e3 * base_mass, rel_tol=SAME_MASS)
    return mass / 1e3 if in_grams else mass / unit


def _joints_to(robot: UrdfRobot, links: Iterable[str]) -> list[UrdfJoint]:
    """The joints whose children are these links, each after the joint before it."""
    children = set(links)
    return [joint for joint in robot.joints.values() if joint.child in children]


def _hanging_on(links: set[str], joints: Iterable[UrdfJoint]) -> set[str]:
    """These links and all that hangs on them by joints, sorted from the root out."""
    found = set(links)
    for joint in joints:
        if joint.parent in found:
            found.add(joint.child)
    return found


#: What tool frames are called, the likeliest first.
TOOL_WORDS = ("tcp", "tool", "tip", "grasp", "effector", "eef", "ee")


def _tool_link(robot: UrdfRobot, wrist: str) -> str:
    """The link fixed to the wrist that is named like a tool; "" if there is none.

    If several are, the one with the likeliest word is taken, then the outermost.
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
    """Index in `TOOL_WORDS` of the likeliest word in a name, or their number."""
    separated = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)
    words = re.split(r"[^a-z]+", separated.lower())
    if "base" in words:
        return len(TOOL_WORDS)
    found = [rank for rank, word in enumerate(TOOL_WORDS) if word in words]
    return min(found, default=len(TOOL_WORDS))
