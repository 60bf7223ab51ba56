"""Pick something up beside a BlueROV2 and stow it, without touching the vehicle.

    python examples/pick_and_stow.py

The hull is a box of the BlueROV2's length, width and height, 457 x 338 x 254 mm (Blue
Robotics, BlueROV2 technical details). Where the arm sits and the skids beside it are
our choice: under the front, upside down, so that the arm's z points down.
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

#: Fixed in base_link [m].
VEHICLE = [
    a5.Obstacle.box("hull", (0.457, 0.338, 0.254), xyz=(-0.15, 0.0, -0.25)),
    a5.Obstacle.box("left skid", (0.40, 0.02, 0.16), xyz=(-0.15, -0.16, -0.05)),
    a5.Obstacle.box("right skid", (0.40, 0.02, 0.16), xyz=(-0.15, 0.16, -0.05)),
]
SHELL = [-0.15, -0.30, 0.10]  # what is picked up: beside a skid, in base_link [m]
#: Its mass and volume [kg, m^3], held at the tcp.
LOAD = a5.load().with_payload(0.15, volume=6e-5)


def main() -> None:
    """Print how each motion goes, how long it takes, and what it asks of the motors."""
    stow = a5.named_pose("stow")
    there = a5.plan(stow, SHELL, obstacles=VEHICLE)
    back = a5.plan(there.position[-1], stow, arm=LOAD, obstacles=VEHICLE)
    print("motion    way                  time [s]  largest torque [N m]")
    for name, motion, arm in (("to it", there, a5.load()), ("and back", back, LOAD)):
        torque = arm.inverse_dynamics_batch(
            motion.position, motion.velocity, motion.acceleration
        )
        largest = np.abs(torque).max()
        print(f"{name:9} {motion.kind:20} {motion.duration:8.1f} {largest:10.2f}")


if __name__ == "__main__":
    main()
