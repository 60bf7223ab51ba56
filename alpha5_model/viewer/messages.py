"""Checks of what pages and other programs send to the live viewer.

Each function takes a received message and returns its content, or raises an error. No
other part of the viewer reads input from outside.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import umsgpack  # type: ignore[import-untyped]

from alpha5_model._support.checks import FloatArray, choice, real, shaped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import InputError, JointLimitError
from alpha5_model.viewer.live_controls import Slider

#: Longest message with joint positions [characters].
_LONGEST_POSE = 4096
#: Most parts of the path of a node in the scene.
_DEEPEST_PATH = 64
#: Longest path of a node in the scene [bytes].
_LONGEST_PATH = 4096
#: How far beyond a limit rounding may put a joint [rad or m].
_ROUNDING = 1e-9
_DATA_URL = re.compile(r"data:image/\w+;base64,")


class SliderMove(NamedTuple):
    """Where a page has moved a slider of the program."""

    name: str
    value: float


def read_move(
    message: str | bytes, arm: Arm, sliders: Mapping[str, Slider]
) -> FloatArray | SliderMove:
    """Read what a page sends if something was moved.

    It is ``{"q": [...]}`` or ``{"slider": name, "value": number}``.

    Args:
        message: The page's message, unchecked.
        arm: The arm whose joints may have moved.
        sliders: The program's sliders.

    Returns:
        Positions within the limits, (n,) [rad, and m for axis_a], or the slider's.

    Raises:
        InputError: Not such a message (`ShapeError`, `NonFiniteError`,
            `UnknownNameError`).
        JointLimitError: A joint is beyond a limit.
    """
    expected = '{"q": [...]} or {"slider": name, "value": number} as text'
    if not isinstance(message, str):
        raise InputError("message", f"{len(message)} bytes", expected)
    if len(message) > _LONGEST_POSE:
        raise InputError("message", f"{len(message)} characters", expected)
    content = _json(message)
    if isinstance(content, dict) and set(content) == {"slider", "value"}:
        return _slider_move(content, sliders)
    if isinstance(content, dict) and set(content) == {"q"}:
        return _positions(content, arm)
    raise InputError("message", message, expected)


def _slider_move(
    content: Mapping[str, Any], sliders: Mapping[str, Slider]
) -> SliderMove:
    name = choice("slider", content["slider"], tuple(sliders))
    moved = sliders[name]
    value = real("value", content["value"])
    if not moved.low <= value <= moved.high:
        expected = f"a number from {moved.low:g} to {moved.high:g}"
        raise InputError("value", value, expected)
    return SliderMove(name=name, value=value)


def _positions(content: Mapping[str, Any], arm: Arm) -> FloatArray:
    """Joint positions within the limits, (n,)."""
    names = arm.joint_names
    limits = arm.limits
    joints = shaped("q", content["q"], (len(names),))
    inside = np.clip(joints, limits.lower, limits.upper)
    for name, value, bound in zip(names, joints, inside, strict=True):
        if abs(value - bound) > _ROUNDING:
            unit = "m" if name == "axis_a" else "rad"
            raise JointLimitError(name, float(value), float(bound), unit)
    return inside


def read_picture(message: str) -> bytes:
    """Read the picture that a page sends, as the bytes of an image file.

    Raises:
        InputError: Not such a message.
    """
    content = _json(message)
    address = content.get("data")
    start = _DATA_URL.match(address) if isinstance(address, str) else None
    try:
        if start is None:
            raise ValueError
        return base64.b64decode(address[start.end() :], validate=True)
    except ValueError:
        raise InputError("data", address, "a picture as a data URL") from None


def read_command(kind: bytes, path: bytes, data: bytes) -> list[str]:
    """Check that pages will read a command of meshcat's protocol as it is meant.

    Args:
        kind: Its name, such as ``set_transform``.
        path: Path of a node in the scene.
        data: Name, path and all else in MessagePack.

    Returns:
        The parts of the path.

    Raises:
        InputError: Pages could not read the command, or would read it as another one.
    """
    parts = _node(path)
    try:
        content = umsgpack.unpackb(data)
    # umsgpack raises many errors of its own, NumPy's and Python's.
    except Exception:
        content = None
    if not isinstance(content, dict) or content.get("type") != kind.decode():
        raise InputError("data", data[:40], f"{kind.decode()} in MessagePack")

    inside = content.get("path", "")
    if not isinstance(inside, str) or path_parts(inside) != parts:
        raise InputError("path in the data", inside, f"{path.decode()!r}, as beside it")
    return parts


def path_parts(path: str) -> list[str]:
    """The names of the nodes along a path of meshcat's scene tree."""
    return [part for part in path.split("/") if part]


def _node(path: bytes) -> list[str]:
    """The parts of a path from another program, which must be short and in UTF-8."""
    if len(path) > _LONGEST_PATH:
        raise InputError("path", f"{len(path)} bytes", f"at most {_LONGEST_PATH}")
    try:
        parts = path_parts(path.decode())
    except UnicodeDecodeError:
        raise InputError("path", path, "UTF-8") from None
    if len(parts) > _DEEPEST_PATH:
        raise InputError("path", f"{len(parts)} parts", f"at most {_DEEPEST_PATH}")
    return parts


def _json(message: str) -> Any:
    try:
        return json.loads(message)
    except (ValueError, RecursionError):
        raise InputError("message", message, "JSON") from None
