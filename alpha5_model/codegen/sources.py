"""The files that are generated from the equations and committed."""

from __future__ import annotations

from functools import cache

from alpha5_model.codegen.arm_functions import functions, moments_of_body
from alpha5_model.codegen.compiled_code import c_source
from alpha5_model.codegen.instructions import program
from alpha5_model.codegen.javascript_code import javascript
from alpha5_model.codegen.python_code import python_source

#: What batches of states call, compiled or in NumPy.
_OF_ROWS = (
    "forward_kinematics",
    "gravity_torque",
    "buoyancy_torque",
    "coriolis_torque",
    "nonlinear_effects",
    "inverse_dynamics",
    "base_wrench",
    "inverse_dynamics_with_base_wrench",
    "forward_dynamics",
    "inverse_kinematics",
)
#: What JAX calls besides; it differentiates by itself.
_OF_JAX = (
    "link_poses",
    "jacobian",
    "hydrostatic_torque",
    "mass_matrix",
    "coriolis_matrix",
)


@cache
def generated_sources() -> dict[str, str]:
    """Path in the repository -> text; the same every time."""
    of_any_arm = {name: program(one) for name, one in functions().items()}
    of_rows = [of_any_arm[name] for name in _OF_ROWS]
    of_jax = [of_any_arm[name] for name in _OF_JAX]

    folder = "alpha5_model/kernels/generated"
    return {
        f"{folder}/formulas.h": c_source(of_rows),
        f"{folder}/formulas.py": python_source(
            [*of_rows, *of_jax, program(moments_of_body())]
        ),
        "alpha5_model/viewer/web/inverse_kinematics.js": javascript(
            [of_any_arm["inverse_kinematics"]]
        ),
    }
