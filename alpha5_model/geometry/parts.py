"""The drawn parts of the arm. Lengths in mm.

Each part has one free dimension, which is solved for so that the part has the volume that
Table 3 prints (`alpha5_model.geometry.drawing`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.geometry.dimensions import Dimensions
from alpha5_model.geometry.solid import (
    Solid,
    box,
    circle_of,
    cylinder,
    kernel,
    loft,
    prism,
    union,
)

#: Points on either side of a finger's blade.
STATIONS = 33


class Part(NamedTuple):
    """A part with one free dimension.

    Attributes:
        outside: The part before its last recess is cut.
        cut: From the free dimension to the part.
    """

    outside: Solid
    cut: Callable[[float], Solid]


# --- link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot


def base(dimensions: Dimensions) -> Part:
    """The base in link_0; free: the depth of the bore under link 1."""
    d = dimensions.base
    bolt = cylinder(1.4, d.hub_low - 1, d.hub_low + 1.6, segments=12)
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
        bore = cylinder(d.shaft_radius, d.hub_high - depth, d.hub_high + 1)
        return outside - bore.translate([0, d.shaft_offset, 0])

    return Part(outside=outside, cut=bored)


def _hub(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    ring = (d.hub_high - 4, 1.6, 0.8)
    return cylinder(
        dimensions.radius,
        d.hub_low,
        d.hub_high,
        edges=(d.hub_edge, 0.6),
        grooves=[ring],
    )


def _base_tube(dimensions: Dimensions) -> Solid:
    d = dimensions.base
    return cylinder(
        dimensions.radius,
        d.cap,
        d.tube_front,
        axis="x",
        edges=(d.cap_edge, 0.8),
        grooves=[(d.tube_front - x, 1.6, 0.8) for x in (6.0, 16.0)],
    )


def _base_neck(dimensions: Dimensions) -> Solid:
    """Between tube and hub, below link 1's collar."""
    d = dimensions.base
    neck = cylinder(dimensions.radius - 0.2, d.tube_front - 2, 0.0, axis="x")
    return neck - box((d.tube_front, -40, d.hub_high), (1, 40, 40))


