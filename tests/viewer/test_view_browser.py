"""The demo's page and the live viewer in a real browser.

Tests compare what is on the canvas, and what moves it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab
from demo_run import demo_run
from reference import UPPER

import alpha5_model as a5
from alpha5_model.viewer.poses import named_poses

pytestmark = needs_browser


@pytest.fixture(scope="module")
def demo() -> tuple[Path, str]:
    """The demo's folder, and what it said."""
    return demo_run()


@pytest.fixture(scope="module")
def opened(chromium: Any, demo: tuple[Path, str]) -> Iterator[Tab]:
    tab = new_tab(chromium)
    tab.open((demo[0] / "alpha5.html").as_uri())
    yield tab
    tab.page.close()


@pytest.fixture
def page(opened: Tab) -> Tab:
    """The demo's page, at home, with its groups as written."""
    opened.reset()
    return opened


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load(gripper="jaws")


def wait_for(condition: Callable[[], Any], seconds: float = 120.0) -> None:
    """Wait for something that another thread does."""
    ends = time.perf_counter() + seconds
    while not condition():
        assert time.perf_counter() < ends
        time.sleep(0.01)


def shown_pose(page: Tab, link: str) -> np.ndarray:
    """Pose of a link as three.js has it in its scene."""
    script = """(link) => {
      const path = ['meshcat', 'alpha5', 'bodies', link];
      const node = alpha5.viewer.scene_tree.find(path).object;
      node.updateMatrix();
      return node.matrix.elements;
    }"""
    elements = page.run(script, link)
    return np.reshape(elements, (4, 4)).T


def test_no_complaint_and_no_request_leaves_the_machine(
    page: Tab, demo: tuple[Path, str]
) -> None:
    assert page.complaints == []
    assert page.requests == [(demo[0] / "alpha5.html").as_uri()]


def test_the_page_could_not_ask_for_more_if_it_tried(page: Tab) -> None:
    """Negative control: a request made on purpose is refused and seen."""
    page.run("() => fetch('http://127.0.0.1:9/x').catch(() => 0)")
    page.wait(
        lambda: any("Content Security Policy" in said for said in page.complaints)
    )
    page.complaints.clear()
    del page.requests[1:]


def test_a_slider_moves_what_is_drawn(page: Tab, arm: a5.Arm) -> None:
    page.show_only("bodies")
    q = named_poses(arm)["home"].copy()
    for i, value in enumerate((2.0, 1.9, 1.2, 3.0, 0.012)):
        before = page.pixels()
        q[i] = value
        page.slide(arm.joint_names[i], value)
        for link in (*(f"link_{k}" for k in range(5)), "finger_1", "finger_2"):
            expected = arm.forward_kinematics(q, frame=link).homogeneous
            np.testing.assert_allclose(shown_pose(page, link), expected, atol=1e-6)
        changed = np.abs(page.pixels() - before).max(axis=2) > 20
        assert changed.mean() > 1e-3, arm.joint_names[i]
    assert page.complaints == []


def coloured(pixels: np.ndarray, strong: int, weak: int) -> int:
    return int((pixels[..., strong] - pixels[..., weak] > 90).sum())


def test_labels_stand_beside_what_they_name(page: Tab, arm: a5.Arm) -> None:
    page.settle()
    found = page.run("""() => {
      const labels = [...document.querySelectorAll('#labels div')];
      const shown = labels.filter((d) => d.style.display !== 'none');
      return shown.map((d) => {
        const { left, top, right, bottom } = d.getBoundingClientRect();
        return [d.textContent, left, top, right, bottom];
      });
    }""")
    labels = {text: box for text, *box in found}
    assert {"tcp", "axis_e", "axis_c", "centre of mass"} <= set(labels)
    q = named_poses(arm)["home"]
    for name, point in (
        ("tcp", arm.forward_kinematics(q).translation),
        ("centre of mass", arm.center_of_mass(q)),
    ):
        x, y = page.project(point[None])[0]
        left, top, right, bottom = labels[name]
        assert abs(left - x - 10) < 2
        assert top - 4 < y < bottom + 60
    boxes = list(labels.values())
    for i, (l, t, r, b) in enumerate(boxes):  # noqa: E741
        for left, top, right, bottom in boxes[:i]:
            assert (
                r <= left + 1 or right <= l + 1 or b <= top + 1.5 or bottom <= t + 1.5
            )
    page.page.locator("#groups input[name='labels']").click()
    page.settle()
    assert page.run("""() => {
      const labels = [...document.querySelectorAll('#labels div')];
      return labels.every((d) => d.style.display === 'none');
    }""")


