"""The verification passes the URDF of an arm of your own, and no other arm's."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.verification import verify_urdf
from alpha5_model.description.verification.own_arm import closed_links
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.pose import Pose

RECORDS = own.RECORDS
every_record = pytest.mark.parametrize("record", [RECORDS[k] for k in (1, 2, 9)])


def failed(text: str, folder: Path, arm: Alpha5Parameters | None) -> set[str]:
    """Checks that a text does not pass."""
    file = folder / "arm.urdf"
    file.write_text(text, encoding="utf-8")
    rows = verify_urdf(file, samples=20, arm=arm)
    assert any(row.verdict == "passed" for row in rows)
    return {row.check for row in rows if row.verdict == "failed"}


@pytest.mark.slow
@every_record
@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_urdf_of_a_record_passes(
    record: Alpha5Parameters, gripper: str, tmp_path: Path
) -> None:
    options: dict[str, Any] = {"gripper": gripper, "dh_frames": True}
    prefixed = urdf(Variant(arm=record, prefix="left_", **options))
    assert failed(prefixed, tmp_path, record) == set()


@every_record
def test_the_sums_are_those_of_the_bodies_one_by_one(record: Alpha5Parameters) -> None:
    for total, bodies in zip(closed_links(record), own.bodies_of(record), strict=True):
        expected = np.zeros((4, 4))
        for body in bodies:
            c = np.append(body.com, 1.0)
            expected += body.mass * np.outer(c, c)
            half_trace = np.trace(body.tensor) / 2
            expected[:3, :3] += half_trace * np.eye(3) - body.tensor
        assert total == pytest.approx(expected, abs=1e-15)


def test_the_catalogues_urdf_is_not_that_of_a_record(tmp_path: Path) -> None:
    found = failed(urdf(), tmp_path, RECORDS[1])
    assert found == {"joints", "inertias", "frames, Pinocchio", "frames, yourdfpy"}
    assert failed(urdf(), tmp_path, parameters()) == set()


def _with_mass(arm: Alpha5Parameters) -> Alpha5Parameters:
    heavier = dataclasses.replace(arm.links[1], mass=arm.links[1].mass + 1e-6)
    return dataclasses.replace(arm, links=(arm.links[0], heavier, *arm.links[2:]))


def _with_tool(arm: Alpha5Parameters) -> Alpha5Parameters:
    assert arm.tool is not None
    moved = np.add(arm.tool.position, [1e-10, 0.0, 0.0])
    tool = Pose(moved, arm.tool.rotation)
    return dataclasses.replace(arm, tool=tool)


def _with_limit(arm: Alpha5Parameters) -> Alpha5Parameters:
    joint = dataclasses.replace(arm.joints[2], effort=arm.joints[2].effort + 1e-9)
    joints = (*arm.joints[:2], joint, *arm.joints[3:])
    return dataclasses.replace(arm, joints=joints)


def _with_mount(arm: Alpha5Parameters) -> Alpha5Parameters:
    assert arm.mount is not None
    moved = np.add(arm.mount.position, [0.0, 1e-9, 0.0])
    mount = Pose(moved, arm.mount.rotation, arm.mount.parent)
    return dataclasses.replace(arm, mount=mount)


FRAMES = {"frames, Pinocchio"}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (_with_mass, {"inertias"}),
        (_with_tool, FRAMES),
        (_with_limit, {"joints"}),
        (_with_mount, {"mount"}),
        (lambda arm: dataclasses.replace(arm, attached=arm.attached[1:]), None),
    ],
)
def test_each_difference_is_found(
    change: Any, expected: set[str] | None, tmp_path: Path
) -> None:
    record = dataclasses.replace(RECORDS[2], mount=own.random_mount(2))
    text = urdf(Variant(arm=change(record)))
    assert failed(text, tmp_path, record) == (expected or {"inertias"})


@pytest.mark.slow
def test_a_missing_mount_is_found(tmp_path: Path) -> None:
    record = RECORDS[9]
    bare = urdf(Variant(arm=dataclasses.replace(record, mount=None)))
    assert failed(bare, tmp_path, record) == {"mount"}
    elsewhere = urdf(Variant(arm=record, parent="table"))
    assert failed(elsewhere, tmp_path, record) == {"mount"}


def test_moving_jaws_of_another_link_4_are_found(tmp_path: Path) -> None:
    record = RECORDS[1]
    spacer = dataclasses.replace(record.attached[0], spacer=record.spacer + 1e-6)
    attached = (spacer, *record.attached[1:])
    longer = dataclasses.replace(record, tool=None, attached=attached)
    text = urdf(Variant(arm=longer, gripper="jaws"))
    assert failed(text, tmp_path, record) == {"closed jaws", "frames, Pinocchio"} | {
        "frames, yourdfpy"
    }


def test_other_corrections_than_the_records_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no corrections beside an arm"):
        verify_urdf(a5.URDF_PATH, ("link3_cob",), arm=RECORDS[1])


EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"


@pytest.mark.slow
def test_the_command_checks_against_the_file(tmp_path: Path, capsys: Any) -> None:
    file = str(tmp_path / "lab.urdf")
    arm = ["--arm", str(EXAMPLE)]
    assert main(["generate", *arm, "--mesh-uri", "package", "--output", file]) == 0
    assert main(["check", "--urdf", file, *arm]) == 0
    assert "lab.urdf: 9 passed" in capsys.readouterr().out
    assert main(["check", "--urdf", file]) == 1
    assert main(["check", *arm]) == 2
    assert "arm: expected a file to check, --urdf FILE" in capsys.readouterr().err
