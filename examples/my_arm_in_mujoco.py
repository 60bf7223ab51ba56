"""An arm of your own, from its file to a controller: MuJoCo, IK, computed torque.

    python examples/my_arm_in_mujoco.py

The simulated arm is that of examples/my_arm.toml, upside down under a vehicle. One
controller knows it, the other one the catalogue's arm on the same mount.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import mujoco
import numpy as np

import alpha5_model as a5
from alpha5_model.description.mjcf import MjcfOptions, mjcf_files
from alpha5_model.numbers.parameters import Alpha5Parameters

FILE = Path(__file__).with_name("my_arm.toml")
TARGET = [0.25, 0.10, 0.10]  # tcp in base_link [m]
STIFFNESS = 6.0  # [rad/s]
DURATION = 3.0  # [s]


def final_position(own: Alpha5Parameters, known: Alpha5Parameters) -> np.ndarray:
    """Where the controller that knows one arm brings the tcp of another, (3,) [m]."""
    files = mjcf_files(MjcfOptions(arm=own, actuators="motor"))
    model = mujoco.MjModel.from_xml_string(files.pop("alpha5.xml").decode(), files)
    data = mujoco.MjData(model)
    controller = a5.load(arm=known)
    position = model.jnt_qposadr[[model.joint(n).id for n in controller.joint_names]]
    rate = model.jnt_dofadr[[model.joint(n).id for n in controller.joint_names]]

    q = np.array(a5.named_pose("reach"))
    goal = a5.inverse_kinematics(TARGET, arm=known).best(q)
    data.qpos[position] = q
    for _ in range(round(DURATION / model.opt.timestep)):
        q, v = data.qpos[position], data.qvel[rate]
        wanted = STIFFNESS**2 * (goal - q) - 2 * STIFFNESS * v  # critically damped
        data.ctrl[:4] = controller.inverse_dynamics(q, v, wanted)
        mujoco.mj_step(model, data)
    return a5.load(arm=own).forward_kinematics(data.qpos[position]).translation


def main() -> None:
    """Print how far the tcp stays from the target."""
    own = a5.arm_file(FILE)
    catalogue = dataclasses.replace(a5.parameters(), mount=own.mount)
    for name, known in (("this arm", own), ("the catalogue's arm", catalogue)):
        error = np.linalg.norm(final_position(own, known) - TARGET)
        print(f"with a controller that knows {name:19} {1e3 * error:6.2f} mm off")


if __name__ == "__main__":
    main()
