"""Dynamics under water against Pinocchio, MuJoCo and roboticstoolbox.

A target here bounds what the wrapping costs: 0.4 says that this package's call, input
checks and a result of the caller's own included, takes at most 1 / 0.4 = 2.5 times the
raw calls below it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np
import pinocchio as pin
from benchmarks.timing import Row, measure

import alpha5_model as a5

OWN = "alpha5_model"
PEERS = {"mujoco": "MuJoCo", "roboticstoolbox": "roboticstoolbox-python"}
#: Bounds of the wrapping, as this package's time over the raw one's.
WRAPPED, WITH_WATER = 2.5, 3.5
MOVING, MOVING_BATCH = 10.0, 3.0


def rows() -> list[Row]:
    """Measured rows of this section."""
    rng = np.random.default_rng(1)
    q, v, a = (np.ascontiguousarray(x) for x in rng.uniform(0.1, 3.0, (3, 4)))
    return [
        *_single(q, v, a),
        *_against_peers(q, v, a),
        *_moving_water(q, v, a),
        _loading(),
    ]


def missing() -> list[str]:
    """Peers that are not installed."""
    return [name for module, name in PEERS.items() if find_spec(module) is None]


def _single(q: Any, v: Any, a: Any) -> list[Row]:
    """Each method beside the Pinocchio calls that give the same numbers."""
    arm = a5.load()
    model, data = arm.model, arm.model.createData()
    fluid, fluid_data = arm.fluid_model, arm.fluid_model.createData()
    tcp = model.getFrameId("tcp")
    gravity = pin.computeGeneralizedGravity
    derivative = pin.computeGeneralizedGravityDerivatives
    axes = pin.LOCAL_WORLD_ALIGNED

    def pose() -> Any:
        pin.forwardKinematics(model, data, q)
        return pin.updateFramePlacement(model, data, tcp).copy()

    def effects() -> Any:
        return pin.nonLinearEffects(model, data, q, v) - gravity(fluid, fluid_data, q)

    def derivatives() -> Any:
        dq, dv, da = pin.computeRNEADerivatives(model, data, q, v, a)
        return dq - derivative(fluid, fluid_data, q), dv.copy(), da.copy()

    def energy() -> Any:
        weight = pin.computePotentialEnergy(model, data, q)
        return weight - pin.computePotentialEnergy(fluid, fluid_data, q)

    link_0 = model.inertias[0]
    mass = sum(inertia.mass for inertia in model.inertias)
    moving = mass - link_0.mass

    def center() -> Any:
        com = pin.centerOfMass(model, data, q)
        return (moving * com + link_0.mass * link_0.lever) / mass

    def wrench() -> Any:
        pin.rnea(model, data, q, v, a)
        gravity(fluid, fluid_data, q)
        load = data.liMi[1].act(data.f[1] - fluid_data.f[1])
        weight = model.inertias[0] * -model.gravity - fluid.inertias[0] * -model.gravity
        return -(load + weight)

    cases: list[tuple[str, Callable[[], Any], str, Callable[[], Any], float]] = [
        (
            "forward_kinematics",
            lambda: arm.forward_kinematics(q),
            "forwardKinematics, updateFramePlacement, copy",
            pose,
            WRAPPED,
        ),
        (
            "jacobian",
            lambda: arm.jacobian(q),
            "computeFrameJacobian",
            lambda: pin.computeFrameJacobian(model, data, q, tcp, axes),
            WRAPPED,
        ),
        (
            "mass_matrix",
            lambda: arm.mass_matrix(q),
            "crba",
            lambda: pin.crba(model, data, q),
            WRAPPED,
        ),
        (
            "coriolis_matrix",
            lambda: arm.coriolis_matrix(q, v),
            "computeCoriolisMatrix",
            lambda: pin.computeCoriolisMatrix(model, data, q, v),
            WRAPPED,
        ),
        (
            "gravity_torque",
            lambda: arm.gravity_torque(q),
            "computeGeneralizedGravity",
            lambda: gravity(model, data, q),
            WRAPPED,
        ),
        (
            "buoyancy_torque",
            lambda: arm.buoyancy_torque(q),
            "computeGeneralizedGravity",
            lambda: gravity(fluid, fluid_data, q),
            WRAPPED,
        ),
        (
            "hydrostatic_torque",
            lambda: arm.hydrostatic_torque(q),
            "computeGeneralizedGravity, no water",
            lambda: gravity(model, data, q),
            WITH_WATER,
        ),
        (
            "hydrostatic_torque_derivative",
            lambda: arm.hydrostatic_torque_derivative(q),
            "computeGeneralizedGravityDerivatives, no water",
            lambda: derivative(model, data, q),
            WITH_WATER,
        ),
        (
            "nonlinear_effects",
            lambda: arm.nonlinear_effects(q, v),
            "nonLinearEffects minus buoyancy",
            effects,
            WRAPPED,
        ),
        (
            "inverse_dynamics",
            lambda: arm.inverse_dynamics(q, v, a),
            "rnea, no water",
            lambda: pin.rnea(model, data, q, v, a),
            WITH_WATER,
        ),
        (
            "forward_dynamics",
            lambda: arm.forward_dynamics(q, v, a),
            "aba, no water",
            lambda: pin.aba(model, data, q, v, a),
            WRAPPED,
        ),
        (
            "inverse_dynamics_derivatives",
            lambda: arm.inverse_dynamics_derivatives(q, v, a),
            "computeRNEADerivatives minus buoyancy, copies",
            derivatives,
            WRAPPED,
        ),
        (
            "kinetic_energy",
            lambda: arm.kinetic_energy(q, v),
            "computeKineticEnergy",
            lambda: pin.computeKineticEnergy(model, data, q, v),
            WRAPPED,
        ),
        (
            "potential_energy",
            lambda: arm.potential_energy(q),
            "computePotentialEnergy, arm and fluid",
            energy,
            WRAPPED,
        ),
        (
            "center_of_mass",
            lambda: arm.center_of_mass(q),
            "centerOfMass and link_0",
            center,
            WRAPPED,
        ),
        (
            "base_wrench",
            lambda: arm.base_wrench(q, v, a),
            "rnea of arm and fluid, last step to the base",
            wrench,
            WRAPPED,
        ),
    ]
    out = []
    for name, ours, raw_name, raw, bound in cases:
        times = measure({OWN: ours, "raw": raw})
        out += _rows(name, times, {"raw": f"Pinocchio: {raw_name}"}, {"raw": 1 / bound})
    return out


def _against_peers(q: Any, v: Any, a: Any) -> list[Row]:
    """Inverse dynamics with water, by everybody who can."""
    arm = a5.load()
    functions: dict[str, Callable[[], Any]] = {
        OWN: lambda: arm.inverse_dynamics(q, v, a),
        "Pinocchio, fext made in Python": _fext(arm, q, v, a),
    }
    if find_spec("mujoco"):
        functions["MuJoCo, native buoyancy"] = _mujoco(arm, q, v, a)
    for name, function in functions.items():
        if np.abs(function() - arm.inverse_dynamics(q, v, a)).max() > 1e-9:
            raise AssertionError(f"{name} disagrees: {function()}")
    if find_spec("roboticstoolbox"):
        dry = _roboticstoolbox(q, v, a)
        if np.abs(dry() - a5.load(a5.AIR).inverse_dynamics(q, v, a)).max() > 1e-9:
            raise AssertionError(f"roboticstoolbox disagrees: {dry()}")
        functions["roboticstoolbox rne (C), no water"] = dry
    return _rows("inverse dynamics under water", measure(functions), {}, {})


def _fext(arm: Any, q: Any, v: Any, a: Any) -> Callable[[], Any]:
    """What one writes without this package: a wrench for each body, then RNEA with
    them.
    """
    model, data = arm.model, arm.model.createData()
    volumes = [
        (model.getJointId(b.joint), b.volume, np.array(b.cob))
        for b in arm.displacements
    ]

    def function() -> Any:
        pin.forwardKinematics(model, data, q)
        forces = [pin.Force.Zero() for _ in range(model.njoints)]
        for joint, volume, cob in volumes:
            up = data.oMi[joint].rotation.T @ np.array([0.0, 0.0, 9.81])
            force = arm.fluid_density * volume * up
            forces[joint] += pin.Force(force, np.cross(cob, force))
        return pin.rnea(model, data, q, v, a, forces)

    return function


def _mujoco(arm: Any, q: Any, v: Any, a: Any) -> Callable[[], Any]:
    """The URDF with a weightless body at each centre of buoyancy, which gravcomp lifts
    by rho V g.
    """
    import mujoco

    from alpha5_model.description.urdf import Variant, urdf

    switch = (
        '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco></robot>'
    )
    text = urdf(Variant(collision="none")).replace("</robot>", switch)
    spec = mujoco.MjSpec.from_string(text)
    for body in arm.displacements:
        if body.body != "link_0":
            spec.body(body.body).add_body(
                name=f"{body.body}_water",
                pos=body.cob,
                ipos=np.zeros(3),
                mass=1e-9,
                inertia=np.zeros(3),
                gravcomp=arm.fluid_density * body.volume / 1e-9 + 1,
                explicitinertial=True,
            )
    model = spec.compile()
    data = mujoco.MjData(model)

    def function() -> Any:
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        return data.qfrc_inverse.copy()

    return function


def _roboticstoolbox(q: Any, v: Any, a: Any) -> Callable[[], Any]:
    """The arm as a DHRobot: inertial parameters moved from the inertial frames to the
    DH frames.
    """
    from roboticstoolbox import DHRobot, RevoluteDH

    p, links = a5.parameters(), []
    for row, link in zip(p.dh[:4], p.links[1:], strict=True):
        c, s = np.cos(row.alpha), np.sin(row.alpha)
        turn = np.array([[1, 0, 0], [0, c, s], [0, -s, c]])  # inertial axes to DH axes
        links.append(
            RevoluteDH(
                d=row.d,
                a=row.a,
                alpha=row.alpha,
                offset=row.theta_offset,
                m=link.mass,
                r=turn @ (link.com - np.array([row.a, 0.0, row.d])),
                I=turn @ link.inertia @ turn.T,
                Jm=0.0,
                G=1.0,
            )
        )
    robot = DHRobot(links, gravity=[0.0, 0.0, -9.81])
    return lambda: robot.rne(q, v, a)


def _moving_water(q: Any, v: Any, a: Any) -> list[Row]:
    """Added mass, drag and a current, beside the same without."""
    arm = a5.load()
    wet = arm.with_hydrodynamics((0.3, -0.5, 0.7))
    model, data, n = arm.model, arm.model.createData(), 20_000
    many = [np.tile(x, (n, 1)) for x in (q, v, a)]
    one = {
        OWN: lambda: wet.inverse_dynamics(q, v, a),
        "raw": lambda: pin.rnea(model, data, q, v, a),
    }
    batch = {
        OWN: lambda: wet.inverse_dynamics_batch(*many, threads=1),
        "raw": lambda: arm.inverse_dynamics_batch(*many, threads=1),
    }
    work = "inverse_dynamics in a current"
    return [
        *_rows(
            work,
            measure(one),
            {"raw": "Pinocchio: rnea, no water"},
            {"raw": 1 / MOVING},
        ),
        *_rows(
            f"{work}, batch of {n}, 1 thread",
            measure(batch, per_call=n),
            {"raw": "the same without moving water"},
            {"raw": 1 / MOVING_BATCH},
        ),
    ]


def _loading() -> Row:
    return Row(
        "load()", OWN, measure({OWN: a5.load})[OWN], setup="after the first call"
    )


def _rows(
    work: str,
    times: Mapping[str, float],
    names: Mapping[str, str],
    targets: Mapping[str, float],
) -> list[Row]:
    return [
        Row(work, names.get(name, name), seconds, target=targets.get(name))
        for name, seconds in times.items()
    ]
