"""A straight line of the tcp, as fast as speeds and motors allow, by TOPP-RA.

    python examples/line_with_toppra.py

The line is 1 mm steps of inverse kinematics on one branch. TOPP-RA [Pham2018]_ finds
the fastest motion along it within rated speeds, accelerations that we choose, and the
torques that the motors hold, in sea water.

.. [Pham2018] Pham, Pham: A new approach to time-optimal path parameterization based on
   reachability analysis, IEEE Transactions on Robotics 34 (3), 2018.
"""

from __future__ import annotations

import logging

import numpy as np
import toppra
from toppra import algorithm, constraint

import alpha5_model as a5

START, END = np.array([0.10, 0.25, 0.05]), np.array([0.30, -0.10, 0.15])  # [m]
ACCELERATION = 2.0  # [rad/s^2]


def main() -> None:
    """Print how long the line takes, how straight it is, and what limits it."""
    logging.getLogger("toppra").setLevel(logging.ERROR)
    arm = a5.load()
    share = np.linspace(0.0, 1.0, round(np.linalg.norm(END - START) / 1e-3) + 1)
    points = START + share[:, None] * (END - START)
    way = a5.inverse_kinematics_path(points)

    path = toppra.SplineInterpolator(share, way)
    speed = arm.limits.velocity
    torque = arm.limits.effort
    limits = [
        constraint.JointVelocityConstraint(np.column_stack([-speed, speed])),
        constraint.JointAccelerationConstraint(np.tile([-1, 1], (4, 1)) * ACCELERATION),
        constraint.JointTorqueConstraint(
            arm.inverse_dynamics, np.column_stack([-torque, torque]), np.zeros(4)
        ),
    ]
    motion = algorithm.TOPPRA(limits, path).compute_trajectory()
    time = np.linspace(0.0, motion.duration, 500)
    q, v, a = motion(time), motion(time, 1), motion(time, 2)

    tip = a5.dh.DHChain.alpha5().forward_kinematics(q)[:, :3, 3]
    along = (tip - START) @ (END - START) / np.linalg.norm(END - START) ** 2
    off = np.linalg.norm(tip - START - along[:, None] * (END - START), axis=1).max()
    print(f"{motion.duration:.2f} s, at most {1e3 * off:.3f} mm from the line")
    efforts = np.abs(arm.inverse_dynamics_batch(q, v, a)).max(axis=0)
    for k, name in enumerate(arm.joint_names):
        used = np.abs(v[:, k]).max() / speed[k]
        print(f"{name}: {100 * used:3.0f} % of its speed, {efforts[k]:.2f} N m")


if __name__ == "__main__":
    main()
