"""The page under a hand, in a real browser with two window sizes and two schemes.

Covered: drag, ghosts, views, limits, strip and layout.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab
from PIL import Image

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH
from alpha5_model.description.reading import urdf_shapes
from alpha5_model.trajectory import Motion, analyse
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.poses import named_poses
from alpha5_model.viewer.shapes import drawn
from alpha5_model.viewer.tracks import tour

pytestmark = needs_browser

WINDOWS = {
    "wide light": ((1400, 900), "light"),
    "wide dark": ((1400, 900), "dark"),
    "phone light": ((400, 800), "light"),
}
#: Where all four branches reach.
OPEN = np.array([0.06, 0.05, 0.36])


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load(gripper="jaws")


@pytest.fixture(scope="module")
def moved(arm: a5.Arm) -> Motion:
    """A raised pose, and back, in less than two seconds."""
    home = named_poses(arm)["home"]
    there = home + np.array([0.2, 0.25, -0.2, 0.4, 0.0])
    return tour([home, there, home], a5.parameters())


@pytest.fixture(scope="module")
def files(
    tmp_path_factory: pytest.TempPathFactory, arm: a5.Arm, moved: Motion
) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    scenes = {
        "motion": build_scene(arm, motion=moved),
        "reached": build_scene(arm, target=OPEN),
        "far": build_scene(arm, target=[0.3, -0.4, 0.5]),
        "beyond": build_scene(arm, [3, 1, 1, 9, 0.0013]),
    }
    for name, scene in scenes.items():
        (folder / f"{name}.html").write_text(static_page(scene), encoding="utf-8")
    return {name: folder / f"{name}.html" for name in scenes}


@pytest.fixture(scope="module")
def tabs(chromium: Any, files: dict[str, Path]) -> Iterator[dict[str, Tab]]:
    """A page with a motion in a window of each size, one in the dark.

    The tests share them because a page costs seconds.
    """
    out = {}
    for name in ("wide dark", "phone light"):
        size, scheme = WINDOWS[name]
        one = new_tab(chromium, size, color_scheme=scheme)
        one.open(files["motion"].as_uri())
        out[name.split()[0]] = one
    yield out
    for name, tab in out.items():
        assert tab.complaints == [], name
        assert tab.requests == [files["motion"].as_uri()], name
        tab.page.close()


@pytest.fixture
def tab(tabs: dict[str, Tab], request: pytest.FixtureRequest) -> Tab:
    """That window, as it was opened."""
    name = getattr(request, "param", "wide light")
    one = tabs[name.split()[0]]
    one.page.emulate_media(color_scheme=WINDOWS[name][1])
    one.reset()
    return one


every_window = pytest.mark.parametrize(
    "tab", ["wide dark", "phone light"], indirect=True
)


@pytest.fixture(scope="module")
def opened(chromium: Any) -> Iterator[Tab]:
    """A window for one page after the other."""
    one = new_tab(chromium, (1400, 900))
    yield one
    one.page.close()


def drag(tab: Tab, pixels: tuple[float, float], release: bool = True) -> np.ndarray:
    """Drag the tip by its handle; the point that the camera's matrices put there."""
    start = np.array(tab.run("() => alpha5.state.poses.tcp"))[:, 3]
    goal = tab.shifted(start, pixels)
    box = tab.page.locator("#tip").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    np.testing.assert_allclose([x, y], tab.project(start[None])[0], atol=0.2)
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    tab.page.mouse.move(x + pixels[0], y + pixels[1], steps=3)
    if release:
        tab.page.mouse.up()
    return goal


@every_window
def test_the_tip_follows_the_pointer_on_its_branch(tab: Tab, arm: a5.Arm) -> None:
    before = tab.joints()
    branch = a5.inverse_kinematics(
        arm.forward_kinematics(before).translation, before[3]
    )
    kept = int(np.nanargmin(np.abs(branch.q - before[:4]).max(axis=1)))
    wide = tab.size()[0] > 1000
    goal = drag(tab, (-60, -70) if wide else (-20, -25))
    q = tab.joints()
    assert np.linalg.norm(arm.forward_kinematics(q).translation - goal) < 1e-4
    assert np.linalg.norm(goal - arm.forward_kinematics(before).translation) > 0.03
    np.testing.assert_allclose(
        q[:4], a5.inverse_kinematics(goal, q[3]).q[kept], atol=1e-3
    )
    assert q[4] == before[4], "the jaws stay as they are"
    assert tab.message() == ""


