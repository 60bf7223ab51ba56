"""One of the two interlocking fingers: curved, perforated, bare metal."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies.dimensions import FINGER
from alpha5_model.description.bodies.solid import Solid, box, cylinder, loft, union

#: Points on either side of the blade.
STATIONS = 33
_GAP = 0.15  # between the closed fingers, each side of the middle


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
