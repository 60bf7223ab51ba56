"""Reach a point as fast as torque and speed allow: predictive control with the arm's equations in CasADi.

python examples/predictive_control.py
"""

from __future__ import annotations

import casadi
import numpy as np

import alpha5_model as a5
from alpha5_model.casadi import load

TORQUE = np.array([0.03, 1.0, 0.4, 0.02])  # N m; no rating is published: put yours here
SPEED = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
STEP, AHEAD = 0.1, 8  # s, steps that are planned
TARGET = np.array([0.12, 0.20, 0.20])


def controller() -> casadi.Function:
    """Of position, speed, goal (4,) and the last plan: the torque for the next step, and the plan."""
    arm, opti, quiet = load(), casadi.Opti(), {"print_level": 0, "sb": "yes"}
    q, v, tau = (opti.variable(4, AHEAD + more) for more in (1, 1, 0))
    now, speed, goal = (opti.parameter(4) for _ in range(3))
    opti.subject_to(casadi.horzcat(q[:, 0], v[:, 0]) == casadi.horzcat(now, speed))
    for k in range(AHEAD):
        middle = q[:, k] + STEP / 2 * v[:, k]
        a = arm.forward_dynamics(middle, v[:, k], tau[:, k])
        opti.subject_to(v[:, k + 1] == v[:, k] + STEP * a)
        opti.subject_to(q[:, k + 1] == middle + STEP / 2 * v[:, k + 1])
        used = casadi.vertcat(tau[:, k] / TORQUE, v[:, k + 1] / SPEED)
        opti.subject_to(opti.bounded(-1, used, 1))
    opti.minimize(
        casadi.sumsqr(q - casadi.repmat(goal, 1, AHEAD + 1)) + 0.1 * casadi.sumsqr(v)
    )
    opti.solver("ipopt", {"print_time": False, "expand": True}, quiet)
    return opti.to_function("control", [now, speed, goal, opti.x], [tau[:, 0], opti.x])


def main() -> None:
    """Pinocchio is the arm that is controlled."""
    arm, control, q, v = a5.load(), controller(), a5.named_pose("home"), np.zeros(4)
    goal, plan, used = a5.inverse_kinematics(TARGET).best(q), 0.0, []
    for step in range(1, 41):
        found, plan = control(q, v, goal, plan)
        tau = np.array(found)[:, 0]
        for _ in range(20):
            v = v + STEP / 20 * arm.forward_dynamics(q, v, tau)
            q = q + STEP / 20 * v
        used.append(np.abs([tau / TORQUE, v / SPEED]))
        miss = np.linalg.norm(arm.forward_kinematics(q).translation - TARGET)
        if step % 10 == 0:
            print(f"{step * STEP:.0f} s: {1e3 * miss:.2f} mm from the target")
    print(
        "most torque and speed, % of the limits:", *(100 * np.max(used, axis=0)).round()
    )


if __name__ == "__main__":
    main()
