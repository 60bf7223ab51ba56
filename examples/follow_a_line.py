"""Follow a straight line with the tcp, and see how fast the joints allow it.

python examples/follow_a_line.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

START, END = np.array([0.15, -0.20, 0.10]), np.array([0.15, 0.20, 0.10])  # [m]


def main() -> None:
    """Print the speed limit of the line, and what a jump says."""
    points = np.linspace(START, END, 201)
    q = a5.inverse_kinematics_path(
        points
    )  # continuous, within the limits, least joint travel
    reached = np.array([a5.load().forward_kinematics(x).translation for x in q])
    print(f"{len(q)} points, largest miss {np.abs(reached - points).max():.1e} m")

    # Joint travel per metre of the line; the joint that allows least sets the pace.
    length = np.linalg.norm(END - START)
    per_metre = np.abs(np.gradient(q, length / (len(q) - 1), axis=0)).max(axis=0)
    joints = a5.parameters().joints[:4]
    for joint, rate in zip(
        joints[:3], per_metre[:3], strict=True
    ):  # the wrist stands still
        print(
            f"{joint.name}: {rate:.2f} rad/m, the tcp at most {joint.velocity / rate:.3f} m/s"
        )

    try:
        a5.inverse_kinematics_path(
            points[[0, -1]]
        )  # the same line, too coarse to be continuous
    except a5.Alpha5Error as error:
        print(f"{type(error).__name__}: {error}")


if __name__ == "__main__":
    main()
