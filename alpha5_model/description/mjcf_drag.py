"""Drag of strips in MuJoCo, whose fluid model knows ellipsoids."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.digits import rounded
from alpha5_model.description.xml import Value
from alpha5_model.numbers.hydrodynamics import DragStrip

#: Pieces that a strip is cut into.
_PIECES = 4
#: Radii of their ellipsoids over their length, so small that added mass is negligible.
_FLAT_RADIUS = 0.1
_NEEDLE_RADIUS = 0.02
#: Half axis along the strip of the flat ellipsoid over the half axes across it.
_FLATNESS = 0.8
#: Best fit of ``sin^2 x cos x`` by a multiple of ``sin x cos x``, over all directions.
_LIFT = 15 * np.pi / 64


def ellipsoids(strip: DragStrip) -> Iterator[dict[str, Value]]:
    """Geoms that drag in MuJoCo as a strip does.

    Each piece of the strip has a flat ellipsoid and a needle.

    For a flow at an angle x to its axis, MuJoCo takes the projected area of an
    ellipsoid with half axes k r, r, r as
    ``pi r^2 sqrt((cos^2 + k^4 sin^2) / (cos^2 + k^2 sin^2))``. With k = 0.8, its
    slender drag agrees with that of the strip, ``sin^3 x``, within 0.04. The needle has
    the strip's drag against rotation and its lift, where MuJoCo's ``sin x cos x``
    stands in for ``sin^2 x cos x``.
    """
    points = np.linspace(strip.start, strip.end, _PIECES + 1)
    for start, end in pairwise(points):
        yield _flat_ellipsoid(strip, start, end)
        yield _needle(strip, start, end)


def _flat_ellipsoid(
    strip: DragStrip, start: FloatArray, end: FloatArray
) -> dict[str, Value]:
    """The ellipsoid with the drag of a piece, along and across it."""
    half = (end - start) / 2
    middle = (start + end) / 2
    length = 2 * float(np.linalg.norm(half))
    radius = _FLAT_RADIUS * length
    half_axis = 2 * _FLATNESS * _FLAT_RADIUS * half

    # Diameter times length over the largest section; MuJoCo's drag has no factor 1/2.
    area_ratio = strip.diameter * length / 2 / (np.pi * radius**2)
    blunt = strip.along
    slender = (strip.across - _FLATNESS * strip.along) / (1 - _FLATNESS)
    return {
        "fromto": rounded([middle - half_axis, middle + half_axis]).ravel(),
        "size": float(rounded(radius)),
        "fluidcoef": rounded([area_ratio * blunt, area_ratio * slender, 0.0, 0.0, 0.0]),
    }


def _needle(strip: DragStrip, start: FloatArray, end: FloatArray) -> dict[str, Value]:
    """The thin ellipsoid with a piece's lift and its drag against rotation."""
    half = (end - start) / 2
    length = 2 * float(np.linalg.norm(half))
    radius = _NEEDLE_RADIUS * length

    area_ratio = strip.diameter / (np.pi * radius)
    turning = 15 / 32 * strip.across
    lift = _LIFT * (strip.across - strip.along)
    return {
        "fromto": rounded([start, end]).ravel(),
        "size": float(rounded(radius)),
        "fluidcoef": rounded([0.0, 0.0, area_ratio * turning, area_ratio * lift, 0.0]),
    }
