"""Checks of the arguments of a planar arm: joint types, lengths, angles and limits."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from numpy.typing import ArrayLike

from alpha5_model._support.checks import float_array, listed
from alpha5_model.errors import InputError, MissingParameterError, ShapeError

#: Least and greatest position of a joint.
Range = tuple[float, float]


def checked_joints(joints: str | None, number: int) -> str:
    """The letters of the joints; all revolute by default."""
    if joints is None:
        return "R" * number
    if (
        not isinstance(joints, str)
        or len(joints) != number
        or not set(joints) <= {"R", "P"}
    ):
        raise InputError("joints", joints, f"{number} letters R or P, one per link")
    return joints


def check_lengths(lengths: Iterable[float], joints: str) -> None:
    """Refuse lengths that are negative, or zero after a revolute joint."""
    for length, kind in zip(lengths, joints, strict=True):
        if kind == "R" and length <= 0:
            raise InputError("lengths", length, "a length that is positive")
        if kind == "P" and length < 0:
            raise InputError("lengths", length, "a length that is not negative")


def checked_angles(angles: ArrayLike | None, number: int) -> tuple[float, ...]:
    """The constant angles of the links; zero by default."""
    if angles is None:
        return (0.0,) * number
    checked = float_array("angles", angles, (number,))
    if checked.ndim != 1:
        raise ShapeError("angles", checked.shape, f"shape ({number},)")
    return tuple(checked.tolist())


def checked_limits(limits: Any, joints: str) -> tuple[Range | None, ...]:
    """The limits of each joint; None for a revolute joint without limits."""
    expected = f"one (lower, upper) or None for {len(joints)} joints"
    ranges = [None] * len(joints)
    if limits is not None:
        ranges = listed("limits", limits, expected)
    if len(ranges) != len(joints):
        raise ShapeError("limits", (len(ranges),), expected)
    return tuple(
        _checked_range(limit, kind) for limit, kind in zip(ranges, joints, strict=True)
    )


def _checked_range(limit: Any, kind: str) -> Range | None:
    """Limits of one joint; None if there are none, or a revolute joint turns fully."""
    if limit is None:
        if kind == "P":
            raise MissingParameterError(
                "limits (lower, upper) of each", "a prismatic joint"
            )
        return None
    values = float_array("limits", limit, (2,))
    if values.ndim != 1:
        raise ShapeError("limits", values.shape, "a pair (lower, upper) per joint")
    lower, upper = values.tolist()
    if lower > upper:
        raise InputError("limits", (lower, upper), "lower <= upper")
    turns_fully = kind == "R" and upper - lower >= 2 * math.pi
    return None if turns_fully else (lower, upper)
