"""Collision bodies: the primitives that URDF knows, around the drawn bodies of each link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray, choice
from alpha5_model.jaws import GRIPPERS, split_link_4
from alpha5_model.meshing.dimensions import BASE, FINGER, JAWS, RADIUS, SHELL, UPPER_ARM, WRIST
from alpha5_model.meshing.parts import STATIONS, frames_in_links, ribbon
from alpha5_model.parameters import parameters
from alpha5_model.spatial import Triple, pose, rpy_from_rotation

#: Added to the boxes around curved outlines, which are known at stations only [mm].
_MARGIN = 0.1
#: Roll, pitch, yaw that turn z to an axis.
_TO: dict[str, Triple] = {
    "x": (0.0, math.pi / 2, 0.0),
    "y": (-math.pi / 2, 0.0, 0.0),
    "z": (0.0, 0.0, 0.0),
}


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
    rpy: Triple = (0.0, 0.0, 0.0)


def collision_primitives(gripper: str = "jaws") -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link.

    Together they enclose the drawn body and stay within 3 mm of it; bodies that turn against each
    other at a joint overlap, so adjacent pairs are to be left out (`alpha5_model.description.srdf`).

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in ``locked`` they
            belong to ``link_4``, closed.

    Raises:
        UnknownNameError: Another gripper.
    """
    shapes = dict(_in_links())
    if choice("gripper", gripper, GRIPPERS) == "locked":
        jaws = split_link_4(parameters(()))
        for finger in (jaws.finger_1, jaws.finger_2):
            closed = pose(finger.origin * 1e3, (finger.roll, 0.0, 0.0))
            shapes["link_4"] += tuple(_moved(s, closed) for s in shapes.pop(finger.name))
    return {link: tuple(map(_as_written, items)) for link, items in shapes.items()}


