"""Whether the parts of an arm's record fit together, and fit Table 1."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES

#: Length of Table 1 -> its row and its field.
LENGTHS = {
    "a_0": (0, "a"),
    "d_0": (0, "d"),
    "a_1": (1, "a"),
    "a_2": (2, "a"),
    "d_3": (3, "d"),
}
#: Largest distance of a tool point from Table 1's [m].
FARTHEST_TOOL = 0.3
#: Difference of a twist that is rounding [rad].
_SAME_TWIST = 1e-9
#: Difference of a moved tool point that is rounding [m].
_SAME_POINT = 1e-12
#: No body of the arm is that long [m].
_LONGEST_BODY = 0.5
#: Bodies that the arm has already.
_TAKEN = ("base_link", *BODY_NAMES, "tcp", "jaw_rod", "finger_1", "finger_2")


def check_dh(dh: Sequence[Any], table_1: Sequence[Any]) -> None:
    """Refuse lengths of the other sign, and axes that are not parallel as printed.

    The closed form of the inverse kinematics needs Table 1's twists.

    Args:
        dh: The rows of the arm, records of `DHParameters`.
        table_1: The rows as printed.

    Raises:
        InputError: A length or a twist that no arm of this kind has.
    """
    for name, (i, field) in LENGTHS.items():
        own = getattr(dh[i], field)
        printed = getattr(table_1[i], field)
        if own * printed <= 0:
            side = "above 0" if printed > 0 else "below 0"
            expected = f"a length {side}, as Table 1's {printed:g} m"
            raise InputError(name, own, expected)
    for i in range(4):
        if abs(dh[i].alpha - table_1[i].alpha) > _SAME_TWIST:
            expected = (
                f"Table 1's {table_1[i].alpha:g} rad: "
                "the closed-form inverse kinematics has no twisted axes"
            )
            raise InputError(f"dh[{i}].alpha", dh[i].alpha, expected)


def check_ranges(joints: Iterable[Any]) -> None:
    """Refuse ranges of a full turn or more.

    Args:
        joints: Records of `JointParameters`.

    Raises:
        InputError: Such a range, in which a pose would have two joint positions.
    """
    for joint in joints:
        width = joint.upper - joint.lower
        if joint.kind == "revolute" and width >= math.tau:
            given = (joint.lower, joint.upper)
            expected = "a range of less than a full turn, 2 pi"
            raise InputError(f"{joint.name} range", given, expected)


def check_attached(attached: Iterable[AttachedBody]) -> None:
    """Refuse names that the arm has already, or that two bodies share.

    Raises:
        InputError: Such a name.
    """
    taken = set(_TAKEN)
    for body in attached:
        if body.name in taken:
            expected = "a name that no other body or frame has"
            raise InputError("attached.name", body.name, expected)
        taken.add(body.name)


def check_tool(tool: Pose, printed: Pose, spacer: float) -> None:
    """Refuse a tool point far from Table 1's, or not where a spacer moves it.

    Args:
        tool: Of the arm.
        printed: Table 1's, with the arm's own lengths.
        spacer: Sum of the spacers [m].

    Raises:
        InputError: Such a tool point.
    """
    distance = float(np.linalg.norm(tool.position - printed.position))
    if distance > FARTHEST_TOOL:
        point = ", ".join(f"{x:g}" for x in printed.position)
        expected = f"a point within {FARTHEST_TOOL:g} m of Table 1's ({point})"
        raise InputError("tool.position", tool.position.tolist(), expected)
    if not spacer:
        return

    moved = printed.position - [0.0, 0.0, spacer]
    if np.abs(tool.position - moved).max() > _SAME_POINT:
        point = ", ".join(f"{x:g}" for x in moved)
        expected = (
            f"either a spacer or a tool position of its own (the spacer of {spacer:g} "
            f"m puts the tool at ({point})); tool=None moves it there"
        )
        raise InputError("tool.position", tool.position.tolist(), expected)


def check_inside(name: str, com: FloatArray, bounds: FloatArray) -> None:
    """Check that a COM is inside a body.

    Args:
        name: Of the COM, for the message.
        com: (3,) [m].
        bounds: Outer bounds of the body, (3, 2) [m].

    Raises:
        InputError: It is outside; the message suggests mm if that would be inside.
    """

    def is_inside(point: FloatArray) -> bool:
        return bool(((bounds[:, 0] <= point) & (point <= bounds[:, 1])).all())

    if is_inside(com):
        return
    expected = f"a point inside the body's bounds, {bounds.tolist()} m"
    if np.abs(com).max() > _LONGEST_BODY and is_inside(com / 1000):
        expected += "; is it in mm?"
    raise InputError(name, com.tolist(), expected)
