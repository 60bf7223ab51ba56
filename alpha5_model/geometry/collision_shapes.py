"""Collision bodies: primitives around the drawn bodies of each link. Lengths in mm."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import pose
from alpha5_model.geometry.dimensions import Dimensions, drawn_dimensions
from alpha5_model.geometry.drawing import frames_in_links
from alpha5_model.geometry.finger_part import ribbon
from alpha5_model.geometry.primitives import Primitive, box, box_around, cylinder
from alpha5_model.numbers.jaws import GRIPPERS, Jaws, split_link_4
from alpha5_model.numbers.parameters import parameters

#: Added to the boxes around curved outlines, which are known at stations only [mm].
_MARGIN = 0.1


@cache
def collision_primitives(
    gripper: str = "jaws", spacer: float = 0.0
) -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link of the published arm.

    Together they enclose the drawn body and stay within 3 mm of it. Bodies that turn
    against each other at a joint overlap, so leave adjacent pairs out
    (`alpha5_model.description.srdf`).

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in
            ``locked`` they belong to ``link_4``, closed.
        spacer: How far spacers move the jaws along -z of link_4 [m].

    Raises:
        UnknownNameError: Another gripper.
    """
    moving = choice("gripper", gripper, GRIPPERS) == "jaws"
    shapes = _shapes(drawn_dimensions())
    if not moving:
        shapes = _with_closed_fingers(shapes, split_link_4(parameters(())), spacer)
    return {
        link: tuple(shape.as_written() for shape in items)
        for link, items in shapes.items()
    }


def _shapes(dimensions: Dimensions) -> dict[str, list[Primitive]]:
    """Shapes of each link and finger, in its frame [mm]."""
    shell = _shell(dimensions)
    finger = _finger(dimensions)
    shapes = {
        "link_0": _base(dimensions),
        "link_1": shell,
        "link_2": _upper_arm(dimensions),
        "link_3": shell,
        "link_4": [_wrist(dimensions)],
        "finger_1": finger,
        "finger_2": finger,
    }
    for name, rows in frames_in_links(dimensions).items():
        frame = np.vstack([rows, [0.0, 0.0, 0.0, 1.0]])
        shapes[name] = [shape.moved(frame) for shape in shapes[name]]
    return shapes


def _with_closed_fingers(
    shapes: dict[str, list[Primitive]], jaws: Jaws, spacer: float
) -> dict[str, list[Primitive]]:
    """The shapes with those of the fingers in link 4, moved by a spacer [m]."""
    links = dict(shapes)
    for finger in (jaws.finger_1, jaws.finger_2):
        origin = finger.origin - [0.0, 0.0, spacer]
        closed = pose(origin * 1e3, (finger.roll, 0.0, 0.0))
        moved = [shape.moved(closed) for shape in links.pop(finger.name)]
        links["link_4"] = links["link_4"] + moved
    return links


def _slabs(
    heights: Iterable[float], radius: float
) -> Iterator[tuple[float, float, float]]:
    """Low, high, and half of the largest width between them of a circle."""
    for low, high in pairwise(heights):
        nearest = max(low, -high, 0.0)
        yield low, high, math.sqrt(radius**2 - nearest**2)


