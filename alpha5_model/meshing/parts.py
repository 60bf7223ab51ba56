"""The parts, each with the cut of its one free dimension. Lengths in mm."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.meshing.dimensions import BASE, FINGER, JAWS, RADIUS, SHELL, UPPER_ARM, WRIST
from alpha5_model.meshing.solid import Solid, box, circle_of, cylinder, kernel, loft, prism, union
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
    """The base in link_0; free: the depth of the bore under link 1."""
    d = BASE
    ring = (d.hub_high - 4, 1.6, 0.8)
    hub = cylinder(RADIUS, d.hub_low, d.hub_high, edges=(d.hub_edge, 0.6), grooves=[ring])
    rings = [(d.tube_front - x, 1.6, 0.8) for x in (6.0, 16.0)]
    tube = cylinder(RADIUS, d.cap, d.tube_front, axis="x", edges=(d.cap_edge, 0.8), grooves=rings)
    neck = cylinder(RADIUS - 0.2, d.tube_front - 2, 0.0, axis="x")
    neck -= box((d.tube_front, -40, d.hub_high), (1, 40, 40))
    nut = cylinder(1.6 * d.plug_radius, d.cap - 5, d.cap + 2, axis="x", edges=(0.8, 0), segments=6)
    thread = [(d.rear + x, 2.0, 0.6) for x in (5.0, 8.0, 11.0)]
    plug = cylinder(d.plug_radius, d.rear, d.cap, axis="x", edges=(1.2, 0), grooves=thread)
    bolts = circle_of(cylinder(1.4, d.hub_low - 1, d.hub_low + 1.6, segments=12), 6, 10.5, 30.0)
    outside = union([hub, tube, neck, nut, plug, _foot()]) - bolts

    def bored(depth: float) -> Solid:
        bore = cylinder(d.shaft_radius, d.hub_high - depth, d.hub_high + 1)
        return outside - bore.translate([0, d.shaft_offset, 0])

    return outside, bored


def _foot() -> Solid:
    """A saddle under the tube, flat on y = foot_face, sloped towards the hub, with bolt holes."""
    d = BASE
    outline = [
        (d.foot_rear, d.foot_face),
        (d.foot_front, d.foot_face),
        (d.foot_slope, d.foot_edge),
        (d.foot_slope, -8.0),
        (d.foot_rear, -8.0),
    ]
    block = prism(outline, -d.foot_half_width, d.foot_half_width, edge=1.2)
    holes = [
        cylinder(1.7, d.foot_face - 1, d.foot_face + 7, axis="y", segments=16).translate([x, 0, z])
        for x in (d.foot_rear + 8.0, d.foot_front - 8.0)
        for z in (-13.0, 13.0)
    ]
    return block - union(holes)


# --- links 1 and 3: collar, mitred half-shell and cheek, drawn once in the shell's own frame


def shell() -> Part:
    """The shell in its own frame; free: the half-shell's bore about the collar's axis, above its floor."""
    d = SHELL
    groove = (d.floor + 1.6, 1.6, 0.8)
    collar = cylinder(RADIUS, -RADIUS, d.collar_face, axis="y", edges=(0, 0.6), grooves=[groove])
    collar = collar.trim_by_plane((0, 1, 1), d.mitre / math.sqrt(2))
    body = (collar - _teeth()).translate([d.axes_apart, 0, 0])
    body -= cylinder(RADIUS + 0.6, -40, d.cheek_inner)
    body -= box((-40, -40, -40), (d.inside, d.floor, d.cheek_inner))
    body -= box((-40, -40, -40), (d.axes_apart + 0.6, 0, d.cheek_inner))
    cheek = cylinder(RADIUS, d.cheek_inner, d.cheek_outer, edges=(0, 1.2))
    bolts = circle_of(cylinder(1.4, d.cheek_outer - 1.6, 40, segments=12), 6, 14.0)
    ring = cylinder(9.5, d.cheek_outer - 0.8, 40) - cylinder(8.3, 0, 41)
    outside = union([body, cheek]) - bolts - ring

    def bored(radius: float) -> Solid:
        bore = cylinder(radius, -40, d.floor, axis="y")
        bore ^= box((0, -60, -40), (40, 60, d.cheek_outer - 2.5 - d.bore_shift))
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
    rings = [(x, 1.6, 0.8) for x in (38.0, 48.0, d.reach - 48.0, d.reach - 38.0)]
    tube = cylinder(RADIUS, -RADIUS, d.reach + RADIUS, axis="x", grooves=rings)
    tube = tube.translate([0, d.drop / 2, 0]).trim_by_plane((1, 0, -1), d.mitre / math.sqrt(2))
    tube = tube.trim_by_plane((-1, 0, -1), (d.mitre - d.reach) / math.sqrt(2))
    half = union([_barrel(), _neck()])
    relief = cylinder(d.cheek_relief, d.barrel_high, 40)
    outside = union([tube, half, _opposite(half)]) - union([relief, _opposite(relief)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, d.barrel_low + 3, d.barrel_high + 1)
        return outside - union([hole, _opposite(hole)])

    return outside, bored


def _barrel() -> Solid:
    d = UPPER_ARM
    barrel = cylinder(RADIUS, d.barrel_low, d.barrel_high, edges=(d.barrel_edge, 0.6))
    bolts = circle_of(cylinder(1.4, -40, d.barrel_low + 1.6, segments=12), 6, 11.5)
    ring = cylinder(9.0, -40, d.barrel_low + 0.8) - cylinder(7.8, -41, 0)
    return barrel - bolts - ring


def _neck() -> Solid:
    """The tube's lower part goes on past its cut end until it meets the barrel."""
    d = UPPER_ARM
    stub = cylinder(RADIUS - 0.2, 2.0, 24.0, axis="x").translate([0, d.drop / 2, 0])
    return stub ^ box((0, -1, -40), (60, d.neck, d.barrel_high))


