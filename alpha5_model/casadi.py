"""The arm's equations as CasADi Functions, for optimal control and estimation.

    from alpha5_model.casadi import load

    arm = load(fluid_density=1000.0)
    tau = arm.inverse_dynamics(q, v, a)  # of numbers, SX or MX
    print(arm.inverse_dynamics.__doc__)  # names, shapes and units

They are of SX kind, so that all of CasADi's means work on them, which interpret them; ``load(compiled=True)`` gives
calls of the compiled kernels, some four times faster. From Python, ``f.buffer()`` is far faster than a plain call.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from alpha5_model._support.checks import FloatArray, flag, instance
from alpha5_model.codegen.casadi_functions import folded
from alpha5_model.codegen.functions import SUMMARIES, casadi, products
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.codegen.program import program
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import arm_parameters
from alpha5_model.dynamics.load import load as load_arm
from alpha5_model.errors import MissingDependencyError
from alpha5_model.kinematics.plane import DOUBLE
from alpha5_model.numbers.parameters import parameters as catalogue

__all__ = ["load"]

#: Function -> kernel that has its derivatives.
_DERIVATIVES = {
    "hydrostatic_torque": "hydrostatic_torque_derivative",
    **{
        f: f"{f}_derivatives"
        for f in ("inverse_dynamics", "forward_dynamics", "base_wrench")
    },
}


def load(
    arm: Arm | None = None, *, fold: bool = True, compiled: bool = False, **options: Any
) -> SimpleNamespace:
    """The equations of an arm.

    Args:
        arm: On a fixed base with its jaws locked; ``a5.load(**options)`` if None.
        fold: Put its parameters into the Functions. Otherwise they are the last input, named ``parameters``, of every
            Function that depends on them.
        compiled: Call the compiled kernels, for values and, with ``fold``, for first derivatives of torques,
            accelerations and the load on the mount; other derivatives are interpreted. They take numbers and MX,
            are not inlined, and cannot be made C of. ``with_payload`` stays as it is.
        options: Of `alpha5_model.load`.

    Returns:
        casadi.Functions by the names of `Arm`'s methods, ``link_poses`` and ``inverse_kinematics``, each with
        names, shapes and units in its ``__doc__``. Poses are (4, 4), flags 0 or 1. ``parameters`` are the arm's base
        parameters, (41,); ``with_payload`` makes those of the arm that holds a body.

    Raises:
        InputError: The arm's base floats, or its jaws move.
        MissingDependencyError: ``compiled``, but the kernels run in NumPy here.
    """
    arm = load_arm(**options) if arm is None else instance("arm", arm, Arm)
    parameters, functions = arm_parameters(arm), products(catalogue())
    known = {"tolerances": DOUBLE, "fluid_density": arm.fluid_density}
    if flag("fold", fold):
        known["parameters"] = parameters
    if flag("compiled", compiled) and kernels.backend() == "numpy":
        remedy = "install alpha5-model where a C compiler is, or load(compiled=False)"
        raise MissingDependencyError(
            "alpha5_model.codegen.kernels._compiled", "compiled=True", remedy
        )
    out = SimpleNamespace(parameters=parameters)
    for name, function in functions.items():
        given = {n for n in known if n in function.name_in()}
        if name == "with_payload":
            given.discard("parameters")
        made = folded(function, **{n: known[n] for n in given})
        summary = program(made).documentation(SUMMARIES[name])
        if compiled and name != "with_payload":
            made = _compiled(made, parameters)
        made.__doc__ = summary
        setattr(out, name, made)
    return out


def _compiled(
    function: casadi.Function, parameters: FloatArray, kernel: str | None = None
) -> casadi.Function:
    """What looks like a Function and calls a kernel; its derivatives call theirs, or are interpreted."""
    called = casadi.external(
        f"alpha5_{kernel or function.name()}", kernels.module().__file__
    )
    names, slope = function.name_in(), function.jacobian()
    inputs: list[Any] = [casadi.MX.sym(x, function.sparsity_in(x)) for x in names]
    last, given = called.n_in() - 1, inputs
    if "parameters" not in names and called.size1_in(last) == len(parameters):
        given = [*inputs[:last], parameters]
        if function.name() in _DERIVATIVES:
            slope = _compiled(slope, parameters, _DERIVATIVES[function.name()])
    outputs: list[Any] = []
    for i, rows in enumerate(called.call(given)):  # of matrices, one after the other
        shape = function.sparsity_out(i)
        matrix = casadi.reshape(rows, shape.size2(), shape.size1()).T
        outputs.append(casadi.project(matrix, shape))
    options: dict[str, Any] = {
        "custom_jacobian": slope,
        "jac_penalty": 0,
        "never_inline": True,
    }
    return casadi.Function(
        function.name(), inputs, outputs, names, function.name_out(), options
    )
