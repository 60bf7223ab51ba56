"""Find the joints of this arm in any URDF, by the shape of their axes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import AXES, foot, rest_position
from alpha5_model.description.urdf_reading import UrdfJoint, UrdfRobot
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.parameters import parameters

TURNING = ("revolute", "continuous")


@dataclass(frozen=True, eq=False)
class Chain:
    """Four joints that turn one after another, and the shape of their axes.

    Attributes:
        joints: Base to tip.
        lengths: Distance of each axis from the one before it, (3,), and of the first from the last
            common normal along the second axis [m].
        twists: Angle of each axis with the one before it, (3,), up to pi/2 [rad].
        misfit: How far the shape is from ours [m]: angles weigh with the length of the upper arm.
        following: How many more joints turn one after another behind them.
    """

    joints: tuple[UrdfJoint, ...]
    lengths: FloatArray
    twists: FloatArray
    misfit: float
    following: int


def our_shape() -> tuple[FloatArray, FloatArray]:
    """Lengths [m] and twists [rad] of our own axes, as in `Chain`."""
    rows = parameters().dh[:3]
    twists = np.abs([row.alpha for row in rows])
    return np.array([*(row.a for row in rows), 0.0]), np.minimum(twists, math.pi - twists)


def _chain(
    joints: tuple[UrdfJoint, ...], following: int, points: FloatArray, directions: FloatArray
) -> Chain:
    """Lengths of links need no more than points on the axes; parallel ones are as good as any."""
    across = np.cross(directions[:-1], directions[1:])
    sines = np.linalg.norm(across, axis=1)
    between = np.diff(points, axis=0)
    twists = np.arctan2(sines, np.abs(np.sum(directions[:-1] * directions[1:], axis=1)))
    ends = [foot(points, directions, 1, 0), foot(points, directions, 2, 3)]
    upper = ends[1] - ends[0]
    offset = float(upper @ directions[1])
    lengths = [abs(b @ n) / max(s, 1e-9) for b, n, s in zip(between, across, sines, strict=True)]
    lengths[1] = float(np.linalg.norm(upper - offset * directions[1]))
    ours = our_shape()
    shape = np.array([*lengths, abs(offset)])
    misfit = np.hypot(
        np.linalg.norm(shape - ours[0]), np.linalg.norm(twists - ours[1]) * ours[0][1]
    )
    return Chain(joints, shape, twists, float(misfit), following)


def find_chains(robot: UrdfRobot, names: Mapping[str, str] | None = None) -> list[Chain]:
    """Every four joints in a row that could be axis_e, axis_d, axis_c and axis_b, the best first.

    Joints are known by the shape of their axes; names decide between chains of the same shape, such
    as two arms on one vehicle. Joints that mimic another or have no range do not count.

    Args:
        robot: The other model.
        names: Ours -> theirs, where the caller says so; four of them need not be in a row.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints mapped to one, one that does not turn, or no such chain.
    """
    given = dict(names or {})
    for axis, name in given.items():
        if axis not in AXES:
            raise UnknownNameError("joint", axis, AXES)
        if name not in robot.joints:
            raise UnknownNameError("joint of the other model", name, robot.joints)
        if robot.joints[name].kind not in TURNING:
            raise InputError("map", name, "a revolute joint")
        if twice := [other for other in given if other != axis and given[other] == name]:
            raise InputError("map", f"{axis}={name},{twice[0]}={name}", "four different joints")
    pose, before = {robot.root: np.eye(4)}, {robot.root: ""}
    rows: dict[str, tuple[str, ...]] = {"": ()}
    for joint in robot.joints.values():
        at = pose[joint.parent] @ joint.transform
        pose[joint.child], before[joint.child] = (
            at @ joint.motion(rest_position(robot, joint)),
            before[joint.parent],
        )
        locked = joint.lower is not None and joint.lower == joint.upper
        if joint.kind in TURNING and joint.mimic is None and not locked:
            rows[joint.name] = (*rows[before[joint.parent]], joint.name)
            before[joint.child] = joint.name
    found = [row[-4:] for row in rows.values() if len(row) >= 4]
    if len(given) == 4:
        found = [tuple([given[axis] for axis in AXES])]
    found = [row for row in found if all(row[AXES.index(a)] == n for a, n in given.items())]
    if given and not found:
        joints = ", ".join(name for name in rows if name) or "none"
        example = ",".join(f"{axis}={name}" for axis, name in given.items())
        raise InputError(
            "map", example, f"four different joints that follow each other, out of: {joints}"
        )
    chains = []
    for row in found:
        four = tuple(robot.joints[name] for name in row)
        at = np.array([pose[joint.parent] @ joint.transform for joint in four])
        axes = np.array([joint.axis for joint in four])
        last = rows.get(row[-1], ())
        following = max(len(r) for r in rows.values() if r[: len(last)] == last) - len(last)
        chains.append(
            _chain(four, following, at[:, :3, 3], np.einsum("nij,nj->ni", at[:, :3, :3], axes))
        )
    return sorted(chains, key=lambda c: (round(c.misfit, 4), -_named(c.joints)))


def _named(joints: tuple[UrdfJoint, ...]) -> int:
    return sum(joint.name.endswith(axis) for axis, joint in zip(AXES, joints, strict=True))


def map_joints(robot: UrdfRobot, names: Mapping[str, str] | None = None) -> tuple[UrdfJoint, ...]:
    """The joints of another model that are axis_e, axis_d, axis_c and axis_b; see `find_chains`.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints mapped to one, or no four joints in a row.
    """
    chains = find_chains(robot, names)
    if not chains:
        raise InputError("robot", robot.name, "four revolute joints in a row")
    return chains[0].joints
