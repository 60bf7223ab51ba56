"""``alpha5 demo``: what it says is true, and it fails when it should."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from demo_run import demo_run
from reference import configurations, inertial_frames
from urdf_edits import with_mass

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description import urdf as variants

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


@pytest.mark.slow
def test_the_demo_prints_what_it_made() -> None:
    folder, said = demo_run()
    for name in (
        "alpha5.urdf",
        "alpha5_jaws.urdf",
        "alpha5.html",
        "alpha5.png",
        "meshes/link_4.obj",
    ):
        assert (folder / name).stat().st_size > 1000, name
        assert name.split("/")[0] in said
    assert said.count("The model agrees with the tables.") == 2
    assert said.strip().splitlines()[-1].startswith("Open ")


@pytest.mark.parametrize("branch", a5.BRANCHES)
def test_the_printed_angles_bring_the_tcp_to_the_printed_target(branch: str) -> None:
    _, said = demo_run()
    lines = said.splitlines()
    (line,) = [line for line in lines if line.strip().startswith(branch + " ")]
    target = re.search(r"tcp at \((.*?)\) mm", said)[1]
    q = [float(x) for x in line.split()[1:5]]
    reached = a5.load().forward_kinematics(q).translation
    expected = np.array(target.split(","), float) / 1e3
    np.testing.assert_allclose(reached, expected, atol=1e-4)


def test_the_printed_torques_are_weight_less_buoyancy() -> None:
    _, said = demo_run()
    table = {}
    for line in said.splitlines():
        name, *numbers = line.split() or [""]
        if name in JOINTS:
            table[name] = [float(number) for number in numbers]
    weight, lift, water, air = np.array([table[name] for name in JOINTS]).T
    np.testing.assert_allclose(weight - lift, water, atol=1.1e-4)
    np.testing.assert_allclose(weight, air, atol=1e-9)
    assert np.abs(water).max() > 0.1


@pytest.mark.parametrize("name", ["alpha5.urdf", "alpha5_jaws.urdf"])
def test_the_files_it_wrote_load_where_they_lie(name: str) -> None:
    folder, _ = demo_run()
    model = pin.buildModelFromUrdf(str(folder / name))
    visual = pin.buildGeomFromUrdf(
        model, str(folder / name), pin.GeometryType.VISUAL, package_dirs=[str(folder)]
    )
    assert visual.ngeoms == 7
    data = model.createData()
    for angles in configurations(20, seed=4):
        q = pin.neutral(model)
        q[:4] = angles
        pin.framesForwardKinematics(model, data, q)
        for i, frame in enumerate(inertial_frames(angles)):
            found = data.oMf[model.getFrameId(f"link_{i}")].homogeneous
            np.testing.assert_allclose(found, frame, atol=1e-12)


@pytest.mark.slow
def test_a_wrong_description_fails_the_demo(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = variants.urdf
    monkeypatch.setattr(
        variants,
        "urdf",
        lambda variant: with_mass(right(variant), "0.83"),
    )
    assert main(["demo", "--output", str(tmp_path)]) == 1
    assert "The model differs" in capsys.readouterr().out


def test_a_folder_that_cannot_be_written_ends_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    blocker = tmp_path / "file"
    blocker.write_text("x")
    assert main(["demo", "--output", str(blocker)]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("alpha5: cannot write")
    assert errors.count("\n") == 1
