"""Regions of a half-plane R >= 0 that are bounded by circular arcs: tracing, area, first moment."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array

#: Step to either side of an arc when asking which side belongs to a region [m].
_STEP = 1e-7


class Arc(NamedTuple):
    """A circular arc in the half-plane, from ``start`` counter-clockwise to ``end``.

    Attributes:
        center: (R, z) [m].
        radius: [m].
        start, end: Angle from the R axis, ``start < end <= start + 2 pi`` [rad].
        filled: +1 if the region is on the centre's side, -1 if on the other, 0 where not known.
        cause: What bounds the region there, for example ``"theta_1 at its upper limit"``.
        side: ``"underarm"`` or ``"overarm"``, the pose that runs along it; ``"published"``.
    """

    center: tuple[float, float]
    radius: float
    start: float
    end: float
    filled: int
    cause: str
    side: str

    def points(self, angle: ArrayLike) -> FloatArray:
        """(R, z) at angles, (..., 2) [m]."""
        angle = float_array("angle", angle, ())
        return np.stack(
            [
                self.center[0] + self.radius * np.cos(angle),
                self.center[1] + self.radius * np.sin(angle),
            ],
            axis=-1,
        )


def trace(
    curves: Sequence[Arc], contains: Callable[[FloatArray, FloatArray], BoolArray]
) -> tuple[Arc, ...]:
    """The boundary of a region that is known to lie on some circles.

    All curves are cut at their crossings and at the axis R = 0. A piece belongs to the boundary if
    exactly one of its sides belongs to the region.

    Args:
        curves: Arcs that cover the boundary.
        contains: Which points (R, z), two arrays (N,), belong to the region.

    Returns:
        Arcs with R > 0; the axis itself, which may close the region, is not listed.
    """
    out: list[Arc] = []
    for curve in curves:
        cuts = _cuts(curve, curves)
        kept: list[Arc] = []
        for start, end in pairwise(cuts):
            piece = curve._replace(start=start, end=end)
            filled = _filled(piece, contains)
            if not filled or any(_covers(arc, piece) for arc in out):
                continue
            if kept and kept[-1].end == start and kept[-1].filled == filled:
                kept[-1] = kept[-1]._replace(end=end)
            else:
                kept.append(piece._replace(filled=filled))
        out += kept
    return tuple(out)


def area(arcs: Iterable[Arc]) -> float:
    """Area of the region that arcs and the axis R = 0 bound, by Green's theorem [m^2].

    ``A = oint R dz``, to which the axis adds nothing.
    """
    total = 0.0
    for arc in arcs:
        primitive = [
            arc.center[0] * math.sin(t) + arc.radius * (t + math.sin(t) * math.cos(t)) / 2
            for t in (arc.start, arc.end)
        ]
        total += arc.filled * arc.radius * (primitive[1] - primitive[0])
    return total


def first_moment(arcs: Iterable[Arc]) -> float:
    """Integral of R over the region, ``oint R^2 / 2 dz`` [m^3].

    Times 2 pi it is the volume of the solid of revolution (Pappus).
    """
    total = 0.0
    for arc in arcs:
        c, r = arc.center[0], arc.radius
        primitive = [
            c * c * math.sin(t)
            + c * r * (t + math.sin(t) * math.cos(t))
            + r * r * (math.sin(t) - math.sin(t) ** 3 / 3)
            for t in (arc.start, arc.end)
        ]
        total += arc.filled * r / 2 * (primitive[1] - primitive[0])
    return total


def _cuts(curve: Arc, curves: Sequence[Arc]) -> list[float]:
    """Angles at which a curve starts, ends, or meets another curve or the yaw axis."""
    (cx, cz), radius = curve.center, curve.radius
    angles = []
    if abs(cx) < radius:  # the yaw axis
        half = math.acos(-cx / radius)
        angles += [half, -half]
    for other in curves:
        dx, dz = other.center[0] - cx, other.center[1] - cz
        distance = math.hypot(dx, dz)
        if distance < 1e-12:
            if abs(other.radius - radius) < 1e-12:
                angles += [other.start, other.end]
            continue
        cosine = (distance**2 + radius**2 - other.radius**2) / (2 * distance * radius)
        if abs(cosine) <= 1.0 + 1e-12:  # tangent circles meet too: the stretched arm at a limit
            middle, half = math.atan2(dz, dx), math.acos(max(-1.0, min(1.0, cosine)))
            angles += [middle - half, middle + half]
    inside = sorted(
        curve.start + shift
        for angle in angles
        if 1e-12 < (shift := (angle - curve.start) % math.tau) < curve.end - curve.start - 1e-12
    )
    cuts = [curve.start]
    for angle in [*inside, curve.end]:
        if angle - cuts[-1] > 1e-12:
            cuts.append(angle)
    return cuts


def _covers(arc: Arc, piece: Arc) -> bool:
    """Whether a piece runs along an arc of the same circle, which must count only once."""
    return (
        math.dist(arc.center, piece.center) < 1e-12
        and abs(arc.radius - piece.radius) < 1e-12
        and ((piece.start + piece.end) / 2 - arc.start) % math.tau < arc.end - arc.start
    )


def _filled(piece: Arc, contains: Callable[[FloatArray, FloatArray], BoolArray]) -> int:
    """+1 or -1 if exactly one side of a piece belongs to the region, 0 if it is no boundary."""
    middle = (piece.start + piece.end) / 2
    step = min(_STEP, (piece.end - piece.start) * piece.radius / 10)
    radii = np.array([piece.radius - step, piece.radius + step])
    r = piece.center[0] + radii * math.cos(middle)
    z = piece.center[1] + radii * math.sin(middle)
    if (r <= 0.0).any():
        return 0
    near, far = contains(r, z).tolist()
    return int(near) - int(far)
