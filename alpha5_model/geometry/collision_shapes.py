"""Collision bodies: the primitives that URDF knows, around the drawn bodies of each link."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import Triple, pose, rpy_from_rotation
from alpha5_model.geometry import parts as meshing
from alpha5_model.geometry.parts import (
    BASE,
    FINGER,
    JAWS,
    RADIUS,
    SHELL,
    UPPER_ARM,
    WRIST,
    ribbon,
)
from alpha5_model.geometry.solid import AXES
from alpha5_model.numbers.jaws import GRIPPERS, split_link_4
from alpha5_model.numbers.parameters import parameters

#: Added to the boxes around curved outlines, which are known at stations only [mm].
_MARGIN = 0.1


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
    xyz: tuple[float, ...]
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)


@cache
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
    moving = choice("gripper", gripper, GRIPPERS) == "jaws"
    shell, blade, jaws = _shell(), _finger(), split_link_4(parameters(()))
    end = JAWS.collar_base + WRIST.collar_height
    wrist = [_cylinder(RADIUS, -end, -WRIST.tube_start, "z")]
    shapes = {
        "link_0": _base(),
        "link_1": shell,
        "link_2": _upper_arm(),
        "link_3": shell,
    }
    shapes |= {"link_4": wrist, "finger_1": blade, "finger_2": blade}
    for name, frame in meshing.frames_in_links().items():
        shapes[name] = [_moved(shape, frame) for shape in shapes[name]]
    for finger in () if moving else (jaws.finger_1, jaws.finger_2):
        closed = pose(finger.origin * 1e3, (finger.roll, 0.0, 0.0))
        wrist += [_moved(shape, closed) for shape in shapes.pop(finger.name)]
    return {link: tuple(map(_as_written, items)) for link, items in shapes.items()}


def _moved(shape: Primitive, frame: FloatArray) -> Primitive:
    """The shape in another frame; ``frame``, (3, 4) or (4, 4), maps its coordinates to that one."""
    placed = frame[:3] @ pose(shape.xyz, shape.rpy)
    xyz = tuple(placed[:3, 3].tolist())
    return Primitive(shape.kind, shape.size, xyz, rpy_from_rotation(placed[:3, :3]))


def _as_written(shape: Primitive) -> Primitive:
    """In metres, to a nanometre and 1e-12 rad: a URDF does not show the last bits of a sine."""
    size, xyz = (
        tuple(round(c * 1e-3, 9) + 0.0 for c in mm) for mm in (shape.size, shape.xyz)
    )
    return Primitive(
        shape.kind, size, xyz, tuple(round(a, 12) + 0.0 for a in shape.rpy)
    )


def _cylinder(
    r: float, low: float, high: float, axis: str, at: Triple = (0, 0, 0)
) -> Primitive:
    """A cylinder between two heights along x, y or z through a point."""
    xyz = tuple(
        a + (low + high) / 2 * (n == axis) for a, n in zip(at, "xyz", strict=True)
    )
    return Primitive(
        "cylinder", (r, high - low), xyz, tuple(np.radians(AXES[axis]).tolist())
    )


def _box(low: Triple, high: Triple) -> Primitive:
    """A box between two corners."""
    ends = list(zip(low, high, strict=True))
    return Primitive(
        "box", tuple(b - a for a, b in ends), tuple((a + b) / 2 for a, b in ends)
    )


def _slabs(heights: Iterable[float]) -> Iterator[tuple[float, float, float]]:
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
    return [
        _cylinder(RADIUS, d.cap, d.tube_front, "x"),
        _cylinder(d.plug_radius, d.rear, d.cap, "x"),
        _cylinder(1.6 * d.plug_radius, d.cap - 5.0, d.cap, "x"),
        _cylinder(RADIUS, d.hub_low, d.hub_high, "z"),
        *(
            _box((d.tube_front, -y, -z), (-1.5, y, min(z, d.hub_high)))
            for y, z in d.neck
        ),
        _box((d.foot_rear, d.foot_face, -half), (d.foot_front, -8.0, half)),
        _box((d.foot_front, d.foot_edge, -half), (d.foot_slope, -8.0, half)),
        Primitive("box", (slope, depth, 2 * half), (x, y, 0.0), (0.0, 0.0, angle)),
    ]


def _shell() -> list[Primitive]:
    d, y = SHELL, (0.0, 9.7, 13.3, 16.8, SHELL.floor)
    # It closes round link 2's barrel where y is positive.
    inner = [math.sqrt((RADIUS + 0.5) ** 2 - b**2) for b in y[1:3]]
    slabs = []
    for low, high, half in _slabs(sorted([*d.slabs, d.cheek_inner])):
        near = (
            inner[0]
            if high <= 0
            else d.axes_apart + (0.5 if low < d.cheek_inner else -half)
        )
        slabs.append(
            _box((near, d.mitre - high, low), (d.axes_apart + half, d.floor, high))
        )
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
    middle, start = d.drop / 2, d.mitre + d.slabs[-1]
    near = [_cylinder(RADIUS, d.barrel_low, d.barrel_high, "z")]
    for low, high, half in _slabs(d.slabs):
        near.append(
            _box(
                (d.mitre + low, middle - half, low), (start + 1.0, middle + half, high)
            )
        )
    near.append(
        _box((14.0, 2.1, 3.0), (d.mitre + d.barrel_high, d.neck, d.barrel_high))
    )
    opposite = pose((d.reach, d.drop, 0.0), (0.0, 0.0, math.pi))
    tube = _cylinder(RADIUS, start, d.reach - start, "x", (0.0, middle, 0.0))
    return [tube, *near, *(_moved(shape, opposite) for shape in near)]


def _finger() -> list[Primitive]:
    thick, limits = JAWS.finger_width / 2, (JAWS.pivot_offset, JAWS.finger_length)
    shapes = [_cylinder(FINGER.lug_radius, -thick, thick, "z")]
    pieces = [
        *((start, stop, 0.0) for start, stop in pairwise(FINGER.boxes)),
        *FINGER.tip_boxes,
    ]
    for start, stop, side in pieces:
        # Near the tip, the half below the middle stops short of the plane where the fingers meet.
        outline, limit = ribbon(start, stop), np.add(limits, (side * FINGER.hook, 0.0))
        outline = np.minimum(outline[outline[:, 0] < limit[0] + 2.0], limit)
        half = float(np.interp(outline[:, 1], *np.array(FINGER.outline).T).max())
        span = (-0.2 if side > 0 else -half, half if side >= 0 else 0.2)
        last = len(outline) // 2
        ends = outline[last - 1 : last + 1].mean(0) - outline[[0, -1]].mean(0)
        tip = (start, stop, side) == tuple(FINGER.tip_boxes[-1])
        shapes.append(_around(outline, span, np.array([0.0, 1.0]) if tip else ends))
    return shapes


def _around(
    outline: FloatArray, span: tuple[float, float], direction: FloatArray
) -> Primitive:
    """Box around an outline in the x-y plane, its long side in a given direction."""
    along = direction / np.linalg.norm(direction)
    axes = np.array([along, [-along[1], along[0]]])
    low, high = (outline @ axes.T).min(0) - _MARGIN, (outline @ axes.T).max(0) + _MARGIN
    size = (*(high - low).tolist(), span[1] - span[0])
    xyz = (*((low + high) / 2 @ axes).tolist(), (span[0] + span[1]) / 2)
    return Primitive("box", size, xyz, (0.0, 0.0, math.atan2(along[1], along[0])))
