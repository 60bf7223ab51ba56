"""The parts, each with the cut of its one free dimension. Lengths in mm."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.meshing.dimensions import BASE, FINGER, JAWS, RADIUS, SHELL, UPPER_ARM, WRIST
from alpha5_model.meshing.solid import Solid, box, circle_of, cylinder, loft, prism, union
from alpha5_model.spatial import pose

#: The outside of a part, and from the free dimension to the part.
Part = tuple[Solid, Callable[[float], Solid]]
#: Points on either side of a finger's blade.
STATIONS = 33
_GAP = 0.15  # between the closed fingers, each side of the middle


def frames_in_links() -> dict[str, FloatArray]:
    """Pose in its link of each part that is drawn in a frame of its own, (3, 4) [mm]."""
    slant = -math.atan2(UPPER_ARM.drop, UPPER_ARM.reach)
    return {
        "link_1": np.array(
            [[-1, 0, 0, SHELL.axes_apart], [0, 0, -1, 0], [0, -1, 0, SHELL.shoulder]], float
        ),
        "link_2": pose((0.0, 0.0, 0.0), (0.0, 0.0, slant))[:3],
        "link_3": np.diag([1.0, -1.0, -1.0, 1.0])[:3],
        "finger_2": np.diag([-1.0, -1.0, 1.0, 1.0])[:3],  # the same part, turned about its hinge
    }


# --- link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot


def base() -> Part:
    """The base in link_0; free: the depth of the connector recess."""
    d = BASE
    ring = (d.hub_high - 4, 1.6, 0.8)
    hub = cylinder(RADIUS, d.hub_low, d.hub_high, edges=(1.5, 0.6), grooves=[ring])
    rings = [(d.tube_front - x, 1.6, 0.8) for x in (13.0, 23.0)]
    tube = cylinder(RADIUS, d.rear, d.tube_front, axis="x", edges=(1.5, 1.5), grooves=rings)
    neck = box(
        (d.tube_front - 2.0, -d.neck_half_width, -d.neck_half_height),
        (-8.0, d.neck_half_width, d.neck_half_height),
    )
    bolts = circle_of(cylinder(1.4, d.hub_low - 1, d.hub_low + 1.6, segments=12), 6, 13.5, 30.0)
    outside = union([hub, tube, neck, _foot()]) - bolts
    without_shaft = outside - cylinder(d.shaft_radius, d.hub_high - d.shaft_depth, d.hub_high + 1)

    def bored(depth: float) -> Solid:
        at = [0, d.recess_offset, 0]
        recess = cylinder(d.recess_radius, d.rear - 1, d.rear + depth, axis="x").translate(at)
        start, end = d.rear + d.plug_start, d.rear + depth + 1
        plug = cylinder(d.plug_radius, start, end, axis="x", edges=(0.8, 0)).translate(at)
        return (without_shaft - recess) + plug

    return outside, bored


def _foot() -> Solid:
    """A saddle under the tube, flat on y = foot_face, sloped towards the hub, with bolt holes."""
    d = BASE
    outline = [
        (d.rear, d.foot_face),
        (d.foot_front, d.foot_face),
        (d.foot_slope, d.foot_edge),
        (d.foot_slope, 0.0),
        (d.rear, 0.0),
    ]
    block = prism(outline, -d.foot_half_width, d.foot_half_width, edge=1.2)
    inside = cylinder(RADIUS - 0.5, d.rear, d.foot_slope, axis="x")
    inside ^= box((-200, -40, -40), (0, 40, 40))
    holes = [
        cylinder(1.7, d.foot_face - 1, d.foot_face + 7, axis="y", segments=16).translate([x, 0, z])
        for x in (-119.0, -90.0)
        for z in (-13.0, 13.0)
    ]
    return (block + inside) - union(holes)


# --- links 1 and 3: collar, half-shell and cheek, drawn once in the shell's own frame


def shell() -> Part:
    """The shell in its own frame; free: the half-shell's bore about the collar's axis, above its floor."""
    d = SHELL
    groove = (d.floor + 1.6, 1.6, 0.8)
    collar = cylinder(RADIUS, d.rim, d.collar_face, axis="y", edges=(0.8, 0.6), grooves=[groove])
    body = (collar - _teeth()).translate([d.axes_apart, 0, 0])
    body -= box((-40, -40, -40), (d.axes_apart + 0.6, d.floor, d.cheek_inner))
    cheek = cylinder(RADIUS, d.cheek_inner, d.cheek_outer, edges=(0, 1.2))
    bolts = circle_of(cylinder(1.4, d.cheek_outer - 1.6, 40, segments=12), 6, 14.0)
    ring = cylinder(9.5, d.cheek_outer - 0.8, 40) - cylinder(8.3, 0, 41)
    outside = union([body, cheek]) - bolts - ring

    def bored(radius: float) -> Solid:
        bore = cylinder(radius, d.rim - 1, d.floor, axis="y")
        bore ^= box((-40, -60, -40), (40, 60, d.cheek_inner - 1.0 - d.bore_shift))
        return outside - bore.translate([d.axes_apart, 0, d.bore_shift])

    return outside, bored


def _teeth() -> Solid:
    """Notches around the collar's edge, axis on y through the origin."""
    notch = box((-2.0, -1.0, 0.0), (2.0, 1.0, 5.0)).translate([RADIUS + 1.2, 0, 0])
    return circle_of(notch, 24, 0.0).rotate([-90, 0, 0]).translate([0, SHELL.collar_face - 5.0, 0])


