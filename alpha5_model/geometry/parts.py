"""The drawn parts of the arm. Lengths in mm.

Each part has one free dimension. It is solved for so that the part has the volume
that Table 3 prints (`alpha5_model.geometry.drawing`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

from alpha5_model.geometry.dimensions import Dimensions
from alpha5_model.geometry.solid import (
    Groove,
    Solid,
    box,
    circle_of,
    cylinder,
    prism,
    union,
)


class Part(NamedTuple):
    """A part with one free dimension.

    Attributes:
        outside: The part before its last recess is cut.
        cut: From the free dimension to the part.
    """

    outside: Solid
    cut: Callable[[float], Solid]


def _ring(middle: float) -> Groove:
    """A ring around a turned part."""
    return Groove(middle, width=1.6, depth=0.8)


# --- link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot


def base(dimensions: Dimensions) -> Part:
    """The base in link_0; free: the depth of the bore under link 1."""
    d = dimensions.base
    bolt = cylinder(1.4, low=d.hub_low - 1, high=d.hub_low + 1.6, segments=12)
    bolts = circle_of(bolt, 6, 10.5, 30.0)
    solids = [
        _hub(dimensions),
        _base_tube(dimensions),
        _base_neck(dimensions),
        *_cable_plug(d),
        _foot(d),
    ]
    outside = union(solids) - bolts

    def bored(depth: float) -> Solid:
        bore = cylinder(d.shaft_radius, low=d.hub_high - depth, high=d.hub_high + 1)
        return outside - bore.translate([0, d.shaft_offset, 0])

    return Part(outside=outside, cut=bored)


def _hub(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    return cylinder(
        dimensions.radius,
        low=d.hub_low,
        high=d.hub_high,
        edges=(d.hub_edge, 0.6),
        grooves=[_ring(d.hub_high - 4)],
    )


def _base_tube(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    return cylinder(
        dimensions.radius,
        low=d.cap,
        high=d.tube_front,
        axis="x",
        edges=(d.cap_edge, 0.8),
        grooves=[_ring(d.tube_front - 6.0), _ring(d.tube_front - 16.0)],
    )


def _base_neck(dimensions: Dimensions) -> Solid:
    """Between tube and hub, below link 1's collar."""
    d = dimensions.base
    neck = cylinder(dimensions.radius - 0.2, low=d.tube_front - 2, high=0.0, axis="x")
    return neck - box(
        low=(d.tube_front, -40, d.hub_high),
        high=(1, 40, 40),
    )


def _cable_plug(d: SimpleNamespace) -> tuple[Solid, Solid]:
    """The nut and the threaded plug in the middle of the cap."""
    nut = cylinder(
        1.6 * d.plug_radius,
        low=d.cap - 5,
        high=d.cap + 2,
        axis="x",
        edges=(0.8, 0),
        segments=6,
    )
    thread = [Groove(d.rear + x, width=2.0, depth=0.6) for x in (5.0, 8.0, 11.0)]
    plug = cylinder(
        d.plug_radius,
        low=d.rear,
        high=d.cap,
        axis="x",
        edges=(1.2, 0),
        grooves=thread,
    )
    return nut, plug


def _foot(d: SimpleNamespace) -> Solid:
    """A saddle under the tube, flat at y = foot_face, sloped towards the hub, bored."""
    outline = [
        (d.foot_rear, d.foot_face),
        (d.foot_front, d.foot_face),
        (d.foot_slope, d.foot_edge),
        (d.foot_slope, -8.0),
        (d.foot_rear, -8.0),
    ]
    foot = prism(outline, -d.foot_half_width, d.foot_half_width, edge=1.2)

    hole = cylinder(
        1.7, low=d.foot_face - 1, high=d.foot_face + 7, axis="y", segments=16
    )
    lengthwise = (d.foot_rear + 8.0, d.foot_front - 8.0)
    places = itertools.product(lengthwise, (-13.0, 13.0))
    return foot - union(hole.translate([x, 0, z]) for x, z in places)


# --- links 1 and 3: collar, mitred half-shell and cheek, drawn once in their own frame


def shell(dimensions: Dimensions) -> Part:
    """The shell in its own frame.

    Its free dimension is the radius of the half-shell's bore above its floor. The bore
    is parallel to the collar's axis.
    """
    d = dimensions.shell
    cheek = cylinder(
        dimensions.radius, low=d.cheek_inner, high=d.cheek_outer, edges=(0, 1.2)
    )
    bolt = cylinder(1.4, low=d.cheek_outer - 1.6, high=40, segments=12)
    bolts = circle_of(bolt, 6, 14.0)
    ring = cylinder(9.5, low=d.cheek_outer - 0.8, high=40) - cylinder(
        8.3, low=0, high=41
    )
    outside = union([_half_shell(dimensions), cheek]) - bolts - ring

    def bored(radius: float) -> Solid:
        bore = cylinder(radius, low=-40, high=d.floor, axis="y")
        bore ^= box(
            low=(0, -60, -40),
            high=(40, 60, d.cheek_outer - 2.5 - d.bore_shift),
        )
        return outside - bore.translate([d.axes_apart, 0, d.bore_shift])

    return Part(outside=outside, cut=bored)


def _half_shell(dimensions: Dimensions) -> Solid:
    """The collar and the half-shell next to it, hollowed out for the neighbour."""
    d = dimensions.shell
    far = (-40, -40, -40)
    shell = _collar(dimensions).translate([d.axes_apart, 0, 0])
    shell -= cylinder(dimensions.radius + 0.6, low=-40, high=d.cheek_inner)
    shell -= box(low=far, high=(d.inside, d.floor, d.cheek_inner))
    shell -= box(low=far, high=(d.axes_apart + 0.6, 0, d.cheek_inner))
    return shell