def test_live_viewer(chromium: Any) -> None:
    arm = a5.load(gripper="jaws")
    start = np.array([2.0, 1.0, 2.2, 0.4, 0.002])
    visualizer = a5.view(arm, start)
    tab = new_tab(chromium)
    try:
        tab.open(visualizer.url())
        tab.page.wait_for_function("() => Math.abs(alpha5.state.q[0] - 2.0) < 1e-9")
        tab.show_only("bodies")
        first = tab.pixels()
        assert (first.max(axis=2) < 110).mean() > 0.01
        # Python moves the page: bodies, sliders, readout
        q = np.array([1.0, 2.0, 3.0, 4.0, 0.010])
        visualizer.display(q)
        tab.page.wait_for_function("() => Math.abs(alpha5.state.q[3] - 4.0) < 1e-9")
        np.testing.assert_allclose(tab.run("() => alpha5.state.q"), q, atol=1e-9)
        expected = arm.forward_kinematics(q, frame="finger_2").homogeneous
        np.testing.assert_allclose(shown_pose(tab, "finger_2"), expected, atol=1e-6)
        assert (np.abs(tab.pixels() - first).max(axis=2) > 20).mean() > 0.01
        # a hand moves it too
        tab.slide("axis_d", 0.5)
        q[1] = 0.5
        expected = arm.forward_kinematics(q, frame="link_4").homogeneous
        np.testing.assert_allclose(shown_pose(tab, "link_4"), expected, atol=1e-6)
        # groups from Python
        visualizer.show("weight")
        tab.page.wait_for_function(
            "() => document.querySelector(\"input[name='weight']\").checked"
        )
        assert coloured(tab.pixels(), 0, 2) > 150
        # With a browser, playing is not faster than real time; it may be slower.
        track = np.linspace(
            [1.0, 1.0, 1.0, 1.0, 0.002], [2.0, 2.0, 2.0, 2.0, 0.012], 50
        )
        assert visualizer.play(track, 0.03) > 1.4
        tab.page.wait_for_function("() => Math.abs(alpha5.state.q[2] - 2.0) < 1e-9")
        assert tab.complaints == []
        origin = visualizer.url().removesuffix("/")
        assert all(url.startswith(origin) for url in tab.requests)
    finally:
        tab.page.close()
        visualizer.close()


def test_two_tabs_python_and_the_end_of_the_program(chromium: Any) -> None:
    arm, seen = a5.load(gripper="jaws"), []
    visualizer = a5.view(arm, [2.0, 1.0, 2.2, 0.4, 0.002])
    visualizer.on_change(seen.append)
    url = visualizer.url()
    tabs = [new_tab(chromium, (400, 300)), new_tab(chromium, (400, 300))]
    try:
        tabs[0].open(url)
        tabs[1].open(url.replace("127.0.0.1", "localhost"))
        tabs[0].page.wait_for_function("() => alpha5.state.q[0] === 2")
        tabs[0].slide("axis_d", 0.5)
        tabs[1].page.wait_for_function("() => alpha5.state.q[1] === 0.5")
        np.testing.assert_array_equal(visualizer.q, [2.0, 0.5, 2.2, 0.4, 0.002])
        wait_for(lambda: seen and (seen[-1] == visualizer.q).all())
        tabs[1].slide("axis_a", 0.01)
        tabs[0].page.wait_for_function("() => alpha5.state.q[4] === 0.01")
        tabs[0].page.reload()
        tabs[0].page.wait_for_function(
            "() => alpha5.state.q[1] === 0.5 && alpha5.state.q[4] === 0.01"
        )
        # beyond its limits too, and as it is: an angle is not turned back by 2 pi
        visualizer.display([2.0, 0.5, 2.2, 9.0, 0.002])
        tabs[1].page.wait_for_function("() => alpha5.state.q[3] === 9")
        assert tabs[0].complaints == tabs[1].complaints == []
        visualizer.close()
        for tab in tabs:
            tab.page.wait_for_selector("#message :text('has ended')")
    finally:
        for tab in tabs:
            tab.page.close()
        visualizer.close()


