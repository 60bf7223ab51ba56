"""Calls of arms: in air, in water, on a vehicle, and in JAX."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from fuzzing.calls import Draw, of, of_function, of_method, with_the_same_rows
from fuzzing.cases import Case
from fuzzing.good_values import Draws, always, normal, one_of, uniform
from fuzzing.values import Rng, transform

import alpha5_model as a5
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.water.terms import water_terms

LINKS = ("link_1", "link_2", "link_3", "link_4", "tcp")
#: Methods of an arm in still water.
METHODS = (
    "forward_kinematics",
    "jacobian",
    "mass_matrix",
    "coriolis_matrix",
    "gravity_torque",
    "buoyancy_torque",
    "hydrostatic_torque",
    "hydrostatic_torque_derivative",
    "buoyancy_wrenches",
    "potential_energy",
    "center_of_mass",
    "center_of_buoyancy",
    "in_collision",
    "collision_distance",
    "collision_distance_gradient",
    "nonlinear_effects",
    "inverse_dynamics",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "base_wrench",
    "base_wrench_derivatives",
    "kinetic_energy",
    "inverse_dynamics_batch",
    "forward_dynamics_batch",
    "base_wrench_batch",
    "with_payload",
    "approach_directions",
    "regressor",
    "with_hydrodynamics",
)
#: Methods of an arm in moving water.
WET_METHODS = (
    "added_mass",
    "base_wrench",
    "base_wrench_batch",
    "base_wrench_current_derivative",
    "base_wrench_derivatives",
    "coriolis_matrix",
    "current_acceleration_load",
    "current_load",
    "dissipated_power",
    "forward_dynamics",
    "forward_dynamics_batch",
    "forward_dynamics_current_derivative",
    "forward_dynamics_derivatives",
    "inverse_dynamics",
    "inverse_dynamics_batch",
    "inverse_dynamics_current_derivative",
    "inverse_dynamics_derivatives",
    "kinetic_energy",
    "mass_matrix",
    "nonlinear_effects",
)
#: Methods of an arm on a vehicle only.
VEHICLE_METHODS = ("mount_load", "reaction", "trim")
#: Methods of JAX's arm: one state each, which are not checked.
JAX_METHODS = (
    "base_wrench",
    "base_wrench_derivatives",
    "buoyancy_torque",
    "coriolis_matrix",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "forward_kinematics",
    "gravity_torque",
    "hydrostatic_torque",
    "hydrostatic_torque_derivative",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "jacobian",
    "link_poses",
    "mass_matrix",
    "nonlinear_effects",
)
#: How many arms `arm`, `_wet` and `_on_floating` know.
ARMS = 24
WET_ARMS = 12
FLOATING_ARMS = 6


def draws() -> dict[str, Draw]:
    """Methods of arms, and functions of arms and states."""
    found = {f"a5.Arm.{method}": _method(arm, ARMS, method) for method in METHODS}
    for method in WET_METHODS:
        found[f"HydrodynamicArm.{method}"] = _method(_wet, WET_ARMS, method)
        found[f"ArmOnVehicle.{method}"] = _method(_on_floating, FLOATING_ARMS, method)
    found["HydrodynamicArm.with_payload"] = _method(_wet, WET_ARMS, "with_payload")
    for method in VEHICLE_METHODS:
        found[f"ArmOnVehicle.{method}"] = _method(_on_floating, FLOATING_ARMS, method)
    found["ArmOnVehicle.configuration"] = of(
        lambda rng: _on_floating(0).configuration,
        transform_vehicle_to_world=transform,
        q=uniform(0, 3, 4),
    )
    for function in (torque_terms, frame_positions, water_terms):
        found[f"dynamics.batch.{function.__name__}"] = _of_states(function)
    return found | _jax_draws()


def states(arm: Any, batch: bool) -> dict[str, Draws]:
    """Positions and rates of an arm: one state, or rows of them."""
    nq = arm.model.nq
    nv = arm.model.nv

    def position(rng: Rng) -> np.ndarray:
        out = rng.uniform(0, 3, (rows(rng), nq))
        if nq > nv:
            out[:, 3:7] /= np.linalg.norm(out[:, 3:7], axis=1)[:, None]
        return out if batch else out[0]

    def rate(rng: Rng) -> np.ndarray:
        out = rng.normal(0, 1, (rows(rng), nv))
        return out if batch else out[0]

    def rows(rng: Rng) -> int:
        return int(rng.integers(0, 4)) if batch else 1

    return {"q": position, "v": rate, "a": rate, "tau": rate}


@cache
def arm(k: int) -> a5.Arm:
    """One of `ARMS` arms in still water; the second half holds a payload."""
    gripper = ("locked", "jaws")[k % 2]
    floating = bool(k // 2 % 2)
    density = (1025.0, 0.0, 2e3)[k // 4 % 3]
    bare = a5.load(density, gripper, floating)
    return bare.with_payload(0.1, volume=5e-4) if k >= ARMS // 2 else bare


@cache
def _wet(k: int) -> Any:
    """One of `WET_ARMS` arms in moving water."""
    current = (0.1 * (k % 2), 0.0, 0.05)
    level = ("low", "nominal", "high")[k % 3]
    return arm(k).with_hydrodynamics(current, level)


@cache
def _vehicle() -> a5.Vehicle:
    return a5.Vehicle(
        mass=11.5,
        com=(0.0, 0.0, 0.02),
        inertia=np.diag([0.2, 0.25, 0.3]),
        volume=0.0115,
        cob=(0.0, 0.0, 0.05),
        added_mass=(5.0, 12.0, 14.0, 0.12, 0.12, 0.12),
        linear_damping=(4.0, 6.0, 5.0, 0.07, 0.07, 0.07),
        quadratic_damping=(18.0, 21.0, 37.0, 1.5, 1.5, 1.5),
    )


@cache
def _on_vehicle(k: int) -> Any:
    return _wet(k).on_vehicle(_vehicle())


def _on_floating(k: int) -> Any:
    """One of `FLOATING_ARMS` arms on a vehicle: those of `arm` whose base floats."""
    return _on_vehicle(4 * (k // 2) + k % 2 + 2)


def _method(make: Callable[[int], Any], kinds: int, method: str) -> Draw:
    """A method of one of several arms."""
    batch = method.endswith("_batch") or method == "regressor"

    def draw(rng: Rng, spoiled: bool) -> Case:
        chosen = make(int(rng.integers(kinds)))
        own: dict[str, Draws] = {**states(chosen, batch), "link": one_of(*LINKS)}
        if not method.startswith("with_"):
            own["current"] = normal(0.5, 3)
            own["acceleration"] = normal(0.5, 3)
        joints = chosen.model.nv - 6
        if method == "reaction":
            own["a"] = normal(1, joints)
        if method == "trim":
            own["q"] = uniform(0, 3, joints)
        call = of_method(always(chosen), method, **own)
        if batch:
            call = with_the_same_rows(call)
        return call(rng, spoiled)

    return draw


def _of_states(function: Callable[..., Any]) -> Draw:
    """A function of an arm and its states."""

    def draw(rng: Rng, spoiled: bool) -> Case:
        chosen = arm(int(rng.integers(ARMS)))
        call = of_function(function, arm=always(chosen), **states(chosen, batch=True))
        return with_the_same_rows(call)(rng, spoiled)

    return draw


def _jax_draws() -> dict[str, Draw]:
    """The arm of JAX, and its inverse kinematics."""
    state = dict.fromkeys(("q", "v", "a", "tau"), uniform(0, 3, 4))
    found = {}
    for method in JAX_METHODS:
        found[f"jax.JaxArm.{method}"] = of_method(_jax, method, **state)
    found["jax.JaxArm.with_payload"] = of_method(
        _jax, "with_payload", inertia=always(np.eye(3) * 1e-4)
    )
    found["jax.inverse_kinematics"] = of_function(
        _jax_inverse_kinematics, position=normal(0.25, 3)
    )
    found["jax.approximate_collision_distance"] = of_function(
        _approximate_distance_in_jax, q=uniform(0, 3, 4)
    )
    return found


def _approximate_distance_in_jax(q: Any) -> Any:
    from alpha5_model import jax

    return jax.approximate_collision_distance(q)


def _jax(rng: Rng) -> Any:
    return _loaded_in_jax()


@cache
def _loaded_in_jax() -> Any:
    from alpha5_model import jax

    return jax.load()


def _jax_inverse_kinematics(position: Any, wrist: Any = 0.0) -> Any:
    from alpha5_model import jax

    return jax.inverse_kinematics(position, wrist)