@cache
def _in_links() -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link, the fingers as links of their own, in mm."""
    shell, finger, frames = _shell(), _finger(), frames_in_links()
    parts = {
        "link_0": _base(),
        "link_1": shell,
        "link_2": _upper_arm(),
        "link_3": shell,
        "link_4": _wrist(),
        "finger_1": finger,
        "finger_2": finger,
    }
    return {
        name: tuple(_moved(s, frames[name]) if name in frames else s for s in shapes)
        for name, shapes in parts.items()
    }


def _moved(shape: Primitive, frame: FloatArray) -> Primitive:
    """The shape in another frame; ``frame``, (3, 4) or (4, 4), maps its coordinates to that one."""
    placed = frame[:3] @ pose(shape.xyz, shape.rpy)
    x, y, z = map(float, placed[:3, 3])
    return Primitive(shape.kind, shape.size, (x, y, z), rpy_from_rotation(placed[:3, :3]))


def _as_written(shape: Primitive) -> Primitive:
    """In metres, to a nanometre and 1e-12 rad: a URDF does not show the last bits of a sine."""
    x, y, z = (round(c * 1e-3, 9) + 0.0 for c in shape.xyz)
    roll, pitch, yaw = (round(a, 12) + 0.0 for a in shape.rpy)
    size = tuple(round(s * 1e-3, 9) for s in shape.size)
    return Primitive(shape.kind, size, (x, y, z), (roll, pitch, yaw))


def _cylinder(
    radius: float, low: float, high: float, axis: str, at: Triple = (0.0, 0.0, 0.0)
) -> Primitive:
    """A cylinder between two heights along x, y or z through a point."""
    x, y, z = (a + (low + high) / 2 * (n == axis) for a, n in zip(at, "xyz", strict=True))
    return Primitive("cylinder", (radius, high - low), (x, y, z), _TO[axis])


def _box(low: Triple, high: Triple) -> Primitive:
    """A box between two corners."""
    x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
    return Primitive("box", tuple(b - a for a, b in zip(low, high, strict=True)), (x, y, z))


def _base() -> list[Primitive]:
    d = BASE
    run, rise, depth = d.foot_slope - d.foot_front, d.foot_edge - d.foot_face, 7.0
    slope, angle = math.hypot(run, rise), math.atan2(rise, run)
    x = d.foot_front + run / 2 - depth / 2 * math.sin(angle)
    y = d.foot_face + rise / 2 + depth / 2 * math.cos(angle)
    half = d.foot_half_width
    neck = (d.neck_half_width, d.neck_half_height)
    return [
        _cylinder(RADIUS, d.rear, d.tube_front, "x"),
        _cylinder(RADIUS, d.hub_low, d.hub_high, "z"),
        _box((d.tube_front, -neck[0], -neck[1]), (-8.0, *neck)),
        _box((d.rear, d.foot_face, -half), (d.foot_front, -8.0, half)),
        _box((d.foot_front, d.foot_edge, -half), (d.foot_slope, -8.0, half)),
        Primitive("box", (slope, depth, 2 * half), (x, y, 0.0), (0.0, 0.0, angle)),
    ]


def _shell() -> list[Primitive]:
    d = SHELL
    # The half-shell's wall as staves, side by side around the collar's axis.
    wall, count, opening = 10.0, 6, math.radians(176.0)
    turn = opening / count
    inner, outer = (RADIUS - wall) * math.cos(turn / 2), RADIUS
    middle, width = (inner + outer) / 2, 2 * outer * math.tan(turn / 2)
    staves = []
    for i in range(count):
        angle = (i + 0.5) * turn - opening / 2  # from +x of the shell towards +z
        x, z = d.axes_apart + middle * math.cos(angle), middle * math.sin(angle)
        size = (outer - inner, d.floor - d.rim, width)
        staves.append(Primitive("box", size, (x, (d.floor + d.rim) / 2, z), (0.0, -angle, 0.0)))
    return [
        _cylinder(RADIUS, d.cheek_inner, d.cheek_outer, "z"),
        _cylinder(RADIUS, d.floor, d.collar_face, "y", (d.axes_apart, 0.0, 0.0)),
        _box((5.5, d.rim, d.cheek_inner), (d.axes_apart + 1.0, d.floor, d.cheek_outer)),
        *staves,
    ]


def _upper_arm() -> list[Primitive]:
    d = UPPER_ARM
    middle, start = d.drop / 2, d.tube_start - 1.5
    near = [
        _cylinder(RADIUS, d.barrel_low, d.barrel_high, "z"),
        _box((11.0, 4.0, -19.0), (start, d.neck, d.barrel_high)),
        _box((15.0, 11.5, d.barrel_high), (start, d.neck, 19.0)),
    ]
    opposite = pose((d.reach, d.drop, 0.0), (0.0, 0.0, math.pi))
    return [
        _cylinder(RADIUS, start, d.reach - start, "x", (0.0, middle, 0.0)),
        *near,
        *(_moved(shape, opposite) for shape in near),
    ]


def _wrist() -> list[Primitive]:
    end = JAWS["collar_base"] + WRIST.collar_height
    return [_cylinder(RADIUS, -end, -WRIST.tube_start, "z")]


def _finger() -> list[Primitive]:
    thick, middle = JAWS["finger_width"] / 2, JAWS["pivot_offset"]
    hook, length = FINGER.hook, JAWS["finger_length"]
    whole, low, high = (-thick, thick), (-thick, 0.2), (0.0, thick)
    shapes = [_cylinder(FINGER.lug_radius, -thick, thick, "z")]
    # Near the tip, the half below the middle stops short of the plane where the fingers meet.
    for start, stop, span, limit in (
        (0.0, 0.2, whole, middle),
        (0.2, 0.4, whole, middle),
        (0.4, 0.6, whole, middle),
        (0.6, 0.78, whole, middle),
        (0.78, 1.0, high, middle + hook),
        (0.78, 0.87, low, middle - hook),
        (0.87, 0.95, low, middle - hook),
    ):
        outline = np.minimum(ribbon(start, stop), [limit, length])
        ends = outline[[STATIONS - 1, STATIONS]].mean(0) - outline[[0, -1]].mean(0)
        shapes.append(_around(outline, span, ends))
    rest = ribbon(0.94, 1.0)
    rest = np.minimum(rest[rest[:, 0] < middle - hook + 2.0], [middle - hook, length])
    shapes.append(_around(rest, low, np.array([0.0, 1.0])))
    return shapes


def _around(outline: FloatArray, span: tuple[float, float], direction: FloatArray) -> Primitive:
    """Box around an outline in the x-y plane, its long side in a given direction."""
    along = direction / np.linalg.norm(direction)
    axes = np.array([along, [-along[1], along[0]]])
    low, high = (outline @ axes.T).min(0) - _MARGIN, (outline @ axes.T).max(0) + _MARGIN
    x, y = map(float, (low + high) / 2 @ axes)
    size = (*(high - low).tolist(), span[1] - span[0])
    angle = math.atan2(along[1], along[0])
    return Primitive("box", size, (x, y, (span[0] + span[1]) / 2), (0.0, 0.0, angle))
