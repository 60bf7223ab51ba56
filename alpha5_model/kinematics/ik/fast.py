"""Inverse kinematics of one target, as fast as plain Python gets, away from every edge.

The formulas of `alpha5_model.kinematics.ik.solutions`, written out for speed: constants bound once, no tuple of
limits to walk, no edge to treat. Where rounding could matter, at the edge of reach, beside a joint
limit or near the yaw axis, the answer is None and `alpha5_model.kinematics.ik.one` decides.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import atan, atan2, nan, pi, sqrt
from struct import Struct

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.kinematics.ik.one import NEAR_AXIS, NEAR_EDGE, NEAR_LIMIT, solve_one
from alpha5_model.kinematics.plane import arm_plane

#: q (4, 4), exists (4,), within_limits (4,), singular (), position (3,), all read-only.
Answer = tuple[FloatArray, BoolArray, BoolArray, BoolArray, FloatArray]

# One target's numbers are packed once, and its arrays are read-only views of them.
_pack, _array, _float = Struct("19d").pack, np.ndarray, np.dtype(np.float64)
#: The flags of four branches, branch i as bit i.
_FLAGS = tuple(
    np.array([code >> branch & 1 for branch in range(4)], np.bool_) for code in range(16)
)
_SINGULAR = (np.array(False), np.array(True))
for _flags in (*_FLAGS, *_SINGULAR):
    _flags.flags.writeable = False

_NOWHERE = (nan, nan, nan, nan, nan, 0, 0)


@cache
def fast_solver() -> Callable[[float, float, float, float], Answer | None]:
    """A function of x, y, z [m] and the wrist angle [rad], all finite."""
    g = arm_plane()
    a_0, d_0, k, (longest_2, shortest_2) = g.a_0, g.d_0, g.k, g.squares
    (low_0, high_0, mid_0), (low_1, high_1, mid_1), (low_2, high_2, mid_2), (low_3, high_3, _) = (
        g.limits
    )
    # Ends of the windows of one turn around each range; the ranges less and plus a margin.
    top_0, bottom_0, top_1, bottom_1, top_2 = (
        mid_0 + pi,
        mid_0 - pi,
        mid_1 + pi,
        mid_1 - pi,
        mid_2 + pi,
    )
    slack = NEAR_LIMIT
    loose_0, loose_1, loose_2 = low_0 - slack, low_1 - slack, low_2 - slack
    low_0, low_1, low_2 = low_0 + slack, low_1 + slack, low_2 + slack
    far_0, far_1, far_2 = high_0 + slack, high_1 + slack, high_2 + slack
    high_0, high_1, high_2 = high_0 - slack, high_1 - slack, high_2 - slack
    tau = 2 * pi
    azimuth_offset, phi_offset, gamma_offset = g.azimuth_offset, g.phi_offset, g.gamma_offset
    flipped_offset = tau - gamma_offset
    half_pi = pi / 2
    near_axis, near_edge = NEAR_AXIS, NEAR_EDGE
    regular = _SINGULAR[False]

    def facing(
        r: float, h: float, h_2: float, theta_0: float
    ) -> tuple[float, float, float, float, float, int, int] | None:
        """theta_0; theta_1, theta_2; both again for the other elbow; bits 1 and 4 of each flag."""
        rho_2 = r * r + h_2
        above = longest_2 - rho_2
        below = rho_2 - shortest_2
        if above < near_edge or below < near_edge:
            return _NOWHERE if above < -near_edge or below < -near_edge else None
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
        if radius < near_axis or not low_3 <= wrist <= high_3:
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
    """The same from `solve_one`, wherever the target is."""
    q, exists, within, singular = solve_one(x, y, z, wrist)
    numbers = _pack(*q, x, y, z)
    return (
        _array((4, 4), _float, numbers),
        _FLAGS[exists],
        _FLAGS[within],
        _SINGULAR[singular],
        _array(3, _float, numbers, 128),
    )
