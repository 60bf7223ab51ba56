"""Inverse kinematics of one target in plain floats.

`fast_solver` has the formulas of `alpha5_model.kinematics.ik` written out for speed: constants
bound once, no tuple of limits to walk, no edge to treat. Where rounding could matter, at the edge
of reach, beside a joint limit or near the yaw axis, it answers None and `solve_one` decides.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import atan, atan2, floor, nan, pi, sqrt, tau
from struct import Struct

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.kinematics.edges import (
    AXIS_TOLERANCE,
    EDGE_TOLERANCE,
    LIMIT_TOLERANCE,
    NEAR_AXIS,
    NEAR_EDGE,
    NEAR_LIMIT,
    SINGULAR_TOLERANCE,
)
from alpha5_model.kinematics.plane import arm_plane

#: q (4, 4), exists (4,), within_limits (4,), singular (), position (3,), all read-only.
Answer = tuple[FloatArray, BoolArray, BoolArray, BoolArray, FloatArray]

# One target's numbers are packed once, and its arrays are read-only views of them.
_pack, _array, _float = Struct("19d").pack, np.ndarray, np.dtype(np.float64)
#: The flags of four branches, branch i as bit i.
_FLAGS = tuple(np.array([[code >> b & 1 for b in range(4)] for code in range(16)], np.bool_))
_SINGULAR = np.array(False), np.array(True)
for _flags in (*_FLAGS, *_SINGULAR):
    _flags.flags.writeable = False

_NOWHERE = (nan, nan, nan, nan, nan, 0, 0)


def solve_one(x: float, y: float, z: float, wrist: float) -> tuple[list[float], int, int, bool]:
    """One target with all its edges, in plain floats.

    Returns:
        q of the four branches (16 numbers), ``exists`` and ``within_limits`` with branch i as
        bit i, singular.
    """
    g = arm_plane()
    limits, (longest_2, shortest_2) = g.limits, g.squares
    # Of rho^2 at the edge of reach, for a distance of 1 m from it: d(rho^2) = 2 rho d(rho).
    stretched, folded = 2 * g.longest, 2 * g.shortest
    turns = floor((wrist - limits[3][2]) / tau + 0.5)
    theta_3, wrist_fits = _into_range(wrist - turns * tau, limits[3], LIMIT_TOLERANCE)
    radius = sqrt(x * x + y * y)
    h = z - g.d_0
    singular = free = radius <= AXIS_TOLERANCE
    if free:
        radius = 0.0
    q = [nan] * 16
    exists = within = 0
    for pair in (0, 1):
        r = (-radius if pair else radius) - g.a_0
        rho_2 = r * r + h * h
        above = longest_2 - rho_2
        below = rho_2 - shortest_2
        if above <= SINGULAR_TOLERANCE * stretched or below <= SINGULAR_TOLERANCE * folded:
            if above < -EDGE_TOLERANCE * stretched or below < -EDGE_TOLERANCE * folded:
                continue
            singular = True
        if free:
            theta_0, fits_0 = limits[0][2], True
        else:
            # The azimuth of a point at distance R is known to rounding / R.
            theta_0 = atan2(y, x) - g.azimuth_offset + (pi if pair else 0.0)
            theta_0, fits_0 = _into_range(
                _near(theta_0, limits[0][2]), limits[0], LIMIT_TOLERANCE + 1e-15 / radius
            )
        root_above = sqrt(above) if above > 0.0 else 0.0
        root_below = sqrt(below) if below > 0.0 else 0.0
        half_gamma = atan2(root_below, root_above)
        alpha = atan2(root_above, root_below) + atan2(g.k * root_above, root_below)
        phi = atan2(h, r) - g.phi_offset
        # Close to the stretched arm, sin(gamma)^2 = above / (l_1 l_2), and rounding of rho^2 moves
        # the two angles against each other by rounding / sin(gamma).
        slack = LIMIT_TOLERANCE + 1e-14 / max(sqrt(abs(above) / (g.l_1 * g.l_2)), 1e-7)
        for branch, side in ((pair, 1.0), (pair + 2, -1.0)):
            theta_1 = _near(phi - side * alpha, limits[1][2])
            theta_2 = _near(side * 2.0 * half_gamma - g.gamma_offset, limits[2][2])
            snapped, fits_1 = _into_range(theta_1, limits[1], slack)
            # The tcp stays where it is: l_2 d(gamma) = (l_1 + l_2) d(phi) for a stretched arm.
            theta_2 += g.longest / g.l_2 * (snapped - theta_1)
            theta_2, fits_2 = _into_range(theta_2, limits[2], LIMIT_TOLERANCE)
            q[4 * branch : 4 * branch + 4] = theta_0, snapped, theta_2, theta_3
            exists |= 1 << branch
            within |= (fits_0 and fits_1 and fits_2 and wrist_fits) << branch
    return q, exists, within, singular


def _near(angle: float, middle: float) -> float:
    """The 2 pi shift of an angle within one turn of the window that is nearest to the middle."""
    if angle > middle + pi:
        return angle - tau
    return angle + tau if angle < middle - pi else angle


def _into_range(
    angle: float, limits: tuple[float, float, float], slack: float
) -> tuple[float, bool]:
    """The angle, put on a limit that it passes by no more than ``slack``, and whether it fits."""
    lower, upper, _ = limits
    if lower <= angle <= upper:
        return angle, True
    limit = lower if angle < lower else upper
    fits = abs(angle - limit) <= slack
    return (limit if fits else angle), fits


@cache
def fast_solver() -> Callable[[float, float, float, float], Answer | None]:
    """A function of x, y, z [m] and the wrist angle [rad], all finite."""
    g = arm_plane()
    a_0, d_0, k, (longest_2, shortest_2) = g.a_0, g.d_0, g.k, g.squares
    azimuth_offset, phi_offset, gamma_offset = g.azimuth_offset, g.phi_offset, g.gamma_offset
    # Of joints 0 to 2: the range less and plus a margin, and the window of one turn around it.
    margin = NEAR_LIMIT
    (low_0, high_0, loose_0, far_0, bottom_0, top_0), joint_1, joint_2 = (
        (low + margin, high - margin, low - margin, high + margin, middle - pi, middle + pi)
        for low, high, middle in g.limits[:3]
    )
    low_1, high_1, loose_1, far_1, bottom_1, top_1 = joint_1
    low_2, high_2, loose_2, far_2, _, top_2 = joint_2
    low_3, high_3, _ = g.limits[3]
    flipped_offset = tau - gamma_offset
    half_pi, regular = pi / 2, _SINGULAR[False]

    def facing(
        r: float, h: float, h_2: float, theta_0: float
    ) -> tuple[float, float, float, float, float, int, int] | None:
        """theta_0; theta_1, theta_2; both again for the other elbow; bits 1 and 4 of each flag."""
        rho_2 = r * r + h_2
        above = longest_2 - rho_2
        below = rho_2 - shortest_2
        if above < NEAR_EDGE or below < NEAR_EDGE:
            return _NOWHERE if above < -NEAR_EDGE or below < -NEAR_EDGE else None
        if theta_0 > top_0:
            theta_0 -= tau
        elif theta_0 < bottom_0:
            theta_0 += tau
        t = sqrt(below / above)
        half_gamma = atan(t)
        alpha = half_pi + atan(k / t) - half_gamma
        phi = atan2(h, r) - phi_offset
        theta_1 = phi - alpha
        if theta_1 < bottom_1:
            theta_1 += tau
        elif theta_1 > top_1:
            theta_1 -= tau
        flipped_1 = phi + alpha
        if flipped_1 > top_1:
            flipped_1 -= tau
        elif flipped_1 < bottom_1:
            flipped_1 += tau
        theta_2 = half_gamma + half_gamma - gamma_offset
        flipped_2 = flipped_offset - half_gamma - half_gamma
        if flipped_2 > top_2:
            flipped_2 -= tau
        within = 0
        if low_0 < theta_0 < high_0:
            if low_1 < theta_1 < high_1:
                if low_2 < theta_2 < high_2:
                    within = 1
                elif loose_2 < theta_2 < far_2:
                    return None
            elif loose_1 < theta_1 < far_1:
                return None
            if low_1 < flipped_1 < high_1:
                if low_2 < flipped_2 < high_2:
                    within += 4
                elif loose_2 < flipped_2 < far_2:
                    return None
            elif loose_1 < flipped_1 < far_1:
                return None
        elif loose_0 < theta_0 < far_0:
            return None
        return theta_0, theta_1, theta_2, flipped_1, flipped_2, 5, within

    def solve(x: float, y: float, z: float, wrist: float) -> Answer | None:
        radius = sqrt(x * x + y * y)
        if radius < NEAR_AXIS or not low_3 <= wrist <= high_3:
            return None
        h = z - d_0
        h_2 = h * h
        theta_0 = atan2(y, x) - azimuth_offset
        under = facing(radius - a_0, h, h_2, theta_0)
        over = facing(-radius - a_0, h, h_2, theta_0 + pi)
        if under is None or over is None:
            return None
        u_0, u_1, u_2, u_1f, u_2f, exists, within = under
        o_0, o_1, o_2, o_1f, o_2f, exists_o, within_o = over
        u_3 = wrist if exists else nan
        o_3 = wrist if exists_o else nan
        # fmt: off
        numbers = _pack(
            u_0, u_1, u_2, u_3, o_0, o_1, o_2, o_3,
            u_0, u_1f, u_2f, u_3, o_0, o_1f, o_2f, o_3,
            x, y, z,
        )
        # fmt: on
        return (
            _array((4, 4), _float, numbers),
            _FLAGS[exists + 2 * exists_o],
            _FLAGS[within + 2 * within_o],
            regular,
            _array(3, _float, numbers, 128),
        )

    return solve


def careful_answer(x: float, y: float, z: float, wrist: float) -> Answer:
    """The same from `solve_one`, for any target."""
    q, exists, within, singular = solve_one(x, y, z, wrist)
    numbers = _pack(*q, x, y, z)
    return (
        _array((4, 4), _float, numbers),
        _FLAGS[exists],
        _FLAGS[within],
        _SINGULAR[singular],
        _array(3, _float, numbers, 128),
    )
