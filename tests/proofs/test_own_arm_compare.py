"""Comparison with an arm of your own, and the arm file of another model."""

from __future__ import annotations

import dataclasses
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
import shared_recordings as recordings
from compared_models import compared
from compared_models import described as described_arm
from own_arm import mount_pose
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.as_arm import ArmOfModel, arm_of_model, arm_text

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
MODELS = recordings.RECORDINGS / "models"


def read_back(described: ArmOfModel, folder: Path) -> Alpha5Parameters:
    """The record that the written file describes."""
    file = folder / "mine.toml"
    file.write_text(arm_text(described, "other.urdf"), encoding="utf-8")
    return a5.arm_file(file)


@pytest.mark.parametrize("k", [1, 2, 9])
def test_an_arm_comes_back_from_its_urdf(k: int, tmp_path: Path) -> None:
    """Kinematics and dynamics in air are Newton's of the record that made the URDF."""
    record = own.RECORDS[k]
    described = described_arm(urdf(Variant(arm=record)))
    back = read_back(described, tmp_path)
    q, v, a = own.states(record, 5)
    arm = a5.load(0.0, arm=back)
    gravity = mount_pose(record)[:3, :3].T @ [0.0, 0.0, -9.81]
    tau, _ = own.inverse_dynamics(record, q, v, a, 0.0, gravity)
    assert arm.inverse_dynamics_batch(q, v, a) == pytest.approx(tau, abs=1e-11)
    for row in q:
        tip = mount_pose(back) @ arm.forward_kinematics(row).homogeneous
        expected = mount_pose(record) @ own.tcp(record, row)
        assert tip == pytest.approx(expected, abs=1e-12)
        matrix = own.mass_matrix(record, row)
        assert arm.mass_matrix(row) == pytest.approx(matrix, abs=1e-11)
    # base_link stays where the model has it, and does not move along the yaw axis.
    assert back.dh[0].d == pytest.approx(record.dh[0].d, abs=1e-12)
    for ours, theirs in zip(record.joints[:4], back.joints[:4], strict=True):
        assert vars(ours) == pytest.approx(vars(theirs), abs=1e-12)


def test_the_catalogues_urdf_gives_the_catalogues_arm(tmp_path: Path) -> None:
    described = arm_of_model(a5.URDF_PATH)
    text = arm_text(described, "alpha5.urdf")
    tables = [line for line in text.splitlines() if line.startswith("[")]
    assert tables == []
    assert "which no URDF has" in text


def edited(joint: str, written: str, instead: str) -> ArmOfModel:
    """The arm of the catalogue's URDF with one attribute of a joint changed."""
    before, name, after = OWN.partition(f'<joint name="{joint}"')
    assert written in after
    text = before + name + after.replace(written, instead, 1)
    return described_arm(text)


def assert_lengths_of_the_catalogue(record: Alpha5Parameters) -> None:
    for row, printed in zip(record.dh, a5.parameters().dh, strict=True):
        assert [row.d, row.a] == pytest.approx([printed.d, printed.a], abs=1e-12)


@pytest.mark.parametrize("joint", ["axis_e", "axis_c"])
def test_a_reversed_axis_leaves_the_lengths(joint: str) -> None:
    described = edited(joint, '<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>')
    assert_lengths_of_the_catalogue(described.record)


def test_an_axis_beside_the_plane_is_left_out_of_the_file() -> None:
    described = edited("axis_b", 'xyz="0.02 0.0 0.0"', 'xyz="0.02 0.0 0.003"')
    assert described.left_out[0] == "axis_b stands 3 mm beside the plane of the arm"
    assert_lengths_of_the_catalogue(described.record)


def test_the_name_of_an_arm_starts_with_a_letter() -> None:
    named = OWN.replace('<robot name="alpha5"', '<robot name="5th/arm"')
    assert described_arm(named).record.name == "arm_5th_arm"


@pytest.mark.parametrize("k", [1, 9])
def test_a_model_of_your_arm_agrees_with_it_alone(k: int) -> None:
    record = own.RECORDS[k]
    robot = urdf(Variant(arm=record))
    found = compared(robot, samples=50, arm=record)
    assert found.agrees, [one.text for one in found.findings if one.serious]
    assert found.verdict == f"The model agrees with {record.name}."
    assert found.tip_error < 1e-9
    assert found.gravity_error.max() < 1e-9
    assert found.mass_matrix_error < 1e-9
    assert not compared(robot, samples=50).agrees


