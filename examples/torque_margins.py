"""How much torque is left when the arm holds a load at each of 100 000 targets?

python examples/torque_margins.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

#: Of axis_e, axis_d, axis_c, axis_b [N m]. No rating is published: put yours here.
LIMITS = np.array([2.0, 2.0, 1.5, 0.5])
SHARES = (0.25, 0.5, 0.75, 1.0)


def main() -> None:
    """Print the share of targets by the share of the torque that they need."""
    steel = 6.4e-5  # [m^3]
    arm = a5.load().with_payload(0.5, com=[0, 0, 0.03], volume=steel)
    low = [-0.5, -0.5, -0.4]
    high = [0.5, 0.5, 0.5]
    points = np.random.default_rng(5).uniform(low, high, (800_000, 3))
    points = points[a5.reachable(points)][:100_000]
    solutions = a5.inverse_kinematics(points)
    within = solutions.within_limits  # (N, 4): up to four poses for each target
    poses = solutions.q[within]
    still = np.zeros((1, 4))
    torque = arm.inverse_dynamics_batch(poses, still, still)

    # Share of its limit that the hardest working joint needs.
    used = np.full(within.shape, np.nan)
    used[within] = (np.abs(torque) / LIMITS).max(axis=1)
    print(f"{len(points)} targets, {len(poses)} poses, 0.5 kg in the gripper")
    limits = "".join(f"{share:7.0%}" for share in SHARES)
    print(f"share of the torque limits   {limits}")
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
