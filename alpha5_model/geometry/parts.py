"""The seven bodies of the arm, each with the volume that Table 3 prints, and their parts. Lengths in mm."""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose, transform
from alpha5_model.errors import InputError
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
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.printed import published

#: The outside of a part, and from its one free dimension to the part.
Part = tuple[Solid, Callable[[float], Solid]]
#: Points on either side of a finger's blade.
STATIONS = 33
#: Where a `Dimension` is from; see ``dimensions.toml``.
SOURCES = ("measured", "printed", "chosen")


class Dimension(float):
    """A length in mm with the kind of its source: one of `SOURCES`, or a jaw's status."""

    source: str

    def __new__(cls, value: float, source: str) -> Dimension:
        number = super().__new__(cls, value)
        number.source = source
        return number


def _dimensions() -> dict[str, SimpleNamespace]:
    """Part -> its dimensions, by the names of ``dimensions.toml``; the jaws' have their status as source."""
    table = tomllib.loads(
        Path(__file__).with_name("dimensions.toml").read_text(encoding="utf-8")
    )
    document: Any = published()
    row, elbow = document.table_1.rows[0], document.elbow
    table["shell"]["printed"] = {"axes_apart": row.a.value, "shoulder": row.d.value}
    table["upper_arm"]["printed"] = {
        "reach": elbow.adjacent.value,
        "drop": elbow.opposite.value,
    }
    table["jaws"] = {}
    for name, jaw in document.supplementary.jaws.items():
        table["jaws"].setdefault(jaw.status, {})[name] = jaw.quantity.value
    parts = {}
    for part, kinds in table.items():
        named = [
            (name, value, kind) for kind in kinds for name, value in kinds[kind].items()
        ]
        parts[part] = SimpleNamespace(
            **{
                n: tuple(v) if isinstance(v, list) else Dimension(v, kind)
                for n, v, kind in named
            }
        )
    return parts


_PARTS = _dimensions()
RADIUS: Dimension = _PARTS["turned"].radius
BASE, SHELL, UPPER_ARM = (_PARTS[name] for name in ("base", "shell", "upper_arm"))
WRIST, FINGER, JAWS = (_PARTS[name] for name in ("wrist", "finger", "jaws"))


def frames_in_links() -> dict[str, FloatArray]:
    """Pose in its link of each part that is drawn in a frame of its own, (3, 4) [mm]."""
    across = [[-1, 0, 0], [0, 0, -1], [0, -1, 0]]
    slant = -math.atan2(UPPER_ARM.drop, UPPER_ARM.reach)
    return {
        "link_1": transform(across, (SHELL.axes_apart, 0.0, SHELL.shoulder))[:3],
        "link_2": pose((0.0, 0.0, 0.0), (0.0, 0.0, slant))[:3],
        "link_3": np.diag([1.0, -1.0, -1.0, 1.0])[:3],
        "finger_2": np.diag([-1.0, -1.0, 1.0, 1.0])[
            :3
        ],  # the same part, turned about its hinge
    }


# --- link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot


def base() -> Part:
    """The base in link_0; free: the depth of the bore under link 1."""
    d = BASE
    ring = (d.hub_high - 4, 1.6, 0.8)
    hub = cylinder(
        RADIUS, d.hub_low, d.hub_high, edges=(d.hub_edge, 0.6), grooves=[ring]
    )
    rings = [(d.tube_front - x, 1.6, 0.8) for x in (6.0, 16.0)]
    tube = cylinder(
        RADIUS, d.cap, d.tube_front, axis="x", edges=(d.cap_edge, 0.8), grooves=rings
    )
    neck = cylinder(RADIUS - 0.2, d.tube_front - 2, 0.0, axis="x")
    neck -= box((d.tube_front, -40, d.hub_high), (1, 40, 40))
    nut = cylinder(
        1.6 * d.plug_radius, d.cap - 5, d.cap + 2, axis="x", edges=(0.8, 0), segments=6
    )
    thread = [(d.rear + x, 2.0, 0.6) for x in (5.0, 8.0, 11.0)]
    plug = cylinder(
        d.plug_radius, d.rear, d.cap, axis="x", edges=(1.2, 0), grooves=thread
    )
    bolts = circle_of(
        cylinder(1.4, d.hub_low - 1, d.hub_low + 1.6, segments=12), 6, 10.5, 30.0
    )
    # A saddle under the tube, flat on y = foot_face, sloped towards the hub, with bolt holes.
    low = [(d.foot_rear, d.foot_face), (d.foot_front, d.foot_face)]
    high = [(d.foot_slope, d.foot_edge), (d.foot_slope, -8.0), (d.foot_rear, -8.0)]
    foot = prism(low + high, -d.foot_half_width, d.foot_half_width, edge=1.2)
    hole = cylinder(1.7, d.foot_face - 1, d.foot_face + 7, axis="y", segments=16)
    places = itertools.product((d.foot_rear + 8.0, d.foot_front - 8.0), (-13.0, 13.0))
    foot -= union(hole.translate([x, 0, z]) for x, z in places)
    outside = union([hub, tube, neck, nut, plug, foot]) - bolts

    def bored(depth: float) -> Solid:
        bore = cylinder(d.shaft_radius, d.hub_high - depth, d.hub_high + 1)
        return outside - bore.translate([0, d.shaft_offset, 0])

    return outside, bored