def test_an_arm_to_the_letter_is_refused() -> None:
    """Its link_0 is turned, and the numbers of link_0 are compared in base_link."""
    with pytest.raises(InputError, match="with the correction base_frame"):
        compared(OWN, arm=own.RECORDS[8])


def changed_urdf(*changes: tuple[str, str]) -> str:
    """Our URDF with other attributes, everywhere."""
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    for pattern, new in changes:
        text, count = re.subn(pattern, new, text)
        assert count, pattern
    return text


#: A change of our URDF, what the arm file says of it, and the field that stays.
UNSAYABLE = [
    ((r' velocity="[^"]+"', ' velocity="100"'), "axis_e has a largest velocity of 100"),
    ((r' effort="[^"]+"', ' effort="1000"'), "axis_b has a largest effort of 1000"),
    (
        (r'lower="[^"]+" upper="[^"]+"', 'lower="300" upper="302"'),
        "from 300 to 302 rad",
    ),
    ((r'lower="[^"]+" upper="[^"]+"', 'lower="0" upper="7"'), "a range of 401.1 deg"),
    ((r'<mass value="[^"]+"', '<mass value="30"'), "link_2 has 30 kg"),
    ((r'<mass value="[^"]+"', '<mass value="0"'), "(no mass)"),
    (
        (r'(<inertial>\s*<origin rpy="0 0 0" xyz=")[^"]+"', r'\g<1>0 0 3"'),
        "link_1 has its COM 3 m off",
    ),
]


@pytest.mark.parametrize(("change", "said"), UNSAYABLE)
def test_what_no_arm_file_takes_is_as_printed_and_listed(
    change: tuple[str, str], said: str, tmp_path: Path
) -> None:
    """Velocities of 100 and efforts of 1000 are what exporters write for 'any'."""
    described = described_arm(changed_urdf(change))
    listed = [text for text in described.left_out if said in text]
    assert listed, described.left_out
    assert all(text.endswith("is kept") for text in listed)
    back = read_back(described, tmp_path)
    for ours, theirs in zip(a5.parameters().joints, back.joints, strict=True):
        assert vars(theirs) == pytest.approx(vars(ours), abs=1e-9)
    for body, own_body in zip(a5.parameters().links, back.links, strict=True):
        assert own_body.mass == pytest.approx(body.mass)
        assert own_body.com == pytest.approx(body.com)


def test_a_com_outside_its_link_is_written_with_a_warning(tmp_path: Path) -> None:
    """A link lost 99 % of its mass to a body beside it, and another was replaced."""
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    com = "0.0736 -0.0709 -0.0007"
    text = text.replace("0.073563 -9.1e-05 -0.000734", com)
    described = described_arm(text)
    back = read_back(described, tmp_path)
    assert back.links[2].mass == a5.parameters().links[2].mass
    assert back.links[2].com == pytest.approx([0.0736, -0.0709, -0.0007])
    assert back.attached == ()
    (said,) = [note for note in described.left_out if note.startswith("warning")]
    assert "link_2 has its COM outside the link" in said


def test_a_wrist_that_is_kept_is_said_with_its_own_numbers() -> None:
    """A link of 0.333 kg was said to have 0.000355."""
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    text = text.replace("-3e-05 -0.001482 -0.100881", "0 0 0.065")
    described = described_arm(text)
    (said,) = [note for note in described.left_out if "is kept" in note]
    assert "link_4 has 0.355 kg with its COM at (0.0, 0.0, 65.0) mm" in said


def test_the_notes_of_a_model_stay_in_the_comments(tmp_path: Path) -> None:
    """Names with line ends wrote tables into the file of somebody else's arm."""
    described = described_arm(OWN)
    described = described._replace(left_out=("x\n[links.link_2]\nmass = 3",))
    back = read_back(described, tmp_path)
    assert back.links[2].mass == a5.parameters().links[2].mass


def changed_link(record: Alpha5Parameters) -> Alpha5Parameters:
    """The record with link 2 heavier by 20 g."""
    link = dataclasses.replace(record.links[2], mass=record.links[2].mass + 0.02)
    links = (*record.links[:2], link, *record.links[3:])
    return dataclasses.replace(record, links=links)


