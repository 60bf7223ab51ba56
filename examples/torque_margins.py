"""100 000 targets in the workspace: with how much torque to spare can the arm hold a load still at each?

python examples/torque_margins.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

#: Of axis_e, axis_d, axis_c, axis_b [N m]. No rating is published: put those of your actuators here.
LIMITS = np.array([2.0, 2.0, 1.5, 0.5])
SHARES = (0.25, 0.5, 0.75, 1.0)


def main() -> None:
    """Print what share of the targets needs at most so much of the torque, by the best pose of each and by the worst."""
    arm = a5.load().with_payload(
        0.5, com=[0, 0, 0.03], volume=6.4e-5
    )  # a part of steel
    points = np.random.default_rng(5).uniform(
        [-0.5, -0.5, -0.4], [0.5, 0.5, 0.5], (800_000, 3)
    )
    points = points[a5.reachable(points)][:100_000]
    solutions = a5.inverse_kinematics(points)
    within = solutions.within_limits  # (N, 4): up to four poses for each target
    poses, still = solutions.q[within], np.zeros((1, 4))
    torque = arm.inverse_dynamics_batch(poses, still, still)

    used = np.full(
        within.shape, np.nan
    )  # of its limit, by the joint that works hardest
    used[within] = (np.abs(torque) / LIMITS).max(axis=1)
    print(f"{len(points)} targets, {len(poses)} poses, 0.5 kg in the gripper")
    print(
        "share of the torque limits   " + "".join(f"{share:7.0%}" for share in SHARES)
    )
    for name, needed in (
        ("best", np.nanmin(used, axis=1)),
        ("worst", np.nanmax(used, axis=1)),
    ):
        shares = "".join(f"{np.mean(needed <= share):7.1%}" for share in SHARES)
        print(f"targets, {name + ' pose':20}{shares}")
    margin = LIMITS - np.abs(torque)
    for name, joint in zip(arm.joint_names, margin.T, strict=True):
        pose = ", ".join(f"{angle:.3f}" for angle in poses[joint.argmin()])
        print(f"{name}: least margin {joint.min():+.3f} N m at q = {pose}")


if __name__ == "__main__":
    main()
