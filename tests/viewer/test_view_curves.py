"""Curves of a recording, of the user and of a program, and a program's sliders."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab, open_scene

import alpha5_model as a5
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

TIME = np.linspace(0.0, 4.0, 81)
#: Sample at which the page is looked at.
AT = 37


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load()


@pytest.fixture(scope="module")
def recording(arm: a5.Arm) -> a5.trajectory.Motion:
    """A motion with efforts and currents that are off, and partly unknown."""
    turned = np.sin(TIME)[:, None] * np.array([0.4, 0.2, -0.2, 0.4])
    moved = a5.trajectory.motion(TIME, a5.named_pose("home") + turned)
    model = a5.trajectory.analyse(moved, arm)
    effort = model.torque + 0.03 * np.cos(9 * TIME)[:, None]
    effort[10:15] = np.nan
    current = model.current - 0.01
    return replace(moved, effort=effort, current=current)


@pytest.fixture(scope="module")
def tab(
    chromium: Any,
    arm: a5.Arm,
    recording: a5.trajectory.Motion,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Tab]:
    curves = {"battery (V)": 24 - 0.1 * TIME, "<b>depth</b>": np.cos(TIME)}
    scene = build_scene(arm, motion=recording, curves=curves)
    folder = tmp_path_factory.mktemp("curves")
    tab = open_scene(chromium, scene, folder, (1200, 800))
    tab.run("(time) => alpha5.seek(time)", TIME[AT])
    yield tab
    assert tab.complaints == []


def shown(tab: Tab, chart: int) -> dict[str, float]:
    """Name of a curve -> its number at the cursor, in one chart."""
    return dict(
        tab.run(
            """(i) => {
              const figure = document.querySelectorAll('#charts figure')[i];
              const items = [...figure.querySelectorAll('.item')];
              return items.map((item) => [
                item.dataset.curve,
                Number(item.querySelector('output').dataset.value),
              ]);
            }""",
            chart,
        )
    )


def draw(tab: Tab, chart: int, quantity: str) -> None:
    tab.page.locator("#charts select.what").nth(chart).select_option(quantity)


@needs_browser
def test_a_recording_stands_beside_the_model(
    tab: Tab, arm: a5.Arm, recording: a5.trajectory.Motion
) -> None:
    model = a5.trajectory.analyse(recording, arm)
    titles = tab.run(
        "() => [...document.querySelectorAll('.what')].map((each) => each.value)"
    )
    assert titles == ["Effort", "Effort, residual", "battery (V)"]
    for k, joint in enumerate(arm.joint_names):
        tab.page.select_option("#torque-of", joint)
        for title, unit, recorded, computed, name in (
            ("Effort", "N\u00b7m", model.effort, model.torque, "model"),
            ("Motor current", "A", model.recorded_current, model.current, "model"),
            (
                "Position",
                "\u00b0",
                np.degrees(recording.position),
                np.degrees(model.smooth.position),
                "smoothed",
            ),
        ):
            assert recorded is not None
            draw(tab, 0, title)
            draw(tab, 1, f"{title}, residual")
            for what in (title, f"{title}, residual"):
                whole = re.compile(f"^{what} of {joint} over time, .* to .* {unit}$")
                assert tab.page.get_by_role("img", name=whole).count() == 1
            both = shown(tab, 0)
            assert both["recorded"] == pytest.approx(recorded[AT, k], abs=6e-5)
            assert both[name] == pytest.approx(computed[AT, k], abs=6e-5)
            assert shown(tab, 1)["recorded minus computed"] == pytest.approx(
                recorded[AT, k] - computed[AT, k], abs=6e-5
            )


@needs_browser
def test_half_an_hour_keeps_its_swing_and_its_peak(
    chromium: Any, arm: a5.Arm, tmp_path: Path
) -> None:
    """1 Hz for 30 minutes, and 6 N m for 0.2 s: both are played and drawn."""
    time = np.arange(0.0, 1800.0, 0.05)
    swing = 0.3 * np.sin(2 * np.pi * time)
    effort = np.zeros((len(time), 4))
    effort[:, 1] = 0.8 * np.sin(2 * np.pi * time)
    effort[20_000:20_004, 1] = 6.0
    moved = a5.trajectory.motion(
        time, a5.named_pose("home") + np.outer(swing, [0, 1, 0, 0])
    )
    path = tmp_path / "page.html"
    scene = build_scene(arm, motion=replace(moved, effort=effort))
    path.write_text(static_page(scene), "utf-8")
    assert path.stat().st_size < 9e6
    tab = new_tab(chromium, (1200, 800))
    tab.open(path.as_uri())

    # Played: each quarter of a period is there, long after the start.
    home = a5.named_pose("home")[1]
    for at, expected in ((1501.25, 0.3), (1501.5, 0.0), (1501.75, -0.3)):
        tab.run("(time) => alpha5.seek(time)", at)
        assert tab.run("() => alpha5.state.q[1]") - home == pytest.approx(
            expected, abs=0.01
        )
    # Drawn: the heights of the recorded curve, from the numbers at the chart's ends.
    ends, points = tab.run("""() => {
      const figure = document.querySelector('#charts figure');
      const ends = [...figure.querySelectorAll('small')].map((e) => e.textContent);
      const line = figure.querySelector('polyline.recorded');
      return [ends, [...line.points].map((p) => [p.x, p.y])];
    }""")
    high, low = (float(text.replace("\u2212", "-")) for text in ends)
    x, y = np.array(points).T
    drawn = low + (96 - y) / 92 * (high - low)
    assert drawn.max() == pytest.approx(6.0, rel=0.01)
    assert x[drawn.argmax()] == pytest.approx(1000 * 1000 / time[-1], abs=1.0)
    for part in np.array_split(drawn, 50):
        assert part.min() == pytest.approx(-0.8, abs=0.02)
        assert np.sort(part)[-3] == pytest.approx(0.8, abs=0.02)
    said = tab.page.locator("#thinned").text_content()
    assert said == "Curves show the lowest and highest of each 1.80 s."
    tab.run("() => alpha5.seek(1000.1)")
    at_peak = tab.page.locator("#charts [data-curve=recorded] output").first
    assert at_peak.text_content() == "\u22120.80 to 6.00"
    assert tab.complaints == []


@needs_browser
def test_what_is_not_known_is_a_gap(tab: Tab) -> None:
    draw(tab, 0, "Effort")
    first = tab.page.locator("#charts figure").first
    assert first.locator("polyline.recorded").count() == 2
    tab.run("(time) => alpha5.seek(time)", TIME[12])
    said = tab.page.locator("#charts [data-curve=recorded] output").first
    assert said.text_content() == "\u2013"
    tab.run("(time) => alpha5.seek(time)", TIME[AT])


@needs_browser
def test_signals_of_the_user_are_drawn_by_name(tab: Tab) -> None:
    assert shown(tab, 2)["value"] == pytest.approx(24 - 0.1 * TIME[AT])
    draw(tab, 2, "<b>depth</b>")
    assert shown(tab, 2)["value"] == pytest.approx(np.cos(TIME[AT]))
    assert tab.run("() => document.querySelectorAll('.what b').length") == 0
    draw(tab, 2, "battery (V)")


def test_signals_that_do_not_fit_are_refused(
    arm: a5.Arm, recording: a5.trajectory.Motion
) -> None:
    with pytest.raises(ShapeError, match=r"curves\['depth'\]"):
        build_scene(arm, motion=recording, curves={"depth": TIME[1:]})
    with pytest.raises(InputError, match="1 to 40 printable characters"):
        build_scene(arm, motion=recording, curves={"a\nb": TIME})
    with pytest.raises(InputError, match="a motion, with whose samples they go"):
        build_scene(arm, curves={"depth": TIME})
