"""The two fingers: interlocking, curved, perforated, of bare metal. Lengths in mm."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from meshes.dimensions import Dimensions
from meshes.parts import Part
from meshes.solid import (
    FAR,
    Solid,
    box,
    cylinder,
    kernel,
    loft,
    union,
)
from scipy.interpolate import CubicSpline

from alpha5_model._support.checks import FloatArray

#: Points on either side of a finger's blade.
STATIONS = 33


def finger(dimensions: Dimensions) -> Part:
    """The finger in finger_1; free: its plate's thickness, as a share of the drawn one.

    The outside has the drawn thickness and no holes.
    """
    d = dimensions.finger
    half_thickness = dimensions.jaws.finger_width / 2
    lug = cylinder(
        d.lug_radius,
        low=-half_thickness,
        high=half_thickness,
        edges=(0.5, 0.5),
        segments=36,
    )
    plate = _plate(d)
    pin = cylinder(d.pin_radius, low=-50, high=50, segments=24)
    beyond = union([_other_finger(dimensions), _beyond_tip(dimensions), pin])
    holes = union(
        cylinder(radius, low=-50, high=FAR, axis="x", segments=32).translate([0, y, 0])
        for y, radius in d.holes
    )

    def whole(share: float) -> Solid:
        return union([_blade(d, share) ^ plate, lug]) - beyond

    def perforated(share: float) -> Solid:
        return whole(share) - holes - _between_teeth(d, share)

    return Part(outside=whole(1.0), cut=perforated)


def _blade(d: SimpleNamespace, share: float) -> Solid:
    """The curved plate in full width, its edges broken."""
    edge = 0.6
    half_width = d.width / 2
    broken = ribbon(d, inset=edge, share=share)
    full = ribbon(d, share=share)
    heights = [-half_width, edge - half_width, half_width - edge, half_width]
    return loft([broken, full, full, broken], heights)


def _between_teeth(d: SimpleNamespace, share: float) -> Solid:
    """The notches between the teeth of the inner side, across the plate."""
    k = kernel()
    start, stop, count = d.teeth
    depth = d.tooth_depth
    notches = []
    for middle in np.linspace(start, stop, int(count)):
        # The first two points of a short ribbon lie on the inner side.
        points = ribbon(d, middle, middle + 1e-3, share=share)
        along = points[1] - points[0]
        along /= np.hypot(*along)
        outwards = np.array([along[1], -along[0]])
        corners = [
            points[0] - depth * outwards,
            points[0] + depth * (outwards - 2 * along),
            points[0] + depth * (outwards + 2 * along),
        ]
        notches.append(k.CrossSection([np.array(corners)]).extrude(d.width))
    return union(notches).translate([0, 0, -d.width / 2])


def _plate(d: SimpleNamespace) -> Solid:
    """The outline of the blade seen along x, with round corners."""
    k = kernel()
    half = np.array(d.outline)
    section = k.CrossSection([np.vstack([half * [1, -1], half[::-1]])])
    for rounding in (-d.corner, d.corner):
        section = section.offset(rounding, k.JoinType.Round, circular_segments=32)

    # The section's axes come along y and z, its height along x.
    across = np.array([[0, 0, 1, -100], [1, 0, 0, 0], [0, 1, 0, 0]], float)
    return section.extrude(200).transform(across)


def _other_finger(dimensions: Dimensions) -> Solid:
    """The room of the other finger, beyond a stepped middle plane."""
    d = dimensions.finger
    middle = dimensions.jaws.pivot_offset - d.gap
    lower = box(
        low=(middle - d.hook, -FAR, -FAR),
        high=(FAR, FAR, d.gap),
    )
    return lower + box(
        low=(middle + d.hook, -FAR, -FAR),
        high=(FAR, FAR, FAR),
    )


def _beyond_tip(dimensions: Dimensions) -> Solid:
    return box(
        low=(-FAR, dimensions.jaws.finger_length, -FAR),
        high=(FAR, FAR, FAR),
    )


def ribbon(
    d: SimpleNamespace,
    start: float = 0.0,
    stop: float = 1.0,
    inset: float = 0.0,
    share: float = 1.0,
) -> FloatArray:
    """Outline of the blade between two parameters, counter-clockwise, (2 n, 2) [mm].

    It goes from start to stop on the inner side and back on the outer side.

    Args:
        d: Dimensions of the finger.
        start, stop: Shares of the centre line.
        inset: By how much the outline is drawn in, but for its end, which is cut off.
        share: Of the drawn thickness.
    """
    x, y, half_thickness = np.array(d.centre_line).T
    x_steps = np.diff(x, prepend=x[0])
    y_steps = np.diff(y, prepend=y[0])
    lengths = np.cumsum(np.hypot(x_steps, y_steps))
    knots = lengths / lengths[-1]

    shares = np.linspace(start, stop, STATIONS)
    points = CubicSpline(knots, np.column_stack([x, y]))(shares)
    half = share * np.interp(shares, knots, half_thickness)

    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    to_the_right = normal * (half - inset)[:, None]

    points[0] += inset * tangent[0]
    inner_side = points + to_the_right
    outer_side = points - to_the_right
    return np.vstack([inner_side, outer_side[::-1]])
