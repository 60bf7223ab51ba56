"""Inverse kinematics of a position, all branches: one function for every language.

The plane of the arm faces the target, or faces away from it
(`alpha5_model.kinematics.plane`). In the plane, the tcp is at ``(r, h)`` from the
shoulder, ``rho^2 = r^2 + h^2``, and the two links and rho are a triangle. With

    s = sqrt(((l_1 + l_2)^2 - rho^2) (rho^2 - (l_1 - l_2)^2)),

four times its area, the angle gamma between the links has the tangent
``s / (l_1^2 + l_2^2 - rho^2)``. The first link is turned from the direction of
``(r, h)`` to either side, by the angle with the tangent
``s / (rho^2 + l_1^2 - l_2^2)``. The factors keep their digits at the edge of reach.
theta_1 is one arctangent, measured from the middle of its range, so that it needs no
full turn.

A target that is within rounding of the edge of reach or of the yaw axis is put there. A
joint within rounding of its limit is put on the limit, see `Tolerances`. All branches
of the code are selections, which work on vectors and have derivatives.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import NamedTuple

import casadi
from casadi import (
    SX,
    atan2,
    fabs,
    floor,
    fmax,
    fmin,
    horzcat,
    if_else,
    logic_and,
    logic_or,
    sqrt,
    vertcat,
    vertsplit,
)

from alpha5_model.codegen.casadi_functions import named
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.tolerances import Tolerances, named_tolerances


class _Target(NamedTuple):
    """Where the tcp is to go.

    Attributes:
        on_axis: Whether it is on the yaw axis, where theta_0 is free.
        radius: Distance from that axis, 0 on it.
        height: Above the shoulder.
        azimuth: About the yaw axis.
        azimuth_slack: How much theta_0 may be beyond a limit.
    """

    on_axis: SX
    radius: SX
    height: SX
    azimuth: SX
    azimuth_slack: SX


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
        at_edge: Whether the links are stretched or folded.
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


class _Branch(NamedTuple):
    """One solution.

    Attributes:
        q: (1, 4), NaN if the branch does not reach the target.
        exists: Whether it reaches the target.
        within_limits: Whether it does so within the limits.
    """

    q: SX
    exists: SX
    within_limits: SX


def inverse_kinematics(plane: ArmPlane) -> casadi.Function:
    """The branches of a target, in the order of `alpha5_model.kinematics.ik.BRANCHES`.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad] and ``tolerances``, a `Tolerances`.

    Outputs: ``q`` (4, 4) [rad], NaN if a branch does not reach the target; ``exists``
    and ``within_limits`` (4,) and ``singular``, 0 or 1.

    Args:
        plane: Lengths and limits, which become constants of the function.
    """
    position = SX.sym("position", 3)
    wrist = SX.sym("wrist")
    allowed = SX.sym("tolerances", len(Tolerances._fields))
    tolerances = named_tolerances(vertsplit(allowed))

    target = _target(position, plane, tolerances)
    theta_3 = _wrist_angle(wrist, plane, tolerances)
    singular = target.on_axis
    elbow_to_one_side = []
    elbow_to_the_other = []
    for faces_it in (True, False):
        theta_0 = _yaw_angle(target, faces_it, plane)
        triangle = _triangle(target, faces_it, plane, tolerances)
        singular = logic_or(singular, logic_and(triangle.reached, triangle.at_edge))

        of_facing = (triangle, theta_0, theta_3, plane, tolerances)
        elbow_to_one_side.append(_branch(1.0, *of_facing))
        elbow_to_the_other.append(_branch(-1.0, *of_facing))

    branches = elbow_to_one_side + elbow_to_the_other
    return named(
        "inverse_kinematics",
        {"position": position, "wrist": wrist, "tolerances": allowed},
        {
            "q": vertcat(*(branch.q for branch in branches)),
            "exists": vertcat(*(branch.exists for branch in branches)),
            "within_limits": vertcat(*(branch.within_limits for branch in branches)),
            "singular": singular,
        },
    )


def _branch(
    side: float,
    triangle: _Triangle,
    theta_0: _Angle,
    theta_3: _Angle,
    plane: ArmPlane,
    tolerances: Tolerances,
) -> _Branch:
    """The solution with the elbow to a side of the line to the tcp: 1 or -1."""
    theta_1 = _shoulder_angle(side, triangle, plane)
    theta_2 = _elbow_angle(side, triangle, theta_1, plane, tolerances)
    angles = (theta_0, theta_1, theta_2, theta_3)
    q = [if_else(triangle.reached, angle.value, math.nan) for angle in angles]
    fits = [angle.fits for angle in angles]
    return _Branch(
        q=horzcat(*q),
        exists=triangle.reached,
        within_limits=reduce(logic_and, fits, triangle.reached),
    )


def _target(position: SX, plane: ArmPlane, tolerances: Tolerances) -> _Target:
    """A position in cylindrical coordinates."""
    x, y, z = vertsplit(position)
    distance = sqrt(x * x + y * y)
    on_axis = distance <= tolerances.axis
    # The azimuth of a point at distance R is known to rounding / R.
    slack = tolerances.azimuth / fmax(distance, tolerances.axis)
    return _Target(
        on_axis=on_axis,
        radius=if_else(on_axis, 0.0, distance),
        height=z - plane.d_0,
        azimuth=atan2(y, x),
        azimuth_slack=tolerances.limit + slack,
    )


def _wrist_angle(wrist: SX, plane: ArmPlane, tolerances: Tolerances) -> _Angle:
    """theta_3: the wrist, shifted by full turns to the middle of its range."""
    turns = floor((wrist - plane.middle[3]) * (1 / math.tau) + 0.5)
    return _in_range(wrist - turns * math.tau, 3, tolerances.limit, plane)


def _yaw_angle(target: _Target, faces_it: bool, plane: ArmPlane) -> _Angle:
    """theta_0; the middle of its range if the target is on the yaw axis."""
    half_turn = 0.0 if faces_it else math.pi
    offset = half_turn - plane.azimuth_offset
    angle = _shifted(target.azimuth, offset, -math.pi, math.pi, plane.middle[0])
    ranged = _in_range(angle, 0, target.azimuth_slack, plane)
    return _Angle(
        value=if_else(target.on_axis, plane.middle[0], ranged.value),
        beyond=ranged.beyond,
        fits=logic_or(target.on_axis, ranged.fits),
    )


def _triangle(
    target: _Target, faces_it: bool, plane: ArmPlane, tolerances: Tolerances
) -> _Triangle:
    """The triangle of the two links if the plane faces the target, or faces away."""
    l_1 = plane.l_1
    l_2 = plane.l_2
    r = (target.radius if faces_it else -target.radius) - plane.a_0
    h = target.height
    rho_2 = r * r + h * h
    above = plane.longest**2 - rho_2
    below = rho_2 - plane.shortest**2
    # From the edge of reach, distances are those of rho^2 over 2 rho.
    margin = fmin(above * (0.5 / plane.longest), below * (0.5 / plane.shortest))
    reached = -tolerances.edge < margin

    # 1 if no root is taken, so that derivatives of the other branches stay finite.
    square = if_else(reached, fmax(above, 0.0) * fmax(below, 0.0), 1.0)
    s = sqrt(square)

    # Close to the stretched arm, rounding of rho^2 moves the two angles against each
    # other by rounding / sin(gamma).
    sine = sqrt(fabs(above) * (1 / (l_1 * l_2)))
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
        gamma=atan2(s, l_1**2 + l_2**2 - rho_2),
        slack=slack,
    )


def _shoulder_angle(side: float, triangle: _Triangle, plane: ArmPlane) -> _Angle:
    """theta_1."""
    r = triangle.ahead_r
    h = triangle.ahead_h
    adjacent = triangle.adjacent
    opposite = side * triangle.opposite
    from_middle = atan2(h * adjacent - r * opposite, r * adjacent + h * opposite)
    return _in_range(plane.middle[1] + from_middle, 1, triangle.slack, plane)


def _elbow_angle(
    side: float,
    triangle: _Triangle,
    theta_1: _Angle,
    plane: ArmPlane,
    tolerances: Tolerances,
) -> _Angle:
    """theta_2."""
    low, high = sorted((0.0, side * math.pi))
    gamma = side * triangle.gamma
    angle = _shifted(gamma, -plane.gamma_offset, low, high, plane.middle[2])
    # If theta_1 was put on its limit, the tcp stays where it is:
    # l_2 d(gamma) = (l_1 + l_2) d(phi) for a stretched arm.
    moved = angle - plane.longest / plane.l_2 * theta_1.beyond
    return _in_range(moved, 2, tolerances.limit, plane)


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
