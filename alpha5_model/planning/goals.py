"""The joint positions that a motion may end in, for a point, a pose or angles."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, real
from alpha5_model.errors import InputError
from alpha5_model.kinematics.choosing import TIE
from alpha5_model.kinematics.geometry import on_axis
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.kinematics.limits import within
from alpha5_model.kinematics.pose import inverse_kinematics_pose
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES

#: Kinds of targets.
POINT = "position"
JOINTS = "joints"
POSE = "pose"
#: Other wrist angles at which a point is looked for, evenly over the range of axis_b.
WRISTS = 91


class Goal(NamedTuple):
    """Where a motion may end.

    Attributes:
        q: (4,) [rad].
        branch: Of the inverse kinematics; None if q itself was asked for.
    """

    q: FloatArray
    branch: str | None


class Target(NamedTuple):
    """What a motion is to reach.

    Attributes:
        kind: ``position``, ``joints`` or ``pose``.
        value: (3,) [m], (4,) [rad] or (4, 4).
        place: Where it was given, for messages.
    """

    kind: str
    value: FloatArray
    place: str


def target_of(name: str, given: Any) -> Target:
    """The target that a caller means.

    Raises:
        InputError: Neither a point, nor four angles, nor a pose.
    """
    if isinstance(given, Target):
        return given
    if hasattr(given, "homogeneous"):
        given = given.homogeneous
    value = float_array(name, given, ())
    kinds = {(3,): POINT, (4,): JOINTS, (4, 4): POSE}
    if value.shape not in kinds:
        expected = "a point (3,) [m], joint positions (4,) [rad] or a pose (4, 4)"
        raise InputError(name, value.tolist(), expected)
    return Target(kind=kinds[value.shape], value=value, place=name)


def joint_position(name: str, given: ArrayLike, arm: Alpha5Parameters) -> FloatArray:
    """A joint position within the limits of an arm, (4,) [rad].

    Raises:
        InputError: Not four finite numbers.
        JointLimitError: One of them is beyond its joint's limit.
    """
    q = float_array(name, given, (4,))
    if q.shape != (4,):
        raise InputError(name, q.tolist(), "four joint positions [rad]")
    lower, upper = joint_range(arm)
    return within(JOINT_NAMES[:4], q, lower, upper)


def joint_range(arm: Alpha5Parameters) -> tuple[FloatArray, FloatArray]:
    """Limits of axis_e to axis_b, (4,) each [rad]."""
    lower = np.array([joint.lower for joint in arm.joints[:4]])
    upper = np.array([joint.upper for joint in arm.joints[:4]])
    return lower, upper


def goals(
    target: Target, q0: FloatArray, wrist: float | None, arm: Alpha5Parameters
) -> list[Goal]:
    """The joint positions within the limits that reach a target.

    A point is reached with the wrist angle given, or else with that of q0. A pose is
    reached by the branches that come closest to its orientation.

    Raises:
        Alpha5Error: There is none; it says why.
    """
    if target.kind == JOINTS:
        return [Goal(q=joint_position("target", target.value, arm), branch=None)]
    if target.kind == POSE:
        return _of_pose(target.value, q0, arm)
    angle = float(q0[3]) if wrist is None else real("wrist", wrist)
    return _of_point(target.value, angle, q0, arm)


def other_wrists(
    target: Target, q0: FloatArray, arm: Alpha5Parameters
) -> list[list[Goal]]:
    """The goals of a point at other wrist angles that reach it, from near to far."""
    angles = reaching_wrists(target.value, float(q0[3]), arm)
    return [_of_point(target.value, float(angle), q0, arm) for angle in angles]


def reaching_wrists(
    position: FloatArray, wrist: float, arm: Alpha5Parameters
) -> FloatArray:
    """Angles of axis_b that reach a point (3,), the nearest to ``wrist`` first [rad].

    They are out of `WRISTS` over its range.
    """
    joint = arm.joints[3]
    angles = np.linspace(joint.lower, joint.upper, WRISTS)
    targets = np.broadcast_to(position, (WRISTS, 3))
    reaches = inverse_kinematics(targets, angles, arm=arm).within_limits.any(axis=1)
    found = angles[reaches]
    return np.asarray(found[np.argsort(np.abs(found - wrist), kind="stable")])


def _of_point(
    position: FloatArray, wrist: float, q0: FloatArray, arm: Alpha5Parameters
) -> list[Goal]:
    solutions = inverse_kinematics(position, wrist, arm=arm)
    if not solutions.within_limits.any():
        solutions.best(q0)  # says why there is none
    q = solutions.q.copy()
    if bool(on_axis(position)):
        # theta_0 is free.
        q[:, 0] = q0[0]
    return [
        Goal(q=q[branch], branch=BRANCHES[branch])
        for branch in np.flatnonzero(solutions.within_limits)
    ]


def _of_pose(
    transform: FloatArray, q0: FloatArray, arm: Alpha5Parameters
) -> list[Goal]:
    solutions = inverse_kinematics_pose(transform, arm=arm)
    if not solutions.within_limits.any():
        solutions.best(q0)  # says why there is none
    error = np.where(solutions.within_limits, solutions.rotation_error, np.inf)
    closest = error <= error.min() + TIE
    return [
        Goal(q=solutions.q[branch].copy(), branch=BRANCHES[branch])
        for branch in np.flatnonzero(closest)
    ]