def test_a_difference_from_your_arm_is_found() -> None:
    record = own.RECORDS[0]
    robot = urdf(Variant(arm=changed_link(record)))
    found = compared(robot, samples=50, arm=record)
    wrong = [one for one in found.findings if one.serious]
    assert {one.where for one in wrong} == {"link_2"}
    assert found.bodies[2].mass_error == pytest.approx(0.02)
    arm = a5.load(0.0, arm=record)
    other = a5.load(0.0, arm=changed_link(record))
    q = np.random.default_rng(0).uniform(
        [joint.lower for joint in record.joints[:4]],
        [joint.upper for joint in record.joints[:4]],
        (50, 4),
    )
    still = np.zeros_like(q)
    torques = [one.inverse_dynamics_batch(q, still, still) for one in (arm, other)]
    worst = np.abs(torques[1] - torques[0]).max(axis=0)
    assert found.gravity_error == pytest.approx(worst, abs=1e-9)


def with_whole_multiples_of_pi(rpy: re.Match[str]) -> str:
    angles = []
    for angle in map(float, rpy[0].split()):
        whole = round(angle / math.pi * 12) * math.pi / 12
        angles.append(whole if abs(angle - whole) < 1e-4 else angle)
    return " ".join(map(repr, angles))


@pytest.mark.skipif(not MODELS.is_dir(), reason="no public models beside the checkout")
@pytest.mark.parametrize(
    "name", ["evan_palmer_alpha.urdf", "hkolano_blue_rov.urdf", "diff_uvms.urdf"]
)
def test_public_models_come_back(name: str, tmp_path: Path) -> None:
    """Axes, tool, gravity torques and mass matrix of the model as it is meant."""
    described = arm_of_model(MODELS / name)
    back = read_back(described, tmp_path)
    text = (MODELS / name).read_text()
    text = re.sub(r'(?<=rpy=")[^"]+', with_whole_multiples_of_pi, text)
    full = pin.buildModelFromXML(text)
    joints = a5.compare(MODELS / name, samples=1).joints
    four = [full.getJointId(joint) for joint in joints.values()]
    rest = np.clip(pin.neutral(full), full.lowerPositionLimit, full.upperPositionLimit)
    frozen = [k for k in range(1, full.njoints) if k not in four]
    model = pin.buildReducedModel(full, frozen, rest)
    data = model.createData()
    sign = np.array(
        [
            -1.0
            if any(t.startswith(f"axis_{x} turns") for t in described.left_out)
            else 1.0
            for x in "edcb"
        ]
    )
    arm = a5.load(0.0, arm=back)  # its mount turns gravity
    kept = [text for text in described.left_out if "printed one is kept" in text]
    # One model's COM of link 4 is on the other side, which leaves no wrist.
    assert len(kept) == (name == "diff_uvms.urdf")
    still = np.zeros(4)
    for q in np.random.default_rng(0).uniform(-2, 2, (20, 4)):
        if not kept:
            torque = pin.computeGeneralizedGravity(model, data, sign * q) * sign
            found = arm.inverse_dynamics_batch(q[None], still[None], still[None])[0]
            assert found == pytest.approx(torque, abs=1e-9)
            matrix = pin.crba(model, data, sign * q) * np.outer(sign, sign)
            assert arm.mass_matrix(q) == pytest.approx(matrix, abs=1e-9)
        pin.forwardKinematics(model, data, sign * q)
        turned = mount_pose(back)[:3, :3] @ arm.jacobian(q)[3:]
        jacobian = pin.computeJointJacobian(model, data, sign * q, 4)
        theirs = data.oMi[4].rotation @ jacobian[3:] * sign
        assert turned == pytest.approx(theirs, abs=1e-9)


def test_the_command_writes_a_file_once(tmp_path: Path, capsys: Any) -> None:
    model = tmp_path / "lab.urdf"
    model.write_text(urdf(Variant(arm=a5.arm_file(EXAMPLE))), encoding="utf-8")
    file = tmp_path / "mine.toml"
    words = ["compare", str(model), "--samples", "20", "--write-arm", str(file)]
    assert main([*words, "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert any("no URDF has" in text for text in record["arm_file"]["left_out"])
    back = a5.arm_file(file)
    assert back.links[2].mass == pytest.approx(0.341)
    assert back.joints[0].effort == 1.5
    assert back.mount is not None

    written = file.read_bytes()
    assert main(words) == 2
    assert "it exists; name another file" in capsys.readouterr().err
    assert file.read_bytes() == written

    words = ["compare", str(model), "--samples", "20", "--arm"]
    assert main([*words, str(EXAMPLE)]) == 0
    assert "agrees with alpha5_lab_2" in capsys.readouterr().out
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("format = 1\n[links.link_2]\nmass = -1\n", encoding="utf-8")
    assert main([*words, str(wrong)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
