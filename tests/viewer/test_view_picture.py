"""The software renderer against geometry worked out by hand, and its pictures."""

from __future__ import annotations

import io
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import InputError
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.canvas import Canvas
from alpha5_model.viewer.framing import check_size
from alpha5_model.viewer.picture import picture, picture_png
from alpha5_model.viewer.scene import Camera
from alpha5_model.viewer.shapes import ball

FIELD = 40.0
HOME = a5.named_pose("home")
#: Looks along +y from 2 m away: x to the right, z up.
FRONT = Camera(np.array([0.0, -2.0, 0.0]), np.zeros(3), FIELD)
FOCAL = 100 / math.tan(math.radians(FIELD / 2))
TRIANGLE = np.array([[0, 1, 2]], dtype=np.uint32)
RED, BLUE = np.tile([1.0, 0.0, 0.0], (3, 1)), np.tile([0.0, 0.0, 1.0], (3, 1))


def drawn(canvas: Canvas, color: tuple[float, float, float]) -> np.ndarray:
    return (np.abs(canvas.color - color).max(axis=1) < 1e-6).reshape(
        canvas.height, canvas.width
    )


def right_angle(y: float, size: float = 0.4) -> np.ndarray:
    """A triangle that faces the viewer, at depth y."""
    return np.array([[0, y, 0], [size, y, 0], [0, y, size]], dtype=float)


def test_points_project_by_similar_triangles() -> None:
    canvas = Canvas(FRONT, 300, 200)
    found = canvas.project(
        np.array([[0, 0, 0], [0.3, 0, 0.1], [0.3, 1.0, 0.1]], dtype=float)
    )
    expected = [
        [150, 100, 2],
        [150 + FOCAL * 0.3 / 2, 100 - FOCAL * 0.1 / 2, 2],
        [150 + FOCAL * 0.3 / 3, 100 - FOCAL * 0.1 / 3, 3],
    ]
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_triangle_covers_its_area_on_its_side() -> None:
    canvas = Canvas(FRONT, 300, 200)
    canvas.draw(right_angle(0.0), RED, TRIANGLE)
    seen = drawn(canvas, (1, 0, 0))
    assert seen.sum() == pytest.approx(0.5 * (FOCAL * 0.4 / 2) ** 2, rel=0.02)
    rows, columns = np.nonzero(seen)
    assert columns.min() >= 150
    assert rows.max() < 100


def test_triangles_that_turn_their_back_are_not_drawn_unless_two_sided() -> None:
    away = TRIANGLE[:, ::-1]
    canvas = Canvas(FRONT, 300, 200)
    canvas.draw(right_angle(0.0), RED, away)
    assert not drawn(canvas, (1, 0, 0)).any()
    canvas.draw(right_angle(0.0), RED, away, two_sided=True)
    assert drawn(canvas, (1, 0, 0)).any()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux can fork safely")
@pytest.mark.parametrize("near_first", [True, False])
def test_the_nearer_triangle_hides_the_farther(near_first: bool) -> None:
    canvas = Canvas(FRONT, 300, 200)
    jobs = [(right_angle(-0.5), RED), (right_angle(0.5), BLUE)]
    for points, color in jobs if near_first else jobs[::-1]:
        canvas.draw(points, color, TRIANGLE)
    near = 0.5 * (FOCAL * 0.4 / 1.5) ** 2
    assert drawn(canvas, (1, 0, 0)).sum() == pytest.approx(near, rel=0.02)
    assert not drawn(canvas, (0, 0, 1)).any(), (
        "the farther one is smaller and wholly hidden"
    )


def test_crossing_triangles_cut_each_other() -> None:
    """Two planes cross in a line; each pixel shows the plane nearer along its ray."""
    canvas = Canvas(FRONT, 300, 200)
    for tilt, color in ((0.5, RED), (-0.5, BLUE)):
        square = np.array(
            [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]
        )
        square[:, 1] = tilt * square[:, 0]
        faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
        canvas.draw(square, np.tile(color[0], (4, 1)), faces)
    red, blue = drawn(canvas, (1, 0, 0)), drawn(canvas, (0, 0, 1))
    assert np.nonzero(red)[1].max() <= 150, "red comes forward on the left"
    assert np.nonzero(blue)[1].min() >= 150
    assert red.sum() == pytest.approx(blue.sum(), rel=0.02)


def test_a_layer_on_top_is_seen_through_a_body_and_a_veil_mixes() -> None:
    canvas = Canvas(FRONT, 300, 200)
    canvas.draw(right_angle(-0.5), RED, TRIANGLE)
    before = canvas.color.copy()
    canvas.draw(right_angle(-0.6), BLUE, TRIANGLE, opacity=0.25)
    inside = drawn(canvas, (0.75, 0, 0.25))
    assert inside.any()
    np.testing.assert_allclose(
        canvas.color[inside.ravel()],
        0.75 * before[inside.ravel()] + [0, 0, 0.25],
        atol=1e-6,
    )
    canvas.clear_depth()
    canvas.draw(right_angle(0.5), BLUE, TRIANGLE)
    assert drawn(canvas, (0, 0, 1)).any()


def test_a_ball_is_a_disc_of_its_size() -> None:
    mesh = ball(0.2, (1, 0, 0), (1, 0, 0), sides=96)
    canvas = Canvas(FRONT, 300, 200)
    canvas.draw(mesh.vertices, mesh.colors, mesh.faces)
    # the outline is the cone that touches the ball: tan = r / sqrt(d^2 - r^2)
    radius = FOCAL * 0.2 / math.sqrt(4 - 0.04)
    assert drawn(canvas, (1, 0, 0)).sum() == pytest.approx(
        math.pi * radius**2, rel=0.02
    )


SIZE = (480, 300)


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load(gripper="jaws")


def pixels_of(
    arm: a5.Arm, q: list[float], show: tuple[str, ...], camera: Camera
) -> np.ndarray:
    from dataclasses import replace

    return picture(replace(build_scene(arm, q, show=show), camera=camera), SIZE).astype(
        int
    )


#: From the front, where the base's -x side is to the left.
SIDE = Camera(np.array([0.1, -1.6, 0.05]), np.array([0.1, 0.0, 0.05]), 30.0)
POSE = [math.pi, 1.2, 2.2, 1.5, 0.0013]


def dark(pixels: np.ndarray) -> np.ndarray:
    return pixels.max(axis=2) < 110


def test_the_base_is_on_the_left_and_the_arm_on_the_right(arm: a5.Arm) -> None:
    scene_x = 0.1
    scale = SIZE[1] / 2 / math.tan(math.radians(15)) / 1.6
    columns = np.nonzero(dark(pixels_of(arm, POSE, ("bodies",), SIDE)))[1]
    left = (columns.min() - SIZE[0] / 2) / scale + scene_x
    assert left == pytest.approx(-0.12665, abs=0.008), "far end of the base tube"
    assert (columns > SIZE[0] / 2).sum() > 500


def test_every_group_changes_the_picture(arm: a5.Arm) -> None:
    from dataclasses import replace

    scene = build_scene(arm, POSE, target=[0.06, 0.05, 0.36], show=["bodies"])
    plain = picture(replace(scene, show=("bodies",)), SIZE).astype(int)
    for group in (
        "see-through",
        "frames",
        "com",
        "cob",
        "workspace",
        "surface",
        "ghosts",
        "collision",
        "labels",
    ):
        shown = picture(replace(scene, show=("bodies", group)), SIZE).astype(int)
        assert (np.abs(shown - plain).max(axis=2) > 8).sum() > 60, group


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
