"""Links 1 and 3: collar, half-shell and cheek, drawn once in the shell's own frame."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies.dimensions import RADIUS, SHELL
from alpha5_model.description.bodies.solid import Solid, box, circle_of, cylinder, union


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


def bored(blank: Solid, radius: float) -> Solid:
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
