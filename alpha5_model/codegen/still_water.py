"""Every function of the arm in still water, as a CasADi Function.

The arm is on a fixed base with its jaws locked; the torques come from the equations of
`alpha5_model.codegen.equations_of_motion`.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi
from casadi import SX, horzcat, jacobian, vertcat, vertsplit

from alpha5_model.codegen.casadi_functions import named
from alpha5_model.codegen.chain import DIMENSIONS, Dimensions, link_poses
from alpha5_model.codegen.equations_of_motion import (
    JOINTS,
    STILL,
    in_air,
    mass_matrix,
    newton_euler,
    weightless,
)
from alpha5_model.codegen.regrouping import BASE_PARAMETERS

#: Name of a function -> name of an output -> its expression.
Outputs = dict[str, dict[str, SX]]


class Inputs(NamedTuple):
    """The symbols that the functions depend on; ``base`` are the base parameters."""

    q: SX
    v: SX
    a: SX
    tau: SX
    base: SX


def dynamics(dimensions: Dimensions) -> tuple[casadi.Function, ...]:
    """Every function, for an arm whose dimensions become constants.

    The inputs are among q, v, a, tau, and the base parameters as ``parameters``.
    """
    base = SX.sym("parameters", len(BASE_PARAMETERS))
    return _functions(base, base, dimensions)


def dynamics_of_any_arm() -> tuple[casadi.Function, ...]:
    """Every function, for arms with any dimensions.

    The inputs are among q, v, a, tau and ``parameters``: the base parameters, then the
    numbers of the dimensions.
    """
    parameters = SX.sym("parameters", len(BASE_PARAMETERS) + DIMENSIONS)
    base, numbers = vertsplit(
        parameters, [0, len(BASE_PARAMETERS), parameters.shape[0]]
    )
    dimensions = Dimensions.from_numbers(vertsplit(numbers))
    return _functions(parameters, base, dimensions)


def _functions(
    parameters: SX, base: SX, dimensions: Dimensions
) -> tuple[casadi.Function, ...]:
    """Every function; its input ``parameters`` holds the base parameters."""
    x = Inputs(
        q=SX.sym("q", JOINTS),
        v=SX.sym("v", JOINTS),
        a=SX.sym("a", JOINTS),
        tau=SX.sym("tau", JOINTS),
        base=base,
    )
    inertial, _ = newton_euler(x.q, STILL, x.a, weightless(x.base), dimensions)
    mass = mass_matrix(inertial, x.a)

    functions = {
        **_kinematics(x, dimensions),
        **_statics(x, dimensions),
        **_terms_of_motion(x, mass, dimensions),
        **_inverse_dynamics(x, mass, dimensions),
        **_forward_dynamics(x, mass, dimensions),
    }
    inputs = {**x._asdict(), "parameters": parameters}
    del inputs["base"]
    return tuple(named(name, inputs, outputs) for name, outputs in functions.items())


def _kinematics(x: Inputs, dimensions: Dimensions) -> Outputs:
    *links, tip = link_poses(x.q, dimensions)
    axes = horzcat(*(link[:3, 2] for link in links))
    linear = jacobian(tip[:3, 3], x.q)
    return {
        "forward_kinematics": {"tcp": tip},
        "link_poses": {f"link_{i}": pose for i, pose in enumerate(links, 1)},
        "jacobian": {"jacobian": vertcat(linear, axes)},
    }


def _statics(x: Inputs, dimensions: Dimensions) -> Outputs:
    holding, _ = newton_euler(x.q, STILL, STILL, x.base, dimensions)
    weight, _ = newton_euler(x.q, STILL, STILL, in_air(x.base), dimensions)
    return {
        "gravity_torque": {"tau": weight},
        "buoyancy_torque": {"tau": weight - holding},
        "hydrostatic_torque": {"tau": holding},
        "hydrostatic_torque_derivative": {"tau_q": jacobian(holding, x.q)},
    }


def _terms_of_motion(x: Inputs, mass: SX, dimensions: Dimensions) -> Outputs:
    without_weight = weightless(x.base)
    coriolis, _ = newton_euler(x.q, x.v, STILL, without_weight, dimensions)
    bias, _ = newton_euler(x.q, x.v, STILL, x.base, dimensions)
    return {
        "mass_matrix": {"tau_a": mass},
        "coriolis_torque": {"tau": coriolis},
        "coriolis_matrix": {"coriolis": jacobian(coriolis, x.v) / 2},
        "nonlinear_effects": {"tau": bias},
    }


def _inverse_dynamics(x: Inputs, mass: SX, dimensions: Dimensions) -> Outputs:
    torque, wrench = newton_euler(x.q, x.v, x.a, x.base, dimensions)
    return {
        "inverse_dynamics": {"tau": torque},
        "inverse_dynamics_derivatives": {
            "tau_q": _by_rows(torque, x.q),
            "tau_v": _by_rows(torque, x.v),
            "tau_a": mass,
        },
        "base_wrench": {"wrench": wrench},
        "inverse_dynamics_with_base_wrench": {"tau": torque, "wrench": wrench},
        "base_wrench_derivatives": {
            "wrench_q": jacobian(wrench, x.q),
            "wrench_v": jacobian(wrench, x.v),
            "wrench_a": jacobian(wrench, x.a),
        },
    }


def _forward_dynamics(x: Inputs, mass: SX, dimensions: Dimensions) -> Outputs:
    """Accelerations and their derivatives.

    The derivatives are ``-M^-1 dtau/dq`` at that acceleration, ``-M^-1 dtau/dv`` and
    ``M^-1``.
    """
    torque, _ = newton_euler(x.q, x.v, x.a, x.base, dimensions)
    bias, _ = newton_euler(x.q, x.v, STILL, x.base, dimensions)
    factors = casadi.ldl(mass, False)
    acceleration = casadi.ldl_solve(x.tau - bias, *factors)

    inverse = casadi.ldl_solve(SX.eye(JOINTS), *factors)
    mobility = casadi.tril2symm(casadi.tril(inverse))
    tau_q = casadi.substitute(_by_rows(torque, x.q), x.a, acceleration)
    tau_v = _by_rows(torque, x.v)
    return {
        "forward_dynamics": {"a": acceleration},
        "forward_dynamics_derivatives": {
            "a_q": -mobility @ tau_q,
            "a_v": -mobility @ tau_v,
            "a_tau": mobility,
        },
    }


def _by_rows(torque: SX, x: SX) -> SX:
    """The Jacobian of a torque, from the outputs: for four torques that is shorter."""
    return jacobian(torque, x, {"helper_options": {"ad_weight": 1}})
