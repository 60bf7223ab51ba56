"""Friction, damping and armature of measured motors, in each format that has them."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.mjcf import MjcfOptions, mjcf
from alpha5_model.description.sdf import SdfOptions, sdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xml import without_armature
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters

mujoco = Lazy("mujoco")

GEAR = {
    joint.name: row.gear_ratio
    for joint, row in zip(
        a5.parameters().joints, a5.parameters().actuators, strict=True
    )
}
#: Numbers at the joint: N m forward and backward, N m s/rad, kg m^2.
FORWARD, BACKWARD, VISCOUS, ARMATURE = 1.2, 1.0, 0.8, 0.05


@pytest.fixture
def calibrated(tmp_path: Path) -> Alpha5Parameters:
    """An arm file with motors of axis_d that were measured."""
    gear = GEAR["axis_d"]
    path = tmp_path / "arm.toml"
    path.write_text(
        "format = 1\n[motors]\n"
        f"friction = {{axis_d = {FORWARD / gear!r}}}\n"
        f"friction_backward = {{axis_d = {BACKWARD / gear!r}}}\n"
        f"viscous_friction = {{axis_d = {VISCOUS / gear**2!r}}}\n"
        f"rotor_inertia = {{axis_d = {ARMATURE / gear**2!r}}}\n"
    )
    return a5.arm_file(path)


def test_mujoco_takes_friction_damping_and_armature(
    calibrated: Alpha5Parameters,
) -> None:
    options = MjcfOptions(arm=calibrated, collision="none", actuators="motor")
    model = mujoco.MjModel.from_xml_string(mjcf(options))
    data = mujoco.MjData(model)
    d = model.joint("axis_d").dofadr[0]
    assert model.dof_armature[d] == pytest.approx(ARMATURE, rel=1e-12)
    assert model.dof_frictionloss[d] == pytest.approx((FORWARD + BACKWARD) / 2)
    assert model.dof_damping[d] == pytest.approx(VISCOUS, rel=1e-12)
    others = np.arange(model.nv) != d
    assert not model.dof_armature[others].any()
    assert not model.dof_frictionloss[others].any()

    plain = mujoco.MjModel.from_xml_string(mjcf(MjcfOptions(collision="none")))
    assert not plain.dof_frictionloss.any()

    # The damper's force, and the rotor in the mass matrix, as MuJoCo computes them.
    data.qvel[d] = 0.3
    data.qpos[:4] = a5.named_pose("reach")
    mujoco.mj_forward(model, data)
    assert data.qfrc_damper[d] == pytest.approx(-0.3 * VISCOUS)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    ours = a5.load(arm=calibrated).mass_matrix(a5.named_pose("reach"))
    assert full[d, d] - ours[1, 1] == pytest.approx(ARMATURE, rel=1e-6)


def test_pinocchio_reads_friction_and_damping(calibrated: Alpha5Parameters) -> None:
    model = pin.buildModelFromXML(urdf(Variant(arm=calibrated)))
    d = model.joints[model.getJointId("axis_d")].idx_v
    friction = np.max([model.upperDryFrictionLimit[d]])
    assert friction == pytest.approx((FORWARD + BACKWARD) / 2, rel=1e-9)
    assert model.damping[d] == pytest.approx(VISCOUS, rel=1e-9)
    assert "<dynamics" not in urdf()


def test_sdf_has_friction_and_damping_and_says_what_it_has_not(
    calibrated: Alpha5Parameters, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = sdf(SdfOptions(arm=calibrated))
    joints = {
        joint.get("name"): joint.find("axis/dynamics")
        for joint in ET.fromstring(text).iter("joint")
    }
    friction, damping = (
        float(joints["axis_d"].findtext(name)) for name in ("friction", "damping")
    )
    assert friction == pytest.approx((FORWARD + BACKWARD) / 2, rel=1e-9)
    assert damping == pytest.approx(VISCOUS, rel=1e-9)
    assert [name for name, losses in joints.items() if losses is not None] == ["axis_d"]
    assert "<dynamics" not in sdf()

    (line,) = without_armature("SDF", calibrated)
    assert f"axis_d {ARMATURE:g} kg m^2" in line
    assert line in text
    for kind, output in (("sdf", "folder"), ("urdf", "arm.urdf"), ("mjcf", "mjcf")):
        file = str(tmp_path / "arm.toml")
        arguments = ["generate", kind, "--arm", file]
        assert main([*arguments, "--output", str(tmp_path / output)]) == 0
        said = capsys.readouterr().err
        assert ("rotor inertia" in said) == (kind != "mjcf")
    assert without_armature("SDF", a5.parameters()) == []


def test_the_motors_are_written_and_read_again(
    calibrated: Alpha5Parameters, tmp_path: Path
) -> None:
    again = tmp_path / "again.toml"
    again.write_text(arm_file_text(calibrated))
    motors = a5.arm_file(again).motors
    assert motors.backward_frictions == calibrated.motors.backward_frictions
    assert motors.viscous_frictions == calibrated.motors.viscous_frictions


def test_the_current_has_the_measured_friction(calibrated: Alpha5Parameters) -> None:
    motor = a5.actuators.actuator("axis_d", arm=calibrated, efficiency="motor")
    k_t = motor.torque_constant * motor.ratio
    current = motor.current(0.2, np.array([0.4, -0.4]))
    expected = [
        (0.2 + FORWARD + 0.4 * VISCOUS) / k_t,
        (0.2 - BACKWARD - 0.4 * VISCOUS) / k_t,
    ]
    np.testing.assert_allclose(current, expected, rtol=1e-12)
    np.testing.assert_allclose(motor.torque(current, [0.4, -0.4]), 0.2, rtol=1e-12)
    held = motor.holding_current(0.2)
    np.testing.assert_allclose(np.array(held) * k_t, [0.2 - BACKWARD, 0.2 + FORWARD])
    loads = motor.holding_torque(held.upper)
    assert loads.lower == pytest.approx(0.2)
    power = motor.power(0.2, -0.4)
    parts = [power.mechanical, power.copper, power.friction, power.gear]
    total = sum(parts) + power.rotor + power.contradiction
    assert power.electrical == pytest.approx(float(total))