# --- links 1 and 3: collar, mitred half-shell and cheek, drawn once in the shell's own frame


def shell() -> Part:
    """The shell in its own frame; free: the half-shell's bore about the collar's axis, above its floor."""
    d = SHELL
    groove = (d.floor + 1.6, 1.6, 0.8)
    collar = cylinder(
        RADIUS, -RADIUS, d.collar_face, axis="y", edges=(0, 0.6), grooves=[groove]
    )
    collar = collar.trim_by_plane((0, 1, 1), d.mitre / math.sqrt(2))
    notch = box((-2.0, -1.0, 0.0), (2.0, 1.0, 5.0)).translate([RADIUS + 1.2, 0, 0])
    teeth = (
        circle_of(notch, 24, 0.0)
        .rotate([-90, 0, 0])
        .translate([0, d.collar_face - 5.0, 0])
    )
    body = (collar - teeth).translate([d.axes_apart, 0, 0])
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


# --- link 2: a motor tube between two transverse barrels, offset to either side


def upper_arm() -> Part:
    """The upper arm in its own frame; free: the shaft's hole in both barrels, under the cheeks."""
    d = UPPER_ARM
    rings = [(x, 1.6, 0.8) for x in (38.0, 48.0, d.reach - 48.0, d.reach - 38.0)]
    tube = cylinder(RADIUS, -RADIUS, d.reach + RADIUS, axis="x", grooves=rings)
    tube = tube.translate([0, d.drop / 2, 0]).trim_by_plane(
        (1, 0, -1), d.mitre / math.sqrt(2)
    )
    tube = tube.trim_by_plane((-1, 0, -1), (d.mitre - d.reach) / math.sqrt(2))
    barrel = cylinder(RADIUS, d.barrel_low, d.barrel_high, edges=(d.barrel_edge, 0.6))
    bolts = circle_of(cylinder(1.4, -40, d.barrel_low + 1.6, segments=12), 6, 11.5)
    ring = cylinder(9.0, -40, d.barrel_low + 0.8) - cylinder(7.8, -41, 0)
    # The tube's lower part goes on past its cut end until it meets the barrel.
    stub = cylinder(RADIUS - 0.2, 2.0, 24.0, axis="x").translate([0, d.drop / 2, 0])
    neck = stub ^ box((0, -1, -40), (60, d.neck, d.barrel_high))
    half = union([barrel - bolts - ring, neck])
    relief = cylinder(d.cheek_relief, d.barrel_high, 40)
    outside = union([tube, half, _opposite(half)]) - union([relief, _opposite(relief)])

    def bored(radius: float) -> Solid:
        hole = cylinder(radius, d.barrel_low + 3, d.barrel_high + 1)
        return outside - union([hole, _opposite(hole)])

    return outside, bored


def _opposite(solid: Solid) -> Solid:
    """Half a turn about z through the middle of the arm: axis d's end becomes axis c's."""
    return solid.rotate([0, 0, 180]).translate([UPPER_ARM.reach, UPPER_ARM.drop, 0])


# --- link 4: the wrist tube with its rings, and the slotted jaw collar


def wrist() -> Part:
    """The wrist in link_4; free: the bearing seat in the end at the elbow, which link 3's collar covers."""
    d = WRIST
    collar, across = JAWS.collar_base, JAWS.pivot_offset
    end, pivot = collar + d.collar_height, collar + JAWS.pivot_height
    near, far = d.waist
    waist = (-(near + far) / 2, far - near, d.waist_depth)
    grooves = [*((-z, 1.6, 0.8) for z in d.rings), waist, (0.6 - collar, 1.2, 1.0)]
    outside = cylinder(RADIUS, -end, -d.tube_start, edges=(2.5, 0.8), grooves=grooves)
    slot = box(
        (-40, -d.slot_half_width, -end - 1),
        (40, d.slot_half_width, -end + d.slot_depth),
    )
    rod = cylinder(
        d.rod_radius, -end - 1, -end + d.slot_depth + d.rod_depth, segments=36
    )
    pin = cylinder(1.5, -40, 40, axis="y", segments=24)
    pins = union(pin.translate([x, 0, -pivot]) for x in (-across, across))
    slotted = outside - slot - rod - pins

    def bored(depth: float) -> Solid:
        return slotted - cylinder(d.bearing_radius, -d.tube_start - depth, 0)

    return outside, bored


# --- the two interlocking fingers: curved, perforated, bare metal


