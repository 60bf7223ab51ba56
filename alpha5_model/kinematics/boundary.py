"""The boundary of what the tcp can reach, as exact arcs in the plane of the arm.

A half-plane through the yaw axis, R >= 0 outwards and z up, is reached from its front by the arm that
faces it (underarm) and from its back by the arm that turns away (overarm, the plane of the arm
mirrored). Where the joints are at the ends of their ranges, or the arm is stretched or folded, the tcp
runs on circles: about the shoulder for theta_2 fixed or singular, about the elbow for theta_1 fixed.
The boundary of the reachable set lies on these circles [Siciliano2009, 2.10.4; Gupta1986].

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.10.4 (workspace).
    [Gupta1986] K. C. Gupta: On the nature of robot workspace, Int. J. Robotics Research 5(2).
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray, choice, flag, together
from alpha5_model.kinematics.arcs import Arc, trace
from alpha5_model.kinematics.arm_plane import arm_plane
from alpha5_model.kinematics.ik_batch import reached

#: How a half-plane is reached: by one pose, or by either.
SIDES = ("underarm", "overarm", "both")


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
    curves = [curve for name in sides for curve in side_curves(name, limits)]
    return trace(curves, lambda radius, z: in_half_plane(radius, z, side, limits))


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


def side_curves(side: str, limits: bool = True) -> list[Arc]:
    """Circles that the boundary can lie on, before cutting."""
    g = arm_plane()
    (phi_low, phi_high), (gamma_low, gamma_high) = g.phi_range, g.gamma_range
    shoulder = (g.a_0, g.d_0)
    if not limits:
        curves = [
            Arc(shoulder, g.longest, 0.0, math.tau, 0, "stretched", side),
            Arc(shoulder, g.shortest, 0.0, math.tau, 0, "folded", side),
        ]
    else:
        curves = [Arc(shoulder, g.longest, phi_low, phi_high, 0, "stretched", side)]
        for gamma, end in ((gamma_low, "lower"), (gamma_high, "upper")):
            # tcp in the axes of the first link
            x, y = g.l_1 - g.l_2 * math.cos(gamma), g.l_2 * math.sin(gamma)
            turn = math.atan2(y, x)
            cause = f"theta_2 at its {end} limit"
            curves.append(
                Arc(shoulder, math.hypot(x, y), phi_low + turn, phi_high + turn, 0, cause, side)
            )
        for phi, end in ((phi_low, "lower"), (phi_high, "upper")):
            elbow = (g.a_0 + g.l_1 * math.cos(phi), g.d_0 + g.l_1 * math.sin(phi))
            first, last = phi + math.pi - gamma_high, phi + math.pi - gamma_low
            curves.append(Arc(elbow, g.l_2, first, last, 0, f"theta_1 at its {end} limit", side))
    return curves if side == "underarm" else [_mirrored(curve) for curve in curves]


def _mirrored(arc: Arc) -> Arc:
    """The arc at -R."""
    center = (-arc.center[0], arc.center[1])
    return arc._replace(center=center, start=math.pi - arc.end, end=math.pi - arc.start)
