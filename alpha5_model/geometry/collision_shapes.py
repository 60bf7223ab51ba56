"""Collision bodies: primitives around the drawn bodies of each link. Lengths in mm."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import Triple, pose
from alpha5_model.geometry.dimensions import Dimensions, drawn_dimensions
from alpha5_model.geometry.drawing import frames_in_links
from alpha5_model.geometry.finger_part import ribbon
from alpha5_model.geometry.parts import tube_axis_of_base
from alpha5_model.geometry.primitives import Primitive, box, box_around, cylinder
from alpha5_model.numbers.jaws import GRIPPERS, split_link_4
from alpha5_model.numbers.parameters import parameters

#: Added to the boxes around curved outlines, which are known at stations only [mm].
_MARGIN = 0.1


@cache
def collision_primitives(
    gripper: str = "jaws", spacer: float = 0.0
) -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link of the published arm.

    Together they enclose the drawn body and stay within 3 mm of it. Links 1 and 3 also
    fill the room in which link 2's barrels turn, where no other body fits. The package
    compares these shapes. Other programs get the fewer ones of
    `alpha5_model.geometry.exported_shapes`. Bodies that turn against each other at a
    joint overlap, so leave adjacent pairs out (`alpha5_model.description.srdf`).

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in
            ``locked`` they belong to ``link_4``, closed.
        spacer: How far spacers move the jaws along -z of link_4 [m].

    Raises:
        UnknownNameError: Another gripper.
    """
    return with_gripper(_shapes(drawn_dimensions()), gripper, spacer)


def with_gripper(
    shapes: dict[str, list[Primitive]], gripper: str, spacer: float
) -> dict[str, tuple[Primitive, ...]]:
    """The shapes [mm] of an arm with a gripper, as files have them.

    Args:
        shapes: Of each link and finger, in its frame [mm].
        gripper, spacer: As of `collision_primitives`.

    Raises:
        UnknownNameError: Another gripper.
    """
    if choice("gripper", gripper, GRIPPERS) == "locked":
        shapes = _with_closed_fingers(shapes, spacer)
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
    shapes: dict[str, list[Primitive]], spacer: float
) -> dict[str, list[Primitive]]:
    """The shapes [mm] with those of the fingers in link 4, closed.

    Args:
        shapes: Of each link and finger, in its frame [mm].
        spacer: How far spacers move the jaws along -z of link_4 [m].
    """
    jaws = split_link_4(parameters(()))
    links = dict(shapes)
    for finger in (jaws.finger_1, jaws.finger_2):
        origin = finger.origin - [0.0, 0.0, spacer]
        closed = pose(origin * 1e3, (finger.roll, 0.0, 0.0))
        moved = [shape.moved(closed) for shape in links.pop(finger.name)]
        links["link_4"] = links["link_4"] + moved
    return links


def _base(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.base
    radius = dimensions.radius
    at = (0.0, tube_axis_of_base(dimensions), 0.0)
    return [
        cylinder(radius, low=d.cap, high=d.tube_front, axis="x", at=at),
        cylinder(d.plug_radius, low=d.rear, high=d.cap, axis="x", at=at),
        *_hub(dimensions),
        *_neck_of_base(dimensions),
    ]


def _hub(dimensions: Dimensions) -> list[Primitive]:
    """Cylinders around the hub, the lower ones around its rounded end."""
    d = dimensions.base
    radius = dimensions.radius
    round_from = d.hub_low + d.hub_edge
    shapes = []
    for low, high in pairwise([*d.hub_slabs, d.hub_high]):
        inwards = max(round_from - high, 0.0)
        across = math.sqrt(d.hub_edge**2 - inwards**2)
        shapes.append(
            cylinder(radius - d.hub_edge + across, low=low, high=high, axis="z")
        )
    return shapes


def _neck_of_base(dimensions: Dimensions) -> list[Primitive]:
    """Boxes along the neck, which rises from the tube's axis to the hub's."""
    d = dimensions.base
    rise = tube_axis_of_base(dimensions) / d.tube_front
    along = pose((0.0, 0.0, 0.0), (0.0, 0.0, math.atan(rise)))
    slant = math.hypot(1.0, rise)
    boxes = []
    for y, z in d.neck:
        straight = box(
            low=(slant * d.tube_front - 4.0, -y / slant, -z),
            high=(-1.5, y / slant, min(z, d.hub_high)),
        )
        boxes.append(straight.moved(along))
    return boxes


def _round_end(
    dimensions: Dimensions, tip: float, axis: str, at: Triple
) -> list[Primitive]:
    """Cylinders around half a ball, which ends a tube along an axis at a tip."""
    radius = dimensions.radius
    shapes = []
    for low, high in pairwise(dimensions.end_slabs):
        across = math.sqrt(radius**2 - (radius - high) ** 2)
        shapes.append(
            cylinder(across, low=tip + low, high=tip + high, axis=axis, at=at)
        )
    return shapes


def _shell(dimensions: Dimensions) -> list[Primitive]:
    """Cheek and collar; they also fill the room in which link 2's barrel turns."""
    d = dimensions.shell
    radius = dimensions.radius
    collar_axis = (d.axes_apart, 0.0, 0.0)
    start = d.tip + dimensions.end_slabs[-1]
    return [
        cylinder(radius, low=d.cheek_inner, high=d.cheek_outer, axis="z"),
        cylinder(radius, low=start, high=d.collar_face, axis="y", at=collar_axis),
        *_round_end(dimensions, d.tip, axis="y", at=collar_axis),
    ]


def _upper_arm(dimensions: Dimensions) -> list[Primitive]:
    d = dimensions.upper_arm
    radius = dimensions.radius
    start = d.tip + dimensions.end_slabs[-1]
    middle = (0.0, d.drop / 2, 0.0)
    tube = cylinder(radius, low=start, high=d.reach - start, axis="x", at=middle)

    one_end = [
        cylinder(radius, low=d.barrel_low, high=d.barrel_high, axis="z"),
        *_round_end(dimensions, d.tip, axis="x", at=middle),
    ]
    to_other_end = pose((d.reach, d.drop, 0.0), (0.0, 0.0, math.pi))
    other_end = [shape.moved(to_other_end) for shape in one_end]
    return [tube, *one_end, *other_end]


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
