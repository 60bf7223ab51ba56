"""Inverse kinematics of a position, four branches with their edges, as one function for every language.

The plane of the arm faces the target, or faces away from it (`alpha5_model.kinematics.plane`). In
it the tcp is at ``(r, h)`` from the shoulder, ``rho^2 = r^2 + h^2``, and the two links and rho are
a triangle. With

    s = sqrt(((l_1 + l_2)^2 - rho^2) (rho^2 - (l_1 - l_2)^2)),

four times its area, the angle gamma between the links has the tangent ``s / (l_1^2 + l_2^2 -
rho^2)``, and the first link is turned from the direction of ``(r, h)`` by the angle with the tangent
``s / (rho^2 + l_1^2 - l_2^2)``, to either side. The factors keep their digits at the edge of reach,
and theta_1 is one arctangent, measured from the middle of its range so that it needs no full turn.

What is at the edge of reach, at a joint limit or on the yaw axis to rounding is put there, see
`Tolerances`. Decisions are selections, so that vectors and derivatives can have them.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import Any

import casadi
from casadi import SX, fabs, fmax, fmin, if_else, logic_and, logic_or

from alpha5_model.codegen.program import named
from alpha5_model.kinematics.plane import Tolerances, arm_plane


def inverse_kinematics() -> casadi.Function:
    """The four branches of a target, in the order of `alpha5_model.kinematics.ik.BRANCHES`.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad] and ``tolerances``, a `Tolerances`.

    Outputs: ``q`` (4, 4) [rad], NaN where a branch does not reach the target; ``exists`` and
    ``within_limits`` (4,) and ``singular``, 0 or 1.
    """
    g = arm_plane()
    position, wrist = SX.sym("position", 3), SX.sym("wrist")
    allowed = SX.sym("tolerances", len(Tolerances._fields))
    t = Tolerances._make(casadi.vertsplit(allowed))
    x, y, z = casadi.vertsplit(position)
    distance, h = casadi.sqrt(x * x + y * y), z - g.d_0
    singular = free = distance <= t.axis
    radius = if_else(free, 0.0, distance)
    azimuth = casadi.atan2(y, x)
    # The azimuth of a point at distance R is known to rounding / R.
    azimuth_slack = t.limit + t.azimuth / fmax(distance, t.axis)
    turns = casadi.floor((wrist - g.middle[3]) * (1 / math.tau) + 0.5)
    theta_3, _, wrist_fits = _in_range(wrist - turns * math.tau, 3, t.limit)

    back = g.phi_offset + g.middle[1]
    cos, sin = math.cos(back), math.sin(back)
    branches: dict[int, tuple[SX, ...]] = {}
    for pair, (r, half_turn) in enumerate(
        ((radius - g.a_0, 0.0), (-radius - g.a_0, math.pi))
    ):
        theta_0 = _shifted(azimuth, half_turn - g.azimuth_offset, -math.pi, math.pi, 0)
        theta_0, _, fits_0 = _in_range(theta_0, 0, azimuth_slack)
        theta_0, fits_0 = if_else(free, g.middle[0], theta_0), logic_or(free, fits_0)
        rho_2 = r * r + h * h
        above, below = g.longest**2 - rho_2, rho_2 - g.shortest**2
        # Distance from the edge of reach over that of rho^2: d(rho^2) = 2 rho d(rho).
        margin = fmin(above * (0.5 / g.longest), below * (0.5 / g.shortest))
        reached = -t.edge < margin
        singular = logic_or(singular, logic_and(reached, margin <= t.singular))
        # 1 where no root is taken, so that derivatives of the other branches stay finite.
        s = casadi.sqrt(if_else(reached, fmax(above, 0.0) * fmax(below, 0.0), 1.0))
        c = rho_2 + (g.l_1**2 - g.l_2**2)
        gamma = casadi.atan2(s, g.l_1**2 + g.l_2**2 - rho_2)
        ahead_h, ahead_r = cos * h - sin * r, cos * r + sin * h
        # Close to the stretched arm rounding of rho^2 moves the two angles against each other by
        # rounding / sin(gamma).
        sine = casadi.sqrt(fabs(above) * (1 / (g.l_1 * g.l_2)))
        slack = t.limit + t.elbow / fmax(sine, t.least_sine)
        for branch, sign in ((pair, 1.0), (pair + 2, -1.0)):
            side, (low, high) = sign * s, sorted((0.0, sign * math.pi))
            off = casadi.atan2(
                ahead_h * c - ahead_r * side, ahead_r * c + ahead_h * side
            )
            theta_1, slid, fits_1 = _in_range(g.middle[1] + off, 1, slack)
            theta_2 = _shifted(sign * gamma, -g.gamma_offset, low, high, 2)
            # The tcp stays where it is: l_2 d(gamma) = (l_1 + l_2) d(phi) for a stretched arm.
            theta_2, _, fits_2 = _in_range(
                theta_2 - g.longest / g.l_2 * slid, 2, t.limit
            )
            fits = reduce(logic_and, (reached, fits_0, fits_1, fits_2, wrist_fits))
            q = (
                if_else(reached, a, math.nan)
                for a in (theta_0, theta_1, theta_2, theta_3)
            )
            branches[branch] = casadi.horzcat(*q), reached, fits
    columns = zip(*(branches[i] for i in range(4)), strict=True)
    q, exists, fits = (casadi.vertcat(*column) for column in columns)
    outputs = {"q": q, "exists": exists, "within_limits": fits, "singular": singular}
    inputs = {"position": position, "wrist": wrist, "tolerances": allowed}
    return named("inverse_kinematics", inputs, outputs)


def _shifted(angle: SX, offset: float, low: float, high: float, joint: int) -> SX:
    """Of an angle from low to high and an offset, the 2 pi shift nearest to the middle of a joint's range."""
    end = arm_plane().middle[joint] + math.pi
    offset += math.tau * math.floor((end - low - offset) / math.tau)
    shifted = angle + offset
    return (
        shifted
        if high + offset <= end
        else shifted - if_else(end < shifted, math.tau, 0.0)
    )


def _in_range(angle: SX, joint: int, slack: Any) -> tuple[SX, SX, SX]:
    """The angle, on a limit that it passes by less than a slack; what it passed it by; whether it is in range."""
    g = arm_plane()
    limit = fmin(fmax(angle, g.lower[joint]), g.upper[joint])
    beyond = angle - limit
    fits = fabs(beyond) < slack
    return if_else(fits, limit, angle), if_else(fits, beyond, 0.0), fits
