"""The arm's equations, written once; everything else that computes them is generated.

CasADi is needed to generate the code, not to run it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, moments, regrouped
from alpha5_model.errors import needing
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.solver import shape_of_kernels
from alpha5_model.kinematics.tolerances import DOUBLE
from alpha5_model.numbers.parameters import Alpha5Parameters

with needing("making code of the equations", "pip install casadi"):
    import casadi as casadi  # for alpha5_model.casadi, too

from alpha5_model.codegen.casadi_functions import folded, named, renamed
from alpha5_model.codegen.chain import turns
from alpha5_model.codegen.closed_form_ik import inverse_kinematics
from alpha5_model.codegen.moving_water import in_moving_water
from alpha5_model.codegen.own_arm_ik import own_arm_inverse_kinematics
from alpha5_model.codegen.still_water import dynamics
from alpha5_model.codegen.words import WORDS

#: Name -> meaning of the functions that users get, in order.
SUMMARIES = WORDS["functions"]


@lru_cache(maxsize=4)
def functions(parameters: Alpha5Parameters) -> dict[str, casadi.Function]:
    """The functions of the kernels, by name.

    Their inputs and outputs have the names of ``words.toml``.

    Args:
        parameters: The arm's parameters; its dimensions and joint limits become
            constants of the functions.
    """
    every = [
        *dynamics(parameters),
        *in_moving_water(parameters),
        folded(inverse_kinematics_of(parameters), tolerances=DOUBLE),
    ]
    for tool_on_axis in (True, False):
        solve = own_arm_inverse_kinematics(tool_on_axis)
        every.append(folded(solve, tolerances=DOUBLE))
    return {function.name(): function for function in every}


def products(parameters: Alpha5Parameters) -> dict[str, casadi.Function]:
    """The functions for users of JAX, CasADi and C, named as the methods of an arm.

    The base parameters and the tolerances are inputs.
    """
    known = functions(parameters) | {
        "inverse_kinematics": inverse_kinematics_of(parameters),
        "with_payload": _with_payload(parameters),
    }
    return {name: known[name] for name in SUMMARIES}


def inverse_kinematics_of(parameters: Alpha5Parameters) -> casadi.Function:
    """The inverse kinematics of an arm, whose numbers become constants.

    Inputs: ``position`` (3,) [m], ``wrist`` [rad] and ``tolerances``. Outputs: ``q``
    (4, 4) [rad], ``exists`` and ``within_limits`` (4,), and ``singular``.

    Args:
        parameters: The arm's, with any lengths, zeros, limits and tool point.

    Raises:
        PublishedDataError: Not a vertical plane with two links in it.
    """
    shape = ArmShape.from_parameters(parameters)
    if shape == shape_of_kernels():
        return inverse_kinematics(ArmPlane.from_parameters(parameters))
    of_any_arm = own_arm_inverse_kinematics(shape.has_tool_on_axis)
    of_arm = folded(of_any_arm, parameters=shape.numbers)
    return renamed(of_arm, "inverse_kinematics")


def _with_payload(parameters: Alpha5Parameters) -> casadi.Function:
    """The base parameters of an arm that holds a body at its tcp.

    They are linear in the moments of the body.
    """
    base_parameters = casadi.SX.sym("parameters", len(BASE_PARAMETERS))
    body = {
        "mass": casadi.SX.sym("mass", 1),
        "com": casadi.SX.sym("com", 3),
        "inertia": casadi.SX.sym("inertia", 3, 3),
        "volume": casadi.SX.sym("volume", 1),
        "cob": casadi.SX.sym("cob", 3),
        "fluid_density": casadi.SX.sym("fluid_density", 1),
    }
    moments_of_body = casadi.veccat(*moments(**body, stack=casadi.vertcat))
    slope = casadi.DM(_slope_by_moments_at_the_tcp(parameters).round(15))
    return named(
        "with_payload",
        {"parameters": base_parameters, **body},
        {"parameters_with_payload": base_parameters + slope @ moments_of_body},
    )


def _slope_by_moments_at_the_tcp(parameters: Alpha5Parameters) -> FloatArray:
    """Derivatives of the base parameters by the moments of a body in tcp, (41, 32)."""
    *_, link_4_to_tcp = turns(casadi.SX.zeros(4), parameters)
    tcp_in_link_4 = np.array(casadi.evalf(link_4_to_tcp.pose()))
    nothing = np.zeros((2, 4, 4))

    columns = []
    for unit in np.eye(32).reshape(32, 2, 4, 4):
        in_link_4 = tcp_in_link_4 @ unit @ tcp_in_link_4.T
        links = [nothing, nothing, nothing, nothing, in_link_4]
        columns.append(regrouped(links, np.zeros(3), parameters))
    return np.array(columns).T
