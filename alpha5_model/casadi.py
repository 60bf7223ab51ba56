"""The arm's equations as CasADi Functions, for optimal control and estimation.

    from alpha5_model.casadi import load

    arm = load(fluid_density=1000.0)
    tau = arm.inverse_dynamics(q, v, a)  # of numbers, SX or MX
    print(arm.inverse_dynamics.__doc__)  # names, shapes and units

They are of SX kind, so that all of CasADi's means work on them. From Python, ``f.buffer()`` is some fifty times faster
than a plain call.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from alpha5_model.checks import flag, instance
from alpha5_model.dynamics import load as load_arm
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import arm_parameters
from alpha5_model.kinematics.plane import DOUBLE
from alpha5_model.symbolic import SUMMARIES, products
from alpha5_model.symbolic.program import folded, program

__all__ = ["load"]


def load(arm: Arm | None = None, *, fold: bool = True, **options: Any) -> SimpleNamespace:
    """The equations of an arm.

    Args:
        arm: On a fixed base with its jaws locked; ``a5.load(**options)`` if None.
        fold: Put its parameters into the Functions. Otherwise they are the last input, named ``parameters``, of every
            Function that depends on them.
        options: Of `alpha5_model.load`.

    Returns:
        casadi.Functions by the names of `Arm`'s methods, ``link_poses`` and ``inverse_kinematics``, each with
        names, shapes and units in its ``__doc__``. Poses are (4, 4), flags 0 or 1. ``parameters`` are the arm's base
        parameters, (41,); ``with_payload`` makes those of the arm that holds a body.

    Raises:
        InputError: The arm's base floats, or its jaws move.
    """
    arm = load_arm(**options) if arm is None else instance("arm", arm, Arm)
    parameters, functions = arm_parameters(arm), products()
    known = {"tolerances": DOUBLE, "fluid_density": arm.fluid_density}
    if flag("fold", fold):
        known["parameters"] = parameters
    out = SimpleNamespace(parameters=parameters)
    for name, function in functions.items():
        given = {n for n in known if n in function.name_in()}
        if name == "with_payload":
            given.discard("parameters")
        made = folded(function, **{n: known[n] for n in given})
        made.__doc__ = program(made).documentation(SUMMARIES[name])
        setattr(out, name, made)
    return out
