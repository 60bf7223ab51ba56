"""The curves of a motion say what they show, in a real browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, open_scene

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene

pytestmark = needs_browser

HOME = a5.named_pose("home")


@pytest.fixture
def tab(chromium: Any, tmp_path: Path) -> Tab:
    """A page at home, with a motion that starts elsewhere."""
    time = np.linspace(0.0, 2.0, 21)
    turned = HOME + np.array([0.3, 0.2, -0.2, 0.1])
    motion = a5.trajectory.motion(time, turned + 0.1 * np.sin(time)[:, None])
    return open_scene(chromium, build_scene(a5.load(), HOME, motion=motion), tmp_path)


def numbers_are_seen(tab: Tab) -> bool:
    """Whether the curves' numbers and the coloured cursor are seen."""
    looks = tab.run("""() => {
      const charts = document.getElementById("charts");
      const cursor = getComputedStyle(charts.querySelector("i")).borderLeftStyle;
      const outputs = [...charts.querySelectorAll("output")];
      return [cursor, ...outputs.map((each) => getComputedStyle(each).visibility)];
    }""")
    assert len(looks) > 5
    seen = {looks[0] == "solid", *(look == "visible" for look in looks[1:])}
    assert len(seen) == 1
    return bool(seen.pop())


def test_the_numbers_of_the_curves_belong_to_the_pose(tab: Tab) -> None:
    assert not numbers_are_seen(tab)  # the page shows home, the motion is elsewhere
    tab.run("() => alpha5.seek(1.0)")
    assert numbers_are_seen(tab)
    tab.run("(q) => alpha5.change({ q })", HOME.tolist())
    assert not numbers_are_seen(tab)
    tab.run("() => alpha5.seek(2.0)")
    assert numbers_are_seen(tab)
    assert tab.complaints == []


@pytest.mark.parametrize(
    ("part", "named"),
    [
        ({"payload": {"mass": 0.5, "com": [0, 0, 0], "volume": 0}}, "payload"),
        ({"density": 0.0}, "fluid"),
        ({"attitude": [0.0, 0.5]}, "mount"),
        ({"shown": {"current": True}}, "current"),
    ],
)
def test_curves_of_other_loads_than_the_panels_are_grey(
    tab: Tab, part: dict[str, Any], named: str
) -> None:
    """Until the page again has what the motion was computed with."""
    stale = "() => document.querySelectorAll('figure.stale').length"
    keys = "(keys) => Object.fromEntries(keys.map((key) => [key, alpha5.state[key]]))"
    before = tab.run(keys, list(part))
    assert tab.run(stale) == 0
    tab.change(**part)
    assert tab.run(stale) == 3
    assert f"another {named} than" in str(tab.page.locator("#other").text_content())
    tab.change(**before)
    assert tab.run(stale) == 0
    assert tab.page.locator("#other").text_content() == ""


@pytest.mark.parametrize(
    ("width", "height"), [(1280, 480), (720, 450), (640, 360), (390, 844), (844, 390)]
)
def test_the_strip_leaves_room_for_the_arm(tab: Tab, width: int, height: int) -> None:
    """As it opens, and unfolded; 720 by 450 is a laptop's window at 200 % zoom."""
    tab.page.set_viewport_size({"width": width, "height": height})
    tab.page.reload()
    tab.wait(lambda: tab.run("() => document.documentElement.dataset.ready"))
    unfolded = "() => !document.getElementById('charts').hidden"
    assert tab.run(unfolded) == (height > 600)
    for _ in range(2):
        tab.settle()
        _, top, _, bottom = tab.run("() => alpha5.free()")
        strip = tab.page.locator("#strip").bounding_box()
        assert bottom <= strip["y"]
        assert bottom - top > 0.25 * height
        if tab.run(unfolded):
            break
        tab.page.locator("#curves").click()


def axis_of(tab: Tab) -> list[list[float]]:
    """Of each tick of the first chart: time, its place, and that of the curves then."""
    return tab.run("""() => {
      const figure = document.querySelector('#charts figure');
      const svg = figure.querySelector('svg');
      const last = alpha5.data.motion.time.at(-1);
      const across = (x) => new DOMPoint(x, 0).matrixTransform(svg.getScreenCTM()).x;
      return [...figure.querySelectorAll('.axis span')].map((tick) => {
        const { left, width } = tick.getBoundingClientRect();
        const middle = left + (tick.style.transform === 'none' ? 0 : width / 2);
        const time = parseFloat(tick.textContent);
        return [time, middle, across(1000 * time / last)];
      });
    }""")


