"""The functions that JAX, CasADi and C users get: named as the methods of an arm, each with a line on what it is."""

from __future__ import annotations

import casadi
import numpy as np
from casadi import SX, vertcat

from alpha5_model.base_parameters import BASE_PARAMETERS, regrouped
from alpha5_model.symbolic import functions
from alpha5_model.symbolic.solutions import solutions

#: Name -> what it is. Those of `functions` that are missing serve the kernels only.
SUMMARIES = {
    "forward_kinematics": "Pose of the tcp, transform_tcp_to_base.",
    "link_poses": "Poses of the moving links in base_link.",
    "jacobian": "Geometric Jacobian of the tcp in the axes of base_link.",
    "gravity_torque": "Torque that holds the weight.",
    "buoyancy_torque": "Torque that the water applies.",
    "hydrostatic_torque": "Torque that holds the arm still in the water: gravity_torque - buoyancy_torque.",
    "hydrostatic_torque_derivative": "Derivative of hydrostatic_torque.",
    "mass_matrix": "Joint-space inertia M(q).",
    "coriolis_matrix": "C(q, v): C v is Coriolis and centrifugal.",
    "nonlinear_effects": "C(q, v) v + hydrostatic_torque(q).",
    "inverse_dynamics": "Joint torque for a motion, water included.",
    "inverse_dynamics_derivatives": "Derivatives of inverse_dynamics.",
    "forward_dynamics": "Joint acceleration under a torque, water included.",
    "forward_dynamics_derivatives": "Derivatives of forward_dynamics.",
    "base_wrench": "Wrench that the arm exerts on its mount.",
    "base_wrench_derivatives": "Derivatives of base_wrench.",
    "inverse_kinematics": "Every joint position that puts the tcp at a point: underarm, overarm, both flipped.",
    "with_payload": "The parameters of the arm with a rigid body fixed to its tcp.",
}


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
