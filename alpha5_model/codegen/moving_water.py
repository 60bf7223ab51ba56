"""The arm in moving water as CasADi Functions: added mass, drag and a current.

The equations are those of `alpha5_model.codegen.equations_of_motion`. The part of the
added mass that a rigid body can have is in the base parameters. The numbers of the
rest, and of the drag, are those of `alpha5_model.codegen.added_mass_and_drag`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import accumulate

import casadi
from casadi import SX, cross, fabs, horzcat, sqrt, vertcat, vertsplit

from alpha5_model.codegen.added_mass_and_drag import STRIPS, WATER_PARAMETERS, StripKind
from alpha5_model.codegen.casadi_functions import named
from alpha5_model.codegen.dimensions import DIMENSIONS, Dimensions, QuarterTurns
from alpha5_model.codegen.equations_of_motion import (
    JOINTS,
    STILL,
    Motion,
    mass_matrix,
    newton_euler,
    turning_moment,
    weightless,
)
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, SECOND
from alpha5_model.numbers.hydrodynamics import gauss_rule


def in_moving_water(twists: tuple[QuarterTurns, ...]) -> tuple[casadi.Function, ...]:
    """Inverse and forward dynamics of arms with any dimensions but these twists.

    Their inputs are q, v, a, tau, the current, and ``parameters``: the base parameters
    with what the water adds to them, then `WATER_PARAMETERS`, then the numbers of the
    dimensions.
    """
    q = SX.sym("q", JOINTS)
    v = SX.sym("v", JOINTS)
    a = SX.sym("a", JOINTS)
    tau = SX.sym("tau", JOINTS)
    current = SX.sym("current", 3)
    sizes = [len(BASE_PARAMETERS), len(WATER_PARAMETERS), DIMENSIONS]
    parameters = SX.sym("parameters", sum(sizes))
    inputs = {
        "q": q,
        "v": v,
        "a": a,
        "tau": tau,
        "current": current,
        "parameters": parameters,
    }

    base, water, numbers = vertsplit(parameters, [0, *accumulate(sizes)])
    dimensions = Dimensions.from_numbers(vertsplit(numbers), twists)
    load = partial(_load, dict(zip(WATER_PARAMETERS, vertsplit(water), strict=True)))

    torque, _ = newton_euler(q, v, a, base, dimensions, current, load)
    bias, _ = newton_euler(q, v, STILL, base, dimensions, current, load)
    no_weight = weightless(base)
    inertial, _ = newton_euler(q, STILL, a, no_weight, dimensions, STILL[:3], load)
    factors = casadi.ldl(mass_matrix(inertial, a), False)
    acceleration = casadi.ldl_solve(tau - bias, *factors)
    return (
        named("inverse_dynamics_in_current", inputs, {"tau": torque}),
        named("forward_dynamics_in_current", inputs, {"a": acceleration}),
    )


def _load(
    numbers: Mapping[str, SX], link: int, first_moments: SX, motion: Motion
) -> tuple[SX, SX]:
    """Force and moment that the motion of a link in the water takes.

    They are those beside the first and second moments, a `Load`.

    Args:
        numbers: `WATER_PARAMETERS`, by name.
        link: 1 to 4.
        first_moments: Of the link, which its acceleration pulls on.
        motion: Of the link.

    Returns:
        Force, and moment about the origin of the link, in its axes.
    """
    b = _symmetric(*_entries(numbers, f"link_{link}.b"))
    c = _symmetric(*_entries(numbers, f"link_{link}.c"))
    c[2, 2] = c[0, 0] + c[1, 1]
    force, moment = _inertial_load(b, c, first_moments, motion)

    for place, strip in enumerate(STRIPS):
        if strip.link == link:
            drag, moment_of_drag = _drag(strip, f"strip_{place}.", numbers, motion)
            force += drag
            moment += moment_of_drag
    return force, moment


def _inertial_load(b: SX, c: SX, first_moments: SX, motion: Motion) -> tuple[SX, SX]:
    """Force and moment of an added mass with the blocks B and C, and of first moments.

    The momentum is ``B v + C omega, C v``. With ``D = 2 C - tr(C)``, the terms
    ``omega x C v + v x C omega`` are ``omega x D v + C (omega x v)``, and
    ``C omega_dot + omega x C omega`` turns as second moments ``-D / 2`` do.
    """
    velocity = motion.velocity
    omega = motion.omega
    momentum = b @ velocity
    d = 2 * (c - c[2, 2] * SX.eye(3))
    second_moments = [-d[at] / 2 for at in SECOND.values()]

    relative = motion.acceleration - cross(omega, velocity)
    force = b @ relative + cross(omega, momentum)
    force += turning_moment(motion.rates, *second_moments)

    moment = (c + casadi.skew(first_moments)) @ motion.acceleration
    moment += cross(omega, d @ velocity) + cross(velocity, momentum)
    return force, moment


def _entries(numbers: Mapping[str, SX], block: str) -> list[SX]:
    """The entries ``SECOND`` of a symmetric block; those that it lacks are 0."""
    return [numbers.get(f"{block}{name}", SX(0)) for name in SECOND]


def _symmetric(xx: SX, yy: SX, xy: SX, xz: SX, yz: SX) -> SX:
    """A symmetric matrix without zz, (3, 3)."""
    return vertcat(
        horzcat(xx, xy, xz),
        horzcat(xy, yy, yz),
        horzcat(xz, yz, SX(0)),
    )


def _drag(
    strip: StripKind, prefix: str, numbers: Mapping[str, SX], motion: Motion
) -> tuple[SX, SX]:
    """Force of a strip along an axis of its link, and moment about the origin.

    At a distance x from the strip's middle, the velocity across it is ``middle velocity
    + x slope``. Force and moment need only the sums of the speeds, times 1, x and x^2,
    over Gauss's points.
    """
    middle = vertcat(*(numbers[f"{prefix}{name}"] for name in "xyz"))
    velocity = motion.velocity + cross(motion.omega, middle)

    axis = strip.axis
    one = (axis + 1) % 3
    other = (axis + 2) % 3
    v_one = velocity[one]
    v_other = velocity[other]
    slope_one = motion.omega[other]
    slope_other = -motion.omega[one]
    speeds, first, second = _sums_of_speeds(
        strip.points,
        half=numbers[f"{prefix}half"],
        across=numbers[f"{prefix}across"],
        square=v_one**2 + v_other**2,
        mixed=v_one * slope_one + v_other * slope_other,
        slope_square=motion.rates[axis, axis],
    )

    force = SX.zeros(3)
    force[axis] = numbers[f"{prefix}along"] * fabs(velocity[axis]) * velocity[axis]
    force[one] = speeds * v_one + first * slope_one
    force[other] = speeds * v_other + first * slope_other

    moment = SX.zeros(3)
    moment[one] = -(first * v_other + second * slope_other)
    moment[other] = first * v_one + second * slope_one
    return force, moment + cross(middle, force)


def _sums_of_speeds(
    points: int, half: SX, across: SX, square: SX, mixed: SX, slope_square: SX
) -> Sequence[SX]:
    """Sums of the speeds across a strip over Gauss's points, times 1, x and x^2.

    Args:
        points: Their number, even.
        half: Half the strip's length.
        across: Drag across, the weight of the sums.
        square: Of the velocity v across at the middle, ``v . v``.
        mixed: With the slope w of the velocity, ``v . w``.
        slope_square: ``-w . w``, an entry of U.
    """
    speeds = SX(0)
    first = SX(0)
    second = SX(0)
    abscissas, weights = gauss_rule(points)
    for abscissa, weight in zip(abscissas, weights, strict=True):
        if abscissa < 0:
            continue  # computed with its mirror image
        x = abscissa * half
        share = weight / 2 * across
        even = square - x**2 * slope_square
        odd = 2 * x * mixed

        ahead = sqrt(fabs(even + odd))
        behind = sqrt(fabs(even - odd))
        both = share * (ahead + behind)
        speeds += both
        first += x * share * (ahead - behind)
        second += x**2 * both
    return speeds, first, second
