"""Hold a pose in water: the same controller with and without the weight and the water in its model.

    python examples/gravity_compensation.py

A computed-torque controller steers the arm, simulated under water, from `home` to `reach`. What it
leaves out of its model stays as an error that only a stiffer controller would push down.
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

STIFFNESS, STEP, DURATION = 8.0, 2e-3, 3.0  # [rad/s], [s], [s]


def error_after(compensation: a5.Arm | None) -> np.ndarray:
    """Error of each joint after the motion [rad], (4,), the arm being in sea water."""
    world, goal = a5.load(), a5.named_pose("reach")
    q, v = a5.named_pose("home"), np.zeros(4)
    for _ in range(round(DURATION / STEP)):
        wanted = STIFFNESS**2 * (goal - q) - 2 * STIFFNESS * v  # critically damped
        torque = world.mass_matrix(q) @ wanted
        if compensation is not None:
            torque += compensation.nonlinear_effects(q, v)  # Coriolis, weight, buoyancy
        v = v + STEP * world.forward_dynamics(q, v, torque)
        q = q + STEP * v
    return goal - q


def main() -> None:
    """Print the error that is left."""
    print(
        f"error after {DURATION:g} s [deg]"
        + "".join(f"{f'axis_{x}':>9}" for x in "edcb")
    )
    for name, model in (
        ("no compensation", None),
        ("weight only", a5.load(a5.AIR)),
        ("weight and buoyancy", a5.load(a5.SEA_WATER)),
    ):
        print(
            f"{name:23}" + "".join(f"{x:9.2f}" for x in np.degrees(error_after(model)))
        )


if __name__ == "__main__":
    main()
