"""Link 4: the wrist tube with its rings, and the slotted jaw collar."""

from __future__ import annotations

from alpha5_model.description.bodies.dimensions import RADIUS, WRIST
from alpha5_model.description.bodies.solid import Solid, box, cylinder, union


def wrist_blank(collar_base: float, pivot_height: float, pivot_offset: float) -> Solid:
    """The wrist before its elbow end is bored, in link_4 [mm]; jaw dimensions in mm."""
    d = WRIST
    end = collar_base + d.collar_height
    rings = [41.0, 51.0, 78.0, 88.0, 118.0, 128.0]
    body = cylinder(
        RADIUS,
        -end,
        -d.tube_start,
        edges=(2.5, 0.8),
        grooves=[*((-z, 1.6, 0.8) for z in rings), (-collar_base + 0.6, 1.2, 1.0)],
    )
    slot = box((-40, -d.slot_half_width, -end - 1), (40, d.slot_half_width, -end + d.slot_depth))
    rod = cylinder(d.rod_radius, -end - 1, -end + d.slot_depth + d.rod_depth, segments=36)
    pivot = -(collar_base + pivot_height)
    pins = union(
        cylinder(1.5, -40, 40, axis="y", segments=24).translate([x, 0, pivot])
        for x in (-pivot_offset, pivot_offset)
    )
    return body - slot - rod - pins


def bored(blank: Solid, depth: float) -> Solid:
    """Bore the bearing seat into the end at the elbow, which link 3's collar covers."""
    return blank - cylinder(WRIST.bearing_radius, -WRIST.tube_start - depth, 0)
