"""A browser without WebGL shows the numbers, and no controls of a picture."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import page_digits
import pytest
from browser import CHROMIUM, Tab, needs_browser, new_tab

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

pytestmark = needs_browser

TIME = np.linspace(0.0, 2.0, 21)
HOME = a5.named_pose("home")


@pytest.fixture(scope="module")
def blind(chromium: Any) -> Iterator[Any]:
    """Chromium that was started without WebGL."""
    options = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]
    running = chromium.browser_type.launch(executable_path=CHROMIUM, args=options)
    yield running
    running.close()


def opened(running: Any, page: Path, size: tuple[int, int] = (1280, 900)) -> Tab:
    tab = new_tab(running, size)
    tab.page.goto(page.as_uri())
    tab.wait(lambda: tab.run("() => document.documentElement.dataset.ready"))
    return tab


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page of a motion."""
    path = tmp_path_factory.mktemp("blind") / "page.html"
    motion = a5.trajectory.motion(TIME, HOME + 0.1 * np.sin(TIME)[:, None])
    path.write_text(static_page(build_scene(a5.load(), motion=motion)), "utf-8")
    return path


def test_the_numbers_stay(blind: Any, page: Path) -> None:
    tab = opened(blind, page)
    one = page_digits.case("locked")
    count, wrong = page_digits.differences(tab, one, page_digits.poses(one, 20, seed=9))
    assert (count, wrong) == (140, [])

    # Targets are solved, and the charts follow the motion.
    target = a5.load().forward_kinematics(HOME + 0.2).translation
    for axis, value in zip("xyz", 1e3 * target, strict=True):
        tab.page.fill(f"#target input[name={axis}]", f"{value:.4f}")
    tab.page.keyboard.press("Tab")
    reached = a5.load().forward_kinematics(tab.run("() => alpha5.state.q")).translation
    np.testing.assert_allclose(reached, target, atol=1e-6)

    tab.page.click("#joints input[name=axis_d]")
    tab.page.keyboard.press("ArrowRight")
    tab.run("(time) => alpha5.seek(time)", TIME[7])
    moved = tab.page.locator("#axis_d-value").input_value()
    assert moved == f"{np.degrees(HOME[1] + 0.1 * np.sin(TIME[7])):.2f}"
    total = tab.page.locator("#charts [data-curve=total] output").first
    row = a5.trajectory.motion(TIME, HOME + 0.1 * np.sin(TIME)[:, None])
    expected = a5.trajectory.analyse(row, a5.load()).torque[7, 1]
    assert float(total.get_attribute("data-value")) == pytest.approx(expected, abs=1e-5)
    assert all("WebGL" in complaint for complaint in tab.complaints)


@pytest.mark.parametrize("size", [(1280, 900), (390, 844)])
def test_controls_of_the_picture_go(
    blind: Any, page: Path, size: tuple[int, int]
) -> None:
    tab = opened(blind, page, size)
    for dead in ("#pane", "#tip", "#scale", "#labels", "#png", "[name=weight]"):
        assert not tab.page.locator(dead).is_visible(), dead
    assert tab.page.locator("#views button:visible").all_text_contents() == ["Link"]
    for alive in ("#message p", "#joints", "[name=current]", "#link"):
        assert tab.page.locator(alive).first.is_visible(), alive
    assert tab.page.locator("#message p").count() == 1
