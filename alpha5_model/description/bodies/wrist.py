"""Link 4: the wrist tube with its rings, and the slotted jaw collar."""

from __future__ import annotations

from alpha5_model.description.bodies.dimensions import RADIUS, WRIST
from alpha5_model.description.bodies.solid import Solid, box, cylinder, union


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


def bored(slotted_blank: Solid, depth: float) -> Solid:
    """Bore the bearing seat into the end at the elbow, which link 3's collar covers."""
    return slotted_blank - cylinder(WRIST.bearing_radius, -WRIST.tube_start - depth, 0)
