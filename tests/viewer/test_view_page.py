"""The page as text, and the command line's errors.

The page is one file, loads nothing, and has the same bytes each time.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from page_script import data_of

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.cli import view as view_command
from alpha5_model.errors import MissingDependencyError
from alpha5_model.trajectory import motion
from alpha5_model.viewer import page
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.scene import Scene


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build_scene(a5.load(gripper="jaws"), target=[0.06, 0.05, 0.36])


@pytest.fixture(scope="module")
def html(scene: Scene) -> str:
    return static_page(scene)


def test_the_same_scene_gives_the_same_bytes(scene: Scene, html: str) -> None:
    again = build_scene(a5.load(gripper="jaws"), target=[0.06, 0.05, 0.36])
    assert static_page(again) == html
    assert len(html) < 6e6


def test_texts_cannot_break_out_of_the_page() -> None:
    arm = a5.load()
    wild = motion(np.arange(5.0), np.ones((5, 4)))
    wild = type(wild)(wild.time, wild.joints, wild.position, source="a</script><b>.csv")
    html = static_page(build_scene(arm, motion=wild))
    assert html.count("</script>") == 3
    assert data_of(html)["motion"]["name"].endswith("script><b>.csv")


def test_a_motion_starts_at_zero_and_keeps_joints_that_it_lacks() -> None:
    arm = a5.load(gripper="jaws")
    moved = motion([5.0, 6.0, 8.0, 9.0, 9.5], 1.0 + np.arange(20.0).reshape(5, 4) / 10)
    track = build_scene(arm, [1, 1, 1, 1, 0.009], motion=moved).motion
    np.testing.assert_array_equal(track.time, [0, 1, 3, 4, 4.5])
    np.testing.assert_array_equal(track.q[:, 4], 0.009)
    np.testing.assert_array_equal(track.q[:, :4], moved.position)


def test_meshcat_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    page.meshcat_script.cache_clear()
    monkeypatch.setattr(page, "find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match="meshcat"):
        page.meshcat_script()


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["view", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("alpha5: ")
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--pose", "upside-down"], "stow, home, reach"),
        (["--pose", "1,2,3"], "four or five numbers"),
        (["--gripper", "locked", "--pose", "1 2 3 4 0.01"], "four numbers"),
        (["--obstacles", "nowhere.toml"], "nowhere.toml"),
        (["--target", "0.1,0.2"], "three numbers"),
        (["--show", "bodies,arrows"], "unknown group 'arrows'"),
        (["--gripper", "claw"], "locked, jaws"),
        (["--fluid", "oil"], "density"),
        (["--size", "big"], "1600x1000"),
        (["--motion", "nowhere.csv"], "nowhere.csv"),
        # These would have no effect.
        (["--degrees"], "--degrees"),
        (["--topic", "/joints"], "--topic"),
        (["--size", "160x100"], "--size"),
        (["--serve"], "--serve"),
        (["--port", "8000"], "--port"),
    ],
)
def test_bad_options_end_in_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    target = tmp_path / "arm.html"
    assert said in refused([*arguments, "--html", str(target)], capsys)
    assert not target.exists()


def test_unwritable_files_end_in_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    blocker = tmp_path / "file"
    blocker.write_text("x")
    folder = tmp_path / "folder.png"
    folder.mkdir()
    for option in ("--html", "--image"):
        size = ["--size", "160x100"] if option == "--image" else []
        small = ["--gripper", "locked", *size, option]
        assert "cannot write" in refused([*small, str(blocker / "arm.png")], capsys)
        assert "it is a folder" in refused([*small, str(folder)], capsys)


def test_no_display_ends_in_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(view_command.sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    said = refused([], capsys)
    assert "no display" in said
    assert "--html" in said
    assert "--serve" in said


def test_a_busy_port_ends_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    import socket

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"port {port} is in use" in refused(
            ["--serve", "--port", str(port)], capsys
        )
    assert "0 to 65535" in refused(["--serve", "--port", "70000"], capsys)


def test_page_and_picture_from_the_command_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    html, image = tmp_path / "arm.html", tmp_path / "arm.png"
    arguments = ["--pose=1,2,3,-0.5", "--target=-0.06,0.05,0.36", "--gripper", "locked"]
    arguments += ["--fluid", "fresh", "--size", "320x200"]
    assert main(["view", *arguments, "--html", str(html), "--image", str(image)]) == 0
    assert capsys.readouterr().out == f"wrote {html}\nwrote {image}\n"
    data = data_of(html.read_text(encoding="utf-8"))
    assert data["q"] == [1, 2, 3, -0.5]
    assert data["water"]["density"] == 1000
    assert next(g["shown"] for g in data["groups"] if g["name"] == "ghosts")
    assert image.read_bytes().startswith(b"\x89PNG")


def recording(path: Path, *rows: str) -> Path:
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def page_of(capsys: pytest.CaptureFixture[str], folder: Path, *words: str) -> dict:
    html = folder / "page.html"
    assert main(["view", *words, "--html", str(html)]) == 0, capsys.readouterr().err
    capsys.readouterr()
    return data_of(html.read_text("utf-8"))


def test_a_page_and_a_picture_of_a_motion_begin_where_it_does(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    names = "time,axis_e,axis_d,axis_c,axis_b"
    rows = [f"{t},1.{t},1.1,1.9,0.5" for t in range(5)]
    file = str(recording(tmp_path / "rec.csv", names, *rows))
    first = [1.0, 1.1, 1.9, 0.5]
    data = page_of(capsys, tmp_path, "--gripper", "locked", "--motion", file)
    assert data["q"] == first
    assert data["motion"]["q"][0] == first
    # A pose that is given counts.
    posed = page_of(capsys, tmp_path, "--motion", file, "--pose", "stow")
    np.testing.assert_allclose(posed["q"][:4], a5.named_pose("stow"))

    image = tmp_path / "arm.png"
    small = ["--gripper", "locked", "--size", "160x100", "--image", str(image)]
    assert main(["view", "--motion", file, *small]) == 0
    moving = image.read_bytes()
    # The same picture as that of the pose, but for the camera, which sees the motion.
    arm = a5.load()
    scene = build_scene(arm, motion=motion(np.arange(5.0), np.tile(first, (5, 1))))
    np.testing.assert_array_equal(scene.q, first)
    assert main(["view", "--pose", "home", "--motion", file, *small]) == 0
    assert image.read_bytes() != moving


def test_a_motion_is_read_as_trajectory_reads_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """--map, --time and --degrees name what the columns are."""
    names = "tick,j1,j2,j3,j4"
    rows = [f"{500 * t},{60 + t},60,110,30" for t in range(5)]
    file = str(recording(tmp_path / "rec.csv", names, *rows))
    joints = "axis_e=j1,axis_d=j2,axis_c=j3,axis_b=j4"
    words = ["--map", joints, "--time", "tick:ms", "--degrees"]
    data = page_of(capsys, tmp_path, "--motion", file, *words)
    np.testing.assert_allclose(data["q"][:4], np.radians([60, 60, 110, 30]))
    np.testing.assert_allclose(data["motion"]["time"], 0.5 * np.arange(5))
    for wrong, said in (
        (["--map", "axis_e=j9"], "j9"),
        (["--map", joints, "--time", "tack"], "tack"),
        ([], "expected"),
    ):
        target = ["--html", str(tmp_path / "none.html")]
        assert said in refused(["--motion", file, *wrong, *target], capsys)


def test_a_motion_is_read_with_the_arm(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A driver that counts axis_e the other way, as the arm file says."""
    arm = tmp_path / "turned.toml"
    arm.write_text("format = 1\n[signs]\naxis_e = -1\n", encoding="utf-8")
    rows = [f"{t},-{2 + 0.01 * t},1.1,1.9,0.5" for t in range(5)]
    names = "time,axis_e,axis_d,axis_c,axis_b"
    file = str(recording(tmp_path / "rec.csv", names, *rows))
    data = page_of(capsys, tmp_path, "--motion", file, "--arm", str(arm))
    assert data["q"][0] == 2.0


@pytest.mark.parametrize(
    "words",
    [
        ["3.1", "1.2", "1.8", "0", "rad"],
        ["3.1rad", "1.2", "1.8", "0"],
        ["177.616916", "68.754935", "103.132403", "0", "deg"],
    ],
)
def test_a_pose_is_read_as_fk_reads_it(
    words: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    data = page_of(capsys, tmp_path, "--pose", *words)
    np.testing.assert_allclose(data["q"][:4], [3.1, 1.2, 1.8, 0.0], atol=1e-7)
    assert main(["fk", *words, "--json"]) == 0
    fk = json.loads(capsys.readouterr().out)
    np.testing.assert_allclose(data["q"][:4], fk["q"], atol=1e-12)


def test_obstacles_of_a_file_are_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "around.toml"
    file.write_text("[hull]\nbox = [0.4, 0.3, 0.2]\nxyz = [-0.3, 0.0, -0.2]\n")
    data = page_of(capsys, tmp_path, "--obstacles", str(file))
    assert "hull" in {label["text"] for label in data["labels"]}
    assert next(g["shown"] for g in data["groups"] if g["name"] == "obstacles")