def test_charts_zoom_in_time(tab: Tab) -> None:
    """By wheel, keys and a double click; the ticks, curves and cursor stay together."""
    tab.page.click("#curves")
    svg = tab.page.locator("#charts svg").first
    box = svg.bounding_box()
    at_half_a_second = box["x"] + box["width"] / 4
    tab.page.mouse.move(at_half_a_second, box["y"] + 20)
    tab.page.mouse.wheel(0, -800)
    tab.wait(lambda: axis_of(tab)[-1][0] < 1.0)
    ticks = axis_of(tab)
    # exp(0.002 * 800) times as near around 0.5 s, of 2 s
    shown = 2.0 * np.exp(-1.6)
    assert ticks[1][0] - ticks[0][0] == pytest.approx(0.2)
    for time, place, curve in ticks:
        meant = box["x"] + box["width"] * ((time - 0.5) / shown + 0.25)
        assert place == pytest.approx(meant, abs=1.0)
        assert curve == pytest.approx(meant, abs=1.0)
        tab.run("(time) => alpha5.seek(time)", time)
        cursor = tab.page.locator(".plot i").first.bounding_box()
        assert cursor["x"] == pytest.approx(meant, abs=2.5)

    # A drag moves to the time under the pointer.
    tab.page.mouse.down()
    assert tab.run("() => document.getElementById('time').valueAsNumber") == (
        pytest.approx(0.5, abs=0.01)
    )
    tab.page.mouse.up()
    # The charts follow the cursor, and a double click shows all.
    tab.run("() => alpha5.seek(1.8)")
    assert axis_of(tab)[0][0] > 1.5
    svg.dblclick()
    assert [time for time, *_ in axis_of(tab)] == [0.0, 0.5, 1.0, 1.5]
    tab.page.focus("#time")
    tab.page.keyboard.press("+")
    assert axis_of(tab)[-1][0] - axis_of(tab)[0][0] < 1.0
    tab.page.keyboard.press("0")
    assert [time for time, *_ in axis_of(tab)] == [0.0, 0.5, 1.0, 1.5]
    assert tab.complaints == []


def test_two_fingers_stretch_the_charts(tab: Tab) -> None:
    """Each finger stays on its time: 0.5 s and 1 s end at a tenth and nine tenths."""
    tab.page.click("#curves")
    tab.run("""() => {
      const svg = document.querySelector('#charts svg');
      const box = svg.getBoundingClientRect();
      svg.setPointerCapture = () => {};
      const finger = (type, pointerId, share) => svg.dispatchEvent(new PointerEvent(
        type, { pointerId, clientX: box.left + share * box.width, buttons: 1 }));
      finger('pointerdown', 7, 0.25);
      finger('pointerdown', 8, 0.5);
      finger('pointermove', 7, 0.1);
      finger('pointermove', 8, 0.9);
      finger('pointerup', 7, 0.1);
      finger('pointerup', 8, 0.9);
    }""")
    box = tab.page.locator("#charts svg").first.bounding_box()
    for time, place, _ in axis_of(tab):
        meant = 0.1 + 0.8 * (time - 0.5) / 0.5
        assert (place - box["x"]) / box["width"] == pytest.approx(meant, abs=0.005)


def test_a_motion_plays_at_a_chosen_speed_once_or_in_a_loop(tab: Tab) -> None:
    """The page's own clock is turned on by hand: each picture comes when it says."""
    tab.run("""() => {
      let clock = 0;
      let next = null;
      performance.now = () => clock;
      globalThis.requestAnimationFrame = (step) => { next = step; };
      globalThis.turn = (seconds) => { clock += 1e3 * seconds; next(clock); };
      alpha5.seek(0);
    }""")
    shown = "() => document.getElementById('time').valueAsNumber"
    name = "() => document.getElementById('play').getAttribute('aria-label')"
    tab.page.select_option("#speed", "0.25")
    tab.page.click("#play")
    tab.run("() => turn(2)")
    assert tab.run(shown) == pytest.approx(0.5)
    tab.page.select_option("#speed", "2")
    tab.run("() => turn(0.5)")
    assert tab.run(shown) == pytest.approx(1.5)
    tab.run("() => turn(0.75)")  # in a loop: 1 s after the end
    assert tab.run(shown) == pytest.approx(1.0)
    tab.page.click("#loop")
    tab.run("() => turn(3)")
    assert tab.run(shown) == pytest.approx(2.0)
    assert tab.run(name) == "Play"