# --- link 2: a motor tube between two transverse barrels, offset to either side


def upper_arm() -> Part:
    """The upper arm in its own frame; free: the shaft's hole in both barrels, under the cheeks."""
    d = UPPER_ARM
    end = d.reach - d.tube_start
    rings = [(x, 1.6, 0.8) for x in (d.tube_start + 9, d.tube_start + 19, end - 19, end - 9)]
    tube = cylinder(RADIUS, d.tube_start, end, axis="x", edges=(1.2, 1.2), grooves=rings)
    tube = tube.translate([0, d.drop / 2, 0])
    half = union([_barrel(), _neck()])
    both = union([half, _opposite(half)])
    reliefs = cylinder(d.cheek_relief, d.barrel_high, 40)
    outside = union([tube, both]) - union([reliefs, _opposite(reliefs)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, d.barrel_high - 20.0, 40)
        return outside - union([hole, _opposite(hole)])

    return outside, bored


def _barrel() -> Solid:
    d = UPPER_ARM
    barrel = cylinder(RADIUS, d.barrel_low, d.barrel_high, edges=(1.5, 0.6))
    bolts = circle_of(cylinder(1.4, -40, d.barrel_low + 1.6, segments=12), 6, 14.0)
    ring = cylinder(9.5, -40, d.barrel_low + 0.8) - cylinder(8.3, -41, 0)
    return barrel - bolts - ring


def _neck() -> Solid:
    """The tube's lower part goes on past its flat end until it meets the barrel."""
    d = UPPER_ARM
    stub = cylinder(RADIUS - 0.2, 2.0, d.tube_start + 3.0, axis="x").translate([0, d.drop / 2, 0])
    return stub ^ box((0, -1, -40), (60, d.neck, 40))


def _opposite(solid: Solid) -> Solid:
    """Half a turn about z through the middle of the arm: axis d's end becomes axis c's."""
    return solid.rotate([0, 0, 180]).translate([UPPER_ARM.reach, UPPER_ARM.drop, 0])


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist() -> Part:
    """The wrist in link_4; free: the bearing seat in the end at the elbow, which link 3's collar covers."""
    d = WRIST
    collar, across = JAWS["collar_base"], JAWS["pivot_offset"]
    end, pivot = collar + d.collar_height, collar + JAWS["pivot_height"]
    grooves = [*((-z, 1.6, 0.8) for z in d.rings), (0.6 - collar, 1.2, 1.0)]
    outside = cylinder(RADIUS, -end, -d.tube_start, edges=(2.5, 0.8), grooves=grooves)
    slot = box((-40, -d.slot_half_width, -end - 1), (40, d.slot_half_width, -end + d.slot_depth))
    rod = cylinder(d.rod_radius, -end - 1, -end + d.slot_depth + d.rod_depth, segments=36)
    pins = union(
        cylinder(1.5, -40, 40, axis="y", segments=24).translate([x, 0, -pivot])
        for x in (-across, across)
    )
    slotted = outside - slot - rod - pins

    def bored(depth: float) -> Solid:
        return slotted - cylinder(d.bearing_radius, -d.tube_start - depth, 0)

    return outside, bored


# --- the two interlocking fingers: curved, perforated, bare metal


def centre_line(parameter: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points of the centre line (n, 2) and half widths (n,) [mm] for parameters in 0 ... 1."""
    from scipy.interpolate import CubicSpline

    points = np.column_stack([FINGER.centre_x, FINGER.centre_y])
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    knots /= knots[-1]
    return CubicSpline(knots, points)(parameter), np.interp(parameter, knots, FINGER.half_widths)


def ribbon(start: float = 0.0, stop: float = 1.0, inset: float = 0.0) -> FloatArray:
    """Outline of the blade between two parameters, counter-clockwise, (2 n, 2) [mm].

    From start to stop on the inner side, back on the outer side; drawn in by ``inset``.
    """
    points, half = centre_line(np.linspace(start, stop, STATIONS))
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    right = np.column_stack([tangent[:, 1], -tangent[:, 0]]) * (half - inset)[:, None]
    points[0] += inset * tangent[0]
    points[-1] -= inset * tangent[-1]
    return np.vstack([points + right, (points - right)[::-1]])


def finger() -> Part:
    """The finger in finger_1; free: the radius of the holes along its centre line."""
    d, edge = FINGER, 0.8
    h, middle = JAWS["finger_width"] / 2, JAWS["pivot_offset"] - _GAP
    broken, full = ribbon(inset=edge), ribbon()
    blade = loft([broken, full, full, broken], [-h, edge - h, h - edge, h])
    lug = cylinder(d.lug_radius, -h, h, edges=(0.5, 0.5), segments=36)
    beyond = box((middle - d.hook, -50, -50), (50, 150, _GAP))
    beyond += box((middle + d.hook, -50, -50), (50, 150, 50))
    tip = box((-50, JAWS["finger_length"], -50), (50, 200, 50))
    pin = cylinder(d.pin_radius, -50, 50, segments=24)
    outside = union([blade, lug]) - beyond - tip - pin
    points, _ = centre_line(np.array(d.holes))

    def perforated(radius: float) -> Solid:
        hole = cylinder(radius, -50, 50, segments=24)
        return outside - union(hole.translate([x, y, 0]) for x, y in points.tolist())

    return outside, perforated
