"""Newton's and Euler's equations of the arm on a fixed base, as CasADi expressions.

They are recursive, in the axes of the links, and in terms of the base parameters:
moving links have first and second moments but no mass
(`alpha5_model.codegen.regrouping`).
With the angular velocity omega of a link and its rate omega_dot, the matrix
``U = [omega_dot]x + [omega]x [omega]x`` gives all accelerations and inertial forces
[Khalil2002]: a point r accelerates by ``U r``, first moments h exert ``U h``, second
moments S exert the moment in ``U S - (U S)^T``.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section
        9.6.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import casadi
from casadi import SX, cross, horzcat, jacobian, vertcat, vertsplit

from alpha5_model.codegen.chain import Dimensions, Turn, turns
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, SECOND

JOINTS = 4
#: No velocities, or no accelerations.
STILL = SX.zeros(JOINTS)


class Motion(NamedTuple):
    """Motion of a link, in its axes, (3, 1) each.

    Attributes:
        velocity: Velocity of its origin relative to the water.
        acceleration: Acceleration of its origin.
        omega: Angular velocity.
        omega_dot: Angular acceleration.
        rates: U, (3, 3).
        gravity: In the axes of the link.
    """

    velocity: SX
    acceleration: SX
    omega: SX
    omega_dot: SX
    rates: SX
    gravity: SX

    def beyond(self, step: Turn, joint_speed: SX, joint_acceleration: SX) -> Motion:
        """Motion of the next link.

        Args:
            step: The joint between the two links.
            joint_speed, joint_acceleration: Of this joint.
        """
        velocity_of_origin = self.velocity + cross(self.omega, step.origin)
        acceleration_of_origin = self.acceleration + self.rates @ step.origin
        omega_before = step.outward(self.omega)
        omega_dot_before = step.outward(self.omega_dot)

        omega = omega_before + vertcat(0.0, 0.0, joint_speed)
        omega_dot = omega_dot_before + vertcat(
            omega_before[1] * joint_speed,
            -omega_before[0] * joint_speed,
            joint_acceleration,
        )
        return Motion(
            velocity=step.outward(velocity_of_origin),
            acceleration=step.outward(acceleration_of_origin),
            omega=omega,
            omega_dot=omega_dot,
            rates=_rates(omega, omega_dot),
            gravity=step.outward(self.gravity),
        )


def _rates(omega: SX, omega_dot: SX) -> SX:
    """U, (3, 3)."""
    x, y, z = vertsplit(omega)
    xx = -x * x
    yy = -y * y
    zz = -z * z
    xy = x * y
    xz = x * z
    yz = y * z

    omega_dot_x, omega_dot_y, omega_dot_z = vertsplit(omega_dot)
    return vertcat(
        horzcat(yy + zz, xy - omega_dot_z, xz + omega_dot_y),
        horzcat(xy + omega_dot_z, xx + zz, yz - omega_dot_x),
        horzcat(xz - omega_dot_y, yz + omega_dot_x, xx + yy),
    )


#: From a link's number, first moments h and motion to a force and a moment about its
#: origin: all that the motion takes beside ``U h`` and the moment in ``U S``.
Load = Callable[[int, SX, Motion], tuple[SX, SX]]


def without_mass(link: int, first_moments: SX, motion: Motion) -> tuple[SX, SX]:
    """The `Load` of a link that has moments but no mass."""
    return SX.zeros(3), cross(first_moments, motion.acceleration)


def newton_euler(
    q: SX,
    v: SX,
    a: SX,
    base_parameters: SX,
    dimensions: Dimensions,
    water_velocity: SX | None = None,
    load: Load = without_mass,
) -> tuple[SX, SX]:
    """Joint torques, and the load on the mount.

    If velocities, accelerations or gravity are zero, only what does not vanish is left:
    statics, Coriolis torques, ...

    Args:
        q, v, a: Joint positions, velocities and accelerations, (4, 1) each.
        base_parameters: `BASE_PARAMETERS`, (41, 1).
        dimensions: Of the arm.
        water_velocity: In base_link, (3, 1); None for still water.
        load: What the motion of a link takes beside its first and second moments.

    Returns:
        Torques (4, 1), and force above moment on the mount in base_link (6, 1).
    """
    numbers = _by_name(base_parameters)
    gravity = vertcat(*(numbers[f"gravity.{axis}"] for axis in "xyz"))
    motion = Motion(
        velocity=SX.zeros(3) if water_velocity is None else -water_velocity,
        acceleration=SX.zeros(3),
        omega=SX.zeros(3),
        omega_dot=SX.zeros(3),
        rates=SX.zeros(3, 3),
        gravity=gravity,
    )

    steps = turns(q, dimensions)
    loads = []
    for i, step in enumerate(steps):
        motion = motion.beyond(step, v[i], a[i])
        loads.append(_on_link(i + 1, motion, numbers, load))

    torques, force, moment = _handed_down(steps, loads)
    weight_of_link_0 = numbers["link_0.n"] * gravity
    moment += cross(gravity, _vector(numbers, 0, "n"))
    return torques, vertcat(weight_of_link_0 - force, -moment)


def _handed_down(
    steps: Sequence[Turn], loads: Sequence[tuple[SX, SX]]
) -> tuple[SX, SX, SX]:
    """Torques (4, 1), and force and moment on link 1 at and in base_link, (3, 1) each.

    Args:
        steps: From base_link to link 1, ..., from link 3 to link 4.
        loads: Force and moment that each link takes, about its origin and in its axes.
    """
    torques: list[SX] = []
    force = SX.zeros(3)
    moment = SX.zeros(3)
    inwards = reversed(list(zip(steps, loads, strict=True)))
    for step, (own_force, own_moment) in inwards:
        force = own_force + force
        moment = own_moment + moment
        torques.insert(0, moment[2])

        force = step.inward(force)
        moment = step.inward(moment) + cross(step.origin, force)
    return vertcat(*torques), force, moment


def _by_name(base_parameters: SX) -> dict[str, SX]:
    """The base parameters by their names."""
    numbers = dict(zip(BASE_PARAMETERS, vertsplit(base_parameters), strict=True))
    # Link 1 turns about its z only: all of xx + yy may stand in xx.
    return numbers | {"link_1.xx": numbers["link_1.izz"]}


def _on_link(
    link: int, motion: Motion, numbers: Mapping[str, SX], load: Load
) -> tuple[SX, SX]:
    """Force and moment about the link's origin that its motion and weight take."""
    first_moments = _vector(numbers, link, "h")
    net_first_moments = _vector(numbers, link, "n")
    second_moments = _entries(numbers, link, tuple(SECOND))

    force, moment = load(link, first_moments, motion)
    force = motion.rates @ first_moments + force
    moment = turning_moment(motion.rates, *second_moments) + moment
    return force, moment + cross(motion.gravity, net_first_moments)


