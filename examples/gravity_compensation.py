"""Hold a pose in water: a controller with and without weight and water in its model.

    python examples/gravity_compensation.py

A computed-torque controller moves the arm, simulated under water, from `home` to
`reach`. Whatever its model lacks causes an error, which only a stiffer controller would
reduce.
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

STIFFNESS = 8.0  # [rad/s]
STEP = 2e-3  # [s]
DURATION = 3.0  # [s]


def error_after(compensation: a5.Arm | None) -> np.ndarray:
    """Error of each joint after the motion in sea water, (4,) [rad]."""
    world = a5.load()
    goal = a5.named_pose("reach")
    q = a5.named_pose("home")
    v = np.zeros(4)
    for _ in range(round(DURATION / STEP)):
        wanted = STIFFNESS**2 * (goal - q) - 2 * STIFFNESS * v  # critically damped
        torque = world.mass_matrix(q) @ wanted
        if compensation is not None:
            # Coriolis, weight, buoyancy
            torque += compensation.nonlinear_effects(q, v)
        v = v + STEP * world.forward_dynamics(q, v, torque)
        q = q + STEP * v
    return goal - q


def main() -> None:
    """Print the error that is left."""
    joints = "".join(f"{name:>9}" for name in a5.load().joint_names)
    print(f"error after {DURATION:g} s [deg]{joints}")
    for name, model in (
        ("no compensation", None),
        ("weight only", a5.load(a5.AIR)),
        ("weight and buoyancy", a5.load(a5.SEA_WATER)),
    ):
        errors = np.degrees(error_after(model))
        print(f"{name:23}" + "".join(f"{error:9.2f}" for error in errors))


if __name__ == "__main__":
    main()
