"""The arm's equations, written once; everything else that computes them is generated.

CasADi is needed to generate the code, not to run it.
"""

from __future__ import annotations

from typing import Any

from alpha5_model.codegen.payload import slope_by_moments_at_the_tcp
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, moments
from alpha5_model.errors import needing
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.tolerances import DOUBLE, Tolerances
from alpha5_model.numbers.parameters import Alpha5Parameters

with needing("making code of the equations", "pip install 'alpha5-model[symbolic]'"):
    import casadi as casadi  # for alpha5_model.casadi, too

from alpha5_model.codegen.casadi_functions import folded, named
from alpha5_model.codegen.chain import Dimensions
from alpha5_model.codegen.inverse_kinematics import inverse_kinematics
from alpha5_model.codegen.still_water import dynamics, dynamics_of_any_arm
from alpha5_model.codegen.words import WORDS

#: Name -> meaning of the functions that users get, in order.
SUMMARIES = WORDS["functions"]


def functions() -> dict[str, casadi.Function]:
    """The functions of any arm, by name.

    Their last input, ``parameters``, holds the base parameters, then the dimensions of
    a `Geometry`. Of the inverse kinematics it holds its ``ik_parameters``.
    """
    every = (*dynamics_of_any_arm(), inverse_kinematics())
    return {function.name(): function for function in every}


def products(
    arm: Alpha5Parameters, tolerances: Tolerances = DOUBLE
) -> dict[str, casadi.Function]:
    """The functions of one arm for CasADi and C, named as the methods of an `Arm`.

    The base parameters are an input, the dimensions are constants.

    Args:
        arm: With any lengths, zeros, limits and tool point.
        tolerances: Of the inverse kinematics.

    Raises:
        InputError: Not a vertical plane with two links in it.
    """
    dimensions = Dimensions.from_numbers(Geometry.of(arm).dimensions.tolist())
    known = {one.name(): one for one in dynamics(dimensions)} | {
        "inverse_kinematics": inverse_kinematics_of(arm, tolerances),
        "with_payload": _with_payload(arm),
    }
    return {name: known[name] for name in SUMMARIES}


def inverse_kinematics_of(
    arm: Alpha5Parameters, tolerances: Tolerances = DOUBLE
) -> casadi.Function:
    """The inverse kinematics of one arm: of ``position`` (3,) and ``wrist``."""
    numbers = Geometry.of(arm).ik_parameters_with(tolerances)
    return folded(inverse_kinematics(), parameters=numbers)


def _with_payload(arm: Alpha5Parameters) -> casadi.Function:
    """The base parameters of an arm that holds a body at its tcp."""
    base_parameters = casadi.SX.sym("parameters", len(BASE_PARAMETERS))
    body = _body()
    slope = casadi.DM(slope_by_moments_at_the_tcp(arm).round(15))
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