def ribbon(start: float = 0.0, stop: float = 1.0, inset: float = 0.0) -> FloatArray:
    """Outline of the blade between two parameters, counter-clockwise, (2 n, 2) [mm].

    From start to stop on the inner side, back on the outer side; drawn in by ``inset``.
    """
    from scipy.interpolate import CubicSpline

    x, y, half_widths = np.array(FINGER.centre_line).T
    knots = np.cumsum(np.hypot(np.diff(x, prepend=x[0]), np.diff(y, prepend=y[0])))
    knots /= knots[-1]
    parameters = np.linspace(start, stop, STATIONS)
    points = CubicSpline(knots, np.column_stack([x, y]))(parameters)
    half = np.interp(parameters, knots, half_widths)
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    right = np.column_stack([tangent[:, 1], -tangent[:, 0]]) * (half - inset)[:, None]
    points[0] += inset * tangent[0]
    points[-1] -= inset * tangent[-1]
    return np.vstack([points + right, (points - right)[::-1]])


def finger() -> Part:
    """The finger in finger_1; free: the radius of the largest holes."""
    d, edge = FINGER, 0.6
    h, middle = d.width / 2, JAWS.pivot_offset - d.gap
    broken, full = ribbon(inset=edge), ribbon()
    blade = loft([broken, full, full, broken], [-h, edge - h, h - edge, h])
    half = np.array(d.outline)
    section = kernel().CrossSection([np.vstack([half * [1, -1], half[::-1]])])
    for rounding in (-d.corner, d.corner):
        section = section.offset(
            rounding, kernel().JoinType.Round, circular_segments=32
        )
    across = np.array(
        [[0, 0, 1, -100], [1, 0, 0, 0], [0, 1, 0, 0]], float
    )  # along y, z and x
    blade ^= section.extrude(200).transform(across)
    thick = JAWS.finger_width / 2
    lug = cylinder(d.lug_radius, -thick, thick, edges=(0.5, 0.5), segments=36)
    beyond = box((middle - d.hook, -50, -50), (50, 150, d.gap))
    beyond += box((middle + d.hook, -50, -50), (50, 150, 50))
    tip = box((-50, JAWS.finger_length, -50), (50, 200, 50))
    pin = cylinder(d.pin_radius, -50, 50, segments=24)
    outside = union([blade, lug]) - beyond - tip - pin

    def perforated(radius: float) -> Solid:
        return outside - union(
            cylinder(share * radius, -50, 50, axis="x", segments=40).translate(
                [0, y, 0]
            )
            for y, share in d.holes
        )

    return outside, perforated


#: Body, base to tip -> its part, and the range of the free dimension, which is solved for [mm].
_DRAWN: dict[str, tuple[Callable[[], Part], float, float]] = {
    "link_0": (base, 1.0, 30.0),
    "link_1": (shell, 5.0, 18.0),
    "link_2": (upper_arm, 0.5, 14.0),
    "link_3": (shell, 5.0, 18.0),
    "link_4": (wrist, 0.5, 60.0),
    "finger_1": (finger, 2.0, 10.5),
    "finger_2": (finger, 2.0, 10.5),
}


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A drawn body, in its link's frame [mm].

    Attributes:
        solid: The solid, with the printed volume.
        outside: The same before its recesses, slots and shaft holes are cut.
    """

    solid: Solid
    outside: Solid


@cache
def bodies() -> dict[str, DrawnBody]:
    """Draw all bodies, base to tip.

    Raises:
        MissingDependencyError: manifold3d is not installed.
    """
    arm, frames = parameters(()), frames_in_links()
    jaws = split_link_4(arm)  # Table 3's link 4 has the fingers in it
    volumes = {link.name: link.volume for link in (*arm.links[:4], *jaws.bodies)}
    drawn = {}
    for name, (part, low, high) in _DRAWN.items():
        solids = _solved(part, volumes[name] * 1e9, low, high)
        if name in frames:
            solids = [one.transform(frames[name]) for one in solids]
        drawn[name] = DrawnBody(*solids)
    return drawn


@cache
def _solved(
    part: Callable[[], Part], volume: float, low: float, high: float
) -> list[Solid]:
    """The part with a volume [mm^3], and its outside; drawn once for links of one part."""
    outside, cut = part()
    return [solve_volume(cut, volume, low, high)[0], outside]


def solve_volume(
    build: Callable[[float], Solid], volume: float, low: float, high: float
) -> tuple[Solid, float]:
    """The part of a family whose volume is the wanted one.

    Args:
        build: From the free dimension [mm] to the solid; its volume changes monotonically.
        volume: Wanted [mm^3].
        low, high: Range of the free dimension [mm].

    Returns:
        The solid, and the dimension found, to 1e-7 mm.

    Raises:
        InputError: No dimension in the range gives this volume.
    """
    from scipy.optimize import brentq

    def excess(dimension: float) -> float:
        return float(build(dimension).volume()) - volume

    ends = excess(low), excess(high)
    if ends[0] * ends[1] > 0:
        reach = " to ".join(f"{(volume + e) * 1e-6:.4f}" for e in sorted(ends))
        raise InputError("volume", volume * 1e-6, f"a volume of {reach} L")
    found = float(brentq(excess, low, high, xtol=1e-7, rtol=1e-12))
    return build(found), found
