"""The examples run, are short and documented, and print what is true."""

from __future__ import annotations

import re
import runpy
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from coal_world import CoalWorld
from pages import DOCS, REPOSITORY
from reference import dh_frames

import alpha5_model as a5
from alpha5_model.errors import BlockedMotionError

EXAMPLES = sorted((REPOSITORY / "examples").glob("*.py"))
NUMBER = r"-?\d+\.?\d*(?:e[-+]?\d+)?"


def said(name: str, capsys: pytest.CaptureFixture[str]) -> str:
    """What an example prints."""
    runpy.run_path(str(REPOSITORY / "examples" / f"{name}.py"), run_name="__main__")
    return capsys.readouterr().out


def numbers(text: str) -> np.ndarray:
    """The numbers of a line."""
    return np.array(re.findall(NUMBER, text), float)


def test_each_example_is_shown() -> None:
    page = (DOCS / "examples.md").read_text("utf-8")
    shown = re.findall(r"\{literalinclude\} \.\./examples/(\w+\.py)", page)
    assert sorted(shown) == [path.name for path in EXAMPLES]


def test_gravity_compensation(capsys: pytest.CaptureFixture[str]) -> None:
    lines = said("gravity_compensation", capsys).splitlines()
    nothing, weight, both = (numbers(line[23:]) for line in lines[1:])
    assert np.abs(both).max() < 0.01
    # Without compensation the shoulder sinks below its goal.
    # With the weight alone compensated it floats above its goal.
    assert nothing[1] > 10
    assert weight[1] < -10


