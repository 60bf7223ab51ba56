"""The arm of another model as an arm file, and the model again from that file."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
from own_arm import TOOL_AXES
from test_compare_public_models import MODELS

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError
from alpha5_model.numbers.mount import Mount
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tool import ToolPose
from alpha5_model.proofs.comparison.measure import compare, model_arm

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
#: Public models of this arm -> whether their bodies are possible.
PUBLIC = {"evan_palmer_alpha": True, "hkolano_blue_rov": True, "diff_uvms": False}


def near_arm(seed: int) -> Alpha5Parameters:
    """A random arm as a laboratory may have one: 5 mm and 10 % off, its tool tilted."""
    rng = np.random.default_rng(seed)
    printed = a5.parameters()
    rows = list(printed.dh)
    for i in range(3):
        rows[i] = dataclasses.replace(
            rows[i],
            a=rows[i].a + rng.uniform(-0.005, 0.005),
            theta_offset=rows[i].theta_offset + rng.uniform(-0.03, 0.03),
        )
    rows[0] = dataclasses.replace(rows[0], d=rows[0].d + rng.uniform(-0.005, 0.005))
    links = [
        dataclasses.replace(
            link,
            mass=link.mass * rng.uniform(0.9, 1.1),
            com=link.com + rng.uniform(-1e-3, 1e-3, 3),
            inertia=link.inertia * rng.uniform(1.0, 1.2),
        )
        for link in printed.links
    ]
    joints = [
        dataclasses.replace(
            joint,
            lower=joint.lower + rng.uniform(0.0, 0.3),
            upper=joint.upper - rng.uniform(0.0, 0.3),
            velocity=joint.velocity * rng.uniform(0.5, 1.0),
            effort=joint.effort * rng.uniform(0.1, 1.0),
        )
        for joint in printed.joints[:4]
    ]
    tilt = pin.exp3(rng.uniform(-0.1, 0.1, 3))
    tool = ToolPose(
        position=rng.uniform(-0.03, 0.03, 3) - [0.0, 0.0, 0.2],
        rotation=tilt @ TOOL_AXES,
    )
    return dataclasses.replace(
        printed,
        name=f"lab_{seed}",
        dh=tuple(rows),
        links=tuple(links),
        joints=(*joints, printed.joints[4]),
        tool=tool,
    )


def written(folder: Path, arm: Alpha5Parameters) -> Path:
    file = folder / "other.urdf"
    file.write_text(urdf(Variant(arm=arm)), encoding="utf-8")
    return file


def through_a_file(arm: Alpha5Parameters, folder: Path) -> Alpha5Parameters:
    file = folder / "arm.toml"
    file.write_text(a5.arm_file_text(arm), encoding="utf-8")
    return a5.arm_file(file)


@pytest.mark.parametrize("seed", range(10))
def test_an_arm_comes_back_from_its_urdf(seed: int, tmp_path: Path) -> None:
    arm = near_arm(seed)
    found = model_arm(written(tmp_path, arm))
    assert len(found.left_out) == 1
    assert "which a URDF does not have" in found.left_out[0]

    again = through_a_file(found.parameters, tmp_path)
    ours = a5.load(a5.AIR, arm=again)
    theirs = pin.buildModelFromUrdf(str(tmp_path / "other.urdf"))
    q, v, a = own.states(arm, 10)
    tool = theirs.getFrameId("tcp")
    for k in range(10):
        data = theirs.createData()
        torque = pin.rnea(theirs, data, q[k], v[k], a[k])
        assert ours.inverse_dynamics(q[k], v[k], a[k]) == pytest.approx(
            torque, abs=1e-12
        )
        pin.framesForwardKinematics(theirs, data, q[k])
        tip = data.oMf[tool].homogeneous
        found_tip = ours.forward_kinematics(q[k]).homogeneous
        assert found_tip == pytest.approx(tip, abs=1e-13)
    assert np.array_equal(ours.limits.lower, theirs.lowerPositionLimit)
    assert np.array_equal(ours.limits.upper, theirs.upperPositionLimit)
    assert np.array_equal(ours.limits.velocity, theirs.velocityLimit)
    assert np.array_equal(ours.limits.effort, theirs.effortLimit)


def test_a_mount_is_kept(tmp_path: Path) -> None:
    tilt = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    mount = Mount(parent="rov", position=np.array([0.2, -0.1, 0.05]), rotation=tilt)
    arm = dataclasses.replace(near_arm(3), mount=mount)
    found = model_arm(written(tmp_path, arm)).parameters.mount
    assert found is not None
    assert found.parent == "rov"
    assert found.position == pytest.approx(mount.position, abs=1e-14)
    assert found.rotation == pytest.approx(tilt, abs=1e-14)


def test_a_joint_that_turns_the_other_way_is_named(tmp_path: Path) -> None:
    text = urdf()
    place = text.index('<axis xyz="0 0 1"/>', text.index('name="axis_c"'))
    turned = text[:place] + text[place:].replace('"0 0 1"', '"0 0 -1"', 1)
    file = tmp_path / "other.urdf"
    file.write_text(turned, encoding="utf-8")
    found = model_arm(file)
    assert any("axis_c turns the other way" in line for line in found.left_out)
    joint = found.parameters.joints[2]
    printed = a5.parameters().joints[2]
    assert (joint.lower, joint.upper) == (-printed.upper, -printed.lower)


def test_a_twisted_axis_is_named(tmp_path: Path) -> None:
    text = urdf()
    start = text.index('name="axis_d"')
    place = text.index("rpy=", start)
    end = text.index('"', place + 5)
    roll, pitch, yaw = map(float, text[place + 5 : end].split())
    tilted = f'rpy="{roll + 0.01} {pitch} {yaw}'
    file = tmp_path / "other.urdf"
    file.write_text(text[:place] + tilted + text[end:], encoding="utf-8")
    found = model_arm(file)
    # The z axes are square by as much as the entry zz of the rotation is 0.
    degrees = math.degrees(math.asin(abs(math.cos(roll + 0.01) * math.cos(pitch))))
    assert any(
        f"axis_e and axis_d are {degrees:.3g} deg from square" in line
        for line in found.left_out
    )


@pytest.mark.parametrize("name", PUBLIC)
def test_public_models_are_nearly_their_arm_files(name: str, tmp_path: Path) -> None:
    file = MODELS / f"{name}.urdf"
    if not file.exists():
        pytest.skip("the public models are not here")
    found = model_arm(file)
    again = through_a_file(found.parameters, tmp_path)
    before = compare(file, samples=50)
    after = compare(file, samples=50, arm=again)
    assert after.tip_error < min(3e-5, before.tip_error / 100)
    if PUBLIC[name]:
        assert after.gravity_error.max() < 1e-5
        assert after.mass_matrix_error < 1e-5
        assert before.gravity_error.max() > 0.05
    else:
        assert any("outside the body" in line for line in found.left_out) or any(
            "COM and inertia of link_2 as printed" in line for line in found.left_out
        )


def test_compare_with_an_arm_of_ones_own(tmp_path: Path) -> None:
    for arm in (*own.RECORDS[:3], own.RECORDS[9]):
        file = written(tmp_path, arm)
        result = compare(file, samples=20, arm=arm)
        assert result.agrees, result.findings
        assert result.tip_error < 1e-12
        assert result.gravity_error.max() < 1e-12
        heavier = dataclasses.replace(arm.links[2], mass=arm.links[2].mass + 0.05)
        links = (*arm.links[:2], heavier, *arm.links[3:])
        other = dataclasses.replace(arm, links=links)
        result = compare(file, samples=20, arm=other)
        assert not result.agrees
        assert any(
            each.where == "link_2" and "mass" in each.text for each in result.findings
        )
    letter = a5.parameters(())
    with pytest.raises(InputError, match="the correction base_frame"):
        compare(file, arm=letter)


def test_the_command_writes_a_new_file_and_lists(capsys: Any, tmp_path: Path) -> None:
    arm = near_arm(2)
    file = written(tmp_path, arm)
    target = tmp_path / "mine.toml"
    words = ["compare", str(file), "--write-arm", str(target)]
    assert main([*words, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["written"] == str(target)
    assert len(said["left_out"]) == 1
    assert a5.arm_file(target).dh[1].a == pytest.approx(arm.dh[1].a, abs=1e-15)

    assert main(words) == 2
    assert "it exists" in capsys.readouterr().err
    against = ["compare", str(file), "--samples", "20", "--arm", str(target)]
    assert main(against) == 0
    assert "agrees" in capsys.readouterr().out


def test_another_arm_has_no_arm_file(capsys: Any, tmp_path: Path) -> None:
    text = urdf().replace("0.1507053084665567", "0.45")
    file = tmp_path / "other.urdf"
    file.write_text(text, encoding="utf-8")
    assert main(["compare", str(file), "--write-arm", str(tmp_path / "a.toml")]) == 2
    assert "expected a Reach Alpha 5" in capsys.readouterr().err
    assert not (tmp_path / "a.toml").exists()
