"""Inverse kinematics of one target, every branch with its edges, as one function.

In the plane of the arm (`alpha5_model.kinematics.plane`) two links reach a point with the elbow on either side. What
is at the edge of reach, at a joint limit or on the yaw axis to rounding is put there, see `Tolerances`. Decisions
are selections, so that every language can have them.
"""

from __future__ import annotations

import math
from functools import reduce

import casadi

from alpha5_model.kinematics.edges import Tolerances
from alpha5_model.kinematics.plane import arm_plane


def solutions() -> casadi.Function:
    """The four branches of a target, row by row in the order of `alpha5_model.kinematics.ik.BRANCHES`.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad] and ``tolerances``, a `Tolerances`.

    Outputs: ``q`` (4, 4) [rad], NaN where a branch does not reach the target; ``exists`` and
    ``within_limits`` (4,) and ``singular``, 0 or 1.
    """
    g, select = arm_plane(), casadi.if_else
    position, wrist = casadi.SX.sym("position", 3), casadi.SX.sym("wrist")
    allowed = casadi.SX.sym("tolerances", len(Tolerances._fields))
    t = Tolerances._make(casadi.vertsplit(allowed))
    x, y, z = casadi.vertsplit(position)

    def near(angle: casadi.SX, joint: int) -> casadi.SX:
        off = angle - g.middle[joint]
        turned = select(off < -math.pi, angle + math.tau, angle)
        return select(off > math.pi, angle - math.tau, turned)

    def into_range(
        angle: casadi.SX, joint: int, slack: casadi.SX | float
    ) -> tuple[casadi.SX, casadi.SX]:
        lower, upper, _ = g.limits[joint]
        limit = casadi.fmin(casadi.fmax(angle, lower), upper)
        fits = casadi.fabs(angle - limit) <= slack
        return select(fits, limit, angle), fits

    # Angles: each the 2 pi shift nearest to the middle of its range.
    turns = casadi.floor((wrist - g.middle[3]) / math.tau + 0.5)
    theta_3, wrist_fits = into_range(wrist - turns * math.tau, 3, t.limit)
    distance = casadi.sqrt(x * x + y * y)
    h = z - g.d_0
    free = distance <= t.axis
    radius = select(free, 0.0, distance)
    singular = free
    branches: dict[int, tuple[casadi.SX, ...]] = {}
    for pair, (sign, half_turn) in enumerate(((1.0, 0.0), (-1.0, math.pi))):
        r = sign * radius - g.a_0
        rho_2 = r * r + h * h
        above, below = g.squares[0] - rho_2, rho_2 - g.squares[1]
        # Distance from the edge of reach over that of rho^2: d(rho^2) = 2 rho d(rho).
        margin = casadi.fmin(above / (2 * g.longest), below / (2 * g.shortest))
        reached = margin >= -t.edge
        singular = casadi.logic_or(singular, casadi.logic_and(reached, margin <= t.singular))
        azimuth = casadi.atan2(y, x) - g.azimuth_offset + half_turn
        # The azimuth of a point at distance R is known to rounding / R.
        slack = t.limit + t.azimuth / casadi.fmax(distance, t.axis)
        theta_0, fits_0 = into_range(near(azimuth, 0), 0, slack)
        theta_0, fits_0 = select(free, g.middle[0], theta_0), casadi.logic_or(free, fits_0)
        # 1 where no root is taken, so that derivatives of the other branches stay finite.
        squares = (select(reached, casadi.fmax(m, 0.0), 1.0) for m in (above, below))
        root_above, root_below = map(casadi.sqrt, squares)
        half_gamma = casadi.atan2(root_below, root_above)
        alpha = casadi.atan2(root_above, root_below) + casadi.atan2(g.k * root_above, root_below)
        phi = casadi.atan2(h, r) - g.phi_offset
        # Close to the stretched arm rounding of rho^2 moves the two angles against each other by
        # rounding / sin(gamma).
        sine = casadi.sqrt(casadi.fabs(above) / (g.l_1 * g.l_2))
        slack = t.limit + t.elbow / casadi.fmax(sine, t.least_sine)
        for branch, side in ((pair, 1.0), (pair + 2, -1.0)):
            raw = near(phi - side * alpha, 1)
            theta_1, fits_1 = into_range(raw, 1, slack)
            theta_2 = near(side * 2.0 * half_gamma - g.gamma_offset, 2)
            # The tcp stays where it is: l_2 d(gamma) = (l_1 + l_2) d(phi) for a stretched arm.
            theta_2 += g.longest / g.l_2 * (theta_1 - raw)
            theta_2, fits_2 = into_range(theta_2, 2, t.limit)
            q = casadi.horzcat(theta_0, theta_1, theta_2, theta_3)
            fits = reduce(casadi.logic_and, (reached, fits_0, fits_1, fits_2, wrist_fits))
            branches[branch] = select(reached, q, math.nan), reached, fits
    q, exists, within = (
        casadi.vertcat(*column) for column in zip(*(branches[i] for i in range(4)), strict=True)
    )
    return casadi.Function(
        "inverse_kinematics",
        [position, wrist, allowed],
        [q, exists, within, singular],
        ["position", "wrist", "tolerances"],
        ["q", "exists", "within_limits", "singular"],
    )