def _vector(numbers: Mapping[str, SX], link: int, name: str) -> SX:
    """First moments of a link, (3, 1)."""
    return vertcat(*_entries(numbers, link, tuple(f"{name}{axis}" for axis in "xyz")))


def _entries(numbers: Mapping[str, SX], link: int, names: tuple[str, ...]) -> list[SX]:
    """Numbers of a link; those that are no base parameters are 0."""
    return [numbers.get(f"link_{link}.{name}", SX(0.0)) for name in names]


def turning_moment(u: SX, xx: SX, yy: SX, xy: SX, xz: SX, yz: SX) -> SX:
    """The moment (3, 1) in the skew part of ``U S``; S are second moments, no zz."""
    about_x = u[2, 0] * xy + u[2, 1] * yy + (u[2, 2] - u[1, 1]) * yz - u[1, 0] * xz
    about_y = (u[0, 0] - u[2, 2]) * xz + u[0, 1] * yz - u[2, 0] * xx - u[2, 1] * xy
    about_z = (
        u[1, 0] * xx
        - u[0, 1] * yy
        + (u[1, 1] - u[0, 0]) * xy
        + u[1, 2] * xz
        - u[0, 2] * yz
    )
    return vertcat(about_x, about_y, about_z)


def weightless(base_parameters: SX) -> SX:
    """The base parameters without gravity."""
    return vertcat(base_parameters[:-3], SX.zeros(3))


def in_air(base_parameters: SX) -> SX:
    """The base parameters in air, for joint torques only.

    The net first moments of the links are those of the mass. link_0 keeps its numbers
    in the fluid, so the load on the mount does not hold.
    """
    place = {name: i for i, name in enumerate(BASE_PARAMETERS)}
    sources = [place.get(name.replace(".n", ".h"), i) for name, i in place.items()]
    return base_parameters[sources]


def mass_matrix(torque: SX, a: SX) -> SX:
    """M (4, 4) from a torque linear in a: the derivative's lower half, mirrored."""
    return casadi.tril2symm(casadi.tril(jacobian(torque, a)))
