"""The drawn parts of the arm. Lengths in mm.

Each part has one free dimension. It is solved for so that the part has the volume
that Table 3 prints (`meshes.drawing`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from meshes.dimensions import Dimensions
from meshes.solid import (
    FAR,
    Groove,
    Solid,
    box,
    circle_of,
    cylinder,
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


def ring_groove(middle: float) -> Groove:
    """A ring around a turned part."""
    return Groove(middle, width=1.6, depth=0.8)


# --- link 0: the base tube along -x, and the hub on the yaw axis, somewhat higher


def base(dimensions: Dimensions) -> Part:
    """The base in link_0; free: the depth of the bore under link 1."""
    d = dimensions.base
    bolt = cylinder(1.4, low=d.hub_low - 1, high=d.hub_low + 1.6, segments=12)
    bolts = circle_of(bolt, 4, 4.0, 45.0)
    solids = [
        _hub(dimensions),
        _base_tube(dimensions),
        _base_neck(dimensions),
        _cable_plug(dimensions),
    ]
    outside = union(solids) - bolts

    def bored(depth: float) -> Solid:
        bore = cylinder(d.shaft_radius, low=d.hub_high - depth, high=d.hub_high + 1)
        return outside - bore

    return Part(outside=outside, cut=bored)


def _hub(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    return cylinder(
        dimensions.radius,
        low=d.hub_low,
        high=d.hub_high,
        edges=(d.hub_edge, 0.6),
        grooves=[ring_groove(d.hub_high - 4)],
    )


def tube_axis_of_base(dimensions: Dimensions) -> float:
    """y of the base tube's axis in link_0."""
    return float(dimensions.base.tube_low + dimensions.radius)


