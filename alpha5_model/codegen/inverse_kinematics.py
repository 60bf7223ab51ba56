"""Inverse kinematics of a position with all branches, as one function for every language.

The plane of the arm faces the target, or faces away from it
(`alpha5_model.kinematics.plane`). In the plane, the tcp is at ``(r, h)`` from the
shoulder, ``rho^2 = r^2 + h^2``, and the two links and rho are a triangle. With

    s = sqrt(((l_1 + l_2)^2 - rho^2) (rho^2 - (l_1 - l_2)^2)),

four times its area, the angle gamma between the links has the tangent
``s / (l_1^2 + l_2^2 - rho^2)``, and the first link is turned from the direction of
``(r, h)`` by the angle with the tangent ``s / (rho^2 + l_1^2 - l_2^2)``, to either side.
The factors keep their digits at the edge of reach. theta_1 is one arctangent, measured
from the middle of its range, so that it needs no full turn.

A target that is at the edge of reach or on the yaw axis to rounding is put there, and so
is a joint at its limit, see `Tolerances`. Decisions are selections, so that vectors and
derivatives can have them.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import NamedTuple

import casadi
from casadi import SX, fabs, fmax, fmin, if_else, logic_and, logic_or

from alpha5_model.codegen.casadi_functions import named
from alpha5_model.kinematics.plane import ArmPlane, Tolerances


class _Angle(NamedTuple):
    """A joint angle and what its limits say.

    Attributes:
        value: The angle, on a limit that it passes by less than the slack.
        beyond: By how much it passed that limit, else 0.
        fits: Whether it is within the limits.
    """

    value: SX
    beyond: SX
    fits: SX


class _Triangle(NamedTuple):
    """Shoulder, elbow and tcp in the plane of the arm.

    Attributes:
        ahead_r, ahead_h: tcp from the shoulder, in axes that are turned by the first
            link's angle in the middle of theta_1's range.
        reached: Whether the links reach it.
        at_edge: Whether they reach it stretched or folded.
        opposite, adjacent: The tangent of the first link's angle from the direction of
            the tcp is ``opposite / adjacent``.
        gamma: Angle between the links.
        slack: How much theta_1 may be beyond a limit.
    """

    ahead_r: SX
    ahead_h: SX
    reached: SX
    at_edge: SX
    opposite: SX
    adjacent: SX
    gamma: SX
    slack: SX


def inverse_kinematics(plane: ArmPlane) -> casadi.Function:
    """The branches of a target, in the order of `alpha5_model.kinematics.ik.BRANCHES`.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad] and ``tolerances``, a `Tolerances`.

    Outputs: ``q`` (4, 4) [rad], NaN if a branch does not reach the target; ``exists`` and
    ``within_limits`` (4,) and ``singular``, 0 or 1.

    Args:
        plane: Lengths and limits, which become constants of the function.
    """
    position = SX.sym("position", 3)
    wrist = SX.sym("wrist")
    allowed = SX.sym("tolerances", len(Tolerances._fields))
    tolerances = Tolerances._make(casadi.vertsplit(allowed))

    x, y, z = casadi.vertsplit(position)
    distance = casadi.sqrt(x * x + y * y)
    on_axis = distance <= tolerances.axis
    radius = if_else(on_axis, 0.0, distance)
    height = z - plane.d_0
    azimuth = casadi.atan2(y, x)
    # The azimuth of a point at distance R is known to rounding / R.
    azimuth_slack = tolerances.limit + tolerances.azimuth / fmax(
        distance, tolerances.axis
    )

    theta_3 = _wrist_angle(wrist, plane, tolerances)
    singular = on_axis
    branches: dict[int, tuple[SX, SX, SX]] = {}
    towards = (radius - plane.a_0, 0.0)
    away = (-radius - plane.a_0, math.pi)
    for facing, (r, half_turn) in enumerate((towards, away)):
        theta_0 = _yaw_angle(azimuth, half_turn, on_axis, azimuth_slack, plane)
        triangle = _triangle(r, height, plane, tolerances)
        reached = triangle.reached
        singular = logic_or(singular, logic_and(reached, triangle.at_edge))

        for branch, sign in ((facing, 1.0), (facing + 2, -1.0)):
            theta_1, theta_2 = _shoulder_and_elbow(triangle, sign, plane, tolerances)
            angles = (theta_0, theta_1, theta_2, theta_3)
            row = [if_else(reached, angle.value, math.nan) for angle in angles]
            fits = [reached, *(angle.fits for angle in angles)]
            branches[branch] = casadi.horzcat(*row), reached, reduce(logic_and, fits)

    q, exists, within_limits = (
        casadi.vertcat(*(branches[branch][part] for branch in range(4)))
        for part in range(3)
    )
    return named(
        "inverse_kinematics",
        {"position": position, "wrist": wrist, "tolerances": allowed},
        {
            "q": q,
            "exists": exists,
            "within_limits": within_limits,
            "singular": singular,
        },
    )


def _wrist_angle(wrist: SX, plane: ArmPlane, tolerances: Tolerances) -> _Angle:
    """theta_3: the wrist, shifted by full turns to the middle of its range."""
    turns = casadi.floor((wrist - plane.middle[3]) * (1 / math.tau) + 0.5)
    return _in_range(wrist - turns * math.tau, 3, tolerances.limit, plane)


def _yaw_angle(
    azimuth: SX, half_turn: float, on_axis: SX, slack: SX, plane: ArmPlane
) -> _Angle:
    """theta_0; the middle of its range if the target is on the yaw axis."""
    offset = half_turn - plane.azimuth_offset
    angle = _shifted(azimuth, offset, -math.pi, math.pi, plane.middle[0])
    value, beyond, fits = _in_range(angle, 0, slack, plane)
    return _Angle(
        value=if_else(on_axis, plane.middle[0], value),
        beyond=beyond,
        fits=logic_or(on_axis, fits),
    )


def _triangle(r: SX, h: SX, plane: ArmPlane, tolerances: Tolerances) -> _Triangle:
    """The triangle of the two links for a tcp at (r, h) from the shoulder."""
    l_1 = plane.l_1
    l_2 = plane.l_2
    rho_2 = r * r + h * h
    above = plane.longest**2 - rho_2
    below = rho_2 - plane.shortest**2
    # From the edge of reach, distances are those of rho^2 over 2 rho.
    margin = fmin(above * (0.5 / plane.longest), below * (0.5 / plane.shortest))
    reached = -tolerances.edge < margin

    # 1 if no root is taken, so that derivatives of the other branches stay finite.
    square = if_else(reached, fmax(above, 0.0) * fmax(below, 0.0), 1.0)
    s = casadi.sqrt(square)

    # Close to the stretched arm, rounding of rho^2 moves the two angles against each
    # other by rounding / sin(gamma).
    sine = casadi.sqrt(fabs(above) * (1 / (l_1 * l_2)))
    slack = tolerances.limit + tolerances.elbow / fmax(sine, tolerances.least_sine)
    back = plane.phi_offset + plane.middle[1]
    cos = math.cos(back)
    sin = math.sin(back)
    return _Triangle(
        ahead_r=cos * r + sin * h,
        ahead_h=cos * h - sin * r,
        reached=reached,
        at_edge=margin <= tolerances.singular,
        opposite=s,
        adjacent=rho_2 + (l_1**2 - l_2**2),
        gamma=casadi.atan2(s, l_1**2 + l_2**2 - rho_2),
        slack=slack,
    )


def _shoulder_and_elbow(
    triangle: _Triangle, sign: float, plane: ArmPlane, tolerances: Tolerances
) -> tuple[_Angle, _Angle]:
    """theta_1 and theta_2, with the elbow to the side that a sign says."""
    ahead_r = triangle.ahead_r
    ahead_h = triangle.ahead_h
    adjacent = triangle.adjacent
    side = sign * triangle.opposite
    from_middle = casadi.atan2(
        ahead_h * adjacent - ahead_r * side, ahead_r * adjacent + ahead_h * side
    )
    theta_1 = _in_range(plane.middle[1] + from_middle, 1, triangle.slack, plane)

    low, high = sorted((0.0, sign * math.pi))
    elbow = _shifted(
        sign * triangle.gamma, -plane.gamma_offset, low, high, plane.middle[2]
    )
    # The tcp stays where it is: l_2 d(gamma) = (l_1 + l_2) d(phi) for a stretched arm.
    moved_along = elbow - plane.longest / plane.l_2 * theta_1.beyond
    return theta_1, _in_range(moved_along, 2, tolerances.limit, plane)


def _shifted(angle: SX, offset: float, low: float, high: float, middle: float) -> SX:
    """An angle from low to high plus an offset, shifted by 2 pi nearest to a middle."""
    end = middle + math.pi
    offset += math.tau * math.floor((end - low - offset) / math.tau)
    shifted = angle + offset
    if high + offset <= end:
        return shifted
    return shifted - if_else(end < shifted, math.tau, 0.0)


def _in_range(angle: SX, joint: int, slack: SX | float, plane: ArmPlane) -> _Angle:
    """An angle within the limits of a joint, which it may pass by less than a slack."""
    limit = fmin(fmax(angle, plane.lower[joint]), plane.upper[joint])
    beyond = angle - limit
    fits = fabs(beyond) < slack
    return _Angle(
        value=if_else(fits, limit, angle),
        beyond=if_else(fits, beyond, 0.0),
        fits=fits,
    )
