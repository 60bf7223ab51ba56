"""``alpha5 move``: what it writes, other commands and MuJoCo can play."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from fk import tip

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.planning import plan

SCENE = "[post]\ncylinder = [0.03, 1.0]\nxyz = [0.22, 0.15, 0.0]\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE, "utf-8")
    return tmp_path


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert main(["move", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.usefixtures("folder")
def test_the_file_is_the_plan(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("home", "0.2", "0.1", "0.1", "--output", "motion.csv")
    found = answer(capsys, *words)
    motion = plan(a5.named_pose("home"), [0.2, 0.1, 0.1])
    assert found["duration_s"] == motion.duration
    assert found["way"] == motion.way.tolist()
    assert found["tcp"][1] == pytest.approx([0.2, 0.1, 0.1])
    read = a5.trajectory.read_motion("motion.csv")
    assert np.array_equal(read.position, motion.position)
    assert np.array_equal(read.velocity, motion.velocity)
    assert np.array_equal(read.time, motion.time)


@pytest.mark.usefixtures("folder")
def test_other_commands_take_the_file(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "home", "0.2", "0.1", "0.1", "--output", "motion.csv")
    command = ["trajectory", "motion.csv", "--smoothing", "interpolate", "--json"]
    assert main(command) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["warnings"] == []
    for peak in found["peaks"]:
        if peak["quantity"] == "torque":
            joint = summary["joints"][peak["joint"]]
            assert abs(joint["torque_peak"]["value"]) == pytest.approx(peak["value"])
    page = ["view", "--motion", "motion.csv", "--gripper", "locked"]
    assert main([*page, "--html", "page.html"]) == 0
    assert Path("page.html").stat().st_size > 10_000


@pytest.mark.usefixtures("folder")
def test_mujoco_plays_the_file(capsys: pytest.CaptureFixture[str]) -> None:
    mujoco = pytest.importorskip("mujoco")
    answer(capsys, "home", "0.2", "0.1", "0.1", "--output", "motion.csv")
    table = np.genfromtxt("motion.csv", delimiter=",", names=True)
    model = mujoco.MjModel.from_xml_path(
        str(Path(a5.REPOSITORY_PATH) / "mjcf/alpha5.xml")
    )
    data = mujoco.MjData(model)
    joints = ["axis_e", "axis_d", "axis_c", "axis_b"]
    for row in table[:: len(table) // 5]:
        q = np.array([row[f"{joint}_pos"] for joint in joints])
        for joint, angle in zip(joints, q, strict=True):
            data.joint(joint).qpos = angle
        mujoco.mj_kinematics(model, data)
        assert data.site("tcp").xpos == pytest.approx(tip(q), abs=1e-9)


@pytest.mark.usefixtures("folder")
def test_places_and_options(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "3.1,1.2,1.8,0", "reach")
    assert found["way"] == [[3.1, 1.2, 1.8, 0.0], a5.named_pose("reach").tolist()]
    found = answer(capsys, "home", "180deg", "90deg", "100deg", "0")
    assert found["way"][-1] == pytest.approx(
        [math.pi, math.pi / 2, math.radians(100), 0]
    )
    found = answer(capsys, "home", "-0.01", "-200mm", "0.2", "--wrist", "90deg")
    assert found["tcp"][1] == pytest.approx([-0.01, -0.2, 0.2])
    slow = answer(capsys, "home", "reach", "--speed", "0.1", "--acceleration", "0.2")
    speeds = [p["value"] for p in slow["peaks"] if p["quantity"] == "speed"]
    assert max(speeds) == pytest.approx(0.1)

    words = ["--speed", f"{np.degrees(0.1)}deg", "--acceleration", "0.2"]
    in_degrees = answer(capsys, "home", "reach", *words)
    assert in_degrees["duration_s"] == pytest.approx(slow["duration_s"])
    limited = answer(
        capsys, "home", "reach", "--supply-voltage", "8", "--current-limit", "1"
    )
    assert limited["slowed"] > 1.0


@pytest.mark.usefixtures("folder")
def test_obstacles_of_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("4.5", "1.5", "2.6", "1.5", "2.9", "1.5", "2.6", "1.5")
    assert answer(capsys, *words)["kind"] == "straight"
    found = answer(capsys, *words, "--obstacles", "scene.toml")
    assert found["kind"] == "by retracted poses"
    assert len(found["way"]) > 2
    # At a margin of 0.2 m the post is everywhere.
    options = ("--obstacles", "scene.toml", "--margin", "200mm")
    assert main(["move", *words, *options]) == 2
    assert "post and link_" in capsys.readouterr().err


@pytest.mark.usefixtures("folder")
def test_waypoints_of_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    Path("points.csv").write_text("x [mm],y [mm],z [mm]\n200,100,100\n150,200,100\n")
    through = ("home", "--through", "points.csv")
    found = answer(capsys, *through, "--bus", "bus.csv", "-o", "m.yaml")
    assert [stop["place"] for stop in found["stops"]] == [
        *("points.csv, line 2", "points.csv, line 3")
    ]
    for stop, point in zip(
        found["stops"], [[0.2, 0.1, 0.1], [0.15, 0.2, 0.1]], strict=True
    ):
        assert tip(np.array(stop["q"])) == pytest.approx(point, abs=1e-9)
    bus = np.genfromtxt("bus.csv", delimiter=",", names=True)
    assert bus["device_4_rad"][-1] == pytest.approx(found["way"][-1][1])
    # The written message is a file of waypoints, with the same way.
    again = answer(capsys, "home", "reach", "--through", "m.yaml")
    assert again["stops"][-2]["q"] == pytest.approx(found["way"][-1])
    assert again["stops"][-1]["q"] == a5.named_pose("reach").tolist()

    lines = ["x,y,z,roll,pitch,yaw", "0.2,0.1,0.1,0,90,0"]
    Path("poses.csv").write_text("\n".join(lines))
    assert main(["move", "home", "--through", "poses.csv", "--degrees"]) == 0
    assert "turned by" in capsys.readouterr().out
    assert main(["move", "home", "--through", "points.csv", "--line"]) == 2
    assert "through" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("home",), "two places"),
        (("home", "there"), "two places"),
        (("1", "2", "3"), "two places"),
        (("home", "reach", "stow"), "two places"),
        (("home", "1", "1", "1"), "cannot be reached"),
        (("home", "reach", "--obstacles", "none.toml"), "no such file"),
        (("home", "reach", "--output", "motion.txt"), "unknown format for --output"),
        (("home", "reach", "--obstacles", "scene.toml", "-o", "scene.toml"), "unknown"),
        (("home", "--through", "scene.toml"), "axis_e to axis_b, or x, y, z"),
        (("home", "--through", "none.csv"), "no such file"),
        (("home", "reach", "--degrees"), "degrees: expected no value without --thr"),
        (("home", "reach", "--prefix", "left_"), "prefix: expected no value without"),
        (("home", "reach", "--map", "axis_e=j1"), "map: expected no value without"),
        (("home", "reach", "--bus", "bus.yaml"), "unknown format for --bus"),
        (("home", "reach", "--speed", "0"), "speed: expected one number above 0"),
        (("home", "reach", "--speed", "fast"), "expected one number (rad/s), got"),
        (("home", "reach", "--supply-voltage", "24"), "both or neither"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_mistakes_are_one_line(
    words: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["move", *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.usefixtures("folder")
def test_an_arm_of_ones_own(capsys: pytest.CaptureFixture[str]) -> None:
    text = "format = 1\n[motors]\nsupply_voltage = 6.0\ncurrent_limit = 1.0\n"
    Path("my_arm.toml").write_text(text, "utf-8")
    assert answer(capsys, "home", "reach", "--arm", "my_arm.toml")["slowed"] > 1.0


def test_the_torque_that_public_models_copy_is_no_limit(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def after_torque(*words: str) -> list[str]:
        assert main(["move", "home", "0.2", "0.1", "0.1", *words]) == 0
        lines = capsys.readouterr().out.splitlines()
        at = next(k for k, line in enumerate(lines) if line.startswith("torque"))
        return lines[at + 1].split()

    assert after_torque() == ["placeholder", "9", "9", "9", "9"]
    effort = '[joint_limits.axis_d]\nmax_effort = {value = 7, unit = "Nm"}\n'
    (folder / "own.toml").write_text(f"format = 1\n{effort}", "utf-8")
    assert after_torque("--arm", "own.toml") == ["limit", "9", "7", "9", "9"]
