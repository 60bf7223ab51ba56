"""The arm's equations, written once; everything else that computes them is generated from here.

CasADi is needed to generate, not to run.
"""

from __future__ import annotations

import casadi
from casadi import SX, densify

from alpha5_model.base_parameters import BASE_PARAMETERS
from alpha5_model.symbolic.dynamics import JOINTS, newton_euler
from alpha5_model.symbolic.inverse_kinematics import inverse_kinematics


def functions() -> dict[str, casadi.Function]:
    """Every function by its name, inputs and outputs named as in `alpha5_model.symbolic.program.TEXTS`."""
    q, v, a = (SX.sym(name, JOINTS) for name in "qva")
    p = SX.sym("parameters", len(BASE_PARAMETERS))
    still = SX.zeros(JOINTS)
    torque, _ = newton_euler(q, v, a, p)
    holding, _ = newton_euler(q, still, still, p)
    inputs = {"q": q, "v": v, "a": a, "parameters": p}

    def function(name: str, of: str, **outputs: SX) -> casadi.Function:
        names = (*of.split(), "parameters")
        given = [inputs[n] for n in names]
        return casadi.Function(
            name, given, [densify(x) for x in outputs.values()], names, [*outputs]
        )

    all_functions = (
        function("hydrostatic_torque", "q", tau=holding),
        function("inverse_dynamics", "q v a", tau=torque),
        inverse_kinematics(),
    )
    return {f.name(): f for f in all_functions}
