"""Weigh an arm on three kitchen scales, and make an arm file of what they show.

The arm is simulated, so that the truth is known: its masses, centres and zeros differ
from the printed ones, its plate is not level, and the scales show whole grams. The true
loads are Pinocchio's; the calibration has kernels of its own.

python examples/calibrate_with_scales.py
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import alpha5_model as a5

#: What lies on each scale beside the arm [g].
PLATE = [412.0, 398.0, 405.0]
STILL = np.zeros(4)


def true_arm(rng):
    """Masses 5 % off, centres of mass 3 mm, zeros of the joints half a degree."""
    arm = a5.parameters()
    links = []
    for link in arm.links:
        mass = link.mass * (1.0 + 0.05 * rng.normal())
        links.append(
            replace(link, mass=mass, com=link.com + 0.003 * rng.normal(size=3))
        )
    rows = list(arm.dh)
    for i, row in enumerate(rows[:4]):
        zero = np.radians(0.5) * rng.normal()
        rows[i] = replace(row, theta_offset=row.theta_offset + zero)
    return replace(arm, links=tuple(links), dh=tuple(rows))


def main() -> None:
    """Print what is learnt, and how far off torques are in poses nobody weighed."""
    rng = np.random.default_rng(2)
    truth = true_arm(rng)
    plan = a5.calibrate.plan_poses(a5.calibrate.scales(), prior="loose")

    # The plate is 0.3 deg off the level.
    arm = a5.load(a5.AIR, gravity=np.array([0.05, -0.03, -9.81]), arm=truth)
    shown = []
    for q in plan.q:
        wrench = arm.base_wrench(q, STILL, STILL).vector
        shown.append(np.round(1e3 * plan.sensor.matrix[:, 4:] @ wrench + PLATE))
    weighed = a5.calibrate.with_readings(plan, 1e-3 * np.array(shown))

    found = a5.calibrate.fit(weighed, prior="loose")
    print(found)
    path = Path(tempfile.mkdtemp()) / "my_arm.toml"
    found.write(path)

    poses = plan.q + rng.uniform(-0.5, 0.5, (12, 4))
    true_torque = a5.load(a5.AIR, arm=truth).inverse_dynamics_batch(poses, STILL, STILL)
    for name, own in (("printed", a5.parameters()), ("calibrated", a5.arm_file(path))):
        torque = a5.load(a5.AIR, arm=own).inverse_dynamics_batch(poses, STILL, STILL)
        error = 1e3 * np.sqrt(((torque - true_torque) ** 2).mean(axis=0))
        print(f"{name}: axis_d {error[1]:.1f} mN m off, axis_c {error[2]:.1f} mN m")


if __name__ == "__main__":
    main()
