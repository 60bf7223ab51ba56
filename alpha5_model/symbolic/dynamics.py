"""The equations of motion of the arm on a fixed base, jaws locked, as CasADi expressions.

Newton's and Euler's equations, recursively and in the axes of the links, of the base parameters: moving
links have first and second moments but no mass, see `alpha5_model.base_parameters`. With angular velocity
omega and acceleration alpha of a link, ``U = [alpha]x + [omega]x [omega]x`` gives all [Khalil2002]: a point r
accelerates by ``U r``, a first moment h pulls with ``U h``, second moments S turn with ``U S - (U S)^T``.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section 9.6.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import casadi
from casadi import SX, cross, horzcat, vertcat, vertsplit

from alpha5_model.base_parameters import BASE_PARAMETERS
from alpha5_model.parameters import parameters

JOINTS = 4
#: Of a link's number, velocity relative to the water, angular velocity, acceleration, angular acceleration: force, moment.
Load = Callable[[int, SX, SX, SX, SX], tuple[SX, SX]]


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
        return vertcat(self.cosine * x + self.sine * y, self.cosine * y - self.sine * x, z)

    def inward(self, vector: SX) -> SX:
        """A vector of the link in the axes of the frame before."""
        x, y, z = vertsplit(vector)
        x, y = self.cosine * x - self.sine * y, self.sine * x + self.cosine * y
        return vertcat(x, self.along * y - self.across * z, self.across * y + self.along * z)


def turns(q: SX) -> list[Turn]:
    """Base to link 1, ..., link 3 to link 4."""
    p = parameters()
    out, origin, alpha = [], [0.0, 0.0, 0.0], 0.0
    for i, row in enumerate(p.dh[:JOINTS]):
        # cos(q + offset) from cos(q) and sin(q): q + offset would round large angles.
        cosine, sine = _exact(math.cos(row.theta_offset)), _exact(math.sin(row.theta_offset))
        c, s = casadi.cos(q[i]), casadi.sin(q[i])
        across, along = round(math.sin(alpha)), round(math.cos(alpha))
        out.append(Turn(SX(origin), cosine * c - sine * s, sine * c + cosine * s, across, along))
        origin, alpha = [row.a, 0.0, row.d], row.alpha
    return out


def tcp() -> Turn:
    """Link 4 to the tcp."""
    *_, wrist, last = parameters().dh
    angle = last.theta_offset
    c, s = SX(_exact(math.cos(angle))), SX(_exact(math.sin(angle)))
    return Turn(
        SX([wrist.a, 0.0, wrist.d]),
        c,
        s,
        round(math.sin(wrist.alpha)),
        round(math.cos(wrist.alpha)),
    )


def _exact(value: float) -> float:
    """Sine or cosine, exact for multiples of pi/2."""
    return float(round(value)) if abs(value - round(value)) < 1e-15 else value


def newton_euler(
    q: SX, v: SX, a: SX, base_parameters: SX, current: SX | None = None, load: Load | None = None
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
    omega, alpha, acceleration, u = SX.zeros(3), SX.zeros(3), SX.zeros(3), SX.zeros(3, 3)
    steps, forces, moments = turns(q), [], []
    velocity = SX.zeros(3) if current is None else -current
    for i, step in enumerate(steps):
        velocity = step.outward(velocity + cross(omega, step.origin))
        acceleration = step.outward(acceleration + u @ step.origin)
        g, omega, alpha = step.outward(g), step.outward(omega), step.outward(alpha)
        alpha += vertcat(omega[1] * v[i], -omega[0] * v[i], a[i])
        omega += vertcat(0.0, 0.0, v[i])
        u = _rates(omega, alpha)
        h, n = vertcat(*of(i + 1, "hx", "hy", "hz")), vertcat(*of(i + 1, "nx", "ny", "nz"))
        second = of(i + 1, "xx", "yy", "xy", "xz", "yz")
        forces.append(u @ h)
        moments.append(_turning(u, *second) + cross(h, acceleration) + cross(g, n))
        if load is not None:
            force, moment = load(i + 1, velocity, omega, acceleration, alpha)
            forces[i], moments[i] = forces[i] + force, moments[i] + moment
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
    rows = (yy + zz, xy - c, xz + b), (xy + c, xx + zz, yz - a), (xz - b, yz + a, xx + yy)
    return vertcat(*(horzcat(*row) for row in rows))


def _turning(u: SX, xx: SX, yy: SX, xy: SX, xz: SX, yz: SX) -> SX:
    """The moment in the skew part of ``U S``, of second moments without zz, (3, 1)."""
    return vertcat(
        u[2, 0] * xy + u[2, 1] * yy + (u[2, 2] - u[1, 1]) * yz - u[1, 0] * xz,
        (u[0, 0] - u[2, 2]) * xz + u[0, 1] * yz - u[2, 0] * xx - u[2, 1] * xy,
        u[1, 0] * xx - u[0, 1] * yy + (u[1, 1] - u[0, 0]) * xy + u[1, 2] * xz - u[0, 2] * yz,
    )


def link_poses(q: SX) -> list[SX]:
    """Poses in base_link of link 1 to link 4 and of the tcp, (4, 4) each."""
    pose, out = SX.eye(4), []
    for step in [*turns(q), tcp()]:
        turned = horzcat(*(step.inward(axis) for axis in casadi.horzsplit(SX.eye(3))))
        pose = pose @ vertcat(horzcat(turned, step.origin), SX([[0.0, 0.0, 0.0, 1.0]]))
        out.append(pose)
    return out


def jacobian(q: SX) -> SX:
    """Of the tcp, velocity of its point above angular velocity, in base_link, (6, 4)."""
    *links, tip = link_poses(q)
    axes = horzcat(*(link[:3, 2] for link in links))
    return vertcat(casadi.jacobian(tip[:3, 3], q), axes)


def mass_matrix(q: SX, base_parameters: SX) -> SX:
    """M(q), (4, 4): its lower half, mirrored."""
    a, still = SX.sym("a", JOINTS), SX.zeros(JOINTS)
    torque, _ = newton_euler(q, still, a, weightless(base_parameters))
    return casadi.tril2symm(casadi.tril(casadi.jacobian(torque, a)))


def weightless(base_parameters: SX) -> SX:
    """The same without gravity."""
    return vertcat(base_parameters[:-3], SX.zeros(3))


def in_air(base_parameters: SX) -> SX:
    """The same without fluid around the moving links: their net first moments are those of the mass."""
    index = {name: i for i, name in enumerate(BASE_PARAMETERS)}
    return base_parameters[[index.get(name.replace(".n", ".h"), i) for name, i in index.items()]]


def dynamics() -> tuple[casadi.Function, ...]:
    """Every function; inputs are of q, v, a, tau and the base parameters."""
    q, v, a, tau = (SX.sym(name, JOINTS) for name in ("q", "v", "a", "tau"))
    p, still = SX.sym("parameters", len(BASE_PARAMETERS)), SX.zeros(JOINTS)
    inputs = {"q": q, "v": v, "a": a, "tau": tau, "parameters": p}
    *links, tip = link_poses(q)
    torque, wrench = newton_euler(q, v, a, p)
    holding, _ = newton_euler(q, still, still, p)
    weight, _ = newton_euler(q, still, still, in_air(p))
    bias, _ = newton_euler(q, v, still, p)
    coriolis, _ = newton_euler(q, v, still, weightless(p))
    by = {
        name: (casadi.jacobian(torque, inputs[name]), casadi.jacobian(wrench, inputs[name]))
        for name in "qva"
    }
    mass = mass_matrix(q, p)
    factors = casadi.ldl(mass, False)
    acceleration = casadi.ldl_solve(tau - bias, *factors)
    mobility = casadi.tril2symm(casadi.tril(casadi.ldl_solve(SX.eye(JOINTS), *factors)))
    pushed = casadi.substitute(by["q"][0], a, acceleration)
    every: dict[str, tuple[str, dict[str, SX]]] = {
        "forward_kinematics": ("q", {"tcp": tip}),
        "link_poses": ("q", {f"link_{i}": pose for i, pose in enumerate(links, 1)}),
        "jacobian": ("q", {"jacobian": jacobian(q)}),
        "gravity_torque": ("q parameters", {"tau": weight}),
        "buoyancy_torque": ("q parameters", {"tau": weight - holding}),
        "hydrostatic_torque": ("q parameters", {"tau": holding}),
        "hydrostatic_torque_derivative": ("q parameters", {"tau_q": casadi.jacobian(holding, q)}),
        "mass_matrix": ("q parameters", {"tau_a": mass}),
        "coriolis_torque": ("q v parameters", {"tau": coriolis}),
        "coriolis_matrix": ("q v parameters", {"coriolis": casadi.jacobian(coriolis, v) / 2}),
        "nonlinear_effects": ("q v parameters", {"tau": bias}),
        "inverse_dynamics": ("q v a parameters", {"tau": torque}),
        "inverse_dynamics_derivatives": (
            "q v a parameters",
            {"tau_q": by["q"][0], "tau_v": by["v"][0], "tau_a": mass},
        ),
        "base_wrench": ("q v a parameters", {"wrench": wrench}),
        "inverse_dynamics_with_base_wrench": (
            "q v a parameters",
            {"tau": torque, "wrench": wrench},
        ),
        "base_wrench_derivatives": (
            "q v a parameters",
            {"wrench_q": by["q"][1], "wrench_v": by["v"][1], "wrench_a": by["a"][1]},
        ),
        "forward_dynamics": ("q v tau parameters", {"a": acceleration}),
        "forward_dynamics_derivatives": (
            "q v tau parameters",
            {"a_q": -mobility @ pushed, "a_v": -mobility @ by["v"][0], "a_tau": mobility},
        ),
    }
    return tuple(
        casadi.Function(
            name,
            [inputs[one] for one in given.split()],
            [casadi.densify(x) for x in outputs.values()],
            given.split(),
            [*outputs],
        )
        for name, (given, outputs) in every.items()
    )
