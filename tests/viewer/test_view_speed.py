"""What makes frames cheap must not be seen: light at vertices, a panel that waits."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

pytestmark = needs_browser

#: Half of the levels between two pixels that look alike.
ALIKE = 6
READOUT = "() => document.getElementById('readout').textContent"


@pytest.fixture(scope="module")
def text() -> str:
    return static_page(build_scene(a5.load()))


@pytest.fixture(scope="module")
def tab(
    chromium: Any, text: str, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Tab]:
    tab = opened(chromium, text, tmp_path_factory.mktemp("speed"))
    yield tab
    assert tab.complaints == []


def opened(chromium: Any, text: str, folder: Path) -> Tab:
    path = folder / "page.html"
    path.write_text(text, "utf-8")
    tab = new_tab(chromium)
    tab.open(path.as_uri())
    return tab


def replaced(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1
    return text.replace(old, new)


def differences(tab: Tab, other: Tab) -> np.ndarray:
    """Of the pixels of the bodies."""
    for each in (tab, other):
        each.show_only("bodies")
    seen = tab.pixels()
    tab.show_only()
    body = (np.abs(seen - tab.pixels()) > ALIKE).any(axis=2)
    assert body.mean() > 0.03
    return np.abs(seen - other.pixels()).max(axis=2)[body]


def test_light_at_vertices_looks_like_light_at_pixels(
    chromium: Any, tab: Tab, text: str, tmp_path: Path
) -> None:
    by_pixel = replaced(text, "litAtVertices(part.material)", "part.material")
    off = differences(tab, opened(chromium, by_pixel, tmp_path))
    assert np.median(off) <= ALIKE
    assert (off > 10 * ALIKE).mean() < 0.02

    dull = replaced(text, "+ vShine + totalEmissive", "+ totalEmissive")
    off = differences(tab, opened(chromium, dull, tmp_path))
    assert (off > 10 * ALIKE).mean() > 0.02, "highlights are seen"


def test_the_panel_follows_a_travel_and_ends_with_it(tab: Tab) -> None:
    tab.run("() => alpha5.setPose([3, 1, 2, 0])")
    before = tab.run(READOUT)
    poses = [[3 + 0.01 * k, 1, 2, 0] for k in range(1, 6)]
    texts = tab.run(
        """(poses) => poses.map((q) => {
          alpha5.setPose(q, "travel");
          return document.getElementById("readout").textContent;
        })""",
        poses,
    )
    assert texts[0] == before, "two frames in a row paint the panel once"
    tab.page.wait_for_timeout(700)
    x, y, z = 1e3 * a5.load().forward_kinematics(np.array(poses[-1])).translation
    shown = f"tcp  x {x:.1f}  y {y:.1f}  z {z:.1f} mm".replace("-", "\u2212")
    assert tab.run(READOUT) == shown

    # A hand is followed at once.
    tab.run("() => alpha5.setPose([3, 1, 2, 0])")
    assert tab.run(READOUT) == before