def test_a_page_checks_what_is_typed(chromium: Any) -> None:
    arm, seen = a5.load(gripper="jaws"), []
    start = [2.0, 1.0, 2.2, 0.4, 0.005]
    visualizer = a5.view(arm, start)
    visualizer.on_change(seen.append)
    tab = new_tab(chromium, (1400, 900))
    try:
        tab.open(visualizer.url())
        # "9" * 400 is no number that JavaScript knows.
        for text in ("400", "-10", "1e60", "9" * 300, "e", "9" * 400):
            tab.type_into("axis_b in \u00b0", text)
            assert tab.message().startswith("axis_b "), text
            assert len(tab.message()) < 120
            assert tab.page.input_value("#axis_b-value") == "22.92"
        tab.type_into("axis_a in mm", "50")
        assert tab.message().startswith("axis_a cannot go to 50 mm")
        for text in ("1e60", "e"):
            tab.type_into("target y in mm", "50")
            assert tab.message() == ""
            tab.type_into("target y in mm", text)
            assert tab.message().startswith("The target's y ")
            assert tab.page.input_value("#target input[name=y]") == ""
        assert seen == []
        assert visualizer.q.tolist() == start
        # A limit as the page shows it is rounded beyond itself; it counts as the limit.
        # It takes the message away.
        shown = f"{math.degrees(UPPER[1]):.2f}"
        assert math.radians(float(shown)) > UPPER[1]
        tab.type_into("axis_d in \u00b0", shown)
        assert tab.message() == ""
        wait_for(lambda: seen)
        assert (
            seen[0].tolist()
            == visualizer.q.tolist()
            == [2.0, UPPER[1], 2.2, 0.4, 0.005]
        )
        assert tab.complaints == []
    finally:
        tab.page.close()
        visualizer.close()


def test_a_page_that_is_refused_says_so_and_goes_back(chromium: Any) -> None:
    arm, seen = a5.load(), []
    visualizer = a5.view(arm, [2.0, 1.0, 2.2, 9.0])
    visualizer.on_change(seen.append)
    tab = new_tab(chromium)
    try:
        tab.open(visualizer.url())
        tab.run("() => alpha5.viewer.connection.send('{\"q\": [99, 99, 99, 99]}')")
        tab.page.wait_for_selector("#message :text('Python refused this')")
        assert "Python refused this: axis_e: 99 rad" in tab.message()
        assert tab.run("() => alpha5.state.q[0]") == 2.0
        assert visualizer.q.tolist() == [2.0, 1.0, 2.2, 9.0]
        assert seen == []
        # What a hand moves stays within the limits, also if Python showed it beyond.
        tab.slide("axis_d", 0.5)
        wait_for(lambda: seen and seen[-1].tolist() == [2.0, 0.5, 2.2, UPPER[3]])
        tab.page.wait_for_function(f"() => alpha5.state.q[3] === {float(UPPER[3])!r}")
        assert tab.message() == ""
        assert tab.complaints == []
    finally:
        tab.page.close()
        visualizer.close()


def test_a_page_is_asked_for_its_picture(chromium: Any) -> None:
    """The picture has what another program added, which Python's drawing lacks."""
    import meshcat.geometry

    visualizer = a5.view(a5.load())
    tabs = [new_tab(chromium, (400, 300)), new_tab(chromium, (400, 300))]
    try:
        for tab in tabs:
            tab.open(visualizer.url())
        for _ in range(3):
            plain = np.asarray(visualizer.get_image().convert("RGB")).astype(int)
            assert plain.shape == (300, 400, 3)
        paint = meshcat.geometry.MeshBasicMaterial(color=0x00FF00)
        visualizer["mine"].set_object(meshcat.geometry.Sphere(0.2), paint)
        green = [0, 255, 0]
        assert not (plain == green).all(axis=2).any()
        after = np.asarray(visualizer.get_image().convert("RGB")).astype(int)
        assert (after == green).all(axis=2).sum() > 1000
        assert tabs[0].complaints == tabs[1].complaints == []
    finally:
        for tab in tabs:
            tab.page.close()
        visualizer.close()
