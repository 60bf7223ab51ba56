"""One target, four ways to reach it: which are within the limits, and what each costs.

python examples/four_branches.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

TARGET = [0.18, 0.05, 0.16]  # [m] in base_link


def main() -> None:
    """Print a row for each branch, and the one to take."""
    arm, now = a5.load(), a5.named_pose("home")
    solutions = a5.inverse_kinematics(TARGET, wrist=now[3])
    print(
        "branch              theta_0  theta_1  theta_2 [deg]  limits  travel [deg]  torque [N m]"
    )
    for name, q, exists, allowed in zip(
        a5.BRANCHES, solutions.q, solutions.exists, solutions.within_limits, strict=True
    ):
        if not exists:
            print(f"{name:19} does not reach the target")
            continue
        angles = "".join(f"{x:9.1f}" for x in np.degrees(q[:3]))
        travel = np.degrees(np.abs(q - now).max())
        torque = np.abs(arm.hydrostatic_torque(q)).max()
        print(
            f"{name:18}{angles}{'yes' if allowed else 'no':>14}{travel:14.0f}{torque:14.3f}"
        )
    best = solutions.best(now)
    tip = arm.forward_kinematics(best).translation
    print(
        f"nearest within the limits: {np.round(np.degrees(best), 1)} deg, tcp at {np.round(tip, 4)} m"
    )


if __name__ == "__main__":
    main()
