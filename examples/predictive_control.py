"""Reach a point as fast as torque and speed allow: predictive control with CasADi.

The arm starts above its mount. On the quickest way, link 2 would hit the mount, so the
controller keeps an approximate distance from self-collision above zero.

python examples/predictive_control.py
"""

from __future__ import annotations

import casadi
import numpy as np

import alpha5_model as a5
from alpha5_model.casadi import approximate_collision_distance, load

#: Largest torques [N m]. No rating is published: put yours here.
TORQUE = np.array([0.03, 1.0, 0.4, 0.02])
SPEED = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
STEP = 0.1  # [s]
AHEAD = 8  # steps that are planned
# Second derivatives of the distance would cost more time than they save.
IPOPT = {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory"}
START = np.array([0.05, 1.4, 1.5, np.pi / 2])  # [rad]
TARGET = np.array([-0.16, -0.24, 0.05])  # [m]


def controller(clearance: float) -> casadi.Function:
    """(position, speed, goal, last plan) -> (torque of the next step, plan)."""
    arm = load()
    self_distance = approximate_collision_distance()
    opti = casadi.Opti()
    q, v = (opti.variable(4, AHEAD + 1) for _ in range(2))
    tau = opti.variable(4, AHEAD)
    now, speed, goal = (opti.parameter(4) for _ in range(3))
    opti.subject_to(casadi.horzcat(q[:, 0], v[:, 0]) == casadi.horzcat(now, speed))
    for k in range(AHEAD):
        middle = q[:, k] + STEP / 2 * v[:, k]
        after = v[:, k] + STEP * arm.forward_dynamics(middle, v[:, k], tau[:, k])
        opti.subject_to(v[:, k + 1] == after)
        opti.subject_to(q[:, k + 1] == middle + STEP / 2 * v[:, k + 1])
        used = casadi.vertcat(tau[:, k] / TORQUE, v[:, k + 1] / SPEED)
        opti.subject_to(opti.bounded(-1, used, 1))
        opti.subject_to(self_distance(q[:, k + 1]) >= clearance)
    miss = q - casadi.repmat(goal, 1, AHEAD + 1)
    opti.minimize(casadi.sumsqr(miss) + 0.1 * casadi.sumsqr(v))
    opti.solver("ipopt", {"print_time": False}, IPOPT)
    return opti.to_function("control", [now, speed, goal, opti.x], [tau[:, 0], opti.x])


def main(clearance: float = 0.002) -> None:
    """Control an arm that Pinocchio simulates."""
    arm = a5.load()
    control = controller(clearance)
    q, v, plan, nearest = START, np.zeros(4), 0.0, 1.0
    goal = a5.inverse_kinematics(TARGET).best(q)
    for step in range(1, 31):
        found, plan = control(q, v, goal, plan)
        tau = np.array(found)[:, 0]
        for _ in range(20):
            v = v + STEP / 20 * arm.forward_dynamics(q, v, tau)
            q = q + STEP / 20 * v
            nearest = min(nearest, arm.collision_distance(q))
        if step % 10 == 0:
            miss = np.linalg.norm(arm.forward_kinematics(q).translation - TARGET)
            print(f"{step * STEP:.0f} s: {1e3 * miss:.2f} mm from the target")
    print(f"nearest to itself: {1e3 * nearest:.1f} mm")


if __name__ == "__main__":
    main()
