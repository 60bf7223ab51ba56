"""The shapes that URDF knows, and how they are placed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from alpha5_model.checks import FloatArray
from alpha5_model.spatial import Triple, pose, rpy_from_rotation

_TO_X: Triple = (0.0, math.pi / 2, 0.0)
_TO_Y: Triple = (-math.pi / 2, 0.0, 0.0)


@dataclass(frozen=True)
class Primitive:
    """One collision shape in its link's frame.

    Attributes:
        kind: ``box``, ``cylinder`` (along its own z) or ``sphere``.
        size: Edges x, y, z; radius and length; or radius [m].
        xyz: Its centre [m].
        rpy: Fixed-axis roll, pitch, yaw [rad].
    """

    kind: str
    size: tuple[float, ...]
    xyz: Triple
    rpy: Triple


def cylinder(
    radius: float, low: float, high: float, axis: str, at: Triple = (0.0, 0.0, 0.0)
) -> Primitive:
    """A cylinder between two heights along x, y or z through a point."""
    middle = (low + high) / 2
    step = {"x": (middle, 0.0, 0.0), "y": (0.0, middle, 0.0), "z": (0.0, 0.0, middle)}[axis]
    turn = {"x": _TO_X, "y": _TO_Y, "z": (0.0, 0.0, 0.0)}[axis]
    x, y, z = (float(a + s) for a, s in zip(at, step, strict=True))
    return Primitive("cylinder", (float(radius), float(high - low)), (x, y, z), turn)


def box(low: Triple, high: Triple) -> Primitive:
    """A box between two corners."""
    size = tuple(float(b - a) for a, b in zip(low, high, strict=True))
    x, y, z = (float(a + b) / 2 for a, b in zip(low, high, strict=True))
    return Primitive("box", size, (x, y, z), (0.0, 0.0, 0.0))


def in_metres(shape: Primitive) -> Primitive:
    """Millimetres to metres."""
    x, y, z = (c * 1e-3 for c in shape.xyz)
    return Primitive(shape.kind, tuple(s * 1e-3 for s in shape.size), (x, y, z), shape.rpy)


def rounded(shape: Primitive) -> Primitive:
    """To a nanometre and 1e-12 rad, so that the text of a URDF does not show the last bits of a sine."""
    x, y, z = (round(c, 9) + 0.0 for c in shape.xyz)
    roll, pitch, yaw = (round(a, 12) + 0.0 for a in shape.rpy)
    size = tuple(round(s, 9) for s in shape.size)
    return Primitive(shape.kind, size, (x, y, z), (roll, pitch, yaw))


def moved(shape: Primitive, frame: FloatArray) -> Primitive:
    """The shape in another frame; ``frame``, (3, 4) or (4, 4), maps its coordinates to that one."""
    placed = frame[:3] @ pose(shape.xyz, shape.rpy)
    x, y, z = map(float, placed[:3, 3])
    return Primitive(shape.kind, shape.size, (x, y, z), rpy_from_rotation(placed[:3, :3]))
