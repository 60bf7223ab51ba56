"""The arm's equations, written once; everything else that computes them is generated.

CasADi is needed to generate the code, not to run it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from alpha5_model.codegen.payload import slope_by_moments_at_the_tcp
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, moments
from alpha5_model.errors import needing
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.solver import shape_of_kernels
from alpha5_model.kinematics.tolerances import DOUBLE
from alpha5_model.numbers.parameters import Alpha5Parameters

with needing("making code of the equations", "pip install casadi"):
    import casadi as casadi  # for alpha5_model.casadi, too

from alpha5_model.codegen.casadi_functions import folded, named, renamed
from alpha5_model.codegen.closed_form_ik import inverse_kinematics
from alpha5_model.codegen.dimensions import Dimensions, twists
from alpha5_model.codegen.kernels.names import KINEMATICS, own
from alpha5_model.codegen.moving_water import in_moving_water
from alpha5_model.codegen.own_arm_ik import own_arm_inverse_kinematics
from alpha5_model.codegen.still_water import dynamics, dynamics_of_any_arm
from alpha5_model.codegen.words import WORDS

#: Name -> meaning of the functions that users get, in order.
SUMMARIES = WORDS["functions"]


@lru_cache(maxsize=4)
def functions(parameters: Alpha5Parameters) -> dict[str, casadi.Function]:
    """The functions of the kernels, by name.

    Their inputs and outputs have the names of ``words.toml``. The dynamics takes the
    dimensions of an arm behind its base parameters. The kinematics comes twice: with
    the dimensions of one arm as constants, which is shorter, and for any arm, see
    `own`.

    Args:
        parameters: The arm's parameters; its dimensions and joint limits become
            constants of its kinematics.
    """
    structure = twists(parameters)
    of_any_arm = {one.name(): one for one in dynamics_of_any_arm(structure)}
    kinematics = [of_any_arm.pop(name) for name in KINEMATICS]
    of_this_arm = dynamics(Dimensions.from_parameters(parameters))
    every = [
        *(one for one in of_this_arm if one.name() in KINEMATICS),
        *of_any_arm.values(),
        *(renamed(one, own(one.name())) for one in kinematics),
        *in_moving_water(structure),
        folded(inverse_kinematics_of(parameters), tolerances=DOUBLE),
    ]
    for tool_on_axis in (True, False):
        solve = own_arm_inverse_kinematics(tool_on_axis)
        every.append(folded(solve, tolerances=DOUBLE))
    return {function.name(): function for function in every}


def products(parameters: Alpha5Parameters) -> dict[str, casadi.Function]:
    """The functions for users of JAX, CasADi and C, named as the methods of an arm.

    The base parameters and the tolerances are inputs, the dimensions constants.
    """
    dimensions = Dimensions.from_parameters(parameters)
    known = {one.name(): one for one in dynamics(dimensions)} | {
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
    """The base parameters of an arm that holds a body at its tcp."""
    base_parameters = casadi.SX.sym("parameters", len(BASE_PARAMETERS))
    body = _body()
    slope = casadi.DM(slope_by_moments_at_the_tcp(parameters).round(15))
    added = slope @ _moments(body)
    return named(
        "with_payload",
        {"parameters": base_parameters, **body},
        {"parameters_with_payload": base_parameters + added},
    )


def moments_of_body() -> casadi.Function:
    """The moments of a body and of what it displaces, (32,), see `moments`."""
    body = _body()
    return named("moments_of_body", body, {"moments": _moments(body)})


def _body() -> dict[str, casadi.SX]:
    return {
        "mass": casadi.SX.sym("mass", 1),
        "com": casadi.SX.sym("com", 3),
        "inertia": casadi.SX.sym("inertia", 3, 3),
        "volume": casadi.SX.sym("volume", 1),
        "cob": casadi.SX.sym("cob", 3),
        "fluid_density": casadi.SX.sym("fluid_density", 1),
    }


def _moments(body: dict[str, casadi.SX]) -> Any:
    return casadi.veccat(*moments(**body, stack=casadi.vertcat))
