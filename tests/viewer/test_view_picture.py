"""What page and picture draw, against projections worked out by hand."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import open_scene
from PIL import Image

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import InputError
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.canvas import Canvas
from alpha5_model.viewer.framing import check_size
from alpha5_model.viewer.picture import picture, picture_png
from alpha5_model.viewer.scene import Camera, Payload, Scene

SIZE = (480, 300)


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load(gripper="jaws")


def pixels_of(
    arm: a5.Arm, q: list[float], show: tuple[str, ...], camera: Camera
) -> np.ndarray:
    return picture(replace(build_scene(arm, q, show=show), camera=camera), SIZE).astype(
        int
    )


#: From the front, where the base's -x side is to the left.
SIDE = Camera(np.array([0.1, -1.6, 0.05]), np.array([0.1, 0.0, 0.05]), 30.0)
POSE = [math.pi, 1.2, 2.2, 1.5, 0.0013]


def dark(pixels: np.ndarray) -> np.ndarray:
    return pixels.max(axis=2) < 110


#: What is drawn, without labels and ghosts.
DRAWN = (
    "bodies",
    "frames",
    "com",
    "cob",
    "weight",
    "buoyancy",
    "current",
    "payload",
    "obstacles",
    "collision",
    "workspace",
    "surface",
)


@pytest.fixture(scope="module")
def full(arm: a5.Arm) -> Scene:
    """A scene in which each of these groups has something."""
    post = a5.Obstacle.box("post", edges=[0.05, 0.1, 0.2], xyz=[0.2, 0.2, 0.1])
    return build_scene(
        arm,
        POSE,
        water_velocity=(0.4, -0.3, 0.2),
        payload=Payload(mass=0.3, com=(0.0, 0.01, 0.02), volume=4e-5),
        obstacles=[post],
        show=("bodies",),
    )


def vertices_of(scene: Scene, group: str) -> np.ndarray:
    """All vertices of a group in the world, (N, 3)."""
    shapes = [shape for shape in scene.shapes if shape.group == group]
    return np.concatenate([each.placed(scene.poses).vertices for each in shapes])


def assert_seen_at(pixels: np.ndarray, plain: np.ndarray, points: np.ndarray) -> None:
    """What is new in a picture has the outermost of some points (N, 2) at its edges."""
    rows, columns = np.nonzero(np.abs(pixels - plain).max(axis=2) > 6)
    height, width = plain.shape[:2]
    found = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
    low = np.maximum(points.min(axis=0), 0.0)
    high = np.minimum(points.max(axis=0), [width, height])
    np.testing.assert_allclose(found, [*low, *high], atol=5.0)


def test_a_picture_draws_all_where_it_is(full: Scene) -> None:
    camera = full.camera
    back = (camera.eye - camera.target) / np.linalg.norm(camera.eye - camera.target)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back])
    focal = SIZE[1] / 2 / math.tan(math.radians(camera.field_of_view / 2))

    plain = picture(replace(full, show=()), SIZE).astype(int)
    for group in DRAWN:
        shown = picture(replace(full, show=(group,)), SIZE).astype(int)
        x, y, z = axes @ (vertices_of(full, group) - camera.eye).T
        points = np.column_stack([focal * x / -z, -focal * y / -z]) + np.divide(SIZE, 2)
        assert_seen_at(shown, plain, points)


def test_a_page_draws_all_where_it_is(
    chromium: Any, full: Scene, tmp_path: Path
) -> None:
    tab = open_scene(chromium, full, tmp_path)
    tab.show_only()
    plain = tab.pixels()
    corner, _ = tab.stage()
    for group in DRAWN:
        tab.page.locator(f"#groups input[name='{group}']").check()
        points = tab.project(vertices_of(full, group)) - corner
        assert_seen_at(tab.pixels(), plain, points)
        tab.page.locator(f"#groups input[name='{group}']").uncheck()
        np.testing.assert_array_equal(tab.pixels(), plain)
    assert tab.complaints == []
    tab.page.close()


def test_the_nearer_body_hides_the_farther() -> None:
    """Two planes cross in a line; each pixel shows the plane nearer along its ray."""
    canvas = Canvas(Camera(np.array([0.0, -2.0, 0.0]), np.zeros(3), 40.0), 300, 200)
    square = np.array([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]])
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    for tilt, color in ((0.5, [1.0, 0.0, 0.0]), (-0.5, [0.0, 0.0, 1.0])):
        square[:, 1] = tilt * square[:, 0]
        canvas.draw(square, np.tile(color, (4, 1)), faces)
    red, _, blue = np.moveaxis(canvas.color.reshape(200, 300, 3), 2, 0) > 0.99
    red, blue = red & ~blue, blue & ~red
    assert np.nonzero(red)[1].max() <= 150, "red comes forward on the left"
    assert np.nonzero(blue)[1].min() >= 150
    assert red.sum() == pytest.approx(blue.sum(), rel=0.02)


def test_a_label_has_its_colour(arm: a5.Arm) -> None:
    scene = build_scene(arm, show=["labels", "com"])
    red = tuple(replace(label, color=(1.0, 0.0, 0.0)) for label in scene.labels)
    pixels = picture(replace(scene, labels=red), SIZE).reshape(-1, 3)
    assert (pixels == [255, 0, 0]).all(axis=1).any()


def test_bars_say_how_long_things_are_where_the_camera_looks(arm: a5.Arm) -> None:
    """100 mm, and 5 N at 15 mm/N, in the lower left corner, by similar triangles."""
    scale = SIZE[1] / 2 / math.tan(math.radians(15)) / 1.6
    plain = pixels_of(arm, POSE, ("bodies",), SIDE)
    shown = pixels_of(arm, POSE, ("bodies", "labels", "weight"), SIDE)
    corner = (np.abs(shown - plain).max(axis=2) > 60)[-45:, : SIZE[0] // 3]
    lengths = []
    for row in corner:
        edges = np.diff(
            np.flatnonzero(np.diff(np.pad(row, 1).astype(int))).reshape(-1, 2)
        ).ravel()
        lengths += [length for length in edges if length > 15]
    assert min(lengths) == pytest.approx(5 * 0.015 * scale + 2, abs=1.5)
    assert max(lengths) == pytest.approx(0.1 * scale + 2, abs=1.5), "and its two ends"


@pytest.mark.slow
def test_a_motion_stays_in_its_video(
    tmp_path: Path, arm: a5.Arm, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "motion.csv"
    names = ",".join(arm.joint_names)
    rows = [f"{t:g},{0.3 + 2 * t},1.2,2.2,1.5,0.0013" for t in np.arange(0, 1.21, 0.1)]
    path.write_text("\n".join([f"time,{names}", *rows]))
    made = ["view", "--motion", str(path), "--show", "bodies", "--size", "160x100"]
    assert main([*made, "--video", str(tmp_path / "arm.gif")]) == 0
    assert "arm.gif" in capsys.readouterr().out
    with Image.open(tmp_path / "arm.gif") as video:
        assert video.n_frames == 19, "1.2 s, one each 0.07 s, and the end"
        frames = []
        for k in range(video.n_frames):
            video.seek(k)
            frames.append(dark(np.asarray(video.convert("RGB")).astype(int)))
    for frame in frames:
        rows, columns = np.nonzero(frame)
        assert rows.min() > 0
        assert rows.max() < 99
        assert columns.min() > 0
        assert columns.max() < 159
    assert (frames[0] != frames[-1]).sum() > 100
    assert main(["view", "--video", str(tmp_path / "arm.gif")]) == 2
    assert "--motion" in capsys.readouterr().err
    assert main([*made, "--video", str(tmp_path / "arm.avi")]) == 2
    assert ".mp4, .gif" in capsys.readouterr().err


def test_png(arm: a5.Arm) -> None:
    scene = build_scene(arm)
    data = picture_png(scene, (320, 200))
    assert data == picture_png(scene, (320, 200)), "the same pixels every time"
    image = Image.open(io.BytesIO(data))
    assert image.format == "PNG"
    assert image.size == (320, 200)
    assert np.asarray(image).std() > 20


@pytest.mark.parametrize(
    "size", [(0, 100), (100, 9000), (3.5, 100), (15, 16), (16, 8001), (16,), (16,) * 3]
)
def test_sizes_that_make_no_picture(arm: a5.Arm, size: tuple[int, int]) -> None:
    with pytest.raises(InputError, match="16 to 8000 pixels"):
        picture_png(build_scene(arm), size)
    for allowed in ((16, 8000), (8000, 16)):
        assert check_size(allowed) == allowed


def test_a_picture_that_cannot_be_drawn_leaves_no_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = ["view", "--html", str(tmp_path / "arm.html")]
    assert main([*page, "--image", str(tmp_path / "arm.png"), "--size", "0x0"]) == 2
    assert "16 to 8000 pixels" in capsys.readouterr().err
    (tmp_path / "taken.png").mkdir()
    small = ["--size", "64x40"]
    assert main([*page, "--image", str(tmp_path / "taken.png"), *small]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["taken.png"]
    assert main([*page, "--image", str(tmp_path / "arm.png"), *small]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        "taken.png",
        "arm.html",
        "arm.png",
    }
