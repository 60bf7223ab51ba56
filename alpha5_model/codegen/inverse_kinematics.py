"""Inverse kinematics of an arm with any lengths and any tool point, in CasADi.

`alpha5_model.kinematics.geometry` has the letters. At a given theta_3 the arm is a
vertical plane with two links in it, which passes the yaw axis at the distance w. A
target at the distance R from that axis is in the plane at

    r = +-sqrt((R - |w|) (R + |w|)),       azimuth = atan2(Y r - X w, X r + Y w),

so that there are four branches: two signs of r, two elbows. In the plane, the target is
at rho from the shoulder, and with the links l_1 and l_2

    s = sqrt(((l_1 + l_2)^2 - rho^2) (rho^2 - (l_1 - l_2)^2)),
    gamma = atan2(s, l_1^2 + l_2^2 - rho^2),
    alpha = atan2(s, rho^2 + l_1^2 - l_2^2)

are the triangle's angles at the elbow and at the shoulder. Sums and products in place
of arccos keep all digits at the edges of reach.

The edges, each within rounding of its set:

- The cylinder R = |w|: underarm and overarm coincide. A target inside of it is out of
  reach at this theta_3.
- The yaw axis, if w = 0: theta_0 is free, and its middle is returned.
- The arm stretched or folded: the two elbows coincide.
- The shoulder, if the links are equally long: theta_1 is free.
- A tool point on the elbow axis: theta_2 is free.

All branches of the code are selections, which work on vectors and have derivatives.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import NamedTuple

import casadi
from casadi import (
    SX,
    atan2,
    cos,
    fabs,
    floor,
    fmax,
    fmin,
    horzcat,
    if_else,
    logic_and,
    logic_or,
    sin,
    sqrt,
    vertcat,
    vertsplit,
)

from alpha5_model.codegen.casadi_functions import named
from alpha5_model.kinematics.tolerances import Tolerances


class _Shape(NamedTuple):
    """Symbols for the lengths, zeros and limits of an arm.

    Attributes:
        a_0, d_0, a_1, a_2, x, y, z: As of a `Geometry` [m].
        azimuth_offset, phi_offset, elbow_offset, wrist_offset: Its zeros [rad].
        lower, upper: Limits of theta_0 to theta_3, (4,) [rad].
    """

    a_0: SX
    d_0: SX
    a_1: SX
    a_2: SX
    x: SX
    y: SX
    z: SX
    azimuth_offset: SX
    phi_offset: SX
    elbow_offset: SX
    wrist_offset: SX
    lower: list[SX]
    upper: list[SX]


class _Forearm(NamedTuple):
    """The second link of the plane, at a given theta_3.

    Attributes:
        length: From the elbow to the tool point [m].
        direction: Angle of the link from x_2 [rad].
        beside: w, the tool point's distance from the plane through the yaw axis [m].
        free: Whether the tool point is on the elbow axis, so that theta_2 is free.
    """

    length: SX
    direction: SX
    beside: SX
    free: SX


class _Target(NamedTuple):
    """Where the tool point is to go.

    Attributes:
        x, y: In the base [m].
        height: Above the shoulder [m].
        radius: r > 0 in the plane of the arm, 0 on the cylinder or inside of it [m].
        outside: Whether it is not inside of the cylinder.
        free: Whether theta_0 is free.
        at_edge: Whether it is on the cylinder, or theta_0 is free.
        azimuth_slack: How much theta_0 may be beyond a limit.
    """

    x: SX
    y: SX
    height: SX
    radius: SX
    outside: SX
    free: SX
    at_edge: SX
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
    """Shoulder, elbow and tool point in the plane of the arm.

    Attributes:
        ahead_r, ahead_h: Tool point from the shoulder, in axes that are turned by the
            first link's angle in the middle of theta_1's range.
        reached: Whether the links reach it.
        at_edge: Whether the links are stretched or folded.
        at_shoulder: Whether it is the shoulder, so that theta_1 is free.
        share_stretched: 1 if the links are stretched, 0 if they are folded.
        elbow_by_shoulder: d(gamma) / d(phi) of a stretched or folded arm whose tool
            point stays where it is.
        shoulder_by_elbow: Its inverse for a stretched arm, 0 for a folded one.
        opposite, adjacent: The tangent of the first link's angle from the direction of
            the tool point is ``opposite / adjacent``.
        gamma: Angle between the links.
        slack: How much theta_1 may be beyond a limit by rounding, besides the limit's
            own tolerance.
    """

    ahead_r: SX
    ahead_h: SX
    reached: SX
    at_edge: SX
    at_shoulder: SX
    share_stretched: SX
    elbow_by_shoulder: SX
    shoulder_by_elbow: SX
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


def inverse_kinematics() -> casadi.Function:
    """The branches of a target, in the order of `alpha5_model.kinematics.ik.BRANCHES`.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad], and ``parameters``, the
    ``ik_parameters`` (26,) of a `Geometry`.

    Outputs: ``q`` (4, 4) [rad], NaN if a branch does not reach the target; ``exists``
    and ``within_limits`` (4,) and ``singular``, 0 or 1.
    """
    position = SX.sym("position", 3)
    wrist = SX.sym("wrist")
    parameters = SX.sym("parameters", 26)
    numbers = vertsplit(parameters)
    shape = _Shape._make([*numbers[:11], numbers[11:15], numbers[15:19]])
    tolerances = Tolerances._make(numbers[19:])

    theta_3 = _wrist_angle(wrist, shape, tolerances)
    forearm = _forearm(theta_3, shape, tolerances)
    target = _target(position, shape, forearm, tolerances)
    singular = target.at_edge
    elbow_to_one_side = []
    elbow_to_the_other = []
    for faces_it in (True, False):
        theta_0 = _yaw_angle(target, faces_it, forearm, shape)
        triangle = _triangle(target, faces_it, shape, forearm, tolerances)
        singular = logic_or(singular, logic_and(triangle.reached, triangle.at_edge))

        of_facing = (triangle, forearm, theta_0, theta_3, shape, tolerances)
        elbow_to_one_side.append(_branch(1.0, *of_facing))
        elbow_to_the_other.append(_branch(-1.0, *of_facing))

    branches = elbow_to_one_side + elbow_to_the_other
    return named(
        "inverse_kinematics",
        {"position": position, "wrist": wrist, "parameters": parameters},
        {
            "q": vertcat(*(branch.q for branch in branches)),
            "exists": vertcat(*(branch.exists for branch in branches)),
            "within_limits": vertcat(*(branch.within_limits for branch in branches)),
            "singular": singular,
        },
    )


def _wrist_angle(wrist: SX, shape: _Shape, tolerances: Tolerances) -> _Angle:
    """theta_3: the wrist, shifted by full turns to the middle of its range."""
    start = _middle(3, shape) - math.pi
    return _in_range(_from(start, wrist), 3, tolerances.limit, shape)


def _forearm(theta_3: _Angle, shape: _Shape, tolerances: Tolerances) -> _Forearm:
    """The second link at a wrist angle."""
    psi = theta_3.value + shape.wrist_offset
    cosine = cos(psi)
    sine = sin(psi)
    along = shape.a_2 + (shape.x * cosine - shape.y * sine)
    length = sqrt(along * along + shape.z * shape.z)
    return _Forearm(
        length=length,
        direction=atan2(-shape.z, along),
        beside=-(shape.x * sine + shape.y * cosine),
        free=length <= tolerances.axis,
    )


def _target(
    position: SX, shape: _Shape, forearm: _Forearm, tolerances: Tolerances
) -> _Target:
    """A position in the plane of the arm that faces it."""
    x, y, z = vertsplit(position)
    distance = sqrt(x * x + y * y)
    off = fabs(forearm.beside)
    gap = distance - off
    free = fmax(distance, off) <= tolerances.axis
    outside = logic_or(free, -tolerances.edge < gap)
    # 1 if no root is taken, so that derivatives elsewhere stay finite.
    rooted = logic_and(gap > 0.0, tolerances.axis < distance)
    root = sqrt(if_else(rooted, gap * (distance + off), 1.0))
    return _Target(
        x=x,
        y=y,
        height=z - shape.d_0,
        radius=if_else(rooted, root, 0.0),
        outside=outside,
        free=free,
        at_edge=logic_and(outside, gap <= tolerances.axis),
        azimuth_slack=_azimuth_slack(distance, tolerances),
    )


def _azimuth_slack(distance: SX, tolerances: Tolerances) -> SX:
    """The azimuth of a point at distance R is known to rounding / R."""
    return tolerances.limit + tolerances.azimuth / fmax(distance, tolerances.axis)


def _yaw_angle(
    target: _Target, faces_it: bool, forearm: _Forearm, shape: _Shape
) -> _Angle:
    """theta_0 that puts the tool point at the target; its middle if it is free."""
    r = target.radius if faces_it else -target.radius
    w = forearm.beside
    azimuth = atan2(target.y * r - target.x * w, target.x * r + target.y * w)
    middle = _middle(0, shape)
    angle = _near(middle, azimuth, SX(-shape.azimuth_offset))
    ranged = _in_range(angle, 0, target.azimuth_slack, shape)
    return _Angle(
        value=if_else(target.free, middle, ranged.value),
        beyond=ranged.beyond,
        fits=logic_or(target.free, ranged.fits),
    )


class _Sides(NamedTuple):
    """The sides of the triangle of the two links.

    Attributes:
        r, h: The target from the shoulder, outwards and up.
        l_1, l_2: The links.
        longest, shortest: Their sum and the magnitude of their difference.
        rho_2: r^2 + h^2.
        above, below: (l_1 + l_2)^2 - rho^2 and rho^2 - (l_1 - l_2)^2, which keep their
            digits at the edges of reach.
    """

    r: SX
    h: SX
    l_1: SX
    l_2: SX
    longest: SX
    shortest: SX
    rho_2: SX
    above: SX
    below: SX


def _sides(target: _Target, faces_it: bool, shape: _Shape, forearm: _Forearm) -> _Sides:
    """The sides if the plane faces the target, or faces away."""
    l_1 = SX(shape.a_1)
    l_2 = forearm.length
    longest = l_1 + l_2
    shortest = fabs(l_1 - l_2)
    r = (target.radius if faces_it else -target.radius) - shape.a_0
    h = target.height
    rho_2 = r * r + h * h
    return _Sides(
        r=r,
        h=h,
        l_1=l_1,
        l_2=l_2,
        longest=longest,
        shortest=shortest,
        rho_2=rho_2,
        above=longest * longest - rho_2,
        below=rho_2 - shortest * shortest,
    )


def _triangle(
    target: _Target,
    faces_it: bool,
    shape: _Shape,
    forearm: _Forearm,
    tolerances: Tolerances,
) -> _Triangle:
    """The triangle of the two links if the plane faces the target, or faces away."""
    sides = _sides(target, faces_it, shape, forearm)
    l_1 = sides.l_1
    l_2 = sides.l_2
    reached, at_edge = _reached(sides, target, tolerances)
    # 1 if no root is taken, so that derivatives of the other branches stay finite.
    square = if_else(reached, fmax(sides.above, 0.0) * fmax(sides.below, 0.0), 1.0)
    s = sqrt(square)

    # l_2 d(gamma) = (l_2 - l_1 cos(gamma)) d(phi), and l_1 l_2 cos(gamma) is known.
    cosine_term = (l_1 * l_1 + l_2 * l_2) - sides.rho_2
    not_zero = fmax(l_2, tolerances.axis)
    per_both = 1.0 / (not_zero * sides.longest)
    per_l_2 = per_both * sides.longest

    back = shape.phi_offset + _middle(1, shape)
    cosine = cos(back)
    sine = sin(back)
    at_shoulder = (
        sides.rho_2 + sides.shortest * sides.shortest
        <= tolerances.axis * tolerances.axis
    )
    return _Triangle(
        ahead_r=cosine * sides.r + sine * sides.h,
        ahead_h=cosine * sides.h - sine * sides.r,
        reached=reached,
        at_edge=at_edge,
        at_shoulder=at_shoulder,
        share_stretched=sides.below * (per_l_2 * (0.25 / l_1)),
        elbow_by_shoulder=1.0 - cosine_term * (0.5 * per_l_2 * per_l_2),
        shoulder_by_elbow=sides.below * ((per_both * not_zero) * (0.25 / l_1)),
        opposite=s,
        adjacent=sides.rho_2 + (l_1 * l_1 - l_2 * l_2),
        gamma=atan2(s, cosine_term),
        slack=_slack(sides, tolerances),
    )


def _reached(sides: _Sides, target: _Target, tolerances: Tolerances) -> tuple[SX, SX]:
    """Whether the links reach the target, and whether that is at an edge of reach."""
    # From the edge of reach, distances are those of rho^2 over 2 rho.
    outer = 2.0 * sides.longest
    inner = 2.0 * fmax(sides.shortest, tolerances.singular)
    reached = logic_and(
        -tolerances.edge * outer < sides.above,
        -tolerances.edge * inner < sides.below,
    )
    reached = logic_and(target.outside, reached)
    at_edge = logic_or(
        sides.above <= tolerances.singular * outer,
        sides.below <= tolerances.singular * inner,
    )
    return reached, at_edge


def _slack(sides: _Sides, tolerances: Tolerances) -> SX:
    """How much rounding moves the two angles against each other.

    Close to the stretched and to the folded arm, it is rounding / sin(gamma).
    """
    product = fmax(sides.l_1 * sides.l_2, tolerances.axis**2)
    least = tolerances.least_sine**2 * product
    square_of_sine = fmax(fmin(fabs(sides.above), fabs(sides.below)), least)
    return tolerances.elbow * sqrt(product / square_of_sine)


def _branch(
    side: float,
    triangle: _Triangle,
    forearm: _Forearm,
    theta_0: _Angle,
    theta_3: _Angle,
    shape: _Shape,
    tolerances: Tolerances,
) -> _Branch:
    """The solution with the elbow to a side of the line to the tool point: 1 or -1."""
    theta_1 = _shoulder_angle(side, triangle, shape, tolerances)
    theta_2 = _elbow_angle(side, triangle, forearm, theta_1, shape, tolerances)
    theta_1 = _after_elbow(triangle, theta_1, theta_2, shape)
    angles = (theta_0, theta_1, theta_2, theta_3)
    q = [if_else(triangle.reached, angle.value, math.nan) for angle in angles]
    fits = [angle.fits for angle in angles]
    return _Branch(
        q=horzcat(*q),
        exists=triangle.reached,
        within_limits=reduce(logic_and, fits, triangle.reached),
    )


def _shoulder_angle(
    side: float, triangle: _Triangle, shape: _Shape, tolerances: Tolerances
) -> _Angle:
    """theta_1; the middle of its range if it is free."""
    r = triangle.ahead_r
    h = triangle.ahead_h
    adjacent = triangle.adjacent
    opposite = side * triangle.opposite
    from_middle = atan2(h * adjacent - r * opposite, r * adjacent + h * opposite)
    turned = if_else(triangle.at_shoulder, 0.0, from_middle)
    slack = tolerances.limit + triangle.slack
    return _in_range(_middle(1, shape) + turned, 1, slack, shape)


def _elbow_angle(
    side: float,
    triangle: _Triangle,
    forearm: _Forearm,
    theta_1: _Angle,
    shape: _Shape,
    tolerances: Tolerances,
) -> _Angle:
    """theta_2; the middle of its range if it is free."""
    middle = _middle(2, shape)
    start = middle - math.pi
    end = middle + math.pi
    # theta_2 of the folded arm.
    folded = _near(middle, forearm.direction, SX(-(shape.elbow_offset + math.pi)))
    angle = folded + side * triangle.gamma
    if side > 0.0:
        angle = angle - if_else(end < angle, math.tau, 0.0)
    else:
        angle = angle + if_else(angle < start, math.tau, 0.0)
    # If theta_1 was put on its limit, the tool point stays where it is.
    moved = angle - triangle.elbow_by_shoulder * theta_1.beyond
    slack = tolerances.limit + triangle.share_stretched * triangle.slack
    ranged = _in_range(moved, 2, slack, shape)
    return _Angle(
        value=if_else(forearm.free, _middle(2, shape), ranged.value),
        beyond=if_else(forearm.free, 0.0, ranged.beyond),
        fits=logic_or(forearm.free, ranged.fits),
    )


def _after_elbow(
    triangle: _Triangle, theta_1: _Angle, theta_2: _Angle, shape: _Shape
) -> _Angle:
    """theta_1 that keeps the tool point in place if theta_2 was put on its limit."""
    moved = theta_1.value - triangle.shoulder_by_elbow * theta_2.beyond
    within = fmin(fmax(moved, shape.lower[1]), shape.upper[1])
    return theta_1._replace(value=if_else(theta_1.fits, within, moved))


def _middle(joint: int, shape: _Shape) -> SX:
    """Middle of the range of a joint."""
    return SX(0.5) * (shape.lower[joint] + shape.upper[joint])


def _near(middle: SX, angle: SX, offset: SX) -> SX:
    """An angle from -pi to pi plus an offset, within half a turn of a middle."""
    # The sum is at least middle - pi, so that one selection is enough.
    turned = angle + _from(middle, offset)
    return turned - if_else(middle + math.pi < turned, math.tau, 0.0)


def _from(start: SX, angle: SX) -> SX:
    """An angle, shifted by full turns to less than a turn from a start on."""
    turns = floor((angle - start) * (1 / math.tau))
    return angle - turns * math.tau


def _in_range(angle: SX, joint: int, slack: SX | float, shape: _Shape) -> _Angle:
    """An angle within the limits of a joint, which it may pass by less than a slack."""
    limit = fmin(fmax(angle, shape.lower[joint]), shape.upper[joint])
    beyond = angle - limit
    fits = fabs(beyond) < slack
    return _Angle(
        value=if_else(fits, limit, angle),
        beyond=if_else(fits, beyond, 0.0),
        fits=fits,
    )
