"""Link 4 without the fingers: the stepped wrist tube, the jaw collar and the yoke.

Lengths in mm.
"""

from __future__ import annotations

from types import SimpleNamespace

from meshes.dimensions import Dimensions
from meshes.parts import Part, ring_groove
from meshes.solid import (
    FAR,
    Groove,
    Solid,
    box,
    cylinder,
    kernel,
    union,
)


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
    slotted -= _saddle(d, end)
    slotted += _yoke(d, end)

    def bored(depth: float) -> Solid:
        return slotted - cylinder(d.bearing_radius, low=-d.tube_start - depth, high=FAR)

    return Part(outside=tube, cut=bored)


def _wrist_grooves(dimensions: Dimensions) -> list[Groove]:
    """The rings, the waist and the groove at the jaw collar's base."""
    d = dimensions.wrist
    near, far = d.waist
    waist = Groove(-(near + far) / 2, width=far - near, depth=d.waist_depth)
    collar = Groove(0.6 - dimensions.jaws.collar_base, width=1.2, depth=1.0)
    return [*(ring_groove(-z) for z in d.rings), waist, collar]


def _jaw_slot(d: SimpleNamespace, end: float) -> Solid:
    """The slot across the collar in which the fingers turn."""
    half_width = d.slot_half_width
    return box(
        low=(-40, -half_width, -end - 1),
        high=(40, half_width, -end + d.slot_depth),
    )


def _saddle(d: SimpleNamespace, end: float) -> Solid:
    """The hollow between the hinges, through which the yoke is seen."""
    hollow = cylinder(d.saddle_radius, low=-40, high=40, axis="y")
    return hollow.translate([0, 0, -end + d.saddle_depth - d.saddle_radius])


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


def _yoke(d: SimpleNamespace, end: float) -> Solid:
    """The jaw rod, and on it the yoke that turns both fingers."""
    floor = -end + d.slot_depth
    rod = cylinder(
        d.rod_thickness / 2, low=-end + d.yoke_below, high=floor + d.rod_depth
    )
    arm = cylinder(
        d.yoke_radius,
        low=-d.yoke_half_width,
        high=d.yoke_half_width,
        axis="y",
        edges=(0.5, 0.5),
        segments=24,
    )
    pin = cylinder(1.2, low=-40, high=40, axis="y", segments=16)
    height = -end + d.yoke_below + d.yoke_radius
    places = [(-d.yoke_reach, 0, height), (d.yoke_reach, 0, height)]
    arms = kernel().Manifold.batch_hull([arm.translate(place) for place in places])
    return union([rod, arms]) - union(pin.translate(place) for place in places)
