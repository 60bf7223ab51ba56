"""Measured values of an arm of your own that no printed number stands for.

They have a half width in the arm file: attached bodies, the length a_1, zeros, tool,
mount, limits, and what Table 4 does not print of the motors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy, rpy_from_rotation
from alpha5_model.numbers.arm_schema import DRIVE_FIELDS, LIMIT_FIELDS
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import tool_of
from alpha5_model.numbers.tables import JOINT_NAMES


class MeasuredNumber(NamedTuple):
    """A number with a half width.

    Attributes:
        name: The key of the arm file, and the component: ``attached.camera.com.x``.
        value: In SI units.
        half_width: The true value is within this of it.
    """

    name: str
    value: float
    half_width: float


def half_widths(arm: Alpha5Parameters) -> dict[str, float]:
    """Key of the arm file -> half width, for the values that have one."""
    return {
        one.key: one.half_width
        for one in arm.measurements
        if one.half_width is not None
    }


def other_numbers(arm: Alpha5Parameters) -> list[MeasuredNumber]:
    """The measured numbers of an arm beside those of its links and actuators."""
    found: list[MeasuredNumber] = []
    for key, half_width in half_widths(arm).items():
        value = _value(arm, key.split("."))
        if value is not None:
            found += _components(key, value, half_width)
    return found


def _components(key: str, value: Any, half_width: float) -> list[MeasuredNumber]:
    """The numbers of a value: itself, three of a vector, six of a tensor."""
    numbers = np.asarray(value, float)
    found = []
    for at in np.ndindex(numbers.shape):
        axes = "".join("xyz"[i] for i in at)
        if axes == "".join(sorted(axes)):
            name = f"{key}.{axes}".rstrip(".")
            found.append(MeasuredNumber(name, float(numbers[at]), half_width))
    return found


def _value(arm: Alpha5Parameters, key: list[str]) -> Any:
    """The value of a key; None if a printed number stands for it."""
    match key:
        case ["attached", name, field]:
            return _of_body(_body(arm, name), field)
        case ["lengths", "a_1"]:
            return arm.dh[1].a
        case ["zeros", joint]:
            return arm.dh[JOINT_NAMES.index(joint)].theta_offset
        case ["joint_limits", joint, limit]:
            return getattr(arm.joints[JOINT_NAMES.index(joint)], LIMIT_FIELDS[limit])
        case ["tool", field]:
            return _of_pose(tool_of(arm), field)
        case ["mount", field] if arm.mount is not None:
            return _of_pose(arm.mount, field)
        case ["motors", "supply_voltage"]:
            return arm.motors.supply_voltage
        case ["motors", drive, *joint] if drive in DRIVE_FIELDS:
            values = getattr(arm.motors, DRIVE_FIELDS[drive])
            return values[JOINT_NAMES.index(joint[0]) if joint else 0]
    return None


def _body(arm: Alpha5Parameters, name: str) -> Any:
    """An attached body."""
    return next(body for body in arm.attached if body.name == name)


def _of_body(body: Any, field: str) -> Any:
    """A value of an attached body."""
    if field in ("at", "rpy"):
        return _of_pose(body, "xyz" if field == "at" else field)
    return getattr(body, field)


def _of_pose(pose: Any, field: str) -> Any:
    """Position, or roll, pitch, yaw, of a tool, a mount or a body."""
    return pose.position if field == "xyz" else rpy_from_rotation(pose.rotation)


def with_changes(
    arm: Alpha5Parameters, changes: Mapping[str, float]
) -> Alpha5Parameters:
    """The arm with some of its `other_numbers` changed.

    Args:
        arm: The record.
        changes: Name -> what is added to the number.
    """
    whole: dict[str, FloatArray | float] = {}
    for name, change in changes.items():
        key, _, axes = name.rpartition(".")
        if key in half_widths(arm) and set(axes) <= {*"xyz"}:
            value = np.array(_value(arm, key.split(".")), float)
            array = np.asarray(whole.setdefault(key, np.zeros(value.shape)))
            at = tuple("xyz".index(axis) for axis in axes)
            array[at] = change
            array[at[::-1]] = change
        else:
            whole[name] = change
    for key, change_of_key in whole.items():
        arm = _changed(arm, key.split("."), change_of_key)
    return arm


def _changed(
    arm: Alpha5Parameters, key: list[str], change: FloatArray | float
) -> Alpha5Parameters:
    """The arm with the value of a key changed."""
    match key:
        case ["attached", name, field]:
            return _with_body(arm, name, field, change)
        case ["lengths", _]:
            return _with_row(arm, 1, "a", float(change))
        case ["zeros", joint]:
            row = JOINT_NAMES.index(joint)
            return _with_row(arm, row, "theta_offset", float(change))
        case ["joint_limits", joint, limit]:
            return _with_limit(arm, joint, LIMIT_FIELDS[limit], float(change))
        case ["tool", field]:
            return replace(arm, tool=_moved_pose(tool_of(arm), field, change))
        case ["mount", field]:
            return replace(arm, mount=_moved_pose(arm.mount, field, change))
        case _:
            return _with_motors(arm, key[1:], float(change))


def _with_body(
    arm: Alpha5Parameters, name: str, field: str, change: FloatArray | float
) -> Alpha5Parameters:
    """The arm with an attached body changed."""
    body = _body(arm, name)
    if field in ("at", "rpy"):
        new = _moved_pose(body, "xyz" if field == "at" else field, change)
    else:
        new = replace(body, **{field: getattr(body, field) + change})
    attached = tuple(new if one is body else one for one in arm.attached)
    tool = arm.tool
    if field == "spacer" and tool is not None:
        position = tool.position - np.array([0.0, 0.0, float(change)])
        tool = replace(tool, position=position)
    return replace(arm, attached=attached, tool=tool)


def _with_row(
    arm: Alpha5Parameters, row: int, field: str, change: float
) -> Alpha5Parameters:
    """The arm with a length or an angle of Table 1 changed."""
    rows = list(arm.dh)
    own: dict[str, Any] = {field: getattr(rows[row], field) + change}
    rows[row] = replace(rows[row], **own)
    return replace(arm, dh=tuple(rows))


def _with_limit(
    arm: Alpha5Parameters, joint: str, field: str, change: float
) -> Alpha5Parameters:
    """The arm with a limit changed."""
    joints = list(arm.joints)
    number = JOINT_NAMES.index(joint)
    own: dict[str, Any] = {field: getattr(joints[number], field) + change}
    joints[number] = replace(joints[number], **own)
    return replace(arm, joints=tuple(joints))


def _moved_pose(pose: Any, field: str, change: FloatArray | float) -> Any:
    """A tool, mount or body with its position, or roll, pitch, yaw, changed."""
    if field == "xyz":
        return replace(pose, position=pose.position + change)
    rpy = np.array(rpy_from_rotation(pose.rotation)) + change
    return replace(pose, rotation=rotation_from_rpy(rpy))


def _with_motors(
    arm: Alpha5Parameters, key: list[str], change: float
) -> Alpha5Parameters:
    """The arm with the supply or the drives of its motors changed."""
    motors = arm.motors
    if key == ["supply_voltage"]:
        supply = (motors.supply_voltage or 0.0) + change
        return replace(arm, motors=replace(motors, supply_voltage=supply))

    field = DRIVE_FIELDS[key[0]]
    values = list(getattr(motors, field))
    for number, value in enumerate(values):
        if value is not None and key[1:] in ([], [JOINT_NAMES[number]]):
            values[number] = value + change
    own: dict[str, Any] = {field: tuple(values)}
    return replace(arm, motors=replace(motors, **own))
