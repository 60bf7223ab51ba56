"""One target, four solutions: which are within the limits, and what each costs.

python examples/four_branches.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

TARGET = [0.18, 0.05, 0.16]  # [m] in base_link


def main() -> None:
    """Print a row for each branch, and the nearest solution."""
    arm = a5.load()
    now = a5.named_pose("home")
    solutions = a5.inverse_kinematics(TARGET, wrist=now[3])
    print(f"{'branch':20}theta_0  theta_1  theta_2 [deg]  limits", end="")
    print("  travel [deg]  torque [N m]")
    for name, q, exists, allowed in zip(
        a5.BRANCHES, solutions.q, solutions.exists, solutions.within_limits, strict=True
    ):
        if not exists:
            print(f"{name:19} does not reach the target")
            continue
        angles = "".join(f"{x:9.1f}" for x in np.degrees(q[:3]))
        travel = np.degrees(np.abs(q - now).max())
        torque = np.abs(arm.hydrostatic_torque(q)).max()
        limits = "yes" if allowed else "no"
        print(f"{name:18}{angles}{limits:>14}{travel:14.0f}{torque:14.3f}")
    best = solutions.best(now)
    tip = np.round(arm.forward_kinematics(best).translation, 4)
    best = np.round(np.degrees(best), 1)
    print(f"nearest within the limits: {best} deg, tcp at {tip} m")


if __name__ == "__main__":
    main()
