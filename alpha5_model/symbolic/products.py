"""The functions that JAX, CasADi and C users get: named as the methods of an arm, each with a line on what it is."""

from __future__ import annotations

import casadi
import numpy as np
from casadi import SX, vertcat

from alpha5_model.base_parameters import BASE_PARAMETERS, regrouped
from alpha5_model.symbolic import functions
from alpha5_model.symbolic.program import WORDS
from alpha5_model.symbolic.solutions import solutions

#: Name -> what it is. Those of `functions` that are missing serve the kernels only.
SUMMARIES = WORDS["functions"]


def products() -> dict[str, casadi.Function]:
    """Name -> function, in the order of `SUMMARIES`; constants of kinematics folded, parameters not."""
    known = {**functions(), "inverse_kinematics": solutions(), "with_payload": _with_payload()}
    return {name: known[name] for name in SUMMARIES}


def _with_payload() -> casadi.Function:
    """Parameters are linear in the moments of the bodies."""
    zero, poses = casadi.DM.zeros(4), functions()
    link = np.array(poses["link_poses"](q=zero)["link_4"])
    tip = np.linalg.inv(link) @ np.array(poses["forward_kinematics"](q=zero)["tcp"])
    tip = tip.round(15)  # turns by multiples of pi/2
    names = ("mass", "com", "inertia", "volume", "cob", "fluid_density")
    shapes = ((1, 1), (3, 1), (3, 3), (1, 1), (3, 1), (1, 1))
    given = [SX.sym(name, *shape) for name, shape in zip(names, shapes, strict=True)]
    mass, com, inertia, volume, cob, density = given
    centre, centroid = vertcat(com, 1), vertcat(cob, 1)
    moments = mass * centre @ centre.T
    net = moments - density * volume * centroid @ centroid.T
    second = casadi.trace(inertia) / 2 * SX.eye(3) - inertia
    moments[:3, :3] += second
    p = added = SX.sym("parameters", len(BASE_PARAMETERS))
    nothing = np.zeros((2, 4, 4))
    for which, matrix in enumerate((moments, net)):
        for row in range(4):
            for column in range(row if which == 0 else 3, 4):
                unit = nothing.copy()
                unit[which, row, column] = unit[which, column, row] = 1.0
                share = regrouped([nothing] * 4 + [tip @ unit @ tip.T], np.zeros(3))
                added = added + casadi.DM(share.round(15)) * matrix[row, column]
    return casadi.Function(
        "with_payload", [p, *given], [added], ["parameters", *names], ["parameters_with_payload"]
    )
