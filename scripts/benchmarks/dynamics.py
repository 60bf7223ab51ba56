"""Dynamics against Pinocchio, MuJoCo, roboticstoolbox, CasADi, JAX and MJX.

A call of ours includes input checks and a result of the caller's own. Where Pinocchio
computes in air, it has less work.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
from benchmarks.timing import Row, compare, installed

import alpha5_model as a5
from alpha5_model.kernels import choice as kernels

OWN = "alpha5_model"
STATES = 100_000
#: Of which MJX computes so many: it keeps everything that a simulation would need.
MJX_STATES = 10_000
#: Of an arm in moving water.
WET_STATES = 20_000
State = tuple[np.ndarray, np.ndarray, np.ndarray]


def rows() -> list[Row]:
    """Measured rows of this subject."""
    rng = np.random.default_rng(1)
    q, v, a = (np.ascontiguousarray(x) for x in rng.uniform(0.1, 3.0, (3, 4)))
    state = (q, v, a)
    q, v, a = rng.uniform(-3.0, 3.0, (3, STATES, 4))
    states = (q, v, a)
    return [
        *(_casadi(state) if installed("casadi") else []),
        *_batches(states),
        *(_jax(states) if installed("jax") else []),
        *_any_arm(),
        *_single(state),
        *_against_peers(state),
        *_moving_water(state),
    ]


def _check(name: str, found: Any, expected: Any, tolerance: float) -> None:
    if np.abs(found - expected).max() > tolerance:
        raise AssertionError(f"{name} disagrees: {found}")


# --- single calls ---------------------------------------------------------------------


def _single(state: State) -> list[Row]:
    """Each method beside the Pinocchio calls that give the same numbers."""
    q, v, a = state
    arm = a5.load()
    model, data = arm.model, arm.model.createData()
    fluid, fluid_data = arm.fluid_model, arm.fluid_model.createData()
    tcp, axes = model.getFrameId("tcp"), pin.LOCAL_WORLD_ALIGNED
    gravity = pin.computeGeneralizedGravity
    slope = pin.computeGeneralizedGravityDerivatives
    link_0 = model.inertias[0]
    mass = sum(inertia.mass for inertia in model.inertias)

    def pose() -> Any:
        pin.forwardKinematics(model, data, q)
        return pin.updateFramePlacement(model, data, tcp).copy()

    def effects() -> Any:
        return pin.nonLinearEffects(model, data, q, v) - gravity(fluid, fluid_data, q)

    def derivatives() -> Any:
        dq, dv, da = pin.computeRNEADerivatives(model, data, q, v, a)
        return dq - slope(fluid, fluid_data, q), dv.copy(), da.copy()

    def energy() -> Any:
        weight = pin.computePotentialEnergy(model, data, q)
        return weight - pin.computePotentialEnergy(fluid, fluid_data, q)

    def center() -> Any:
        com = pin.centerOfMass(model, data, q)
        return ((mass - link_0.mass) * com + link_0.mass * link_0.lever) / mass

    def wrench() -> Any:
        pin.rnea(model, data, q, v, a)
        gravity(fluid, fluid_data, q)
        load = data.liMi[1].act(data.f[1] - fluid_data.f[1])
        weight = model.inertias[0] * -model.gravity - fluid.inertias[0] * -model.gravity
        return -(load + weight)

    peers: dict[str, tuple[tuple[Any, ...], Callable[[], Any], str]] = {
        "forward_kinematics": (
            (q,),
            pose,
            "forwardKinematics, updateFramePlacement, copy",
        ),
        "jacobian": (
            (q,),
            lambda: pin.computeFrameJacobian(model, data, q, tcp, axes),
            "computeFrameJacobian",
        ),
        "mass_matrix": ((q,), lambda: pin.crba(model, data, q), "crba"),
        "coriolis_matrix": (
            (q, v),
            lambda: pin.computeCoriolisMatrix(model, data, q, v),
            "computeCoriolisMatrix",
        ),
        "gravity_torque": (
            (q,),
            lambda: gravity(model, data, q),
            "computeGeneralizedGravity",
        ),
        "buoyancy_torque": (
            (q,),
            lambda: gravity(fluid, fluid_data, q),
            "computeGeneralizedGravity",
        ),
        "hydrostatic_torque": (
            (q,),
            lambda: gravity(model, data, q),
            "computeGeneralizedGravity, no water",
        ),
        "hydrostatic_torque_derivative": (
            (q,),
            lambda: slope(model, data, q),
            "computeGeneralizedGravityDerivatives, no water",
        ),
        "nonlinear_effects": ((q, v), effects, "nonLinearEffects minus buoyancy"),
        "inverse_dynamics": (
            state,
            lambda: pin.rnea(model, data, q, v, a),
            "rnea, no water",
        ),
        "forward_dynamics": (
            state,
            lambda: pin.aba(model, data, q, v, a),
            "aba, no water",
        ),
        "inverse_dynamics_derivatives": (
            state,
            derivatives,
            "computeRNEADerivatives minus buoyancy, copies",
        ),
        "kinetic_energy": (
            (q, v),
            lambda: pin.computeKineticEnergy(model, data, q, v),
            "computeKineticEnergy",
        ),
        "potential_energy": (
            (q,),
            energy,
            "computePotentialEnergy, arm and fluid",
        ),
        "center_of_mass": ((q,), center, "centerOfMass and link_0"),
        "base_wrench": (state, wrench, "rnea of arm and fluid, last step to the base"),
    }
    found = []
    for name, (given, raw, raw_name) in peers.items():
        ours = partial(getattr(arm, name), *given)
        found += compare(name, {OWN: ours, f"Pinocchio: {raw_name}": raw})
    return found


def _casadi(state: State) -> list[Row]:
    """A CasADi Function, called through its buffers."""
    from alpha5_model.casadi import load

    q, v, a = state
    arm = a5.load()
    model, data = arm.model, arm.model.createData()
    buffer, run = load(arm).inverse_dynamics.buffer()
    tau = np.zeros(4)
    for i, x in enumerate(state):
        buffer.set_arg(i, memoryview(x))
    buffer.set_res(0, memoryview(tau))
    run()
    _check("CasADi", tau, arm.inverse_dynamics(q, v, a), 1e-12)
    candidates: dict[str, Callable[[], object]] = {
        "alpha5_model.casadi, buffered": run,
        "Pinocchio: rnea, no water": lambda: pin.rnea(model, data, q, v, a),
    }
    return compare("inverse_dynamics, one call of a CasADi Function", candidates)


# --- batches --------------------------------------------------------------------------


def _batches(states: State) -> list[Row]:
    """On one thread, compiled and without a compiler."""
    q, v, a = states
    arm = a5.load()
    pool = pin.ModelPool(arm.model, 1)
    found = []
    for name, ours, raw in (
        ("rnea", arm.inverse_dynamics_batch, pin.rneaInParallel),
        ("aba", arm.forward_dynamics_batch, pin.abaInParallel),
    ):
        candidates: dict[str, Callable[[], object]] = {}
        if kernels.backend() != "numpy":
            candidates["alpha5_model, compiled"] = partial(ours, *states, threads=1)
        without = "alpha5_model, numpy"
        peer = f"Pinocchio: {name}InParallel, no water"
        candidates[without] = partial(_without_compiler, ours, states)
        candidates[peer] = partial(raw, 1, pool, q.T, v.T, a.T)
        work = f"{ours.__name__}, {STATES} states, 1 thread"
        rows = compare(work, candidates, STATES)
        found += rows
        if name == "rnea":
            work += ", without a compiler"
            found += [replace(row, work=work) for row in rows[-2:]]
    return found


def _without_compiler(batch: Callable[..., Any], states: State) -> Any:
    before = os.environ.get("ALPHA5_KERNELS")
    os.environ["ALPHA5_KERNELS"] = "numpy"
    kernels.module.cache_clear()
    try:
        return batch(*states, threads=1)
    finally:
        os.environ.pop("ALPHA5_KERNELS")
        if before is not None:
            os.environ["ALPHA5_KERNELS"] = before
        kernels.module.cache_clear()


def _jax(states: State) -> list[Row]:
    """Mapped over the states, on the processor, in double precision."""
    import jax

    from alpha5_model.jax import load

    arm = a5.load()
    pool = pin.ModelPool(arm.model, 1)
    with jax.enable_x64(True), jax.default_device(jax.devices("cpu")[0]):
        given = [jax.numpy.asarray(x) for x in states]
        ours = jax.jit(jax.vmap(load(arm).inverse_dynamics))
        expected = arm.inverse_dynamics_batch(*states, threads=1)
        _check("JAX", np.asarray(ours(*given)), expected, 1e-11)
        units = {
            "alpha5_model.jax, vmap, double": STATES,
            "Pinocchio: rneaInParallel, 1 thread, no water": STATES,
        }
        calls: list[Callable[[], object]] = [
            lambda: ours(*given).block_until_ready(),
            lambda: pin.rneaInParallel(1, pool, *(x.T for x in states)),
        ]
        if installed("mujoco.mjx"):
            few = [0.3 + 0.3 * jax.numpy.abs(x[:MJX_STATES]) for x in given]
            dry = a5.load(a5.AIR).inverse_dynamics_batch(*map(np.asarray, few))
            mjx = _mjx()
            _check("MJX", np.asarray(mjx(*few)), dry, 1e-9)
            units[f"MJX on our MJCF, {MJX_STATES} states, no water"] = MJX_STATES
            calls.append(lambda: mjx(*few).block_until_ready())
        candidates = dict(zip(units, calls, strict=True))
        work = f"inverse dynamics in JAX, {STATES} states, CPU"
        return compare(work, candidates, units, rounds=5)


def _mjx() -> Any:
    """Inverse dynamics of the exported MuJoCo model, mapped over states that are within
    the limits.
    """
    import jax
    import mujoco
    from mujoco import mjx

    from alpha5_model.description.mjcf import MjcfOptions, mjcf

    text = mjcf(MjcfOptions(collision="none", fluid_density=0.0))
    tree = mjx.put_model(mujoco.MjModel.from_xml_string(text))
    empty = mjx.make_data(tree)

    def one(q: Any, v: Any, a: Any) -> Any:
        return mjx.inverse(tree, empty.replace(qpos=q, qvel=v, qacc=a)).qfrc_inverse

    return jax.jit(jax.vmap(one))


def _any_arm() -> list[Row]:
    """An arm of one's own in place of the catalogue's."""
    printed = a5.parameters()
    dh = list(printed.dh)
    dh[1] = replace(dh[1], a=dh[1].a + 0.01)
    arms = {
        "catalogue's arm": a5.load(),
        "own lengths": a5.load(arm=replace(printed, dh=tuple(dh))),
    }
    q, v, a = np.random.default_rng(7).uniform(0.3, 2.0, (3, STATES, 4))
    calls = {
        name: partial(arm.inverse_dynamics_batch, q, v, a) for name, arm in arms.items()
    }
    return compare(
        "inverse dynamics of any arm: 100 000 states", calls, STATES, rounds=41
    )


# --- under water ----------------------------------------------------------------------


def _against_peers(state: State) -> list[Row]:
    """Inverse dynamics with water, by everybody who can."""
    q, v, a = state
    arm = a5.load()
    candidates: dict[str, Callable[[], Any]] = {
        OWN: lambda: arm.inverse_dynamics(q, v, a),
        "Pinocchio, fext made in Python": _fext(arm, state),
    }
    if installed("mujoco"):
        candidates["MuJoCo, native buoyancy"] = _mujoco(arm, state)
    for name, function in candidates.items():
        _check(name, function(), arm.inverse_dynamics(q, v, a), 1e-9)
    if installed("roboticstoolbox"):
        dry = _roboticstoolbox(state)
        expected = a5.load(a5.AIR).inverse_dynamics(q, v, a)
        _check("roboticstoolbox", dry(), expected, 1e-9)
        candidates["roboticstoolbox rne (C), no water"] = dry
    return compare("inverse dynamics under water", candidates)


def _fext(arm: Any, state: State) -> Callable[[], Any]:
    """What one writes without this package: a wrench for each body, then RNEA."""
    q, v, a = state
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


def _mujoco(arm: Any, state: State) -> Callable[[], Any]:
    """The URDF with a weightless body at each centre of buoyancy, which gravcomp lifts
    by rho V g.
    """
    import mujoco

    from alpha5_model.description.urdf import Variant, urdf

    q, v, a = state
    switch = '<compiler fusestatic="false" discardvisual="true"/>'
    text = urdf(Variant(collision="none")).replace(
        "</robot>", f"<mujoco>{switch}</mujoco></robot>"
    )
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


def _roboticstoolbox(state: State) -> Callable[[], Any]:
    """The arm as a DHRobot: inertial parameters moved from the inertial frames to the
    DH frames.
    """
    from roboticstoolbox import DHRobot, RevoluteDH

    p = a5.parameters()
    links = []
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
    return lambda: robot.rne(*state)


def _moving_water(state: State) -> list[Row]:
    """Added mass, drag and a current, beside the same without."""
    arm = a5.load()
    wet = arm.with_hydrodynamics((0.3, -0.5, 0.7))
    model, data = arm.model, arm.model.createData()
    many = [np.tile(x, (WET_STATES, 1)) for x in state]
    one = {
        OWN: lambda: wet.inverse_dynamics(*state),
        "Pinocchio: rnea, no water": lambda: pin.rnea(model, data, *state),
    }
    batch = {
        OWN: lambda: wet.inverse_dynamics_batch(*many, threads=1),
        "the same without moving water": (
            lambda: arm.inverse_dynamics_batch(*many, threads=1)
        ),
    }
    work = "inverse_dynamics in a current"
    batches = f"{work}, batch of {WET_STATES}, 1 thread"
    return [*compare(work, one), *compare(batches, batch, WET_STATES)]
