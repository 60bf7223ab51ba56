"""The arm's equations, written once; everything else that computes them is generated from here.

CasADi is needed to generate, not to run.
"""

from __future__ import annotations

from functools import cache

from alpha5_model.errors import MissingDependencyError

try:
    import casadi
except ImportError:
    what = "making code of the equations"
    raise MissingDependencyError("casadi", what, "pip install casadi") from None

from alpha5_model.symbolic.dynamics import dynamics
from alpha5_model.symbolic.inverse_kinematics import inverse_kinematics
from alpha5_model.symbolic.moving_water import in_moving_water


@cache
def functions() -> dict[str, casadi.Function]:
    """Every function by its name, inputs and outputs named as in ``words.toml``."""
    return {f.name(): f for f in (*dynamics(), *in_moving_water(), inverse_kinematics())}