def _cable_plug(d: SimpleNamespace) -> tuple[Solid, Solid]:
    """The nut and the threaded plug in the middle of the cap."""
    nut = cylinder(
        1.6 * d.plug_radius, d.cap - 5, d.cap + 2, axis="x", edges=(0.8, 0), segments=6
    )
    thread = [(d.rear + x, 2.0, 0.6) for x in (5.0, 8.0, 11.0)]
    plug = cylinder(
        d.plug_radius, d.rear, d.cap, axis="x", edges=(1.2, 0), grooves=thread
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

    hole = cylinder(1.7, d.foot_face - 1, d.foot_face + 7, axis="y", segments=16)
    places = itertools.product((d.foot_rear + 8.0, d.foot_front - 8.0), (-13.0, 13.0))
    return foot - union(hole.translate([x, 0, z]) for x, z in places)


# --- links 1 and 3: collar, mitred half-shell and cheek, drawn once in the shell's own frame


def shell(dimensions: Dimensions) -> Part:
    """The shell in its own frame; free: radius of the half-shell's bore above its floor.

    The bore is parallel to the collar's axis.
    """
    d = dimensions.shell
    radius = dimensions.radius
    body = _collar(dimensions).translate([d.axes_apart, 0, 0])
    body -= cylinder(radius + 0.6, -40, d.cheek_inner)
    body -= box((-40, -40, -40), (d.inside, d.floor, d.cheek_inner))
    body -= box((-40, -40, -40), (d.axes_apart + 0.6, 0, d.cheek_inner))

    cheek = cylinder(radius, d.cheek_inner, d.cheek_outer, edges=(0, 1.2))
    bolts = circle_of(cylinder(1.4, d.cheek_outer - 1.6, 40, segments=12), 6, 14.0)
    ring = cylinder(9.5, d.cheek_outer - 0.8, 40) - cylinder(8.3, 0, 41)
    outside = union([body, cheek]) - bolts - ring

    def bored(bore_radius: float) -> Solid:
        bore = cylinder(bore_radius, -40, d.floor, axis="y")
        bore ^= box((0, -60, -40), (40, 60, d.cheek_outer - 2.5 - d.bore_shift))
        return outside - bore.translate([d.axes_apart, 0, d.bore_shift])

    return Part(outside=outside, cut=bored)


def _collar(dimensions: Dimensions) -> Solid:
    """The toothed collar and its half-shell, about y, cut at 45 deg."""
    d = dimensions.shell
    radius = dimensions.radius
    groove = (d.floor + 1.6, 1.6, 0.8)
    collar = cylinder(
        radius, -radius, d.collar_face, axis="y", edges=(0, 0.6), grooves=[groove]
    )
    collar = collar.trim_by_plane((0, 1, 1), d.mitre / math.sqrt(2))

    notch = box((-2.0, -1.0, 0.0), (2.0, 1.0, 5.0)).translate([radius + 1.2, 0, 0])
    teeth = circle_of(notch, 24, 0.0).rotate([-90, 0, 0])
    return collar - teeth.translate([0, d.collar_face - 5.0, 0])


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
    relief = cylinder(d.cheek_relief, d.barrel_high, 40)
    outside = union([_motor_tube(dimensions), half, opposite(half)])
    outside -= union([relief, opposite(relief)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, d.barrel_low + 3, d.barrel_high + 1)
        return outside - union([hole, opposite(hole)])

    return Part(outside=outside, cut=bored)


def _motor_tube(dimensions: Dimensions) -> Solid:
    """The tube half-way between both axes, its ends cut at 45 deg."""
    d = dimensions.upper_arm
    radius = dimensions.radius
    rings = [(x, 1.6, 0.8) for x in (38.0, 48.0, d.reach - 48.0, d.reach - 38.0)]
    tube = cylinder(radius, -radius, d.reach + radius, axis="x", grooves=rings)
    tube = tube.translate([0, d.drop / 2, 0])
    tube = tube.trim_by_plane((1, 0, -1), d.mitre / math.sqrt(2))
    return tube.trim_by_plane((-1, 0, -1), (d.mitre - d.reach) / math.sqrt(2))


def _barrel(dimensions: Dimensions) -> Solid:
    d = dimensions.upper_arm
    edges = (d.barrel_edge, 0.6)
    barrel = cylinder(dimensions.radius, d.barrel_low, d.barrel_high, edges=edges)
    bolts = circle_of(cylinder(1.4, -40, d.barrel_low + 1.6, segments=12), 6, 11.5)
    ring = cylinder(9.0, -40, d.barrel_low + 0.8) - cylinder(7.8, -41, 0)
    return barrel - bolts - ring


def _barrel_neck(dimensions: Dimensions) -> Solid:
    """The tube's lower part, which goes on past its cut end until it meets the barrel."""
    d = dimensions.upper_arm
    stub = cylinder(dimensions.radius - 0.2, 2.0, 24.0, axis="x")
    stub = stub.translate([0, d.drop / 2, 0])
    return stub ^ box((0, -1, -40), (60, d.neck, d.barrel_high))


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist(dimensions: Dimensions) -> Part:
    """The wrist in link_4; free: depth of the bearing seat in the end at the elbow.

    Link 3's collar covers the seat.
    """
    d = dimensions.wrist
    end = dimensions.jaws.collar_base + d.collar_height
    tube = cylinder(
        dimensions.radius,
        -end,
        -d.tube_start,
        edges=(2.5, 0.8),
        grooves=_wrist_grooves(dimensions),
    )
    slotted = tube - _jaw_slot(d, end) - _rod_bore(d, end) - _hinge_pins(dimensions)

    def bored(depth: float) -> Solid:
        return slotted - cylinder(d.bearing_radius, -d.tube_start - depth, 0)

    return Part(outside=tube, cut=bored)


def _wrist_grooves(dimensions: Dimensions) -> list[tuple[float, float, float]]:
    """The rings, the waist and the groove at the jaw collar's base."""
    d = dimensions.wrist
    near, far = d.waist
    rings = [(-z, 1.6, 0.8) for z in d.rings]
    waist = (-(near + far) / 2, far - near, d.waist_depth)
    collar = (0.6 - dimensions.jaws.collar_base, 1.2, 1.0)
    return [*rings, waist, collar]


def _jaw_slot(d: SimpleNamespace, end: float) -> Solid:
    """The slot across the collar in which the fingers turn."""
    half_width = d.slot_half_width
    return box((-40, -half_width, -end - 1), (40, half_width, -end + d.slot_depth))


def _rod_bore(d: SimpleNamespace, end: float) -> Solid:
    """The bore in the slot's floor, where the jaw rod comes out."""
    floor = -end + d.slot_depth
    return cylinder(d.rod_radius, -end - 1, floor + d.rod_depth, segments=36)


def _hinge_pins(dimensions: Dimensions) -> Solid:
    """The holes of the fingers' hinges."""
    jaws = dimensions.jaws
    height = jaws.collar_base + jaws.pivot_height
    pin = cylinder(1.5, -40, 40, axis="y", segments=24)
    places = (-jaws.pivot_offset, jaws.pivot_offset)
    return union(pin.translate([x, 0, -height]) for x in places)


# --- the two interlocking fingers: curved, perforated, bare metal


def finger(dimensions: Dimensions) -> Part:
    """The finger in finger_1; free: the radius of the largest holes."""
    d = dimensions.finger
    half_thickness = dimensions.jaws.finger_width / 2
    blade = _blade(d) ^ _plate(d)
    lug = cylinder(
        d.lug_radius, -half_thickness, half_thickness, edges=(0.5, 0.5), segments=36
    )
    pin = cylinder(d.pin_radius, -50, 50, segments=24)
    outside = union([blade, lug]) - _other_finger(dimensions) - _beyond_tip(dimensions)
    outside -= pin

    def perforated(radius: float) -> Solid:
        return outside - union(
            cylinder(share * radius, -50, 50, axis="x", segments=40).translate(
                [0, y, 0]
            )
            for y, share in d.holes
        )

    return Part(outside=outside, cut=perforated)


def _blade(d: SimpleNamespace) -> Solid:
    """The curved plate in full width, its edges broken."""
    edge = 0.6
    half_width = d.width / 2
    broken = ribbon(d, inset=edge)
    full = ribbon(d)
    heights = [-half_width, edge - half_width, half_width - edge, half_width]
    return loft([broken, full, full, broken], heights)


def _plate(d: SimpleNamespace) -> Solid:
    """The outline of the blade seen along x, with round corners."""
    k = kernel()
    half = np.array(d.outline)
    section = k.CrossSection([np.vstack([half * [1, -1], half[::-1]])])
    for rounding in (-d.corner, d.corner):
        section = section.offset(rounding, k.JoinType.Round, circular_segments=32)

    # The section's axes come along y and z, its height along x.
    across = np.array([[0, 0, 1, -100], [1, 0, 0, 0], [0, 1, 0, 0]], float)
    return section.extrude(200).transform(across)


def _other_finger(dimensions: Dimensions) -> Solid:
    """The room of the other finger, beyond a stepped middle plane."""
    d = dimensions.finger
    middle = dimensions.jaws.pivot_offset - d.gap
    lower = box((middle - d.hook, -50, -50), (50, 150, d.gap))
    return lower + box((middle + d.hook, -50, -50), (50, 150, 50))


def _beyond_tip(dimensions: Dimensions) -> Solid:
    return box((-50, dimensions.jaws.finger_length, -50), (50, 200, 50))


def ribbon(
    d: SimpleNamespace, start: float = 0.0, stop: float = 1.0, inset: float = 0.0
) -> FloatArray:
    """Outline of the blade between two parameters, counter-clockwise, (2 n, 2) [mm].

    It goes from start to stop on the inner side and back on the outer side.

    Args:
        d: Dimensions of the finger.
        start, stop: Shares of the centre line.
        inset: By how much the outline is drawn in.
    """
    from scipy.interpolate import CubicSpline

    x, y, half_thickness = np.array(d.centre_line).T
    knots = np.cumsum(np.hypot(np.diff(x, prepend=x[0]), np.diff(y, prepend=y[0])))
    knots /= knots[-1]

    shares = np.linspace(start, stop, STATIONS)
    points = CubicSpline(knots, np.column_stack([x, y]))(shares)
    half = np.interp(shares, knots, half_thickness)
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])

    right = normal * (half - inset)[:, None]
    points[0] += inset * tangent[0]
    points[-1] -= inset * tangent[-1]
    return np.vstack([points + right, (points - right)[::-1]])