def _base(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.base
    radius = dimensions.radius
    neck = [
        box(
            low=(d.tube_front, -y, -z),
            high=(-1.5, y, min(z, d.hub_high)),
        )
        for y, z in d.neck
    ]
    half = d.foot_half_width
    return [
        cylinder(radius, low=d.cap, high=d.tube_front, axis="x"),
        cylinder(d.plug_radius, low=d.rear, high=d.cap, axis="x"),
        cylinder(1.6 * d.plug_radius, low=d.cap - 5.0, high=d.cap, axis="x"),
        cylinder(radius, low=d.hub_low, high=d.hub_high, axis="z"),
        *neck,
        box(
            low=(d.foot_rear, d.foot_face, -half),
            high=(d.foot_front, -8.0, half),
        ),
        box(
            low=(d.foot_front, d.foot_edge, -half),
            high=(d.foot_slope, -8.0, half),
        ),
        _slope_of_foot(dimensions),
    ]


def _slope_of_foot(dimensions: Dimensions) -> Primitive:
    """A box under the foot's sloped face."""
    d = dimensions.base
    depth = 7.0
    run = d.foot_slope - d.foot_front
    rise = d.foot_edge - d.foot_face
    angle = math.atan2(rise, run)
    x = d.foot_front + run / 2 - depth / 2 * math.sin(angle)
    y = d.foot_face + rise / 2 + depth / 2 * math.cos(angle)
    return Primitive(
        kind="box",
        size=(math.hypot(run, rise), depth, 2 * d.foot_half_width),
        xyz=(x, y, 0.0),
        rpy=(0.0, 0.0, angle),
    )


def _shell(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.shell
    radius = dimensions.radius
    collar_axis = (d.axes_apart, 0.0, 0.0)
    return [
        cylinder(radius, low=d.cheek_inner, high=d.cheek_outer, axis="z"),
        cylinder(radius, low=d.floor, high=d.collar_face, axis="y", at=collar_axis),
        *_half_shell(dimensions),
        *_sides_of_shell(dimensions),
    ]


#: y of the boxes beside link 2's barrel, up to the shell's floor.
_BESIDE_BARREL = (0.0, 9.7, 13.3, 16.8)


def _inner_x(dimensions: Dimensions, y: float) -> float:
    """x from which the shell closes round link 2's barrel at a y."""
    return math.sqrt((dimensions.radius + 0.5) ** 2 - y**2)


def _half_shell(dimensions: Dimensions) -> list[Primitive]:
    """Boxes around the half-shell, slab by slab up to its cut at 45 deg."""
    d = dimensions.shell
    inner = _inner_x(dimensions, _BESIDE_BARREL[1])
    boxes = []
    heights = sorted([*d.slabs, d.cheek_inner])
    for low, high, half in _slabs(heights, dimensions.radius):
        if high <= 0:
            near = inner
        elif low < d.cheek_inner:
            near = d.axes_apart + 0.5
        else:
            near = d.axes_apart - half
        far = d.axes_apart + half
        boxes.append(
            box(
                low=(near, d.mitre - high, low),
                high=(far, d.floor, high),
            )
        )
    return boxes


def _sides_of_shell(dimensions: Dimensions) -> list[Primitive]:
    """Boxes where the shell closes round link 2's barrel: at positive y."""
    d = dimensions.shell
    y_0, y_1, y_2, y_3 = _BESIDE_BARREL
    near_1 = _inner_x(dimensions, y_1)
    near_2 = _inner_x(dimensions, y_2)
    beside = d.axes_apart + 1.0
    top = d.cheek_inner
    return [
        box(
            low=(near_1, y_0, 0.0),
            high=(beside, y_1, top),
        ),
        box(
            low=(near_2, y_1, d.mitre - y_2),
            high=(beside, y_2, top),
        ),
        box(
            low=(d.inside, y_2, d.mitre - y_3),
            high=(beside, d.floor, top),
        ),
        box(
            low=(d.inside, y_3, -dimensions.radius),
            high=(beside, d.floor, d.mitre - y_3),
        ),
    ]


def _upper_arm(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.upper_arm
    start = _start_of_tube(dimensions)
    middle = (0.0, d.drop / 2, 0.0)
    tube = cylinder(
        dimensions.radius, low=start, high=d.reach - start, axis="x", at=middle
    )

    one_end = _end_of_upper_arm(dimensions)
    to_other_end = pose((d.reach, d.drop, 0.0), (0.0, 0.0, math.pi))
    other_end = [shape.moved(to_other_end) for shape in one_end]
    return [tube, *one_end, *other_end]


def _start_of_tube(dimensions: Dimensions) -> float:
    """x from which the upper arm's tube is whole."""
    d = dimensions.upper_arm
    return float(d.mitre + d.slabs[-1])


def _end_of_upper_arm(dimensions: Dimensions) -> list[Primitive]:
    """Barrel, tube up to its cut at 45 deg, slab by slab, and neck."""
    d = dimensions.upper_arm
    y = d.drop / 2
    far = _start_of_tube(dimensions) + 1.0
    shapes = [
        cylinder(dimensions.radius, low=d.barrel_low, high=d.barrel_high, axis="z")
    ]
    for low, high, half in _slabs(d.slabs, dimensions.radius):
        near = d.mitre + low
        shapes.append(
            box(
                low=(near, y - half, low),
                high=(far, y + half, high),
            )
        )

    end_of_neck = (d.mitre + d.barrel_high, d.neck, d.barrel_high)
    shapes.append(box(low=(14.0, 2.1, 3.0), high=end_of_neck))
    return shapes


def _wrist(dimensions: Dimensions) -> Primitive:
    d = dimensions.wrist
    end = dimensions.jaws.collar_base + d.collar_height
    return cylinder(dimensions.radius, low=-end, high=-d.tube_start, axis="z")


def _finger(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.finger
    half_thickness = dimensions.jaws.finger_width / 2
    shapes = [
        cylinder(d.lug_radius, low=-half_thickness, high=half_thickness, axis="z")
    ]
    for start, stop in pairwise(d.boxes):
        shapes.append(_box_of_blade(dimensions, start, stop, side=0.0))
    *tip_boxes, last_of_tip = d.tip_boxes
    for start, stop, side in tip_boxes:
        shapes.append(_box_of_blade(dimensions, start, stop, side))
    start, stop, side = last_of_tip
    along_y = np.array([0.0, 1.0])
    shapes.append(_box_of_blade(dimensions, start, stop, side, along_y))
    return shapes


def _box_of_blade(
    dimensions: Dimensions,
    start: float,
    stop: float,
    side: float,
    direction: FloatArray | None = None,
) -> Primitive:
    """A box around a piece of a finger's blade.

    Args:
        dimensions: Of the parts.
        start, stop: Shares of the centre line.
        side: Of the plane in which the jaws move: 1 above, -1 below, 0 both.
        direction: Of the box's long side, (2,); along the piece if None.
    """
    d = dimensions.finger
    jaws = dimensions.jaws
    # Near the tip, the half below the middle ends before the plane where fingers meet.
    meeting_x = jaws.pivot_offset + side * d.hook
    outline = ribbon(d, start, stop)
    outline = outline[outline[:, 0] < meeting_x + 2.0]
    outline = np.minimum(outline, (meeting_x, jaws.finger_length))

    half = _half_width(dimensions, outline)
    bottom = -0.2 if side > 0 else -half
    top = half if side >= 0 else 0.2
    if direction is None:
        direction = _along(outline)
    return box_around(outline, (bottom, top), direction, _MARGIN)


def _along(outline: FloatArray) -> FloatArray:
    """From the middle of a ribbon's start to the middle of its end, (2,)."""
    last = len(outline) // 2
    start = outline[[0, -1]].mean(0)
    end = outline[last - 1 : last + 1].mean(0)
    return np.asarray(end - start)


def _half_width(dimensions: Dimensions, outline: FloatArray) -> float:
    """Largest half width of the plate over an outline of the blade."""
    y, half_width = np.array(dimensions.finger.outline).T
    return float(np.interp(outline[:, 1], y, half_width).max())
