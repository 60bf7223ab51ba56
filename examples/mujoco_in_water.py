"""The same arm in MuJoCo, buoyancy included: generated, loaded, compared to Pinocchio.

python examples/mujoco_in_water.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import mujoco
import numpy as np

import alpha5_model as a5
from alpha5_model.cli import main as alpha5


def load() -> mujoco.MjModel:
    """The model that ``alpha5 generate mjcf`` writes, with idle motors."""
    with tempfile.TemporaryDirectory() as folder:
        status = alpha5(
            ["generate", "mjcf", "--actuators", "motor", "--output", folder]
        )
        assert status == 0
        return mujoco.MjModel.from_xml_path(str(Path(folder) / "alpha5.xml"))


def main() -> None:
    """Print the accelerations of both, and how far the arm sinks in a second."""
    arm = a5.load()
    model = load()
    data = mujoco.MjData(model)
    joints = [model.joint(name).id for name in arm.joint_names]
    positions = model.jnt_qposadr[joints]
    rates = model.jnt_dofadr[joints]
    q = a5.named_pose("reach")
    v = np.array([0.1, -0.2, 0.3, 0.5])
    data.qpos[positions] = q
    data.qvel[rates] = v
    mujoco.mj_forward(model, data)
    ours = arm.forward_dynamics(q, v, np.zeros(4))
    print("acceleration, motors off [rad/s^2]")
    print(f"  MuJoCo    {np.round(data.qacc[rates], 6)}")
    print(f"  Pinocchio {np.round(ours, 6)}")
    before = arm.forward_kinematics(q).translation[2]
    mujoco.mj_step(model, data, nstep=round(1.0 / model.opt.timestep))
    after = arm.forward_kinematics(data.qpos[positions]).translation[2]
    print(f"let go for 1 s, the tcp goes from {before:.3f} m to {after:.3f} m")


if __name__ == "__main__":
    main()
