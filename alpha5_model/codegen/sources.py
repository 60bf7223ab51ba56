"""The files that are generated from the equations and committed."""

from __future__ import annotations

from functools import cache

from alpha5_model.codegen.arm_functions import functions, moments_of_body, products
from alpha5_model.codegen.casadi_functions import renamed
from alpha5_model.codegen.compiled_code import kernels
from alpha5_model.codegen.instructions import program
from alpha5_model.codegen.javascript_code import javascript
from alpha5_model.codegen.kernels.names import own
from alpha5_model.codegen.own_arm_ik import own_arm_inverse_kinematics
from alpha5_model.codegen.python_code import python_source
from alpha5_model.codegen.still_water import upright
from alpha5_model.kinematics.solver import OFF_AXIS, ON_AXIS
from alpha5_model.numbers.parameters import parameters

#: Kernels that have a second, shorter body for an arm that stands upright: those that
#: control loops and batches call.
UPRIGHT = (
    "hydrostatic_torque",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "inverse_dynamics_in_current",
    "forward_dynamics_in_current",
)
#: Frames, Jacobian, holding torque and inverse kinematics, for the viewer's page.
_ON_THE_PAGE = (
    "forward_kinematics",
    "link_poses",
    "jacobian",
    "hydrostatic_torque",
    "inverse_kinematics",
)
#: Name on the page -> function of the kernels for any arm, whose numbers are an input.
_OF_ANY_ARM = {
    "forward_kinematics": own("forward_kinematics"),
    "link_poses": own("link_poses"),
    "jacobian": own("jacobian"),
    "hydrostatic_torque": "hydrostatic_torque",
    "inverse_kinematics_on_axis": ON_AXIS,
    "inverse_kinematics_off_axis": OFF_AXIS,
}
#: Of the catalogue's arm, and of any arm with its tool on the wrist axis or beside it.
_INVERSE_KINEMATICS = ("inverse_kinematics", ON_AXIS, OFF_AXIS)


@cache
def generated_sources() -> dict[str, str]:
    """Path in the repository -> text; the same every time."""
    arm = parameters()
    known = functions(arm)
    for_users = products(arm)

    every = [program(function) for function in known.values()]
    upright_bodies = [program(upright(known[name])) for name in UPRIGHT]
    one_target = [program(known[name]) for name in _INVERSE_KINEMATICS]
    page = for_users | {"inverse_kinematics": known["inverse_kinematics"]}
    on_the_page = [program(page[name]) for name in _ON_THE_PAGE]
    of_any_arm = [
        program(renamed(known[kernel], name)) for name, kernel in _OF_ANY_ARM.items()
    ]
    own_code = [
        program(for_users[name]) for name in ("inverse_kinematics", "with_payload")
    ]
    own_code.append(program(moments_of_body()))
    for tool_on_axis in (True, False):
        own_code.append(program(own_arm_inverse_kinematics(tool_on_axis)))
    files = {
        "formulas.py": python_source(every),
        "products.py": python_source(own_code),
        "numbers.py": python_source(one_target, "numbers"),
        **kernels(every, upright_bodies),
    }

    folder = "alpha5_model/codegen/kernels/generated"
    sources = {f"{folder}/{name}": text for name, text in files.items()}
    sources["alpha5_model/viewer/formulas.js"] = javascript(on_the_page)
    sources["alpha5_model/viewer/own_formulas.js"] = javascript(
        of_any_arm, "own_formulas"
    )
    return sources
