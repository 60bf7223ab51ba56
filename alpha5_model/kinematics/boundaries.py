"""The boundary of what the tcp can reach, as arcs of a half-plane.

In the plane the arm is a planar arm of two links. If one of its joints is at the end of
its range, or the arm is stretched or folded, the other joint moves the tcp on an arc.
The boundary of the reachable set lies on these arcs [Siciliano2009, 2.10.4; Gupta1986].

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.10.4
        (workspace).
    [Gupta1986] K. C. Gupta: On the nature of robot workspace, Int. J. Robotics
        Research 5(2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import NamedTuple

from alpha5_model._support.checks import BoolArray, FloatArray, choice, flag
from alpha5_model.kinematics.arcs import Arc, planar_arc
from alpha5_model.kinematics.half_plane import POSES, SIDES, in_half_plane
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.theory import planar
from alpha5_model.theory.planar.arm import RELATIVE_STEP, RELATIVE_TOLERANCE
from alpha5_model.theory.planar.boundary import bounds

#: Points of the half-plane R (M,), z (M,) -> whether each belongs to a region, (M,).
Region = Callable[[FloatArray, FloatArray], BoolArray]
#: Least and greatest angle of a joint of the planar arm [rad].
Range = tuple[float, float]


def boundary(plane: ArmPlane, side: str, limits: bool) -> tuple[Arc, ...]:
    """Boundary arcs of the reachable part of a half-plane."""
    return _boundary(plane, choice("side", side, SIDES), flag("limits", limits))


@cache
def _boundary(plane: ArmPlane, side: str, limits: bool) -> tuple[Arc, ...]:
    arcs = []
    for pose in POSES if side == "both" else (side,):
        arcs += critical_arcs(plane, pose, limits)
    return trace(
        plane, arcs, lambda radius, z: in_half_plane(plane, radius, z, side, limits)
    )


class _Sweep(NamedTuple):
    """A motion along an arc: one joint of the planar arm is fixed, the other turns.

    Attributes:
        cause: Why the joint is fixed.
        first: Direction of the first link.
        second: Angle of the second link to the first.
    """

    cause: str
    first: Range
    second: Range


def critical_arcs(plane: ArmPlane, side: str, limits: bool = True) -> list[Arc]:
    """The arcs of a pose that the boundary can lie on."""
    sweeps = _within_limits(plane) if limits else _whole_turns()
    return [_arc(plane, sweep, side) for sweep in sweeps]


def _whole_turns() -> Iterator[_Sweep]:
    """The sweeps of an arm without limits."""
    turn = (-math.pi, math.pi)
    yield _Sweep(cause="stretched", first=turn, second=(0.0, 0.0))
    yield _Sweep(cause="folded", first=turn, second=(math.pi, math.pi))


def _within_limits(plane: ArmPlane) -> Iterator[_Sweep]:
    """The sweeps of an arm with limits."""
    phi_lower = plane.lower[1] + plane.phi_offset
    phi_upper = plane.upper[1] + plane.phi_offset
    # The second link bends from the first by pi - gamma: less for a greater theta_2.
    bend_at_lower = math.pi - (plane.lower[2] + plane.gamma_offset)
    bend_at_upper = math.pi - (plane.upper[2] + plane.gamma_offset)

    phi = (phi_lower, phi_upper)
    bend = (bend_at_upper, bend_at_lower)
    yield _Sweep("stretched", phi, (0.0, 0.0))
    yield _Sweep("theta_2 at its lower limit", phi, (bend_at_lower, bend_at_lower))
    yield _Sweep("theta_1 at its lower limit", (phi_lower, phi_lower), bend)
    yield _Sweep("theta_2 at its upper limit", phi, (bend_at_upper, bend_at_upper))
    yield _Sweep("theta_1 at its upper limit", (phi_upper, phi_upper), bend)


def _arc(plane: ArmPlane, sweep: _Sweep, side: str) -> Arc:
    """The arc that the tcp draws in the half-plane."""
    arm = planar.PlanarArm((plane.l_1, plane.l_2), (sweep.first, sweep.second))
    (curve,) = arm.workspace().thin
    assert isinstance(curve, planar.Arc)
    x, z = curve.center
    x += plane.a_0
    start, end = curve.interval
    if side == "overarm":  # the same at -R
        x = -x
        start, end = math.pi - end, math.pi - start
    return Arc(
        center=(x, z + plane.d_0),
        radius=curve.radius,
        start=start,
        end=end,
        filled=0,
        cause=sweep.cause,
        side=side,
    )


def trace(plane: ArmPlane, arcs: Sequence[Arc], contains: Region) -> tuple[Arc, ...]:
    """The boundary of a region of the half-plane that is known to lie on some arcs.

    Args:
        plane: Its longest reach sets the scale of the search.
        arcs: If two lie on one circle, the boundary there is attributed to the first.
        contains: Which points belong to the region.

    Returns:
        Arcs with R > 0; the axis itself, which may close the region, is not listed.
    """
    size = 2 * plane.longest
    tolerance = RELATIVE_TOLERANCE * size
    curves: list[planar.Curve] = [planar_arc(arc) for arc in arcs]
    curves.append(planar.Segment((0.0, -size), math.pi / 2, 2 * size))  # the axis
    edges, _ = bounds(
        curves,
        lambda points: (points[:, 0] > 0.0) & contains(points[:, 0], points[:, 1]),
        tolerance,
        RELATIVE_STEP * size,
    )

    traced = []
    for edge in edges:
        if not isinstance(edge.curve, planar.Arc):
            continue
        arc = _on_same_circle(arcs, edge.curve)
        start, end = edge.curve.interval
        turn = math.tau * round((start + end) / (2 * math.tau))
        filled = 1 if edge.inside_left else -1
        traced.append(arc._replace(start=start - turn, end=end - turn, filled=filled))
    return tuple(traced)


def _on_same_circle(arcs: Sequence[Arc], found: planar.Arc) -> Arc:
    """The arc with the centre and radius of another."""
    circle = (*found.center, found.radius)
    return min(arcs, key=lambda arc: math.dist((*arc.center, arc.radius), circle))
