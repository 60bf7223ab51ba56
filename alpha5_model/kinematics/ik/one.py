"""Inverse kinematics of one target with all its edges, in plain floats: the reference of the kernels."""

from __future__ import annotations

from math import atan2, floor, nan, pi, sqrt, tau

from alpha5_model.kinematics.edges import (
    AXIS_TOLERANCE,
    EDGE_TOLERANCE,
    LIMIT_TOLERANCE,
    SINGULAR_TOLERANCE,
)
from alpha5_model.kinematics.plane import arm_plane


def solve_one(x: float, y: float, z: float, wrist: float) -> tuple[list[float], int, int, bool]:
    """Solve a finite target.

    Args:
        x, y, z: tcp in ``base_link`` [m].
        wrist: theta_3, any turn of it [rad].

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