def _base_tube(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    tube = cylinder(
        dimensions.radius,
        low=d.cap,
        high=d.tube_front,
        axis="x",
        edges=(d.cap_edge, 0.8),
        grooves=[ring_groove(d.tube_front - 6.0), ring_groove(d.tube_front - 16.0)],
    )
    return tube.translate([0, tube_axis_of_base(dimensions), 0])


def _base_neck(dimensions: Dimensions) -> Solid:
    """Between tube and hub, below link 1's collar; it rises to the hub's axis."""
    d = dimensions.base
    neck = cylinder(dimensions.radius - 0.2, low=d.tube_front - 0.5, high=0.0, axis="x")
    rise = tube_axis_of_base(dimensions) / d.tube_front
    sheared = np.array([[1, 0, 0, 0], [rise, 1, 0, 0], [0, 0, 1, 0]], float)
    return neck.transform(sheared) - box(
        low=(d.tube_front, -FAR, d.hub_high),
        high=(1, FAR, FAR),
    )


def _cable_plug(dimensions: Dimensions) -> Solid:
    """The plug in the middle of the cap."""
    d = dimensions.base
    plug = cylinder(
        d.plug_radius,
        low=d.rear,
        high=d.cap,
        axis="x",
        edges=(1.2, 0),
        grooves=[Groove(d.cap - 3.0, width=2.0, depth=0.8)],
    )
    return plug.translate([0, tube_axis_of_base(dimensions), 0])


# --- links 1 and 3: collar, half-shell and cheek, drawn once in their own frame


def shell(dimensions: Dimensions) -> Part:
    """The shell in its own frame.

    Its free dimension is the radius of the half-shell's bore above its floor. The bore
    is parallel to the collar's axis. The outside has the room closed in which link 2's
    barrel turns.
    """
    d = dimensions.shell
    cheek = cylinder(
        dimensions.radius, low=d.cheek_inner, high=d.cheek_outer, edges=(0, 1.2)
    )
    bolt = cylinder(1.4, low=d.cheek_outer - 1.6, high=FAR, segments=12)
    bolts = circle_of(bolt, 6, 14.0)
    ring = cylinder(9.5, low=d.cheek_outer - 0.8, high=FAR)
    ring -= cylinder(8.3, low=-FAR, high=FAR)
    collar = _collar(dimensions).translate([d.axes_apart, 0, 0])
    open_shell = union([collar - _room_of_barrel(dimensions), cheek]) - bolts - ring

    def bored(radius: float) -> Solid:
        bore = cylinder(radius, low=-40, high=d.floor, axis="y")
        bore ^= box(
            low=(0, -FAR, -FAR),
            high=(FAR, FAR, d.cheek_outer - 2.5 - d.bore_shift),
        )
        return open_shell - bore.translate([d.axes_apart, 0, d.bore_shift])

    return Part(outside=union([collar, cheek]), cut=bored)


def _collar(dimensions: Dimensions) -> Solid:
    """The toothed collar about y, which goes on as a shell with a round end."""
    d = dimensions.shell
    radius = dimensions.radius
    collar = cylinder(
        radius,
        low=d.tip,
        high=d.collar_face,
        axis="y",
        edges=(radius, 0.6),
        grooves=[ring_groove(d.ring)],
    )
    notch = box(
        low=(-2.0, -1.0, 0.0),
        high=(2.0, 1.0, 5.0),
    )
    notches = circle_of(notch.translate([radius + 1.2, 0, 0]), 24, 0.0)
    notches = notches.rotate([-90, 0, 0])
    return collar - notches.translate([0, d.collar_face - 5.0, 0])


def _room_of_barrel(dimensions: Dimensions) -> Solid:
    """What the half-shell leaves free for link 2's barrel, up to the cheek."""
    d = dimensions.shell
    far = (-FAR, -FAR, -FAR)
    turning = cylinder(dimensions.radius + 0.6, low=-40, high=d.cheek_inner)
    beside = box(far, (d.inside, d.floor, d.cheek_inner))
    behind = box(far, (d.axes_apart + 0.6, 0, d.cheek_inner))
    return union([turning, beside, behind])


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
    relief = cylinder(d.cheek_relief, low=d.barrel_high, high=FAR)
    outside = union([_motor_tube(dimensions), half, opposite(half)])
    outside -= union([relief, opposite(relief)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, low=d.barrel_low + 3, high=d.barrel_high + 1)
        return outside - union([hole, opposite(hole)])

    return Part(outside=outside, cut=bored)


def _motor_tube(dimensions: Dimensions) -> Solid:
    """The tube half-way between both axes, with round ends."""
    d = dimensions.upper_arm
    radius = dimensions.radius
    places = (46.0, d.reach - 46.0)
    tube = cylinder(
        radius,
        low=d.tip,
        high=d.reach - d.tip,
        axis="x",
        edges=(radius, radius),
        grooves=[ring_groove(x) for x in places],
    )
    return tube.translate([0, d.drop / 2, 0])


def _barrel(dimensions: Dimensions) -> Solid:
    d = dimensions.upper_arm
    edges = (d.barrel_edge, 0.6)
    barrel = cylinder(
        dimensions.radius, low=d.barrel_low, high=d.barrel_high, edges=edges
    )
    bolt = cylinder(1.4, low=-FAR, high=d.barrel_low + 1.6, segments=12)
    bolts = circle_of(bolt, 6, 11.5)
    ring = cylinder(9.0, low=-FAR, high=d.barrel_low + 0.8)
    ring -= cylinder(7.8, low=-FAR, high=FAR)
    return barrel - bolts - ring


def _barrel_neck(dimensions: Dimensions) -> Solid:
    """A thinner tube from the barrel into the motor tube's round end."""
    d = dimensions.upper_arm
    stub = cylinder(d.neck_radius, low=2.0, high=d.neck_end, axis="x")
    stub = stub.translate([0, d.drop / 2, 0])
    return stub ^ box(
        low=(0, -1, -FAR),
        high=(FAR, d.neck, d.barrel_high),
    )
