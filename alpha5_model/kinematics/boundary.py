"""The boundary of what the tcp can reach, as exact arcs in the plane of the arm.

A half-plane through the yaw axis, R >= 0 outwards and z up, is reached from its front by the arm that
faces it (underarm) and from its back by the arm that turns away (overarm, the plane of the arm
mirrored). In the plane the arm is a planar arm of two links. Where one of its joints is at the end of its range, or
the arm is stretched or folded, the other joint moves the tcp on an arc, and the boundary of the reachable
set lies on these arcs [Siciliano2009, 2.10.4; Gupta1986].

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.10.4 (workspace).
    [Gupta1986] K. C. Gupta: On the nature of robot workspace, Int. J. Robotics Research 5(2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model import planar
from alpha5_model.checks import BoolArray, FloatArray, choice, flag, float_array, together
from alpha5_model.kinematics.ik.batch import reached
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.planar.arm import RELATIVE_STEP, RELATIVE_TOLERANCE
from alpha5_model.planar.arrangement import bounds, united

#: How a half-plane is reached: by one pose, or by either.
SIDES = ("underarm", "overarm", "both")


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
        return _curve(self).point(float_array("angle", angle, ()))


def boundary(side: str = "both", limits: bool = True) -> tuple[Arc, ...]:
    """Boundary arcs of the reachable part of a half-plane.

    The yaw axis itself, which closes the region at R = 0, is not an arc and not listed: from a
    region on the axis the set goes on beyond it.

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union, which holds at all
            azimuths where the range of theta_0 allows both.
        limits: Respect the limits of theta_1 and theta_2.

    Raises:
        UnknownNameError: Another side.
        InputError: Limits that are neither True nor False.
    """
    return _boundary(choice("side", side, SIDES), flag("limits", limits))


@cache
def _boundary(side: str, limits: bool) -> tuple[Arc, ...]:
    sides = SIDES[:2] if side == "both" else (side,)
    arcs = [arc for name in sides for arc in critical_arcs(name, limits)]
    return trace(arcs, lambda radius, z: in_half_plane(radius, z, side, limits))


def in_half_plane(
    radius: FloatArray, z: FloatArray, side: str = "both", limits: bool = True
) -> BoolArray:
    """Which points of a half-plane can be reached, theta_0 aside.

    Args:
        radius: Distance from the yaw axis, (...) [m].
        z: Height, (...) [m].
        side, limits: As for `boundary`.
    """
    g = arm_plane()
    choice("side", side, SIDES)
    limits = flag("limits", limits)
    radius, z = together(radius=radius, z=z)
    out = np.zeros(radius.shape, np.bool_)
    for pair, name in enumerate(SIDES[:2]):
        if side in (name, "both"):
            azimuth = g.middle[0] + g.azimuth_offset - pair * math.pi
            target = np.stack([radius * math.cos(azimuth), radius * math.sin(azimuth), z], axis=-1)
            flags = reached(target, limits)
            out |= flags[..., pair] | flags[..., pair + 2]
    return out


def critical_arcs(side: str, limits: bool = True) -> list[Arc]:
    """Arcs that the boundary can lie on: where the tcp goes with one of the two joints held."""
    g = arm_plane()
    phi, bend = (-math.pi, math.pi), (math.pi - g.gamma_range[1], math.pi - g.gamma_range[0])
    held = [("stretched", phi, (0.0, 0.0)), ("folded", phi, (math.pi, math.pi))]
    if limits:
        held = [("stretched", g.phi_range, (0.0, 0.0))]
        for name, first, gamma in zip(("lower", "upper"), g.phi_range, g.gamma_range, strict=True):
            still = math.pi - gamma
            held.append((f"theta_2 at its {name} limit", g.phi_range, (still, still)))
            held.append((f"theta_1 at its {name} limit", (first, first), bend))
    out = []
    for cause, *ranges in held:
        (curve,) = planar.PlanarArm((g.l_1, g.l_2), ranges).workspace().thin
        assert isinstance(curve, planar.Arc)
        (x, z), (start, end) = curve.center, curve.interval
        x += g.a_0
        if side == "overarm":  # the same at -R
            x, start, end = -x, math.pi - end, math.pi - start
        out.append(Arc((x, z + g.d_0), curve.radius, start, end, 0, cause, side))
    return out


def trace(
    arcs: Sequence[Arc], contains: Callable[[FloatArray, FloatArray], BoolArray]
) -> tuple[Arc, ...]:
    """The boundary of a region of the half-plane that is known to lie on some arcs.

    Args:
        arcs: Where two are of one circle, the boundary is said to lie on the first.
        contains: Which points (R, z), two arrays (N,), belong to the region.

    Returns:
        Arcs with R > 0; the axis itself, which may close the region, is not listed.
    """
    size = 2 * arm_plane().longest
    tolerance, step = RELATIVE_TOLERANCE * size, RELATIVE_STEP * size
    axis = planar.Segment((0.0, -size), math.pi / 2, 2 * size)
    edges, _ = bounds(
        united([*map(_curve, arcs), axis], tolerance),
        lambda p: (p[:, 0] > 0.0) & contains(p[:, 0], p[:, 1]),
        tolerance,
        step,
    )
    out = []
    for edge in edges:
        if isinstance(curve := edge.curve, planar.Arc):
            arc = next(
                arc
                for arc in arcs
                if math.dist(arc.center, curve.center) <= tolerance
                and abs(arc.radius - curve.radius) <= tolerance
            )
            start, end = curve.interval
            turn = math.tau * round((start + end) / (2 * math.tau))
            filled = 1 if edge.inside_left else -1
            out.append(arc._replace(start=start - turn, end=end - turn, filled=filled))
    return tuple(out)


def area(arcs: Iterable[Arc]) -> float:
    """Area of the region that arcs and the axis R = 0 bound, by Green's theorem [m^2]."""
    return sum(arc.filled * _curve(arc).area_integral() for arc in arcs)


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


def _curve(arc: Arc) -> planar.Arc:
    return planar.Arc(arc.center, arc.radius, arc.start, arc.end - arc.start)
