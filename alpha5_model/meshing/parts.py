"""The parts, each before and after its one free dimension is cut. Lengths in mm."""

from __future__ import annotations

import math

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.meshing.dimensions import BASE, FINGER, RADIUS, SHELL, UPPER_ARM, WRIST
from alpha5_model.meshing.solid import Solid, box, circle_of, cylinder, loft, prism, union

#: Points on either side of a finger's blade.
STATIONS = 33
_GAP = 0.15  # between the closed fingers, each side of the middle


# --- link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot


def base_blank() -> Solid:
    """The outside of the base, in link_0 [mm]."""
    d = BASE
    hub = cylinder(
        RADIUS, d.hub_low, d.hub_high, edges=(1.5, 0.6), grooves=[(d.hub_high - 4, 1.6, 0.8)]
    )
    tube = cylinder(
        RADIUS,
        d.rear,
        d.tube_front,
        axis="x",
        edges=(1.5, 1.5),
        grooves=[(d.tube_front - 13.0, 1.6, 0.8), (d.tube_front - 23.0, 1.6, 0.8)],
    )
    neck = box(
        (d.tube_front - 2.0, -d.neck_half_width, -d.neck_half_height),
        (-8.0, d.neck_half_width, d.neck_half_height),
    )
    bolts = circle_of(cylinder(1.4, d.hub_low - 1, d.hub_low + 1.6, segments=12), 6, 13.5, 30.0)
    return union([hub, tube, neck, _foot()]) - bolts


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
    inside = cylinder(RADIUS - 0.5, d.rear, d.foot_slope, axis="x") ^ box(
        (-200, -40, -40), (0, 40, 40)
    )
    holes = [
        cylinder(1.7, d.foot_face - 1, d.foot_face + 7, axis="y", segments=16).translate([x, 0, z])
        for x in (-119.0, -90.0)
        for z in (-13.0, 13.0)
    ]
    return (block + inside) - union(holes)


def base_bored(blank: Solid, depth: float) -> Solid:
    """Bore the shaft's hole under link 1, and the connector recess with its connector to a depth."""
    d = BASE
    at = [0, d.recess_offset, 0]
    shaft = cylinder(d.shaft_radius, d.hub_high - d.shaft_depth, d.hub_high + 1)
    recess = cylinder(d.recess_radius, d.rear - 1, d.rear + depth, axis="x").translate(at)
    plug = cylinder(
        d.plug_radius, d.rear + d.plug_start, d.rear + depth + 1, axis="x", edges=(0.8, 0)
    ).translate(at)
    return (blank - shaft - recess) + plug


# --- links 1 and 3: collar, half-shell and cheek, drawn once in the shell's own frame


def shell_blank() -> Solid:
    """The shell before the half-shell is bored, in the shell's frame [mm]."""
    d = SHELL
    body = (
        cylinder(
            RADIUS,
            d.rim,
            d.collar_face,
            axis="y",
            edges=(0.8, 0.6),
            grooves=[(d.floor + 1.6, 1.6, 0.8)],
        )
        - _teeth()
    )
    body = body.translate([d.axes_apart, 0, 0])
    body -= box((-40, -40, -40), (d.axes_apart + 0.6, d.floor, d.cheek_inner))
    cheek = cylinder(RADIUS, d.cheek_inner, d.cheek_outer, edges=(0, 1.2))
    bolts = circle_of(cylinder(1.4, d.cheek_outer - 1.6, 40, segments=12), 6, 14.0)
    ring = cylinder(9.5, d.cheek_outer - 0.8, 40) - cylinder(8.3, 0, 41)
    return union([body, cheek]) - bolts - ring


def _teeth() -> Solid:
    """Notches around the collar's edge, axis on y through the origin."""
    notch = box((-2.0, -1.0, 0.0), (2.0, 1.0, 5.0)).translate([RADIUS + 1.2, 0, 0])
    return circle_of(notch, 24, 0.0).rotate([-90, 0, 0]).translate([0, SHELL.collar_face - 5.0, 0])


def shell_bored(blank: Solid, radius: float) -> Solid:
    """Bore the half-shell about the collar's axis, above the collar's floor."""
    d = SHELL
    bore = cylinder(radius, d.rim - 1, d.floor, axis="y")
    bore ^= box((-40, -60, -40), (40, 60, d.cheek_inner - 1.0 - d.bore_shift))
    return blank - bore.translate([d.axes_apart, 0, d.bore_shift])


def frame_in_link_1(shoulder: float) -> FloatArray:
    """The shell's frame in link_1, (3, 4) [mm]; its axis d lies ``shoulder`` above link_1's origin."""
    return np.array([[-1, 0, 0, SHELL.axes_apart], [0, 0, -1, 0], [0, -1, 0, shoulder]], float)


