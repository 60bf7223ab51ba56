"""Link 0: the base tube along -x, the hub on the yaw axis, the sloped mounting foot."""

from __future__ import annotations

from alpha5_model.description.bodies.dimensions import BASE, RADIUS
from alpha5_model.description.bodies.solid import Solid, box, circle_of, cylinder, prism, union


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


def bored(blank: Solid, depth: float) -> Solid:
    """Bore the shaft's hole under link 1, and the connector recess with its connector to a depth."""
    d = BASE
    at = [0, d.recess_offset, 0]
    shaft = cylinder(d.shaft_radius, d.hub_high - d.shaft_depth, d.hub_high + 1)
    recess = cylinder(d.recess_radius, d.rear - 1, d.rear + depth, axis="x").translate(at)
    plug = cylinder(
        d.plug_radius, d.rear + d.plug_start, d.rear + depth + 1, axis="x", edges=(0.8, 0)
    ).translate(at)
    return (blank - shaft - recess) + plug
