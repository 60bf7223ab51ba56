"""The arm under a vehicle of the BlueROV2's size: trim, load on the mount, reaction.

    python examples/arm_on_bluerov2.py

The numbers of the vehicle are those of the BlueROV2 Heavy in [VonBenzon2022]_, which
public simulators use too. There z points down, here it points up; this changes only the
sign of the centre of buoyancy. The place of the arm is our choice: under the front,
upside down, so that it reaches ahead and down.

.. [VonBenzon2022] von Benzon, Sorensen, Uth, Jouffroy, Liniger, Pedersen: An
   open-source benchmark simulator: control of a BlueROV2 underwater robot, J. Mar. Sci.
   Eng. 10 (12), 1898, 2022: mass, inertia, volume, centres, added mass and damping,
   identified in fresh water.
"""

from __future__ import annotations

import math

import numpy as np

import alpha5_model as a5

#: Pose of base_link in the vehicle's frame: half a turn about x.
MOUNT = np.diag([1.0, -1.0, -1.0, 1.0])
MOUNT[:3, 3] = 0.15, 0.0, -0.14
BLUEROV2_HEAVY = a5.Vehicle(
    mass=13.5,
    com=[0.0, 0.0, 0.0],
    inertia=np.diag([0.26, 0.23, 0.37]),
    volume=0.0134,
    cob=[0.0, 0.0, 0.01],
    added_mass=[6.36, 7.12, 18.68, 0.189, 0.135, 0.222],
    linear_damping=[13.7, 0.0, 33.0, 0.0, 0.8, 0.0],
    quadratic_damping=[141.0, 217.0, 190.0, 1.19, 0.47, 1.5],
    mount=MOUNT,
)


def main() -> None:
    """Print the trim of the vehicle, the load on the mount, and a reaction."""
    arm = a5.load(a5.FRESH_WATER).with_hydrodynamics()
    system = arm.on_vehicle(BLUEROV2_HEAVY)
    print("pose     roll   pitch [deg]   net weight [N]")
    for name in ("stow", "home", "reach"):
        trim = system.trim(a5.named_pose(name))
        roll = math.degrees(trim.roll)
        pitch = math.degrees(trim.pitch)
        print(f"{name:7}{roll:+6.1f}{pitch:+8.1f}{trim.net_weight:17.2f}")

    q = system.configuration(np.eye(4), a5.named_pose("reach"))
    still = np.zeros(10)
    load = system.mount_load(q, still, still, water_velocity=[0.0, 1.0, 0.0])
    print("\nload on the mount in a side current of 1 m/s, arm stretched out:")
    force = np.round(load.linear, 2)
    moment = np.round(load.angular, 2)
    print(f"  force {force} N, moment {moment} N m")

    swing = np.array([1.0, 0.0, 0.0, 0.0])  # rad/s^2 about axis_e
    base, torque = system.reaction(q, still, swing)
    level, _ = system.reaction(q, still, np.zeros(4))
    print("\nthe arm swings about axis_e with 1 rad/s^2, thrusters off:")
    yaw = (base - level)[5]
    print(f"  the vehicle turns with {yaw:+.3f} rad/s^2; torque {torque[0]:+.3f} N m")


if __name__ == "__main__":
    main()