def _opposite(solid: Solid) -> Solid:
    """Half a turn about z through the middle of the arm: axis d's end becomes axis c's."""
    return solid.rotate([0, 0, 180]).translate([UPPER_ARM.reach, UPPER_ARM.drop, 0])


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist() -> Part:
    """The wrist in link_4; free: the bearing seat in the end at the elbow, which link 3's collar covers."""
    d = WRIST
    collar, across = JAWS["collar_base"], JAWS["pivot_offset"]
    end, pivot = collar + d.collar_height, collar + JAWS["pivot_height"]
    near, far = d.waist
    waist = (-(near + far) / 2, far - near, d.waist_depth)
    grooves = [*((-z, 1.6, 0.8) for z in d.rings), waist, (0.6 - collar, 1.2, 1.0)]
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
    """The finger in finger_1; free: the radius of the largest holes."""
    d, edge = FINGER, 0.6
    h, middle = d.width / 2, JAWS["pivot_offset"] - _GAP
    broken, full = ribbon(inset=edge), ribbon()
    blade = loft([broken, full, full, broken], [-h, edge - h, h - edge, h])
    half = np.array(d.outline)
    section = kernel().CrossSection([np.vstack([half * [1, -1], half[::-1]])])
    for rounding in (-d.corner, d.corner):
        section = section.offset(rounding, kernel().JoinType.Round, circular_segments=32)
    across = np.array([[0, 0, 1, -100], [1, 0, 0, 0], [0, 1, 0, 0]], float)  # along y, z and x
    blade ^= section.extrude(200).transform(across)
    thick = JAWS["finger_width"] / 2
    lug = cylinder(d.lug_radius, -thick, thick, edges=(0.5, 0.5), segments=36)
    beyond = box((middle - d.hook, -50, -50), (50, 150, _GAP))
    beyond += box((middle + d.hook, -50, -50), (50, 150, 50))
    tip = box((-50, JAWS["finger_length"], -50), (50, 200, 50))
    pin = cylinder(d.pin_radius, -50, 50, segments=24)
    outside = union([blade, lug]) - beyond - tip - pin

    def perforated(radius: float) -> Solid:
        return outside - union(
            cylinder(share * radius, -50, 50, axis="x", segments=40).translate([0, y, 0])
            for y, share in d.holes
        )

    return outside, perforated