def frame_in_link_3() -> FloatArray:
    """The shell's frame in link_3, (3, 4) [mm]."""
    return np.array([[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0]], float)


# --- link 2: a motor tube between two transverse barrels, offset to either side


def upper_arm_blank() -> Solid:
    """The upper arm before its barrels are bored, in its own frame [mm]."""
    d = UPPER_ARM
    middle = d.drop / 2
    end = d.reach - d.tube_start
    tube = cylinder(
        RADIUS,
        d.tube_start,
        end,
        axis="x",
        edges=(1.2, 1.2),
        grooves=[(x, 1.6, 0.8) for x in (d.tube_start + 9, d.tube_start + 19, end - 19, end - 9)],
    ).translate([0, middle, 0])
    half = union([_barrel(), _neck()])
    both = union([half, _opposite(half)])
    reliefs = cylinder(d.cheek_relief, d.barrel_high, 40)
    return union([tube, both]) - union([reliefs, _opposite(reliefs)])


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


def upper_arm_bored(blank: Solid, radius: float) -> Solid:
    """Bore the shaft's hole into both barrels, from the faces that the cheeks cover."""
    hole = cylinder(radius, UPPER_ARM.barrel_high - 20.0, 40)
    return blank - union([hole, _opposite(hole)])


def in_link_2(solid: Solid, theta_c: float) -> Solid:
    """From the upper arm's frame to link_2, whose x runs from axis d to axis c."""
    return solid.rotate([0, 0, -math.degrees(theta_c)])


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist_blank(collar_base: float) -> Solid:
    """The outside of the wrist, in link_4 [mm]; ``collar_base`` in mm."""
    d = WRIST
    return cylinder(
        RADIUS,
        -(collar_base + d.collar_height),
        -d.tube_start,
        edges=(2.5, 0.8),
        grooves=[*((-z, 1.6, 0.8) for z in d.rings), (0.6 - collar_base, 1.2, 1.0)],
    )


def slotted(blank: Solid, collar_base: float, pivot_height: float, pivot_offset: float) -> Solid:
    """Cut the slot for the fingers, their pins and the rod's bore; jaw dimensions in mm."""
    d = WRIST
    end, pivot = collar_base + d.collar_height, collar_base + pivot_height
    slot = box((-40, -d.slot_half_width, -end - 1), (40, d.slot_half_width, -end + d.slot_depth))
    rod = cylinder(d.rod_radius, -end - 1, -end + d.slot_depth + d.rod_depth, segments=36)
    pins = union(
        cylinder(1.5, -40, 40, axis="y", segments=24).translate([x, 0, -pivot])
        for x in (-pivot_offset, pivot_offset)
    )
    return blank - slot - rod - pins


def wrist_bored(slotted_blank: Solid, depth: float) -> Solid:
    """Bore the bearing seat into the end at the elbow, which link 3's collar covers."""
    return slotted_blank - cylinder(WRIST.bearing_radius, -WRIST.tube_start - depth, 0)


# --- the two interlocking fingers: curved, perforated, bare metal


def centre_line(parameter: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points of the centre line (n, 2) and half widths (n,) [mm] for parameters in 0 ... 1."""
    from scipy.interpolate import CubicSpline

    points = np.array(FINGER.centre_line)
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
    points = points.copy()
    points[0] += inset * tangent[0]
    points[-1] -= inset * tangent[-1]
    return np.vstack([points + right, (points - right)[::-1]])


def finger_blank(width: float, pivot_offset: float, length: float) -> Solid:
    """The finger before its perforation, in finger_1 [mm].

    Args:
        width: Across the plane of motion.
        pivot_offset: Distance of the hinge from the middle plane.
        length: From the hinge to the tip.
    """
    d, h, edge = FINGER, width / 2, 0.8
    broken, full = ribbon(inset=edge), ribbon()
    blade = loft([broken, full, full, broken], [-h, edge - h, h - edge, h])
    lug = cylinder(d.lug_radius, -h, h, edges=(0.5, 0.5), segments=36)
    beyond = box((pivot_offset - d.hook - _GAP, -50, -50), (50, 150, _GAP)) + box(
        (pivot_offset + d.hook - _GAP, -50, -50), (50, 150, 50)
    )
    tip = box((-50, length, -50), (50, 200, 50))
    pin = cylinder(d.pin_radius, -50, 50, segments=24)
    return union([blade, lug]) - beyond - tip - pin


def perforated(blank: Solid, radius: float) -> Solid:
    """Drill the row of holes along the centre line."""
    points, _ = centre_line(np.array(FINGER.holes))
    hole = cylinder(radius, -50, 50, segments=24)
    return blank - union(hole.translate([x, y, 0]) for x, y in points.tolist())


def as_finger_2(solid: Solid) -> Solid:
    """The other finger is the same part, turned by half a turn about its hinge."""
    return solid.rotate([0, 0, 180])
