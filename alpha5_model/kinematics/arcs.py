"""Circular arcs in a half-plane through the yaw axis, and what they bound."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array
from alpha5_model.theory import planar


class Arc(NamedTuple):
    """A circular arc in the half-plane, from ``start`` counter-clockwise to ``end``.

    Attributes:
        center: (R, z) [m].
        radius: [m].
        start, end: Angle from the R axis, ``start < end <= start + 2 pi`` [rad].
        filled: +1 if the region is on the centre's side, -1 if on the other, 0 if not
            known.
        cause: What bounds the region there, for example
            ``"theta_1 at its upper limit"``.
        side: ``"underarm"`` or ``"overarm"``, the pose that runs along it;
            ``"published"``.
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
        return planar_arc(self).point(float_array("angle", angle, ()))


def planar_arc(arc: Arc) -> planar.Arc:
    """The same arc of plane geometry."""
    return planar.Arc(
        center=arc.center,
        radius=arc.radius,
        start=arc.start,
        span=arc.end - arc.start,
    )


def area(arcs: Iterable[Arc]) -> float:
    """Area of the region between arcs and the axis R = 0, by Green's theorem [m^2]."""
    return sum(arc.filled * planar_arc(arc).area_integral() for arc in arcs)


def first_moment(arcs: Iterable[Arc]) -> float:
    """Integral of R over the region, ``oint R^2 / 2 dz`` [m^3].

    Times 2 pi it is the volume of the solid of revolution (Pappus).
    """
    # On an arc R = c + r cos(t) and dz = r cos(t) dt. Each end gives r / 2 times the
    # antiderivative of R^2 cos(t).
    total = 0.0
    for arc in arcs:
        c = arc.center[0]
        r = arc.radius
        t = np.array([arc.start, arc.end])
        s = np.sin(t)
        start, end = c * c * s + c * r * (t + s * np.cos(t)) + r * r * (s - s**3 / 3)
        total += arc.filled * r / 2 * float(end - start)
    return total