def test_four_branches(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("four_branches", capsys)
    rows = [line.split() for line in text.splitlines()[1:5]]
    assert [row[4] for row in rows] == ["yes", "yes", "no", "no"]
    for row in rows:
        q = np.radians([*map(float, row[1:4]), 90.0])
        tcp = dh_frames(q)[-1][:3, 3]
        np.testing.assert_allclose(
            tcp, [0.18, 0.05, 0.16], atol=5e-4
        )  # one decimal of a degree
    nearest = min(
        (row for row in rows if row[4] == "yes"), key=lambda row: float(row[5])
    )
    np.testing.assert_allclose(
        numbers(text.splitlines()[5])[:3], [*map(float, nearest[1:4])], atol=0.1
    )


def test_follow_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("follow_a_line", capsys)
    assert float(re.search(rf"miss ({NUMBER})", text)[1]) < 1e-12
    # Its middle is 0.15 m from the yaw axis, square to the arm: 1 / 0.15 m.
    assert float(re.search(rf"axis_e: ({NUMBER})", text)[1]) == pytest.approx(
        1 / 0.15, abs=0.01
    )
    assert "DiscontinuousPathError: positions[1]" in text


def test_payload(capsys: pytest.CaptureFixture[str]) -> None:
    lines = {
        line[:28].strip(): numbers(line[28:])
        for line in said("payload", capsys).splitlines()
    }
    torque, mount, inertia = (
        {name: row[i] for name, row in lines.items() if len(row) == 5}
        for i in (0, 3, 4)
    )
    assert torque["sample of sea water, 0.5 L"] == torque["nothing"]
    assert inertia["sample of sea water, 0.5 L"] > 2 * inertia["nothing"]
    steel = 0.5 * (1 - 1025 / 7850) * 9.81
    assert mount["steel, 0.5 kg"] - mount["nothing"] == pytest.approx(steel, abs=0.011)
    floating = (0.05 - 1025 * 0.25e-3) * 9.81
    assert mount["float, 0.25 L"] - mount["nothing"] == pytest.approx(
        floating, abs=0.011
    )


def test_compare_a_model(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("compare_a_model", capsys)
    assert text.startswith("The model differs")
    for words in (
        "mass 0.255 kg in place of 0.355 kg",
        "y has the wrong sign",
        "SolidWorks sign",
    ):
        assert words in text
    assert '<mass value="0.355"/>' in text


def test_mujoco_in_water(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("mujoco_in_water", capsys)
    theirs, ours = (
        numbers(line) for line in re.findall(r"\[(.+)\]$", text, re.MULTILINE)[-2:]
    )
    assert len(ours) == 4
    np.testing.assert_allclose(theirs, ours, rtol=1e-6)
    before, after = numbers(text.splitlines()[-1].partition("from")[2])
    assert after < before


@pytest.mark.slow
def test_my_arm_in_mujoco(capsys: pytest.CaptureFixture[str]) -> None:
    mine, catalogue = said("my_arm_in_mujoco", capsys).splitlines()
    assert numbers(mine)[-1] < 0.01
    # The guide says so.
    assert numbers(catalogue)[-1] == pytest.approx(59, abs=0.5)


@pytest.mark.slow
def test_predictive_control(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    used: list[np.ndarray] = []

    def dynamics(arm: a5.Arm, q: np.ndarray, v: np.ndarray, tau: np.ndarray):
        used.append(np.array([tau, v]))
        return forward_dynamics(arm, q, v, tau)

    forward_dynamics = a5.Arm.forward_dynamics
    monkeypatch.setattr(a5.Arm, "forward_dynamics", dynamics)
    *misses, nearest = said("predictive_control", capsys).splitlines()
    off = [numbers(line)[1] for line in misses]
    assert off == sorted(off, reverse=True)
    assert off[0] > 100
    assert off[-1] < 2
    assert numbers(nearest)[0] > 1
    example = runpy.run_path(str(REPOSITORY / "examples" / "predictive_control.py"))
    torque, speed = np.abs(used).max(axis=0)
    assert (torque / example["TORQUE"]).max() == pytest.approx(1, abs=1e-4)
    assert 1 <= (speed / example["SPEED"]).max() < 1.06, "kept at each planned step"

    # Without the constraint, the quickest way leads through the mount.
    example["main"](clearance=-1.0)
    assert numbers(capsys.readouterr().out.splitlines()[-1])[0] < -5


def test_motion_as_mcap(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """MCAP's own library reads the messages, and ours the motion."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    time = 1.7e9 + 0.1 * np.arange(30)
    q = a5.named_pose("home") + 0.2 * np.sin(time - time[0])[:, None]
    analysis = a5.trajectory.analyse(a5.trajectory.motion(time, q))
    recording, target = tmp_path / "m.csv", tmp_path / "m.mcap"
    a5.trajectory.write(analysis, recording)
    monkeypatch.setattr(sys, "argv", ["", str(recording), str(target)])
    assert "30 samples" in said("motion_as_mcap", capsys)

    again = a5.trajectory.read_motion(target)
    np.testing.assert_allclose(again.time, time, atol=1e-6)
    np.testing.assert_allclose(again.position, q, atol=1e-3)
    with target.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        found = {c.topic: m for _, c, _, m in reader.iter_decoded_messages()}
    state = found["/joint_states"]
    wrench = found["/mount_load"].wrench
    expected = a5.load().base_wrench(state.position, state.velocity, np.zeros(4))
    force = [wrench.force.x, wrench.force.y, wrench.force.z]
    np.testing.assert_allclose(force, expected.linear, atol=0.05)
    tip = found["/tcp"].point
    pose = a5.load().forward_kinematics(np.array(state.position))
    np.testing.assert_allclose([tip.x, tip.y, tip.z], pose.translation, atol=1e-9)
    frames = [t.child_frame_id for t in found["/tf"].transforms]
    assert len(frames) == len({*frames}) > 4


@pytest.mark.slow
def test_payload_from_motion(capsys: pytest.CaptureFixture[str]) -> None:
    *steps, answer = said("payload_from_motion", capsys).splitlines()
    off = [numbers(line)[1] for line in steps]
    assert off[0] > 5
    assert off[-1] < 0.5
    assert numbers(answer)[0] == pytest.approx(0.35, abs=0.004)


def test_torque_margins(capsys: pytest.CaptureFixture[str]) -> None:
    count, _, best, worst, *margins = said("torque_margins", capsys).splitlines()
    assert numbers(count)[0] == 100_000
    best, worst = numbers(best), numbers(worst)
    assert (np.diff(best) > 0).all()
    assert (worst <= best).all()
    # the worst pose of the shoulder, by the tests' own statics
    place = next(line for line in margins if line.startswith("axis_d"))
    margin, *q = numbers(place)
    arm = a5.load().with_payload(0.5, com=[0, 0, 0.03], volume=6.4e-5)
    assert margin == pytest.approx(
        2.0 - abs(arm.gravity_torque(q) - arm.buoyancy_torque(q))[1], abs=2e-3
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["torque_map", "mount_map"])
def test_maps_of_studies(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    said(name, capsys)
    assert (tmp_path / f"{name}.png").stat().st_size > 20_000


@pytest.mark.slow
def test_pick_and_stow(capsys: pytest.CaptureFixture[str]) -> None:
    rows = [line.split() for line in said("pick_and_stow", capsys).splitlines()[1:]]
    assert [row[0] for row in rows] == ["to", "and"]
    assert all("retracted" in row for row in rows)
    example = runpy.run_path(str(REPOSITORY / "examples" / "pick_and_stow.py"))
    obstacles = example["VEHICLE"]
    stow = a5.named_pose("stow")
    motion = a5.plan(stow, example["SHELL"], obstacles=obstacles)
    tcp = dh_frames(motion.position[-1])[-1][:3, 3]
    np.testing.assert_allclose(tcp, example["SHELL"], atol=1e-9)
    world = CoalWorld(obstacles=obstacles)
    assert min(world.distances(q).min() for q in motion.position[::4]) > 0.0
    # The straight line to the same place is not free.
    straight = np.linspace(stow, motion.position[-1], 50)
    assert min(world.distances(q).min() for q in straight) < 0.0


@pytest.mark.slow
def test_plan_with_ompl(capsys: pytest.CaptureFixture[str]) -> None:
    """OMPL's way holds for coal at every degree; our own planner finds none."""
    rows = said("plan_with_ompl", capsys).splitlines()
    example = runpy.run_path(str(REPOSITORY / "examples" / "plan_with_ompl.py"))
    way = np.radians([numbers(row) for row in rows])
    for q, point in zip((way[0], way[-1]), example["ENDS"], strict=True):
        np.testing.assert_allclose(dh_frames(q)[-1][:3, 3], point, atol=1e-3)
    with pytest.raises(BlockedMotionError):
        a5.plan(way[0], way[-1], obstacles=example["OBSTACLES"])

    exact = example["way"](way[0], way[-1])
    world = CoalWorld(obstacles=example["OBSTACLES"])
    for start, end in pairwise(exact):
        steps = int(np.degrees(np.abs(end - start).max())) + 2
        for q in np.linspace(start, end, steps):
            assert world.distances(q).min() > 0.0


def test_line_with_toppra(capsys: pytest.CaptureFixture[str]) -> None:
    """The time is that of the rated speeds alone, and that to start and to stop."""
    first, *rows = said("line_with_toppra", capsys).splitlines()
    duration, off = numbers(first)
    assert off < 0.01
    used = np.array([numbers(row)[0] for row in rows])
    torque = np.array([numbers(row)[1] for row in rows])
    assert used.max() == 100
    assert (torque < 9.0).all()

    example = runpy.run_path(str(REPOSITORY / "examples" / "line_with_toppra.py"))
    points = np.linspace(example["START"], example["END"], 200)
    way = a5.inverse_kinematics_path(points)
    speed = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
    at_rated_speed = (np.abs(np.diff(way, axis=0)) / speed).max(axis=1).sum()
    ends = 2 * speed.max() / example["ACCELERATION"]
    assert at_rated_speed < duration < at_rated_speed + ends
