"""The arm's equations, written once; everything else that computes them is generated from here.

CasADi is needed to generate, not to run.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from alpha5_model.codegen.base_parameters import BASE_PARAMETERS, moments, regrouped
from alpha5_model.errors import needing
from alpha5_model.kinematics.plane import DOUBLE
from alpha5_model.numbers.parameters import parameters

with needing("making code of the equations", "pip install casadi"):
    import casadi as casadi  # for alpha5_model.casadi, too

from alpha5_model.codegen.dynamics import dynamics, in_moving_water, turns
from alpha5_model.codegen.inverse_kinematics import inverse_kinematics
from alpha5_model.codegen.program import WORDS, folded, named

#: Name -> what it is, of the functions that users get, in order.
SUMMARIES = WORDS["functions"]


@cache
def functions() -> dict[str, casadi.Function]:
    """Every function of the kernels by its name, inputs and outputs named as in ``words.toml``."""
    targets = folded(inverse_kinematics(), tolerances=DOUBLE)
    return {f.name(): f for f in (*dynamics(), *in_moving_water(), targets)}


def products() -> dict[str, casadi.Function]:
    """What JAX, CasADi and C users get, named as the methods of an arm: constants of kinematics folded, parameters not."""
    known = functions() | {f.name(): f for f in (inverse_kinematics(), _with_payload())}
    return {name: known[name] for name in SUMMARIES}


def _with_payload() -> casadi.Function:
    """Parameters are linear in the moments of the bodies."""
    tip = np.array(casadi.evalf(turns(casadi.SX.zeros(4))[-1].pose()))
    shapes = {"mass": (1,), "com": (3,), "inertia": (3, 3), "volume": (1,), "cob": (3,)}
    shapes["fluid_density"] = (1,)
    given = {name: casadi.SX.sym(name, *shape) for name, shape in shapes.items()}
    p, nothing = casadi.SX.sym("parameters", len(BASE_PARAMETERS)), np.zeros((2, 4, 4))
    units = (tip @ unit @ tip.T for unit in np.eye(32).reshape(32, 2, 4, 4))
    shares = np.array(
        [regrouped([nothing] * 4 + [unit], np.zeros(3), parameters()) for unit in units]
    )
    body = casadi.veccat(*moments(*given.values(), stack=casadi.vertcat))
    out = {"parameters_with_payload": p + casadi.DM(shares.T.round(15)) @ body}
    return named("with_payload", {"parameters": p, **given}, out)
