"""Inverse kinematics of a position as real numbers only: angles, and margins that say what they are.

The plane of the arm faces the target, or faces away from it (`alpha5_model.kinematics.plane`). In
it the tcp is at ``(r, h)`` from the shoulder, ``rho^2 = r^2 + h^2``, and the two links and rho are
a triangle. With

    s = sqrt(((l_1 + l_2)^2 - rho^2) (rho^2 - (l_1 - l_2)^2)),

four times its area, the angle gamma between the links has the tangent ``s / (l_1^2 + l_2^2 -
rho^2)``, and the first link is turned from the direction of ``(r, h)`` by the angle with the tangent
``s / (rho^2 + l_1^2 - l_2^2)``, to either side. The factors keep their digits at the edge of reach,
and theta_1 is one arctangent, measured from the middle of its range so that it needs no full turn.

No margin is a truth value, so that every kind of code can be made of this: what holds is the sign.
Where rounding could turn a sign, the clearance is not positive, and the target is one for
`alpha5_model.kinematics.ik.one.solve_one`.
"""

from __future__ import annotations

import math
from functools import reduce

import casadi

from alpha5_model.kinematics.edges import LIMIT_TOLERANCE, NEAR_AXIS, NEAR_EDGE, NEAR_LIMIT
from alpha5_model.kinematics.plane import arm_plane


def inverse_kinematics() -> casadi.Function:
    """Four branches (`BRANCHES`), constants of the arm folded.

    Inputs: ``position`` (3) [m] and ``wrist`` [rad].

    Outputs:
        q: (4, 4), branch and joint, as in `Solutions` but a number for every branch [rad].
        reach: (2), of the pose that faces the target and the one that faces away; it reaches where
            this is positive: rho^2 from the nearer edge of reach [m^2].
        limits: (4), distance from the nearest joint limit; within them where not negative [rad].
        clearance: What of these decides is certain where this is positive [1].
    """
    g = arm_plane()
    position, wrist = casadi.SX.sym("position", 3), casadi.SX.sym("wrist")
    x, y, z = casadi.vertsplit(position)
    radius, h = casadi.sqrt(x * x + y * y), z - g.d_0
    ranges = [((upper - lower) / 2, middle) for lower, upper, middle in g.limits[:3]]
    theta_3, wrist_margin = _wrist(wrist)

    azimuth = casadi.atan2(y, x) - g.azimuth_offset
    theta_0 = [_wrapped(azimuth + half_turn, g.middle[0]) for half_turn in (0.0, math.pi)]
    reach, nearest, q, limits = [], [], {}, {}
    for pair, r in enumerate((radius - g.a_0, -radius - g.a_0)):
        rho_2 = r * r + h * h
        above, below = g.squares[0] - rho_2, rho_2 - g.squares[1]
        reach.append(casadi.fmin(above, below))
        s = casadi.sqrt(casadi.fmax(above * below, 0))
        c = rho_2 + (g.l_1**2 - g.l_2**2)
        gamma = casadi.atan2(s, g.l_1**2 + g.l_2**2 - rho_2)
        ahead_h, ahead_r = _turned(r, h, g.phi_offset + g.middle[1])
        theta_2 = gamma - g.gamma_offset, _wrapped(-gamma - g.gamma_offset, g.middle[2])
        for branch, side, bend in ((pair, s, theta_2[0]), (pair + 2, -s, theta_2[1])):
            off = casadi.atan2(ahead_h * c - ahead_r * side, ahead_r * c + ahead_h * side)
            theta = theta_0[pair], g.middle[1] + off, bend
            margin = reduce(
                casadi.fmin,
                (half - casadi.fabs(t - m) for t, (half, m) in zip(theta, ranges, strict=True)),
            )
            nearest.append(casadi.fabs(margin))
            limits[branch] = casadi.fmin(margin, wrist_margin)
            q[branch] = [*theta, theta_3]
    edge = casadi.fmin(*map(casadi.fabs, reach)) * (1 / NEAR_EDGE)
    limit = reduce(casadi.fmin, nearest) * (1 / NEAR_LIMIT)
    clearance = reduce(casadi.fmin, (radius * (1 / NEAR_AXIS), edge, limit)) - 1
    return casadi.Function(
        "inverse_kinematics",
        [position, wrist],
        [
            casadi.vertcat(*(casadi.horzcat(*q[branch]) for branch in range(4))),
            casadi.vertcat(*reach),
            casadi.vertcat(*(limits[branch] for branch in range(4))),
            clearance,
        ],
        ["position", "wrist"],
        ["q", "reach", "limits", "clearance"],
    )


def _turned(x: casadi.SX, y: casadi.SX, angle: float) -> tuple[casadi.SX, casadi.SX]:
    """y and x of a vector turned back by a constant angle."""
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * y - sin * x, cos * x + sin * y


def _wrapped(angle: casadi.SX, middle: float) -> casadi.SX:
    """The angle less full turns, within half a turn of a middle."""
    return angle - math.tau * casadi.floor((angle - middle) * (1 / math.tau) + 0.5)


def _wrist(wrist: casadi.SX) -> tuple[casadi.SX, casadi.SX]:
    """theta_3 in its range, put on a limit that it passes by rounding, and its margin."""
    lower, upper, middle = arm_plane().limits[3]
    angle = _wrapped(wrist, middle)
    beyond = angle - casadi.fmin(casadi.fmax(angle, lower), upper)
    # 1 up to the tolerance, 0 beyond it.
    rounding = casadi.fmin(
        casadi.floor(LIMIT_TOLERANCE / casadi.fmax(casadi.fabs(beyond), LIMIT_TOLERANCE / 2)), 1
    )
    theta_3 = angle - rounding * beyond
    return theta_3, casadi.fmin(theta_3 - lower, upper - theta_3)
