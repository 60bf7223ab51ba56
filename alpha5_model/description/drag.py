"""Drag strips in the words of simulators: damping of a whole link, or ellipsoids along each strip."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.hydrodynamics import DragStrip, gauss_points
from alpha5_model.spatial import cross_matrix

#: Share of a velocity that counts beside another one. A norm is no sum of sizes; with this one the damping is within
#: a tenth of the strips in a current and a sixth where joints move (root mean square), 0 and 1 both err by more.
_BESIDE = 0.45
#: Pieces of a strip in MuJoCo; radii of their ellipsoids over their length, so small that no added mass is felt.
_PIECES, _FLAT_RADIUS, _NEEDLE_RADIUS = 4, 0.1, 0.02
#: Half axes of the flat ellipsoid, one over the other, and the best share of ``sin x cos x`` in ``sin^2 x cos x``
#: over directions from all around, 15 pi / 64.
_FLATNESS, _LIFT = 0.8, 15 * np.pi / 64


def damping(strips: Iterable[DragStrip], density: float) -> FloatArray:
    """Quadratic damping about and in the link's frame, (6, 6, 6): force i is ``D[i, j, k] nu_j |nu_k|``.

    Exact for each component of the velocity alone, linear before angular; never adds energy.
    """
    out = np.zeros((6, 6, 6))
    mix = _BESIDE + (1 - _BESIDE) * np.eye(6)
    for strip in strips:
        line = strip.end - strip.start
        length = float(np.linalg.norm(line))
        along = np.outer(line, line) / length**2
        for point, share in gauss_points(strip):
            velocity = np.hstack([np.eye(3), -cross_matrix(point)])
            for part, drag in ((np.eye(3) - along, strip.across), (along, strip.along)):
                slip = part @ velocity
                face = density / 2 * drag * strip.diameter * length * share
                sizes = np.linalg.norm(slip, axis=0)
                out -= face * (slip.T @ slip)[:, :, None] * sizes * mix
    return out


def ellipsoids(strip: DragStrip) -> Iterator[dict[str, Any]]:
    """Geoms that drag in MuJoCo as a strip does: a flat ellipsoid and a needle on each of its pieces.

    At an angle x to the axis MuJoCo takes for the shadow of an ellipsoid with half axes k r, r, r
    ``pi r^2 sqrt((cos^2 + k^4 sin^2) / (cos^2 + k^2 sin^2))``. With k = 0.8 its slender drag goes within 0.04 like the
    strip's, ``sin^3 x``. The needle has the strip's lift, ``sin^2 x cos x`` against its ``sin x cos x``, and its turning.
    """
    points = np.linspace(strip.start, strip.end, _PIECES + 1)
    for start, end in pairwise(points):
        half, middle = (end - start) / 2, (start + end) / 2
        length = 2 * float(np.linalg.norm(half))
        radius, needle = _FLAT_RADIUS * length, _NEEDLE_RADIUS * length
        share = strip.diameter * length / 2 / (np.pi * radius**2)
        blunt, slender = strip.along, (strip.across - _FLATNESS * strip.along) / (1 - _FLATNESS)
        short = 2 * _FLATNESS * _FLAT_RADIUS * half
        flat = np.concatenate([middle - short, middle + short])
        drag = share * blunt, share * slender, 0.0, 0.0, 0.0
        yield {"fromto": flat, "size": radius, "fluidcoef": drag}
        share = strip.diameter / (np.pi * needle)
        turning, lift = 15 / 32 * strip.across, _LIFT * (strip.across - strip.along)
        turn = 0.0, 0.0, share * turning, share * lift, 0.0
        yield {"fromto": np.concatenate([start, end]), "size": needle, "fluidcoef": turn}
