"""Link 2: a motor tube between two transverse barrels, offset to either side."""

from __future__ import annotations

import math

from alpha5_model.description.bodies.dimensions import RADIUS, UPPER_ARM
from alpha5_model.description.bodies.solid import Solid, box, circle_of, cylinder, union


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


def bored(blank: Solid, radius: float) -> Solid:
    """Bore the shaft's hole into both barrels, from the faces that the cheeks cover."""
    hole = cylinder(radius, UPPER_ARM.barrel_high - 20.0, 40)
    return blank - union([hole, _opposite(hole)])


def in_link_2(solid: Solid, theta_c: float) -> Solid:
    """From the upper arm's frame to link_2, whose x runs from axis d to axis c."""
    return solid.rotate([0, 0, -math.degrees(theta_c)])
