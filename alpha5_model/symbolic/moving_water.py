"""What moving water does to a link, as CasADi expressions of `alpha5_model.water_parameters`.

Along a strip the velocity across it is ``u + t w`` for t from -1 to 1: the sums of the speeds, times t and times t^2, over
Gauss's points are all that force and moment need of them.
"""

from __future__ import annotations

from functools import partial

import casadi
import numpy as np
from casadi import SX, cross, vertcat

from alpha5_model.base_parameters import BASE_PARAMETERS
from alpha5_model.symbolic.dynamics import JOINTS, newton_euler, weightless
from alpha5_model.water_parameters import STRIPS, WATER_PARAMETERS

#: Gauss's points on a strip, as many as `alpha5_model.hydrodynamics.gauss_points`.
POINTS = 8


def in_moving_water() -> tuple[casadi.Function, ...]:
    """Inverse and forward dynamics; inputs as of `alpha5_model.symbolic.dynamics.dynamics`, and the current.

    The parameters are the base parameters with what the water adds to them, then `WATER_PARAMETERS`.
    """
    q, v, a, tau = (SX.sym(name, JOINTS) for name in ("q", "v", "a", "tau"))
    current, still = SX.sym("current", 3), SX.zeros(JOINTS)
    p = SX.sym("parameters", len(BASE_PARAMETERS) + len(WATER_PARAMETERS))
    base, water = casadi.vertsplit(p, [0, len(BASE_PARAMETERS), p.shape[0]])
    load = partial(_load, water)
    torque, _ = newton_euler(q, v, a, base, current, load)
    bias, _ = newton_euler(q, v, still, base, current, load)
    at_rest, _ = newton_euler(q, still, a, weightless(base), SX.zeros(3), load)
    mass = casadi.tril2symm(casadi.tril(casadi.jacobian(at_rest, a)))
    acceleration = casadi.ldl_solve(tau - bias, *casadi.ldl(mass, False))
    return (
        casadi.Function(
            "inverse_dynamics_in_current",
            [q, v, a, current, p],
            [torque],
            ["q", "v", "a", "current", "parameters"],
            ["tau"],
        ),
        casadi.Function(
            "forward_dynamics_in_current",
            [q, v, tau, current, p],
            [acceleration],
            ["q", "v", "tau", "current", "parameters"],
            ["a"],
        ),
    )


def _load(
    parameters: SX, link: int, velocity: SX, omega: SX, acceleration: SX, alpha: SX
) -> tuple[SX, SX]:
    """Force and moment about the origin that a link spends on the water, beside those of a rigid body, in its axes.

    Args:
        parameters: Values of `WATER_PARAMETERS`.
        link: 1 to 4.
        velocity: Of its origin relative to the water.
        omega, alpha: Angular velocity and acceleration.
        acceleration: Of its origin.
    """
    p = dict(zip(WATER_PARAMETERS, casadi.vertsplit(parameters), strict=True))
    p[f"link_{link}.bzz"] = SX(0)
    b, c = (_symmetric([p[f"link_{link}.{block}{at}"] for at in _LOWER]) for block in "bc")
    rate = acceleration - cross(omega, velocity)
    momentum, turning = b @ velocity + c @ omega, c @ velocity
    force = b @ rate + c @ alpha + cross(omega, momentum)
    moment = c @ rate + cross(omega, turning) + cross(velocity, momentum)
    for k, (carrier, axis) in enumerate(STRIPS):
        if carrier == link:
            numbers = [p[name] for name in WATER_PARAMETERS if name.startswith(f"strip_{k}.")]
            drag, about = _strip(axis, velocity, omega, vertcat(*numbers[:3]), *numbers[3:])
            force, moment = force + drag, moment + about
    return force, moment


_LOWER = ("xx", "xy", "xz", "yy", "yz", "zz")


def _symmetric(entries: list[SX]) -> SX:
    xx, xy, xz, yy, yz, zz = entries
    return vertcat(*(casadi.horzcat(*row) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))


def _strip(
    axis: int, velocity: SX, omega: SX, middle: SX, half: SX, across: SX, along: SX
) -> tuple[SX, SX]:
    """Force of a strip along an axis of its link, and moment about the origin."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    there = velocity + cross(omega, middle)
    u, w = (there[one], there[other]), (half * omega[other], -half * omega[one])
    uu, uw, ww = u[0] ** 2 + u[1] ** 2, u[0] * w[0] + u[1] * w[1], w[0] ** 2 + w[1] ** 2
    speeds = first = second = SX(0)
    for t, weight in zip(*np.polynomial.legendre.leggauss(POINTS), strict=True):
        if t > 0:  # and its mirror image
            even, odd = uu + t**2 * ww, 2 * t * uw
            ahead, behind = (casadi.sqrt(casadi.fabs(x)) for x in (even + odd, even - odd))
            both = weight / 2 * (ahead + behind)
            speeds, second = speeds + both, second + t**2 * both
            first += t * weight / 2 * (ahead - behind)
    speeds, first, second = across * speeds, across * first, half * across * second
    force, moment = SX.zeros(3), SX.zeros(3)
    force[axis] = along * casadi.fabs(there[axis]) * there[axis]
    for at, x, y in zip((one, other), u, w, strict=True):
        force[at] = speeds * x + first * y
    lever = half * first
    moment[one] = -(lever * u[1] + second * w[1])
    moment[other] = lever * u[0] + second * w[0]
    return force, moment + cross(middle, force)
