"""The generated formulas against Pinocchio: single calls, batches, CasADi, JAX.

A call includes input checks and a result of the caller's own. Pinocchio computes in
air, which is less work.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np
import pinocchio as pin
from benchmarks.timing import Row, measure

import alpha5_model as a5
from alpha5_model.codegen.kernels import choice as kernels

STATES = 100_000
#: Of which MJX computes so many: it keeps everything that a simulation would need.
MJX_STATES = 10_000
PEERS = {"CasADi": "casadi", "JAX": "jax", "MJX": "mujoco.mjx"}
WIDTHS = {
    1: "one state at a time",
    2: "2 states wide",
    4: "4 states wide",
    8: "8 states wide",
}


def missing() -> list[str]:
    """Peers that are not installed."""
    return [name for name, module in PEERS.items() if not _installed(module)]


def rows() -> list[Row]:
    """Measured rows of this section."""
    rng = np.random.default_rng(1)
    state = [np.ascontiguousarray(x) for x in rng.uniform(0.1, 3.0, (3, 4))]
    states = rng.uniform(-3.0, 3.0, (3, STATES, 4))
    return [
        *_single(*state),
        *(_casadi(*state) if _installed("casadi") else []),
        *_batches(*states),
        *(_jax(*states) if _installed("jax") else []),
    ]


def _installed(module: str) -> bool:
    package = module.partition(".")[0]
    return find_spec(package) is not None and find_spec(module) is not None


def _single(q: Any, v: Any, a: Any) -> list[Row]:
    arm = a5.load(backend="kernels")
    model, data = arm.model, arm.model.createData()
    tcp, axes = model.getFrameId("tcp"), pin.LOCAL_WORLD_ALIGNED
    cases: dict[str, tuple[Callable[[], Any], str, Callable[[], Any], float | None]] = {
        "inverse_dynamics": (
            lambda: arm.inverse_dynamics(q, v, a),
            "rnea",
            lambda: pin.rnea(model, data, q, v, a),
            0.35,
        ),
        "hydrostatic_torque": (
            lambda: arm.hydrostatic_torque(q),
            "computeGeneralizedGravity",
            lambda: pin.computeGeneralizedGravity(model, data, q),
            0.5,
        ),
        "mass_matrix": (
            lambda: arm.mass_matrix(q),
            "crba",
            lambda: pin.crba(model, data, q),
            0.5,
        ),
        "jacobian": (
            lambda: arm.jacobian(q),
            "computeFrameJacobian",
            lambda: pin.computeFrameJacobian(model, data, q, tcp, axes),
            0.5,
        ),
        "inverse_dynamics_derivatives": (
            lambda: arm.inverse_dynamics_derivatives(q, v, a),
            "computeRNEADerivatives",
            lambda: pin.computeRNEADerivatives(model, data, q, v, a),
            0.25,
        ),
        "forward_dynamics": (
            lambda: arm.forward_dynamics(q, v, a),
            "aba",
            lambda: pin.aba(model, data, q, v, a),
            None,
        ),
    }
    out = []
    for name, (ours, raw_name, raw, share) in cases.items():
        work = f'{name}, backend="kernels"'
        seconds = measure({"ours": ours, "raw": raw})
        out += [
            Row(work, f"alpha5_model, {kernels.backend()}", seconds["ours"]),
            Row(
                work,
                f"Pinocchio: {raw_name}, no water",
                seconds["raw"],
                target=share and 1 / share,
            ),
        ]
    return out


def _casadi(q: Any, v: Any, a: Any) -> list[Row]:
    from alpha5_model.casadi import load

    arm = a5.load()
    model, data = arm.model, arm.model.createData()
    expected = arm.inverse_dynamics(q, v, a)
    candidates: dict[str, Callable[[], object]] = {}
    kept = []  # a buffer holds no reference to what it writes into
    for compiled in (True, False)[kernels.backend() == "numpy" :]:
        buffer, run = load(arm, compiled=compiled).inverse_dynamics.buffer()
        tau = np.zeros(4)
        for i, x in enumerate((q, v, a)):
            buffer.set_arg(i, memoryview(x))
        buffer.set_res(0, memoryview(tau))
        kept.append((buffer, tau))
        run()
        if np.abs(tau - expected).max() > 1e-12:
            raise AssertionError(f"CasADi disagrees: {tau}")
        candidates["compiled" if compiled else "interpreted"] = run
    seconds = measure({**candidates, "raw": lambda: pin.rnea(model, data, q, v, a)})
    work, peer = (
        "inverse_dynamics, one call of a CasADi Function",
        "Pinocchio: rnea, no water",
    )
    rows = [
        Row(work, f"alpha5_model.casadi, buffered, {n}", seconds[n]) for n in candidates
    ]
    return [*rows, Row(work, peer, seconds["raw"], target=1 / 1.5)]


def _batches(q: Any, v: Any, a: Any) -> list[Row]:
    """On one thread, at every width that this processor has, and without a compiler."""
    arm, running = a5.load(), kernels.module()
    pool = pin.ModelPool(arm.model, 1)
    out = []
    for name, ours, raw, fewest in (
        ("rnea", arm.inverse_dynamics_batch, pin.rneaInParallel, 30.0),
        ("aba", arm.forward_dynamics_batch, pin.abaInParallel, 20.0),
    ):
        candidates: dict[str, Callable[[], object]] = {}
        if kernels.backend() != "numpy":
            for width, text in reversed(WIDTHS.items()):
                label = f"alpha5_model, compiled ({running.width(width)}, {text})"
                candidates[label] = partial(_at_width, width, ours, q, v, a)
        candidates["alpha5_model, numpy"] = lambda f=ours: _without_compiler(f, q, v, a)
        peer = f"Pinocchio: {name}InParallel, no water"
        candidates[peer] = lambda f=raw: f(1, pool, q.T, v.T, a.T)
        seconds = measure(candidates, per_call=STATES)
        work = f"{ours.__name__}, {STATES} states, 1 thread"
        targets = {peer: fewest}
        out += [Row(work, n, s, target=targets.get(n)) for n, s in seconds.items()]
        if name == "rnea":
            work += ", without a compiler"
            shown = ("alpha5_model, numpy", peer)
            out += [
                Row(work, n, seconds[n], target=1 / 0.8 if n == peer else None)
                for n in shown
            ]
    if kernels.backend() != "numpy":
        running.width(max(WIDTHS))
    return out


def _at_width(width: int, batch: Callable[..., Any], *states: Any) -> Any:
    kernels.module().width(width)
    return batch(*states, threads=1)


def _without_compiler(batch: Callable[..., Any], *states: Any) -> Any:
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


def _jax(*states: Any) -> list[Row]:
    """Mapped over the states, on the processor, in double precision."""
    import jax

    from alpha5_model.jax import load

    arm = a5.load()
    pool = pin.ModelPool(arm.model, 1)
    with jax.enable_x64(True), jax.default_device(jax.devices("cpu")[0]):
        given = [jax.numpy.asarray(x) for x in states]
        ours = jax.jit(jax.vmap(load(arm).inverse_dynamics))
        expected = arm.inverse_dynamics_batch(*states, threads=1)
        if np.abs(np.asarray(ours(*given)) - expected).max() > 1e-11:
            raise AssertionError("JAX disagrees")
        candidates: dict[str, tuple[Callable[[], object], int]] = {
            "alpha5_model.jax, vmap, double": (
                lambda: ours(*given).block_until_ready(),
                STATES,
            ),
            "Pinocchio: rneaInParallel, 1 thread, no water": (
                lambda: pin.rneaInParallel(1, pool, *(x.T for x in states)),
                STATES,
            ),
        }
        if _installed("mujoco.mjx"):
            mjx, few = (
                _mjx(),
                [0.3 + 0.3 * jax.numpy.abs(x[:MJX_STATES]) for x in given],
            )
            dry = a5.load(a5.AIR).inverse_dynamics_batch(
                *map(np.asarray, few), threads=1
            )
            if np.abs(np.asarray(mjx(*few)) - dry).max() > 1e-9:
                raise AssertionError("MJX disagrees")
            candidates[f"MJX on our MJCF, {MJX_STATES} states, no water"] = (
                lambda: mjx(*few).block_until_ready(),
                MJX_STATES,
            )
        seconds = measure({name: f for name, (f, _) in candidates.items()}, rounds=5)
    work = f"inverse dynamics in JAX, {STATES} states, CPU"
    targets = {"Pinocchio: rneaInParallel, 1 thread, no water": 1 / 0.7}
    return [
        Row(work, name, seconds[name] / count, target=targets.get(name))
        for name, (_, count) in candidates.items()
    ]


def _mjx() -> Any:
    """Inverse dynamics of the exported MuJoCo model, mapped over states that are within
    the limits.
    """
    import jax
    import mujoco
    from mujoco import mjx

    from alpha5_model.description.mjcf import MjcfOptions, mjcf

    spec = mujoco.MjModel.from_xml_string(
        mjcf(MjcfOptions(collision="none", fluid_density=0.0))
    )
    tree = mjx.put_model(spec)
    empty = mjx.make_data(tree)

    def one(q: Any, v: Any, a: Any) -> Any:
        return mjx.inverse(tree, empty.replace(qpos=q, qvel=v, qacc=a)).qfrc_inverse

    return jax.jit(jax.vmap(one))