def _collar(dimensions: Dimensions) -> Solid:
    """The toothed collar and its half-shell, about y, cut at 45 deg."""
    d = dimensions.shell
    radius = dimensions.radius
    collar = cylinder(
        radius,
        low=-radius,
        high=d.collar_face,
        axis="y",
        edges=(0, 0.6),
        grooves=[_ring(d.floor + 1.6)],
    )
    collar = collar.trim_by_plane((0, 1, 1), d.mitre / math.sqrt(2))

    notch = box(
        low=(-2.0, -1.0, 0.0),
        high=(2.0, 1.0, 5.0),
    )
    notches = circle_of(notch.translate([radius + 1.2, 0, 0]), 24, 0.0)
    notches = notches.rotate([-90, 0, 0])
    return collar - notches.translate([0, d.collar_face - 5.0, 0])


# --- link 2: a motor tube between two transverse barrels, offset to either side


def upper_arm(dimensions: Dimensions) -> Part:
    """The upper arm in its own frame; free: radius of the shaft's hole in both barrels.

    The cheeks of the neighbours cover the holes.
    """
    d = dimensions.upper_arm

    def opposite(solid: Solid) -> Solid:
        """Half a turn about z: what is at axis d's end comes to axis c's."""
        return solid.rotate([0, 0, 180]).translate([d.reach, d.drop, 0])

    half = union([_barrel(dimensions), _barrel_neck(dimensions)])
    relief = cylinder(d.cheek_relief, low=d.barrel_high, high=40)
    outside = union([_motor_tube(dimensions), half, opposite(half)])
    outside -= union([relief, opposite(relief)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, low=d.barrel_low + 3, high=d.barrel_high + 1)
        return outside - union([hole, opposite(hole)])

    return Part(outside=outside, cut=bored)


def _motor_tube(dimensions: Dimensions) -> Solid:
    """The tube half-way between both axes, its ends cut at 45 deg."""
    d = dimensions.upper_arm
    radius = dimensions.radius
    places = (38.0, 48.0, d.reach - 48.0, d.reach - 38.0)
    rings = [_ring(x) for x in places]
    tube = cylinder(radius, low=-radius, high=d.reach + radius, axis="x", grooves=rings)
    tube = tube.translate([0, d.drop / 2, 0])
    tube = tube.trim_by_plane((1, 0, -1), d.mitre / math.sqrt(2))
    return tube.trim_by_plane((-1, 0, -1), (d.mitre - d.reach) / math.sqrt(2))


def _barrel(dimensions: Dimensions) -> Solid:
    d = dimensions.upper_arm
    edges = (d.barrel_edge, 0.6)
    barrel = cylinder(
        dimensions.radius, low=d.barrel_low, high=d.barrel_high, edges=edges
    )
    bolt = cylinder(1.4, low=-40, high=d.barrel_low + 1.6, segments=12)
    bolts = circle_of(bolt, 6, 11.5)
    ring = cylinder(9.0, low=-40, high=d.barrel_low + 0.8) - cylinder(
        7.8, low=-41, high=0
    )
    return barrel - bolts - ring


def _barrel_neck(dimensions: Dimensions) -> Solid:
    """The tube's lower part, continued past its cut end until it meets the barrel."""
    d = dimensions.upper_arm
    stub = cylinder(dimensions.radius - 0.2, low=2.0, high=24.0, axis="x")
    stub = stub.translate([0, d.drop / 2, 0])
    return stub ^ box(
        low=(0, -1, -40),
        high=(60, d.neck, d.barrel_high),
    )


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist(dimensions: Dimensions) -> Part:
    """The wrist in link_4; free: depth of the bearing seat in the end at the elbow.

    Link 3's collar covers the seat.
    """
    d = dimensions.wrist
    end = dimensions.jaws.collar_base + d.collar_height
    tube = cylinder(
        dimensions.radius,
        low=-end,
        high=-d.tube_start,
        edges=(2.5, 0.8),
        grooves=_wrist_grooves(dimensions),
    )
    slotted = tube - _jaw_slot(d, end) - _rod_bore(d, end) - _hinge_pins(dimensions)

    def bored(depth: float) -> Solid:
        return slotted - cylinder(d.bearing_radius, low=-d.tube_start - depth, high=0)

    return Part(outside=tube, cut=bored)


def _wrist_grooves(dimensions: Dimensions) -> list[Groove]:
    """The rings, the waist and the groove at the jaw collar's base."""
    d = dimensions.wrist
    near, far = d.waist
    waist = Groove(-(near + far) / 2, width=far - near, depth=d.waist_depth)
    collar = Groove(0.6 - dimensions.jaws.collar_base, width=1.2, depth=1.0)
    return [*(_ring(-z) for z in d.rings), waist, collar]


def _jaw_slot(d: SimpleNamespace, end: float) -> Solid:
    """The slot across the collar in which the fingers turn."""
    half_width = d.slot_half_width
    return box(
        low=(-40, -half_width, -end - 1),
        high=(40, half_width, -end + d.slot_depth),
    )


def _rod_bore(d: SimpleNamespace, end: float) -> Solid:
    """The bore in the slot's floor, where the jaw rod comes out."""
    floor = -end + d.slot_depth
    return cylinder(d.rod_radius, low=-end - 1, high=floor + d.rod_depth, segments=36)


def _hinge_pins(dimensions: Dimensions) -> Solid:
    """The holes of the fingers' hinges."""
    jaws = dimensions.jaws
    height = jaws.collar_base + jaws.pivot_height
    pin = cylinder(1.5, low=-40, high=40, axis="y", segments=24)
    places = (-jaws.pivot_offset, jaws.pivot_offset)
    return union(pin.translate([x, 0, -height]) for x in places)
