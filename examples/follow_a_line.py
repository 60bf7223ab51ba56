"""Follow a straight line with the tcp, and see how fast the joints allow it.

python examples/follow_a_line.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

#: Ends of the line in base_link [m].
START = np.array([0.15, -0.20, 0.10])
END = np.array([0.15, 0.20, 0.10])


def main() -> None:
    """Print the speed limit of the line, and the error of a line with a jump."""
    points = np.linspace(START, END, 201)
    # The path is continuous, within the limits, and has the least joint travel.
    q = a5.inverse_kinematics_path(points)
    arm = a5.load()
    reached = np.array([arm.forward_kinematics(x).translation for x in q])
    print(f"{len(q)} points, largest miss {np.abs(reached - points).max():.1e} m")

    # Joint travel per metre of the line; the wrist stands still.
    step = np.linalg.norm(END - START) / (len(q) - 1)
    rates = np.abs(np.gradient(q, step, axis=0)).max(axis=0)
    for joint, rate in zip(a5.parameters().joints[:3], rates[:3], strict=True):
        speed = joint.velocity / rate
        print(f"{joint.name}: {rate:.2f} rad/m, the tcp at most {speed:.3f} m/s")

    try:
        # The same line, too coarse to be continuous.
        a5.inverse_kinematics_path(points[[0, -1]])
    except a5.Alpha5Error as error:
        print(f"{type(error).__name__}: {error}")


if __name__ == "__main__":
    main()
