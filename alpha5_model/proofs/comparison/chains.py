"""Which joints of another model are this arm's, by the shape of their axes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.proofs.comparison.axis_lines import AxisLines, axis_shape
from alpha5_model.proofs.comparison.frozen_joints import rest_poses
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of

AXES = JOINT_NAMES[:4]
TURNING = ("revolute", "continuous")
#: How many numbers of a shape, see `axis_shape`, are lengths; the others are angles.
LENGTHS, ANGLES = 4, 3

Joints = tuple[UrdfJoint, ...]


@dataclass(frozen=True, eq=False)
class Chain:
    """Four joints that turn one after another, and the shape of their axes.

    Attributes:
        joints: Base to tip.
        shape: Distances and angles of their axes, (7,) [m, rad]; see `axis_shape`.
        differences: How far the shape is from ours, (7,) [m]: angles times the length
            of our upper arm.
        following: Length of the longest chain of turning joints behind them.
    """

    joints: Joints
    shape: FloatArray
    differences: FloatArray
    following: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return tuple([joint.name for joint in self.joints])

    @property
    def misfit(self) -> float:
        """All differences together [m]."""
        return float(np.linalg.norm(self.differences))

    @property
    def named_as_ours(self) -> int:
        """How many of the joints have a name that ends in ours."""
        return sum(map(str.endswith, self.names, AXES))


def our_shape(parameters: Alpha5Parameters) -> FloatArray:
    """Distances [m] and angles [rad] of our own axes, (7,); see `axis_shape`."""
    rows = parameters.dh[:3]
    lengths = [row.a for row in rows]
    twists = np.abs([row.alpha for row in rows])
    angles = np.minimum(twists, math.pi - twists)
    return np.array([*lengths, 0.0, *angles])


def find_chains(
    robot: UrdfRobot,
    parameters: Alpha5Parameters,
    names: Mapping[str, str] | None = None,
) -> list[Chain]:
    """Every four joints in a row that could be our first four, the best first.

    They are ranked by the shape of their axes. Names decide between chains of the same
    shape, such as two arms on one vehicle. Joints that mimic another or have no range
    do not count.

    Args:
        robot: The other model.
        parameters: Our arm.
        names: Our joint name -> theirs, for joints that the user names. If all four
            are named, they need not be in a row.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints are mapped to one, one does not turn, or there is
            no such chain.
    """
    given = dict(names or {})
    _check_names(robot, given)

    rows = _rows_of_turning_joints(robot)
    if len(given) == 4:
        found = [tuple(robot.joints[given[axis]] for axis in AXES)]
    else:
        found = [row for row in rows.values() if _fits(row, given)]
    if given and not found:
        mapping = ",".join(f"{axis}={name}" for axis, name in given.items())
        names_there = ", ".join(rows) or "none"
        expected = (
            f"four different joints that follow each other, out of: {names_there}"
        )
        raise InputError("map", mapping, expected)

    chains = _measured(robot, found, our_shape(parameters))
    chains.sort(key=lambda chain: (round(chain.misfit, 4), -chain.named_as_ours))
    return chains


def _check_names(robot: UrdfRobot, given: Mapping[str, str]) -> None:
    """Refuse names of joints that do not exist, do not turn, or are given twice."""
    for axis, name in given.items():
        choice("joint", axis, AXES)
        choice("joint of the other model", name, tuple(robot.joints))
        if robot.joints[name].kind not in TURNING:
            raise InputError("map", name, "a revolute joint")

        same = [other for other in given if other != axis and given[other] == name]
        if same:
            mapping = f"{axis}={name},{same[0]}={name}"
            raise InputError("map", mapping, "four different joints")


def _rows_of_turning_joints(robot: UrdfRobot) -> dict[str, Joints]:
    """Turning joint -> the last four turning joints up to it, base to tip."""
    way_to_link: dict[str, Joints] = {robot.root: ()}
    rows: dict[str, Joints] = {}
    for joint in robot.joints.values():  # each after the joint before it
        way = way_to_link[joint.parent]
        if _turns(joint):
            way = (*way, joint)[-4:]
            rows[joint.name] = way
        way_to_link[joint.child] = way
    return rows


def _fits(row: Joints, given: Mapping[str, str]) -> bool:
    """Whether a row has four joints, with the names that are given for them."""
    if len(row) < 4:
        return False
    return all(row[AXES.index(axis)].name == name for axis, name in given.items())


def _measured(
    robot: UrdfRobot, rows: list[Joints], expected: FloatArray
) -> list[Chain]:
    """Rows of four joints with their shapes, compared with the expected one (7,)."""
    poses = rest_poses(robot)
    following = _following(robot)
    upper_arm = expected[1]
    to_metres = np.repeat([1.0, upper_arm], (LENGTHS, ANGLES))

    chains = []
    for row in rows:
        shape = axis_shape(_lines(poses, row))
        chains.append(
            Chain(
                joints=row,
                shape=shape,
                differences=np.abs(shape - expected) * to_metres,
                following=following[row[-1].child],
            )
        )
    return chains


def _lines(poses: Mapping[str, FloatArray], row: Joints) -> AxisLines:
    """The axes of joints as lines in the root, (N, 3)."""
    origins = np.array([poses[joint.parent] @ joint.transform for joint in row])
    axes = [joint.axis for joint in row]
    return AxisLines(
        points=origin_of(origins),
        directions=np.einsum("nij,nj->ni", rotation_of(origins), axes),
    )


def _turns(joint: UrdfJoint) -> bool:
    """Whether a joint turns by itself: it follows no other and has a range."""
    locked = joint.lower is not None and joint.lower == joint.upper
    return joint.kind in TURNING and joint.mimic is None and not locked


def _following(robot: UrdfRobot) -> dict[str, int]:
    """Link -> length of the longest chain of turning joints behind it."""
    following = dict.fromkeys(robot.links, 0)
    for joint in reversed(robot.joints.values()):
        behind = following[joint.child] + _turns(joint)
        following[joint.parent] = max(following[joint.parent], behind)
    return following
