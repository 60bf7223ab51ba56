"""``--arm FILE``: what commands say of an arm of one's own is what Python computes."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import generate, main
from alpha5_model.collision.self_collision import without_self_collision
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.kinematics import workspace

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
Q = [3.1, 1.2, 1.8, 0.2]


def answer(capsys: Any, *words: str, arm: Path = EXAMPLE) -> Any:
    assert main([*words, "--arm", str(arm), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def with_a_motor(folder: Path) -> Path:
    """The catalogue's arm with masses, a mount and motors of its own."""
    file = folder / "mine.toml"
    file.write_text(
        'format = 1\nname = "mine"\n'
        '[mount]\nparent = "rov"\nrpy = {value = [180, 0, 0], unit = "deg"}\n'
        '[links.link_2]\nmass = {value = 400, unit = "g"}\n'
        '[motors]\nconstants = "torque"\nrotor_inertia = {axis_d = 5e-6}\n',
        encoding="utf-8",
    )
    return file


def test_fk_and_ik_are_of_the_file(capsys: Any) -> None:
    record = a5.arm_file(EXAMPLE)
    frames = answer(capsys, "fk", *map(str, Q))["frames"]
    expected = a5.load(arm=record).forward_kinematics(Q).homogeneous
    assert np.array(frames["tcp"]) == pytest.approx(expected, abs=1e-15)

    target = expected[:3, 3]
    found = answer(capsys, "ik", *map(str, target), "--wrist", str(Q[3]))
    solved = a5.inverse_kinematics(target, Q[3], arm=record)
    for i, branch in enumerate(found["branches"]):
        assert branch["exists"] == solved.exists[i]
        assert branch["within_limits"] == solved.within_limits[i]
        if branch["exists"]:
            assert branch["q"] == pytest.approx(solved.q[i], abs=1e-12)
    assert any(
        np.allclose(branch["q"], Q, atol=1e-9)
        for branch in found["branches"]
        if branch["exists"]
    )


@pytest.mark.slow
def test_torque_has_the_masses_mount_and_motors_of_the_file(
    capsys: Any, tmp_path: Path
) -> None:
    file = with_a_motor(tmp_path)
    words = ["torque", "--q", "3.1 1.2 1.8 0.2", "--v", "0 0.2 0 0", "--a", "0 3 0 0"]
    found = answer(capsys, *words, arm=file)
    arm = a5.load(arm=a5.arm_file(file))
    torque = arm.inverse_dynamics(Q, [0, 0.2, 0, 0], [0, 3, 0, 0])
    assert [joint["torque"] for joint in found["joints"]] == pytest.approx(torque)
    assert found["gravity"] == pytest.approx([0.0, 0.0, 9.81])
    assert found["constants"] == "torque"

    shoulder = a5.actuators.actuator("axis_d", "torque", rotor_inertia=5e-6)
    with_rotor = shoulder.current(torque[1], 0.2, 3.0)
    without = shoulder.current(torque[1], 0.2)
    assert abs(with_rotor - without) > 0.01
    assert found["joints"][1]["current"] == pytest.approx(with_rotor)


def test_options_win_over_the_file(capsys: Any, tmp_path: Path) -> None:
    words = ["torque", "--q", "3.1 1.2 1.8 0.2", "--mount", "0 0 0"]
    options = ["--constants", "voltage"]
    found = answer(capsys, *words, *options, arm=with_a_motor(tmp_path))
    assert found["gravity"] == [0.0, 0.0, -9.81]
    assert found["constants"] == "voltage"


def test_the_workspace_is_that_of_the_file(capsys: Any) -> None:
    record = a5.arm_file(EXAMPLE)
    found = answer(capsys, "workspace")
    assert found["volume"] == workspace.volume(arm=record)
    assert found["volume"] > 1.05 * workspace.volume()
    assert len(found["boundary"]["both"]) == len(workspace.boundary(arm=record))
    assert "published_tori" not in found

    assert main(["workspace", "--arm", str(EXAMPLE)]) == 0
    assert f"{1e3 * found['volume']:.3f} L" in capsys.readouterr().out


def test_the_urdf_is_that_of_the_file(capsys: Any) -> None:
    assert main(["generate", "urdf", "--arm", str(EXAMPLE)]) == 0
    written = capsys.readouterr().out
    assert written == urdf(Variant(arm=a5.arm_file(EXAMPLE), mesh_prefix="meshes/"))


#: Formats that no mount changes, and why.
WITHOUT_A_MOUNT = {
    "srdf": "groups, named poses and pairs of links are the arm's own",
    "moveit": "the same, with limits of the joints",
    "water": "volumes and drag are in the frames of the links",
}


@pytest.mark.slow
def test_each_format_is_on_the_mount_of_the_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Two arms that differ in the mount alone, and have the same name."""
    file = tmp_path / "mine.toml"
    mount = 'format = 1\nname = "mine"\n[mount]\nparent = "rov"\n'
    # The formats of the command are no public name.
    formats = generate._FORMATS
    texts: dict[str, list[str]] = {form: [] for form in formats}
    for height in (0.3, 0.4):
        tilt = f"xyz = [0.1, 0.2, {height}]\nrpy = [{height}, 0.0, 0.0]\n"
        file.write_text(mount + tilt, "utf-8")
        for form in formats:
            assert main(["generate", form, "--arm", str(file)]) == 0
            texts[form].append(capsys.readouterr().out)
    unchanged = {form for form, (one, other) in texts.items() if one == other}
    assert unchanged == set(WITHOUT_A_MOUNT)


@pytest.mark.parametrize(
    "words",
    [
        ["ik", "0.2", "0", "0.1"],
        ["fk", "3", "1", "1", "0"],
        ["torque", "--q", "3 1 1 0"],
        ["workspace"],
        ["dh"],
        ["generate", "urdf"],
    ],
)
def test_a_wrong_file_is_one_line(
    capsys: Any, tmp_path: Path, words: list[str]
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text("format = 1\n[links.link_2]\nmass = -1\n", encoding="utf-8")
    assert main([*words, "--arm", str(file)]) == 2
    said = capsys.readouterr().err
    assert "mine.toml, links.link_2.mass: " in said
    assert said.count("\n") == 1


@pytest.mark.slow
def test_the_workspace_is_drawn_and_tried_for_collision(
    capsys: Any, tmp_path: Path
) -> None:
    picture = tmp_path / "workspace.png"
    words = ["workspace", "--arm", str(EXAMPLE)]
    assert main([*words, "--plot", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()

    tried = answer(capsys, "workspace", "--self-collision", "--samples", "200")
    share = tried["without_self_collision"]
    record = a5.arm_file(EXAMPLE)
    free = partial(without_self_collision, arm=record)
    expected = workspace.sampled_share(free, 200, arm=record)
    assert share["share"] == expected.share
    assert 0.5 < share["share"] < 1.0

    both = [*words, "--self-collision", "--plot", str(picture)]
    assert main(both) == 2
    assert "no --plot beside --self-collision" in capsys.readouterr().err


def test_the_dh_table_is_that_of_the_file(capsys: Any) -> None:
    record = a5.arm_file(EXAMPLE)
    found = answer(capsys, "dh", *map(str, Q))
    expected = a5.load(arm=record).forward_kinematics(Q).homogeneous
    assert np.array(found["frames"]["tool"]) == pytest.approx(expected, abs=1e-14)
    assert found["links"][0]["lower"] == record.joints[0].lower
    assert main(["dh", "--arm", str(EXAMPLE), "--link", "0 0 1 0 0"]) == 2
    assert "--link and --arm: expected one of them" in capsys.readouterr().err