def test_outside_the_reach_the_tip_stops_at_the_nearest_point(
    tab: Tab, arm: a5.Arm
) -> None:
    goal = drag(tab, (420, -60))
    place = arm.forward_kinematics(tab.joints()).translation
    away = float(a5.distance_to_reach(goal))
    assert away > 0.02
    assert np.linalg.norm(place - goal) == pytest.approx(away, abs=1e-4)
    said = tab.message()
    assert "out of reach" in said
    assert float(re.findall(r"[\d.]+(?= mm)", said)[0]) == pytest.approx(
        1e3 * away, abs=0.11
    )


def outline(arm: a5.Arm, q: np.ndarray) -> np.ndarray:
    """Points along the arm, shoulder to tcp."""
    ends = [
        arm.forward_kinematics(q, frame=f).translation
        for f in ("link_2", "link_3", "tcp")
    ]
    t = np.linspace(0.1, 0.9, 15)[:, None]
    return np.concatenate([a + t * (b - a) for a, b in pairwise(ends)])


def centres(arm: a5.Arm, q: np.ndarray) -> np.ndarray:
    """Points within upper arm and forearm: their centres of buoyancy.

    The line of `outline` leaves the bodies at the elbow.
    """
    links = a5.parameters().links
    return np.array(
        [arm.forward_kinematics(q, frame=f"link_{i}").act(links[i].cob) for i in (2, 4)]
    )


def test_a_click_on_a_ghost_takes_its_way(tab: Tab, arm: a5.Arm) -> None:
    tab.change(shown={"ghosts": True})
    tab.run("(p) => alpha5.follow(p, 0)", OPEN.tolist())
    tab.change(shown={"labels": False})
    tab.run("() => alpha5.look('side', false)")
    tab.settle()
    q = tab.joints()
    ways = a5.inverse_kinematics(OPEN, q[3])
    assert ways.within_limits.all()
    pixels = [tab.project(outline(arm, np.append(way, q[4]))) for way in ways.q]
    aims = [tab.project(centres(arm, np.append(way, q[4]))) for way in ways.q]
    # the body of a ghost that lies furthest from the rest
    clear = [
        np.linalg.norm(
            aims[i][:, None] - np.concatenate([pixels[j] for j in range(4) if j != i]),
            axis=-1,
        ).min(axis=1)
        for i in range(4)
    ]
    chosen = 1 + int(np.argmax([c.max() for c in clear[1:]]))
    x, y = aims[chosen][clear[chosen].argmax()]
    tab.page.mouse.click(x, y)
    after = tab.joints()
    np.testing.assert_allclose(after[:4], ways.q[chosen], atol=1e-9)
    # A ghost that equals the arm is hidden; the pose that the arm left is a ghost now.
    seen = tab.run("""() => alpha5.ghosts.map(
      (g) => g.group.visible && Object.values(g.links).some((l) => l.visible)
    )""")
    assert seen == [i != chosen for i in range(4)]
    tab.page.mouse.click(float(tab.size()[0]) - 5, 450)  # where there is no ghost
    np.testing.assert_array_equal(tab.joints(), after)


def body_points(arm: a5.Arm, q: np.ndarray) -> np.ndarray:
    """Corners of all bodies in the world."""
    folder = str(Path(JAWS_URDF_PATH).parent)
    parts = []
    for shape in urdf_shapes(Path(JAWS_URDF_PATH).read_text("utf-8")):
        pose = arm.forward_kinematics(q, frame=shape.link).homogeneous
        parts.append(drawn(shape, folder).vertices[::7] @ pose[:3, :3].T + pose[:3, 3])
    return np.concatenate(parts)


#: The direction from the centre of the view to the camera, in three.js's axes.
_CAMERA_DIRECTION = """() => {
  const { camera, controls } = alpha5.viewer;
  return camera.position.clone().sub(controls.target).normalize().toArray();
}"""


