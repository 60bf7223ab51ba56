"""The arm travels on the page: where it goes, how fast, and what is said of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

pytestmark = needs_browser

SPEED = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
#: Between two frames of the tests' clock [s].
FRAME = 0.04
#: The browser's clock and frames, by hand: frames(n) draws n and returns q of each.
CLOCK = """(frame) => {
  let waiting = [];
  let now = 1000;
  performance.now = () => now;
  window.requestAnimationFrame = (then) => waiting.push(then);
  window.frames = (count) => Array.from({ length: count }, () => {
    now += 1000 * frame;
    const due = waiting;
    waiting = [];
    for (const then of due) then(now);
    return alpha5.state.q;
  });
}"""
NAMES = ("x", "y", "z")


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load()


@pytest.fixture(scope="module")
def opened(
    chromium: Any, tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Tab]:
    def show(arm: a5.Arm, **options: Any) -> Tab:
        path = Path(tmp_path_factory.mktemp("travel"), "page.html")
        path.write_text(static_page(build_scene(arm)), "utf-8")
        tab = new_tab(chromium, **{"reduced_motion": "no-preference", **options})
        tab.open(path.as_uri())
        tab.run(CLOCK, FRAME)
        return tab

    return show


@pytest.fixture(scope="module")
def shared(opened: Callable[..., Tab], arm: a5.Arm) -> Tab:
    """One page for many tests, because a page costs seconds."""
    return opened(arm)


@pytest.fixture
def tab(shared: Tab) -> Iterator[Tab]:
    """That page, at rest at home, without a target."""
    tab = shared
    tab.run("() => alpha5.change({ aim: null, q: alpha5.data.poses.home })")
    frames(tab, 2)
    yield tab
    assert tab.complaints == []


def place(tab: Tab, q: Any) -> None:
    tab.run("(q) => alpha5.change({ q })", list(map(float, q)))


def frames(tab: Tab, count: int) -> np.ndarray:
    return np.array(tab.run("(count) => frames(count)", count))


def told(tab: Tab) -> str:
    return str(tab.run("() => document.getElementById('travel').textContent"))


def type_target(tab: Tab, target: Any) -> None:
    for name, value in zip(NAMES, target, strict=True):
        tab.page.fill(f"#target input[name={name}]", f"{1e3 * value:.3f}")
    tab.page.press("#target input[name=z]", "Enter")


def test_a_named_pose_is_reached_at_rated_speed(tab: Tab) -> None:
    """All joints arrive together, the slowest at its rated speed."""
    start = np.array([0.5, 1.2, 1.5, 1.0])
    goal = a5.named_pose("reach")
    place(tab, start)
    frames(tab, 1)
    tab.page.get_by_role("button", name="reach", exact=True).click()
    seconds = float(np.max(np.abs(goal - start) / SPEED))
    assert told(tab) == f"reach: {seconds:.1f} s at rated speed."

    q = frames(tab, int(seconds / FRAME) + 3)
    share = np.minimum(FRAME * (1 + np.arange(len(q))) / seconds, 1.0)
    np.testing.assert_allclose(q, start + share[:, None] * (goal - start), atol=1e-9)
    assert q[-1].tolist() == goal.tolist()
    assert told(tab) == ""
    # The arm is there: nothing moves, and nothing is said.
    tab.page.get_by_role("button", name="reach", exact=True).click()
    assert told(tab) == ""
    assert frames(tab, 3).tolist() == [goal.tolist()] * 3


def test_buttons_and_typed_targets_travel(tab: Tab, arm: a5.Arm) -> None:
    target = np.array([0.06, 0.05, 0.36])  # all branches reach it
    place(tab, [3.0, 1.5, 1.5, 1.0])
    type_target(tab, target)
    assert told(tab).startswith("Target: ")
    halfway = frames(tab, 20)[-1]
    assert np.linalg.norm(arm.forward_kinematics(halfway).translation - target) > 0.01
    assert tab.message() == ""
    there = frames(tab, 600)[-1]
    away = arm.forward_kinematics(there).translation - target
    assert np.linalg.norm(away) < 1e-9

    tab.page.get_by_role("button", name="overarm", exact=True).click()
    assert told(tab).startswith("overarm: ")
    assert np.abs(frames(tab, 1)[0] - there).max() < SPEED.max() * FRAME
    there = frames(tab, 900)[-1]
    away = arm.forward_kinematics(there).translation - target
    assert np.linalg.norm(away) < 1e-9


def test_a_drag_across_the_yaw_axis_does_not_jump(tab: Tab, arm: a5.Arm) -> None:
    """axis_e turns by half a turn there; without a limit, between two frames."""
    start = a5.inverse_kinematics([0.05, 0.01, 0.20]).best([3.0, 1.5, 1.5, 1.0])
    place(tab, start)
    frames(tab, 2)
    at = arm.forward_kinematics(start).translation
    pixels = tab.project(np.array([at, at * [-1.0, -1.0, 1.0]]))
    tab.page.mouse.move(*pixels[0])
    tab.page.mouse.down()
    rows = [start]
    for share in np.linspace(0, 1, 25)[1:]:
        tab.page.mouse.move(*(pixels[0] + share * (pixels[1] - pixels[0])))
        rows.extend(frames(tab, 1))
    tab.page.mouse.up()
    assert told(tab) == "The arm follows as fast as it can."
    rows.extend(frames(tab, 300))
    moved = np.array(rows)
    assert np.ptp(moved[:, 0]) > 2.0
    chased = np.abs(np.diff(moved[-200:], axis=0))
    assert (chased <= SPEED * FRAME * (1 + 1e-9)).all()
    assert np.abs(np.diff(moved, axis=0)).max() < 0.35
    assert told(tab) == ""


def test_who_wants_no_motion_sees_the_end_at_once(
    opened: Callable[..., Tab], arm: a5.Arm
) -> None:
    tab = opened(arm, reduced_motion="reduce")
    tab.page.get_by_role("button", name="reach", exact=True).click()
    assert frames(tab, 1)[0].tolist() == a5.named_pose("reach").tolist()
    assert told(tab) == ""
    assert tab.complaints == []


def test_a_slider_leaves_the_target(tab: Tab) -> None:
    place(tab, [3.0, 1.5, 1.5, 1.0])
    type_target(tab, [0.2, 0.1, 0.1])
    frames(tab, 600)
    tab.page.get_by_label("axis_d", exact=True).first.press("ArrowRight")
    assert tab.run("() => alpha5.state.aim") is None
    fields = tab.page.locator("#target input")
    assert [fields.nth(k).input_value() for k in range(3)] == [""] * 3
    assert tab.message() == ""


def test_keys_move_sliders_and_the_tip_by_small_steps(tab: Tab, arm: a5.Arm) -> None:
    start = np.array([3.0, 1.5, 1.5, 1.0])
    place(tab, start)
    slider = tab.page.get_by_label("axis_d", exact=True).first
    assert slider.get_attribute("aria-valuetext") == "85.9°"
    for key, degrees in (("ArrowRight", 0.1), ("PageDown", -1.0), ("ArrowUp", 0.1)):
        before = tab.run("() => alpha5.state.q[1]")
        slider.press(key)
        turned = np.degrees(tab.run("() => alpha5.state.q[1]") - before)
        assert turned == pytest.approx(degrees, abs=1e-9)
    place(tab, start)
    slider.press("Home")
    assert tab.run("() => alpha5.state.q[1]") == pytest.approx(arm.limits.lower[1])

    place(tab, start)
    frames(tab, 2)
    at = arm.forward_kinematics(start).translation
    tip = tab.page.get_by_role("application")
    for key, length in (("ArrowRight", 1e-3), ("Shift+ArrowUp", 1e-2)):
        place(tab, start)
        tip.press(key)
        q = frames(tab, 2)[-1]
        moved = arm.forward_kinematics(q).translation - at
        assert np.linalg.norm(moved) == pytest.approx(length, abs=1e-9)
        before, after = tab.project(np.array([at, at + moved]))
        right, down = after - before
        assert (right if key == "ArrowRight" else -down) > 0.0
