"""Collision bodies: the primitives that URDF knows, around the drawn bodies of each link."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

from alpha5_model.checks import FloatArray, choice
from alpha5_model.jaws import GRIPPERS, split_link_4
from alpha5_model.meshing.dimensions import BASE, FINGER, JAWS, RADIUS, SHELL, UPPER_ARM, WRIST
from alpha5_model.meshing.parts import frames_in_links, ribbon
from alpha5_model.parameters import parameters
from alpha5_model.spatial import Triple, pose, rpy_from_rotation

#: Added to the boxes around curved outlines, which are known at stations only [mm].
_MARGIN = 0.1
#: Heights of the slabs around an end that is cut at 45 deg [mm].
_TUBE_SLABS = (-20.0, -17.9, -15.0, -11.5, -7.8, -4.0, 0.0, 4.0, 7.7, 11.0, 13.6, 15.8)
_SHELL_SLABS = (
    -20.0,
    -18.5,
    -16.2,
    -13.4,
    -10.2,
    -6.8,
    -3.8,
    -1.6,
    0.0,
    4.1,
    8.2,
    11.6,
    SHELL.cheek_inner,
    17.6,
    20.0,
)
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


def _slabs(heights: Sequence[float]) -> Iterator[tuple[float, float, float]]:
    """Low, high, and half of the largest width between them of a circle of `RADIUS`."""
    for low, high in pairwise(heights):
        yield low, high, math.sqrt(RADIUS**2 - max(low, -high, 0.0) ** 2)


def _base() -> list[Primitive]:
    d = BASE
    run, rise, depth = d.foot_slope - d.foot_front, d.foot_edge - d.foot_face, 7.0
    slope, angle = math.hypot(run, rise), math.atan2(rise, run)
    x = d.foot_front + run / 2 - depth / 2 * math.sin(angle)
    y = d.foot_face + rise / 2 + depth / 2 * math.cos(angle)
    half = d.foot_half_width
    # The tube goes on to the hub below the latter's face.
    neck = [(20.0, 9.2), (17.9, 13.3), (15.2, 16.9), (10.7, 19.85)]
    return [
        _cylinder(RADIUS, d.cap, d.tube_front, "x"),
        _cylinder(d.plug_radius, d.rear, d.cap, "x"),
        _cylinder(1.6 * d.plug_radius, d.cap - 5.0, d.cap, "x"),
        _cylinder(RADIUS, d.hub_low, d.hub_high, "z"),
        *(_box((d.tube_front, -y, -z), (-1.5, y, min(z, d.hub_high))) for y, z in neck),
        _box((d.foot_rear, d.foot_face, -half), (d.foot_front, -8.0, half)),
        _box((d.foot_front, d.foot_edge, -half), (d.foot_slope, -8.0, half)),
        Primitive("box", (slope, depth, 2 * half), (x, y, 0.0), (0.0, 0.0, angle)),
    ]


def _shell() -> list[Primitive]:
    d, y = SHELL, (0.0, 9.7, 13.3, 16.8, SHELL.floor)
    # It closes round link 2's barrel where y is positive.
    inner = [math.sqrt((RADIUS + 0.5) ** 2 - b**2) for b in y[1:3]]
    slabs = []
    for low, high, half in _slabs(_SHELL_SLABS):
        near = inner[0] if high <= 0 else d.axes_apart + (0.5 if low < d.cheek_inner else -half)
        slabs.append(_box((near, d.mitre - high, low), (d.axes_apart + half, d.floor, high)))
    beside, top = d.axes_apart + 1.0, d.cheek_inner
    return [
        _cylinder(RADIUS, d.cheek_inner, d.cheek_outer, "z"),
        _cylinder(RADIUS, d.floor, d.collar_face, "y", (d.axes_apart, 0.0, 0.0)),
        *slabs,
        _box((inner[0], y[0], 0.0), (beside, y[1], top)),
        _box((inner[1], y[1], d.mitre - y[2]), (beside, y[2], top)),
        _box((d.inside, y[2], d.mitre - y[3]), (beside, y[4], top)),
        _box((d.inside, y[3], -RADIUS), (beside, y[4], d.mitre - y[3])),
    ]


def _upper_arm() -> list[Primitive]:
    d = UPPER_ARM
    middle, start = d.drop / 2, d.mitre + _TUBE_SLABS[-1]
    near = [
        _cylinder(RADIUS, d.barrel_low, d.barrel_high, "z"),
        *(
            _box((d.mitre + low, middle - half, low), (start + 1.0, middle + half, high))
            for low, high, half in _slabs(_TUBE_SLABS)
        ),
        _box((14.0, 2.1, 3.0), (d.mitre + d.barrel_high, d.neck, d.barrel_high)),
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
    shapes = [_cylinder(FINGER.lug_radius, -thick, thick, "z")]
    steps = (0.0, 0.092, 0.108, 0.124, 0.28, 0.4, 0.5, 0.6, 0.7, 0.78)
    pieces = [(start, stop, 0) for start, stop in pairwise(steps)]
    pieces += [(0.78, 0.89, 1), (0.89, 1.0, 1), (0.78, 0.87, -1), (0.87, 0.95, -1), (0.94, 1.0, -1)]
    for start, stop, side in pieces:
        # Near the tip, the half below the middle stops short of the plane where the fingers meet.
        outline, limit = ribbon(start, stop), middle + side * hook
        outline = np.minimum(outline[outline[:, 0] < limit + 2.0], [limit, length])
        half = float(np.interp(outline[:, 1], *np.array(FINGER.outline).T).max())
        span = (-0.2 if side > 0 else -half, half if side >= 0 else 0.2)
        last = len(outline) // 2
        ends = outline[last - 1 : last + 1].mean(0) - outline[[0, -1]].mean(0)
        tip = (start, side) == (0.94, -1)
        shapes.append(_around(outline, span, np.array([0.0, 1.0]) if tip else ends))
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