@every_window
def test_views_by_button_and_key_frame_the_whole_motion(
    tab: Tab, arm: a5.Arm, moved: Motion
) -> None:
    track = tab.run("() => alpha5.data.motion.q")
    points = np.concatenate(
        [body_points(arm, np.array(q)) for q in track[:: len(track) // 4]]
    )
    for key, name, back in (
        ("1", "Front", (1, 0, 0)),
        ("2", "Side", (0, -1, 0)),
        ("3", "Top", (0, 0, 1)),
        ("h", "Corner", np.array([0.35, -1, 0.42]) / np.linalg.norm([0.35, -1, 0.42])),
    ):
        tab.run("() => { alpha5.viewer.camera.position.set(2, 1, 1); }")
        if tab.size()[0] > 1000:
            tab.page.keyboard.press(key)
        else:
            tab.page.get_by_role("button", name=name, exact=True).click()
        tab.settle()
        x, y, z = tab.run(_CAMERA_DIRECTION)
        np.testing.assert_allclose([x, -z, y], back, atol=2e-4)
        left, top, right, bottom = tab.run("() => alpha5.free()")
        seen = tab.project(points)
        assert (seen > [left, top]).all(), name
        assert (seen < [right, bottom]).all(), name
        share = np.ptp(seen, axis=0) / [right - left, bottom - top]
        assert share.max() > 0.6, f"{name}: the picture is filled"


def test_the_scale_bar_is_as_long_as_it_says(tab: Tab) -> None:
    tab.change(shown={"weight": True})
    tab.run("() => alpha5.look('side', false)")
    tab.settle()
    x, _, z = tab.run("() => alpha5.viewer.controls.target.toArray()")
    middle = np.array([x, 0.0, 0.0])
    y = -z
    bars = tab.run("""() => {
      const bars = [...document.querySelectorAll('#scale div:not([hidden])')];
      const width = (bar) => bar.querySelector('i').getBoundingClientRect().width;
      return bars.map((d) => [d.textContent, Number(d.dataset.size), width(d)]);
    }""")
    assert [text.split()[1] for text, *_ in bars] == ["mm", "N"]
    for (_, size, width), metres in zip(bars, (1e-3, 0.015), strict=True):
        ends = np.array([[middle[0], y, 0.0], [middle[0] + size * metres, y, 0.0]])
        (one, other) = tab.project(ends)
        assert width == pytest.approx(other[0] - one[0], rel=2e-3)


def beyond(tab: Tab) -> tuple[str, list[str]]:
    """The message, and the names of the joints that are marked."""
    return tab.run("""() => {
      const labels = [...document.querySelectorAll('.joint.beyond label')];
      const message = document.querySelector('#message').textContent;
      return [message, labels.map((l) => l.textContent)];
    }""")


def red(pixels: np.ndarray) -> int:
    """Pixels of a red body."""
    r, g, b = np.moveaxis(pixels, -1, 0)
    return int(((r > 120) & (r > 1.8 * g) & (r > 1.8 * b)).sum())


def test_joints_beyond_their_limits_are_marked(
    opened: Tab, files: dict[str, Path]
) -> None:
    tab = opened
    tab.open(files["beyond"].as_uri())
    said, rows = beyond(tab)
    assert said == "axis_b at 515.7° is above its upper limit, 355.2°."
    assert rows == ["axis_b"]
    tab.show_only("bodies")
    assert red(tab.pixels()) > 1500
    # typed in radians, within its limits
    tab.page.get_by_role("button", name="rad", exact=True).click()
    field = tab.page.locator("#axis_b-value")
    assert field.input_value() == "9.0000"
    field.fill("1.25")
    field.press("Enter")
    assert beyond(tab) == ["", []]
    assert tab.run("() => alpha5.state.q[3]") == 1.25
    assert red(tab.pixels()) == 0
    assert tab.complaints == []


@pytest.mark.parametrize("name", ["reached", "far"])
def test_a_given_target_is_reached_or_said_to_be_out_of_reach(
    opened: Tab, files: dict[str, Path], arm: a5.Arm, name: str
) -> None:
    tab = opened
    tab.open(files[name].as_uri())
    target = np.array(tab.run("() => alpha5.data.target"))
    place = arm.forward_kinematics(tab.joints()).translation
    away = float(a5.distance_to_reach(target))
    assert np.linalg.norm(place - target) == pytest.approx(away, abs=1e-9)
    said = beyond(tab)[0]
    if away:
        out = f"Target out of reach: the tip stops {1e3 * away:.1f} mm from it."
        assert said.startswith(out)
        # Towards a target out of reach the arm is stretched.
        assert "Near a singularity" in said
    else:
        assert said == ""
    assert bool(away) == (name == "far")
    typed = [
        tab.page.locator(f"#target input[name={axis}]").input_value() for axis in "xyz"
    ]
    np.testing.assert_allclose(np.array(typed, float), 1e3 * target, atol=0.051)
    # another one, typed
    for axis, value in zip("xyz", (-180, 60, 160), strict=True):
        tab.page.fill(f"#target input[name={axis}]", str(value))
    tab.page.press("#target input[name=z]", "Enter")
    place = arm.forward_kinematics(tab.joints()).translation
    np.testing.assert_allclose(place, [-0.18, 0.06, 0.16], atol=1e-9)
    assert beyond(tab)[0] == ""


def test_the_strip_shows_what_python_computes_there(
    tab: Tab, arm: a5.Arm, moved: Motion
) -> None:
    analysis = analyse(moved, arm)
    time = analysis.smooth.time
    causes = {
        "Coriolis" if k == "coriolis" else k: v for k, v in analysis.causes().items()
    }
    causes["total"] = analysis.torque
    del causes["friction"]
    read = """() => [...document.querySelectorAll('#charts figure')].map((figure) => {
      const items = [...figure.querySelectorAll('.item')];
      const value = (item) => Number(item.querySelector('output').dataset.value);
      return Object.fromEntries(items.map((i) => [i.dataset.curve, value(i)]));
    })"""
    for joint, at in ((1, 0.3), (2, 0.62), (4, 0.8)):
        tab.page.select_option("#torque-of", index=joint)
        tab.run("(t) => alpha5.seek(t)", at * time[-1])
        torque, force, moment = tab.run(read)
        now = tab.run("() => Number(document.getElementById('time').value)")
        assert now == pytest.approx(at * time[-1])
        assert set(torque) == set(causes)
        for name, value in torque.items():
            expected = np.interp(now, time, causes[name][:, joint])
            assert value == pytest.approx(expected, abs=1e-5), name
        for values, first in ((force, 0), (moment, 3)):
            expected = [
                np.interp(now, time, analysis.base_wrench[:, first + k])
                for k in range(3)
            ]
            np.testing.assert_allclose(
                [values[axis] for axis in "xyz"], expected, atol=1e-5
            )
    # a hand in the strip moves arm, player and cursor alike
    box = tab.page.locator("#charts svg").first.bounding_box()
    tab.page.mouse.move(box["x"] + 3, box["y"] + 20)
    tab.page.mouse.down()
    tab.page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 20, steps=2)
    tab.page.mouse.up()
    now = tab.run("() => Number(document.getElementById('time').value)")
    assert now == pytest.approx(0.4 * time[-1], rel=0.02)
    expected = [np.interp(now, moved.time, column) for column in moved.position.T]
    np.testing.assert_allclose(tab.joints(), expected, atol=2e-5)
    cursor = tab.page.locator("#charts .plot i").first.bounding_box()
    assert cursor["x"] + 1 == pytest.approx(box["x"] + 0.4 * box["width"], abs=1.5)


def test_a_picture_holds_what_is_seen(tab: Tab) -> None:
    picture = tab.run("() => alpha5.picture()").split(",")[1]
    shot = np.asarray(
        Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    ).astype(int)
    left, top, right, bottom = tab.run("() => alpha5.free()")
    assert abs(shot.shape[1] - (right - left)) <= 2
    assert abs(shot.shape[0] - (bottom - top)) <= 2
    assert 0.01 < (shot.max(axis=2) < 90).mean() < 0.4, "the arm"
    tcp = np.array(tab.run("() => alpha5.state.poses.tcp"))[:, 3]
    x, y = tab.project(tcp[None])[0]
    label = shot[
        round(y - top) - 8 : round(y - top) + 8,
        round(x - left) + 12 : round(x - left) + 32,
    ]
    assert label.max() > 225, "the label's paper beside the tcp"
    assert label.min() < 130, "and its letters"
    with tab.page.expect_download() as kept:
        tab.page.get_by_role("button", name="PNG").click()
    with Image.open(kept.value.path()) as image:
        assert image.size == shot.shape[1::-1]
