"""The equations of motion of the arm on a fixed base, jaws locked, as CasADi expressions.

Newton's and Euler's equations, recursively and in the axes of the links, of the base parameters: moving
links have first and second moments but no mass, see `alpha5_model.codegen.base_parameters`. With angular velocity
omega and acceleration alpha of a link, ``U = [alpha]x + [omega]x [omega]x`` gives all [Khalil2002]: a point r
accelerates by ``U r``, a first moment h pulls with ``U h``, second moments S turn with ``U S - (U S)^T``.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section 9.6.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import casadi
import numpy as np
from casadi import SX, cross, horzcat, jacobian, vertcat, vertsplit

from alpha5_model.codegen.base_parameters import (
    BASE_PARAMETERS,
    SECOND,
)
from alpha5_model.codegen.program import named
from alpha5_model.codegen.water_parameters import STRIPS, WATER_PARAMETERS
from alpha5_model.numbers.parameters import parameters

JOINTS = 4
#: Of a link's number, first moments, velocity relative to the water, angular velocity, acceleration and U: force, moment.
Load = Callable[[int, SX, SX, SX, SX, SX], tuple[SX, SX]]


class Turn(NamedTuple):
    """The step from a frame to the next link: along its x and z, about x by a multiple of pi/2, then about z.

    Attributes:
        origin: Of the link in the frame before, (3, 1).
        cosine, sine: Of the angle about z.
        across, along: Sine and cosine of the angle about x.
    """

    origin: SX
    cosine: SX
    sine: SX
    across: int
    along: int

    def outward(self, vector: SX) -> SX:
        """A vector in the axes of the link."""
        x, y, z = vertsplit(vector)
        y, z = self.along * y + self.across * z, self.along * z - self.across * y
        return vertcat(
            self.cosine * x + self.sine * y, self.cosine * y - self.sine * x, z
        )

    def inward(self, vector: SX) -> SX:
        """A vector of the link in the axes of the frame before."""
        x, y, z = vertsplit(vector)
        x, y = self.cosine * x - self.sine * y, self.sine * x + self.cosine * y
        return vertcat(
            x, self.along * y - self.across * z, self.across * y + self.along * z
        )

    def pose(self) -> SX:
        """Of the link in the frame before, (4, 4)."""
        turned = horzcat(*(self.inward(axis) for axis in casadi.horzsplit(SX.eye(3))))
        return vertcat(horzcat(turned, self.origin), SX([[0.0, 0.0, 0.0, 1.0]]))


def turns(q: SX) -> list[Turn]:
    """Base to link 1, ..., link 3 to link 4, and link 4 to the tcp."""
    out, origin, alpha = [], [0.0, 0.0, 0.0], 0.0
    turned = [
        *((casadi.cos(x), casadi.sin(x)) for x in vertsplit(q)),
        (SX(1.0), SX(0.0)),
    ]
    for row, (c, s) in zip(parameters().dh, turned, strict=True):
        # cos(q + offset) from cos(q) and sin(q): q + offset would round large angles.
        cosine, sine = (_exact(f(row.theta_offset)) for f in (math.cos, math.sin))
        across, along = round(math.sin(alpha)), round(math.cos(alpha))
        out.append(
            Turn(
                SX(origin), cosine * c - sine * s, sine * c + cosine * s, across, along
            )
        )
        origin, alpha = [row.a, 0.0, row.d], row.alpha
    return out


def _exact(value: float) -> float:
    """Sine or cosine, exact for multiples of pi/2."""
    return float(round(value)) if abs(value - round(value)) < 1e-15 else value


def newton_euler(
    q: SX,
    v: SX,
    a: SX,
    base_parameters: SX,
    current: SX | None = None,
    load: Load | None = None,
) -> tuple[SX, SX]:
    """Joint torques (4, 1), and force above moment on the mount in base_link (6, 1).

    In moving water: the current in base_link (3, 1), and what the links spend on the water beside the base parameters.
    Of zero velocities, accelerations or gravity only what does not vanish is left: statics, Coriolis, ...
    """
    p = dict(zip(BASE_PARAMETERS, vertsplit(base_parameters), strict=True))
    p |= {"link_1.xx": p["link_1.izz"]}  # xx + yy is all that counts there

    def of(link: int, *names: str) -> list[SX]:
        return [p.get(f"link_{link}.{name}", SX(0.0)) for name in names]

    gravity = g = vertcat(*(p[f"gravity.{axis}"] for axis in "xyz"))
    omega, alpha, acceleration, u = (
        SX.zeros(3),
        SX.zeros(3),
        SX.zeros(3),
        SX.zeros(3, 3),
    )
    steps, forces, moments = turns(q)[:JOINTS], [], []
    velocity = SX.zeros(3) if current is None else -current
    for i, step in enumerate(steps):
        velocity = step.outward(velocity + cross(omega, step.origin))
        acceleration = step.outward(acceleration + u @ step.origin)
        g, omega, alpha = step.outward(g), step.outward(omega), step.outward(alpha)
        alpha += vertcat(omega[1] * v[i], -omega[0] * v[i], a[i])
        omega += vertcat(0.0, 0.0, v[i])
        u = _rates(omega, alpha)
        h, n = (
            vertcat(*of(i + 1, "hx", "hy", "hz")),
            vertcat(*of(i + 1, "nx", "ny", "nz")),
        )
        second = of(i + 1, "xx", "yy", "xy", "xz", "yz")
        force, moment = SX.zeros(3), cross(h, acceleration)
        if load is not None:
            force, moment = load(i + 1, h, velocity, omega, acceleration, u)
        forces.append(u @ h + force)
        moments.append(_turning(u, *second) + moment + cross(g, n))
    force, moment = SX.zeros(3), SX.zeros(3)
    torques: list[SX] = []
    for i in reversed(range(JOINTS)):
        force, moment = forces[i] + force, moments[i] + moment
        torques.insert(0, moment[2])
        force = steps[i].inward(force)
        moment = steps[i].inward(moment) + cross(steps[i].origin, force)
    weight = p["link_0.n"] * gravity
    moment += cross(gravity, vertcat(*of(0, "nx", "ny", "nz")))
    return vertcat(*torques), vertcat(weight - force, -moment)


def _rates(omega: SX, alpha: SX) -> SX:
    """U, (3, 3)."""
    x, y, z = vertsplit(omega)
    a, b, c = vertsplit(alpha)
    xx, yy, zz, xy, xz, yz = -x * x, -y * y, -z * z, x * y, x * z, y * z
    rows = (
        (yy + zz, xy - c, xz + b),
        (xy + c, xx + zz, yz - a),
        (xz - b, yz + a, xx + yy),
    )
    return vertcat(*(horzcat(*row) for row in rows))


def _turning(u: SX, xx: SX, yy: SX, xy: SX, xz: SX, yz: SX) -> SX:
    """The moment in the skew part of ``U S``, of second moments without zz, (3, 1)."""
    return vertcat(
        u[2, 0] * xy + u[2, 1] * yy + (u[2, 2] - u[1, 1]) * yz - u[1, 0] * xz,
        (u[0, 0] - u[2, 2]) * xz + u[0, 1] * yz - u[2, 0] * xx - u[2, 1] * xy,
        u[1, 0] * xx
        - u[0, 1] * yy
        + (u[1, 1] - u[0, 0]) * xy
        + u[1, 2] * xz
        - u[0, 2] * yz,
    )


def link_poses(q: SX) -> list[SX]:
    """Poses in base_link of link 1 to link 4 and of the tcp, (4, 4) each."""
    pose, out = SX.eye(4), []
    for step in turns(q):
        pose = pose @ step.pose()
        out.append(pose)
    return out


def weightless(base_parameters: SX) -> SX:
    """The same without gravity."""
    return vertcat(base_parameters[:-3], SX.zeros(3))


def in_air(base_parameters: SX) -> SX:
    """The same without fluid around the moving links: their net first moments are those of the mass."""
    index = {name: i for i, name in enumerate(BASE_PARAMETERS)}
    return base_parameters[
        [index.get(name.replace(".n", ".h"), i) for name, i in index.items()]
    ]


def _mass_matrix(torque: SX, a: SX) -> SX:
    """Of a torque linear in a: the lower half of the derivative, mirrored."""
    return casadi.tril2symm(casadi.tril(jacobian(torque, a)))


def dynamics() -> tuple[casadi.Function, ...]:
    """Every function; inputs are of q, v, a, tau and the base parameters."""
    q, v, a, tau = (SX.sym(name, JOINTS) for name in ("q", "v", "a", "tau"))
    p, still = SX.sym("parameters", len(BASE_PARAMETERS)), SX.zeros(JOINTS)
    inputs = {"q": q, "v": v, "a": a, "tau": tau, "parameters": p}
    *links, tip = link_poses(q)
    axes = horzcat(*(link[:3, 2] for link in links))
    torque, wrench = newton_euler(q, v, a, p)
    holding, _ = newton_euler(q, still, still, p)
    weight, _ = newton_euler(q, still, still, in_air(p))
    bias, _ = newton_euler(q, v, still, p)
    coriolis, _ = newton_euler(q, v, still, weightless(p))
    # From the outputs, row by row, where that takes fewer operations: of four torques, not of six of a wrench.
    rows = {"helper_options": {"ad_weight": 1}}
    by = {
        k: (jacobian(torque, inputs[k], rows), jacobian(wrench, inputs[k]))
        for k in "qva"
    }
    mass = _mass_matrix(newton_euler(q, still, a, weightless(p))[0], a)
    factors = casadi.ldl(mass, False)
    acceleration = casadi.ldl_solve(tau - bias, *factors)
    mobility = casadi.tril2symm(casadi.tril(casadi.ldl_solve(SX.eye(JOINTS), *factors)))
    pushed = casadi.substitute(by["q"][0], a, acceleration)
    slopes = {
        "a_q": -mobility @ pushed,
        "a_v": -mobility @ by["v"][0],
        "a_tau": mobility,
    }
    every = {
        "forward_kinematics": {"tcp": tip},
        "link_poses": {f"link_{i}": pose for i, pose in enumerate(links, 1)},
        "jacobian": {"jacobian": vertcat(jacobian(tip[:3, 3], q), axes)},
        "gravity_torque": {"tau": weight},
        "buoyancy_torque": {"tau": weight - holding},
        "hydrostatic_torque": {"tau": holding},
        "hydrostatic_torque_derivative": {"tau_q": jacobian(holding, q)},
        "mass_matrix": {"tau_a": mass},
        "coriolis_torque": {"tau": coriolis},
        "coriolis_matrix": {"coriolis": jacobian(coriolis, v) / 2},
        "nonlinear_effects": {"tau": bias},
        "inverse_dynamics": {"tau": torque},
        "inverse_dynamics_derivatives": {
            "tau_q": by["q"][0],
            "tau_v": by["v"][0],
            "tau_a": mass,
        },
        "base_wrench": {"wrench": wrench},
        "inverse_dynamics_with_base_wrench": {"tau": torque, "wrench": wrench},
        "base_wrench_derivatives": {f"wrench_{name}": by[name][1] for name in "qva"},
        "forward_dynamics": {"a": acceleration},
        "forward_dynamics_derivatives": slopes,
    }
    return tuple(named(name, inputs, outputs) for name, outputs in every.items())


def upright(function: casadi.Function) -> casadi.Function:
    """The same for gravity along the z of base_link only: in still water no torque then depends on the first joint."""
    *states, p = inputs = function.sx_in()
    at = [*BASE_PARAMETERS].index("gravity.x")
    given = [*states, vertcat(p[:at], 0, 0, p[at + 2 :])]
    out = [casadi.densify(x) for x in function.call(given)]
    names = function.name_in(), function.name_out()
    return casadi.Function(f"{function.name()}_upright", inputs, out, *names)


def in_moving_water() -> tuple[casadi.Function, ...]:
    """Inverse and forward dynamics; inputs as of `dynamics`, and the current.

    The parameters are the base parameters with what the water adds to them, then `WATER_PARAMETERS`.
    """
    q, v, a, tau = (SX.sym(name, JOINTS) for name in ("q", "v", "a", "tau"))
    current, still = SX.sym("current", 3), SX.zeros(JOINTS)
    p = SX.sym("parameters", len(BASE_PARAMETERS) + len(WATER_PARAMETERS))
    base, water = vertsplit(p, [0, len(BASE_PARAMETERS), p.shape[0]])
    load = partial(_load, water)
    torque, _ = newton_euler(q, v, a, base, current, load)
    bias, _ = newton_euler(q, v, still, base, current, load)
    mass = _mass_matrix(
        newton_euler(q, still, a, weightless(base), SX.zeros(3), load)[0], a
    )
    acceleration = casadi.ldl_solve(tau - bias, *casadi.ldl(mass, False))
    inputs = {"q": q, "v": v, "a": a, "tau": tau, "current": current, "parameters": p}
    results = {"inverse": {"tau": torque}, "forward": {"a": acceleration}}
    return tuple(
        named(f"{k}_dynamics_in_current", inputs, out) for k, out in results.items()
    )


def _load(
    parameters: SX, link: int, h: SX, velocity: SX, omega: SX, acceleration: SX, u: SX
) -> tuple[SX, SX]:
    """What a link spends on the water beside what a rigid body would, and the moment of the first moments.

    Of the momentum ``B v + C omega, C v``: with ``D = 2 C - tr(C)``, ``omega x C v + v x C omega`` is ``D``'s share,
    ``omega x D v + C (omega x v)``, and ``C alpha + omega x C omega`` turns as second moments ``-D / 2`` do.

    Args:
        parameters: Values of `WATER_PARAMETERS`.
        link: 1 to 4.
        h: First moments, which the acceleration pulls on.
        velocity: Of its origin relative to the water.
        omega: Angular velocity.
        acceleration: Of its origin.
        u: U.

    Returns:
        Force and moment about its origin, in its axes.
    """
    p = dict(zip(WATER_PARAMETERS, vertsplit(parameters), strict=True))
    entries = (
        [p.get(f"link_{link}.{block}{at}", SX(0)) for at in SECOND] for block in "bc"
    )
    b, c = (_symmetric(*each) for each in entries)
    c[2, 2] = c[0, 0] + c[1, 1]
    d = 2 * (c - c[2, 2] * SX.eye(3))
    momentum = b @ velocity
    force = b @ (acceleration - cross(omega, velocity)) + cross(omega, momentum)
    force += _turning(u, *(-d[at] / 2 for at in SECOND.values()))
    moment = (c + casadi.skew(h)) @ acceleration
    moment += cross(omega, d @ velocity) + cross(velocity, momentum)
    for k, (carrier, axis, points) in enumerate(STRIPS):
        if carrier == link:
            numbers = [
                p[name] for name in WATER_PARAMETERS if name.startswith(f"strip_{k}.")
            ]
            drag, about = _strip(axis, points, velocity, omega, u, numbers)
            force, moment = force + drag, moment + about
    return force, moment


def _symmetric(xx: SX, yy: SX, xy: SX, xz: SX, yz: SX) -> SX:
    """Without zz."""
    return vertcat(
        *(horzcat(*row) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, SX(0))))
    )


def _strip(
    axis: int, points: int, velocity: SX, omega: SX, u: SX, p: list[SX]
) -> tuple[SX, SX]:
    """Force of a strip along an axis of its link, and moment about the origin.

    At a distance x from its middle the velocity across is ``there + x w``: the sums of the speeds, times x and times
    x^2, over Gauss's points are all that force and moment need of them.
    """
    one, other = (axis + 1) % 3, (axis + 2) % 3
    middle, (half, across, along) = vertcat(*p[:3]), p[3:]
    there = velocity + cross(omega, middle)
    w = (omega[other], -omega[one])
    square = there[one] ** 2 + there[other] ** 2
    mixed = there[one] * w[0] + there[other] * w[1]
    speeds = first = second = SX(0)
    for t, weight in zip(*np.polynomial.legendre.leggauss(points), strict=True):
        if t > 0:  # and its mirror image
            x, share = t * half, weight / 2 * across
            even, odd = square - x**2 * u[axis, axis], 2 * x * mixed
            ahead, behind = (
                casadi.sqrt(casadi.fabs(y)) for y in (even + odd, even - odd)
            )
            both = share * (ahead + behind)
            speeds, second = speeds + both, second + x**2 * both
            first += x * share * (ahead - behind)
    force, moment = SX.zeros(3), SX.zeros(3)
    force[axis] = along * casadi.fabs(there[axis]) * there[axis]
    for at, y in zip((one, other), w, strict=True):
        force[at] = speeds * there[at] + first * y
    moment[one] = -(first * there[other] + second * w[1])
    moment[other] = first * there[one] + second * w[0]
    return force, moment + cross(middle, force)
