"""Carry something under water: its weight and volume count, and where they act.

python examples/payload.py
"""

from __future__ import annotations

import numpy as np

import alpha5_model as a5

#: Name -> mass [kg], volume [m^3], centre of mass and centre of buoyancy in tcp [m].
PAYLOADS = {
    "nothing": (0.0, 0.0, [0, 0, 0], [0, 0, 0]),
    "steel, 0.5 kg": (0.5, 0.5 / 7850, [0, 0, 0.02], [0, 0, 0.02]),
    "sample of sea water, 0.5 L": (0.5125, 0.5e-3, [0, 0, 0.05], [0, 0, 0.05]),
    "float, 0.25 L": (0.05, 0.25e-3, [0, 0, 0.03], [0, 0, 0.03]),
    "camera, heavy side out": (0.4, 0.3e-3, [0, 0, 0.06], [0, 0, 0.03]),
}


def main() -> None:
    """Print the torque and current that hold each of them with the arm stretched."""
    arm = a5.load()
    q = a5.named_pose("reach")
    still = np.zeros(4)
    shoulder = a5.actuators.actuator("axis_d")
    print(f"{'payload':28}axis_d [N m]   current [A]", end="")
    print("   mount, down [N]  inertia, axis_e [kg m^2]")
    for name, (mass, volume, com, cob) in PAYLOADS.items():
        loaded = arm
        if mass:
            loaded = arm.with_payload(mass, com=com, volume=volume, cob=cob)
        torque = loaded.hydrostatic_torque(q)[1]
        # An interval: friction may help to hold the load, or not.
        current = shoulder.holding_current(torque)
        weight = -loaded.base_wrench(q, still, still).linear[2]
        # A neutral payload has no weight under water, but all of its inertia.
        swing = loaded.mass_matrix(q)[0, 0]
        print(f"{name:28}{torque:12.3f}", end="")
        print(f"{current.lower:9.3f} to {current.upper:5.3f}", end="")
        print(f"{weight:13.2f}{swing:20.4f}")


if __name__ == "__main__":
    main()
