"""Scenes and pages of arms of one's own, against Newton-Euler of their records."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest
from browser import Tab, needs_browser, new_tab

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.scene import Scene

#: Tool on the wrist axis: moved by a spacer; beside it: of its own; with a mount.
SEEN = {0: "beside", 1: "spacer", 9: "mount"}


def scene_of(record: Alpha5Parameters, gripper: str = "jaws", **more: Any) -> Scene:
    return build_scene(a5.load(gripper=gripper, arm=record), **more)


@pytest.fixture(scope="module", params=SEEN, ids=lambda seed: f"{SEEN[seed]}_{seed}")
def record(request: pytest.FixtureRequest) -> Alpha5Parameters:
    return own.RECORDS[request.param]


@pytest.fixture(scope="module")
def page(
    chromium: Any, record: Alpha5Parameters, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Tab]:
    file = tmp_path_factory.mktemp("pages") / "own.html"
    file.write_text(static_page(scene_of(record)), encoding="utf-8")
    tab = new_tab(chromium)
    tab.open(file.as_uri())
    yield tab
    assert tab.complaints == []
    tab.page.close()


def upright(record: Alpha5Parameters) -> np.ndarray:
    """Rotation of the base as it is drawn: the mount's, without its yaw."""
    if record.mount is None:
        return np.eye(3)
    mounted = record.mount.rotation
    yaw = np.arctan2(mounted[1, 0], mounted[0, 0])
    cosine, sine = np.cos(yaw), np.sin(yaw)
    without_yaw = [[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]]
    return np.array(without_yaw) @ mounted


@needs_browser
def test_sliders_poses_and_texts_are_those_of_the_record(
    page: Tab, record: Alpha5Parameters
) -> None:
    for joint in record.joints:
        slider = page.run(
            """(name) => {
              const slider = `#joints input[name=${name}]`;
              const { min, max } = document.querySelector(slider);
              return [Number(min), Number(max)];
            }""",
            joint.name,
        )
        np.testing.assert_allclose(slider, [joint.lower, joint.upper], atol=1e-9)
    for name in NAMED_POSES:
        page.run(
            """(name) => {
              const buttons = [...document.querySelectorAll('#poses button')];
              buttons.find((button) => button.textContent === name).click();
            }""",
            name,
        )
        at = page.run("() => alpha5.state.q")[:4]
        np.testing.assert_allclose(at, a5.named_pose(name, record), atol=1e-12)
        assert page.run("document.querySelectorAll('.joint.beyond').length") == 0
    heading = page.run("document.querySelector('h1').textContent")
    assert heading == f"Reach Alpha 5: {record.name}"
    assert page.run("document.title") == heading
    notes = page.run("document.getElementById('notes').textContent")
    assert f"{record.name} differs from the catalogue's arm in " in notes
    assert "lengths a_0, d_0, a_1, a_2; zeros axis_e, axis_d, axis_c, axis_b;" in notes
    assert "attached sensor, lamp, plate" in notes
    assert "with its weight but not drawn: sensor, lamp, plate." in notes
    assert ("Mounted on bluerov" in notes) == (record.mount is not None)


# --- scenes ---------------------------------------------------------------------------


@pytest.mark.slow
def test_a_spacer_moves_the_jaws() -> None:
    record = own.RECORDS[1]
    assert record.spacer > 0.0
    printed = dataclasses.replace(record, attached=(), tool=None)
    for gripper, link in (("jaws", "finger_1"), ("locked", "link_4")):
        moved = scene_of(record, gripper)
        still = scene_of(printed, gripper)
        ends = [far_end(scene, link) for scene in (moved, still)]
        assert ends[0] - ends[1] == pytest.approx(record.spacer, abs=1e-9)


def far_end(scene: Scene, link: str) -> float:
    """How far the bodies of a link go along the jaws, in link_4 [m]."""
    to_link_4 = np.linalg.inv(scene.poses["link_4"])
    z = [
        shape.placed(scene.poses).moved(to_link_4).vertices[:, 2].min()
        for shape in scene.shapes
        if shape.group == "bodies" and shape.name.startswith(f"{link}/")
    ]
    return -min(z)


def test_a_tool_beside_the_wrist_axis_has_no_reach_shapes() -> None:
    beside = scene_of(own.RECORDS[0], target=(9.0, 0.0, 0.0))
    assert not beside.geometry.tool_on_axis
    groups = {shape.group for shape in beside.shapes}
    assert not groups & {"workspace", "surface"}
    assert "Reach is not drawn for a tool beside the wrist axis." in beside.notes
    home = a5.named_pose("home", own.RECORDS[0])
    np.testing.assert_allclose(beside.q[:4], home, atol=0.0)
    assert "target, out of reach" in [label.text for label in beside.labels]


@pytest.mark.parametrize("seed", [0, 1, 2, 9])
def test_the_arm_starts_at_a_target(seed: int) -> None:
    record = own.RECORDS[seed]
    q = own.own_arm.within(record, 1, seed)[0]
    target = own.tcp(record, q)[:3, 3]
    scene = scene_of(record, target=target)
    placed = upright(record) @ target
    np.testing.assert_allclose(scene.poses["tcp"][:3, 3], placed, atol=1e-9)
    assert any(shape.group == "ghosts" for shape in scene.shapes)


def test_another_model_than_the_record_is_refused() -> None:
    arm = a5.load(arm=own.RECORDS[0])
    model = arm.model
    model.jointPlacements[2].translation += [0.0, 0.0, 0.01]
    other = a5.Arm(model, arm.displacements, SEA_WATER, parameters=own.RECORDS[0])
    with pytest.raises(InputError, match="the dimensions of its record"):
        build_scene(other)


def test_attached_bodies_are_named_where_they_are() -> None:
    record = own.RECORDS[1]
    scene = scene_of(record)
    named = {label.text: label for label in scene.labels}
    assert len(record.attached) == 3
    for body in record.attached:
        place = named[body.name].anchor.transform(scene.poses)
        link = scene.poses[body.link]
        wanted = link[:3, :3] @ body.position + link[:3, 3]
        np.testing.assert_allclose(place[:3, 3], wanted, atol=1e-12)


def test_the_mount_turns_the_arrows() -> None:
    record = own.RECORDS[9]
    assert record.mount is not None
    shown = scene_of(record, show=["weight"])
    (whole,) = (s for s in shown.shapes if (s.group, s.name) == ("weight", "arm"))
    farthest = np.linalg.norm(whole.mesh.vertices, axis=1).argmax()
    tip = whole.mesh.vertices[farthest]
    down = upright(record) @ record.mount.rotation.T @ [0.0, 0.0, -1.0]
    np.testing.assert_allclose(down, [0.0, 0.0, -1.0], atol=1e-12)
    np.testing.assert_allclose(tip / np.linalg.norm(tip), down, atol=1e-6)
    (note,) = (line for line in shown.notes if line.startswith("Mounted on bluerov"))
    x, y, z = (
        f"{1e3 * part:.1f}".replace("-", "\u2212") for part in record.mount.position
    )
    assert f"({x}, {y}, {z}) mm" in note

    afloat = build_scene(a5.load(arm=record, floating_base=True))
    assert not [line for line in afloat.notes if line.startswith("Mounted")]


def test_a_file_that_is_refused_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text("format = 1\n[lengths]\na_1 = -0.15\n", encoding="utf-8")
    page = tmp_path / "own.html"
    assert main(["view", "--arm", str(file), "--html", str(page)]) == 2
    assert "lengths.a_1" in capsys.readouterr().err
    assert not page.exists()
