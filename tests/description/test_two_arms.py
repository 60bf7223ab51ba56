"""Two arms on one vehicle: each is the arm alone, on its own mount and in water."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model._support.paths import MJCF_PATH, XACRO_PATH
from alpha5_model._support.spatial import rotation_from_rpy

xacro = Lazy("xacro", reason="xacro is not installed")

#: Prefix -> position and roll, pitch, yaw of base_link in the vehicle.
MOUNTS = {
    "left_": ((0.2, 0.25, -0.1), (np.pi, 0.0, 0.0)),
    "right_": ((0.2, -0.25, -0.1), (0.4, -0.3, 0.2)),
}
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
CALL = """
  <xacro:alpha5 parameters="${{numbers}}" prefix="{prefix}" parent="vehicle"
                mesh_prefix="package://alpha5_description/meshes/">
    <origin xyz="{xyz}" rpy="{rpy}"/>
  </xacro:alpha5>"""
ROBOT = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="two_arms">
  <xacro:include filename="{folder}/alpha5_macro.xacro"/>
  <xacro:property name="file" value="{folder}/parameters.yaml"/>
  <xacro:property name="numbers" value="${{xacro.load_yaml(file)}}"/>
  <link name="vehicle"/>{calls}
</robot>
"""


def states(seed: int, count: int) -> np.ndarray:
    """Joint positions of both arms, (count, 8)."""
    rng = np.random.default_rng(seed)
    return np.hstack([rng.uniform(LOWER, UPPER, (count, 4)) for _ in MOUNTS])


def alone(prefix: str, fluid: float) -> a5.Arm:
    """The arm on its mount: gravity as it is felt in base_link."""
    rotation = rotation_from_rpy(MOUNTS[prefix][1])
    return a5.load(fluid, gravity=rotation.T @ [0.0, 0.0, -9.81])


def test_xacro_prefixes_give_two_arms(tmp_path):
    calls = ""
    for prefix, (xyz, rpy) in MOUNTS.items():
        words = {"xyz": " ".join(map(repr, xyz)), "rpy": " ".join(map(repr, rpy))}
        calls += CALL.format(prefix=prefix, **words)
    file = tmp_path / "two.urdf.xacro"
    file.write_text(ROBOT.format(folder=Path(XACRO_PATH).parent, calls=calls))
    model = pin.buildModelFromXML(xacro.process_file(str(file)).toxml())
    data = model.createData()
    names = [prefix + joint for prefix in MOUNTS for joint in JOINTS]
    order = [model.joints[model.getJointId(name)].idx_v for name in names]
    assert model.nv == 8
    for q in states(1, 5):
        there = np.empty(8)
        there[order] = q
        upper = np.triu(pin.crba(model, data, there))
        mass = (upper + np.triu(upper, 1).T)[np.ix_(order, order)]
        weight = pin.computeGeneralizedGravity(model, data, there)[order]
        pin.framesForwardKinematics(model, data, there)
        for i, prefix in enumerate(MOUNTS):
            own = slice(4 * i, 4 * i + 4)
            arm = alone(prefix, a5.AIR)
            expected = arm.mass_matrix(q[own])
            np.testing.assert_allclose(mass[own, own], expected, atol=1e-14)
            torque = arm.gravity_torque(q[own])
            np.testing.assert_allclose(weight[own], torque, atol=1e-13)
            xyz, rpy = MOUNTS[prefix]
            mount = pin.SE3(rotation_from_rpy(rpy), np.array(xyz))
            tcp = data.oMf[model.getFrameId(f"{prefix}tcp")]
            expected_tcp = mount * arm.forward_kinematics(q[own])
            np.testing.assert_allclose(
                tcp.homogeneous, expected_tcp.homogeneous, atol=1e-14
            )
        # They share nothing but the vehicle, which stands.
        np.testing.assert_array_equal(mass[:4, 4:], 0.0)


def test_mjspec_attaches_two_arms_in_water():
    mujoco = pytest.importorskip("mujoco", minversion="3.5", reason="MuJoCo 3.5")
    vehicle = mujoco.MjSpec()
    vehicle.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    body = vehicle.worldbody.add_body(name="vehicle")
    for prefix, (xyz, rpy) in MOUNTS.items():
        turn = pin.Quaternion(rotation_from_rpy(rpy))
        mount = body.add_frame(pos=xyz, quat=[turn.w, turn.x, turn.y, turn.z])
        arm = mujoco.MjSpec.from_file(MJCF_PATH)
        vehicle.attach(arm, prefix=prefix, frame=mount)
    model = vehicle.compile()
    assert model.nu == 8
    assert {model.key(i).name for i in range(model.nkey)} >= {"left_home", "right_home"}
    for name in ("CONTACT", "LIMIT", "ACTUATION"):
        model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{name}")

    data = mujoco.MjData(model)
    names = [prefix + joint for prefix in MOUNTS for joint in JOINTS]
    order = [model.joint(name).dofadr[0] for name in names]
    rng = np.random.default_rng(3)
    for q in states(2, 5):
        v = rng.uniform(-1.0, 1.0, 8)
        data.qpos[order] = q
        data.qvel[order] = v
        mujoco.mj_forward(model, data)
        for i, prefix in enumerate(MOUNTS):
            own = slice(4 * i, 4 * i + 4)
            arm = alone(prefix, a5.SEA_WATER)
            expected = arm.forward_dynamics(q[own], v[own], np.zeros(4))
            found = data.qacc[order][own]
            np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8)
