"""What a screen reader and a keyboard find on the page, by Chromium's own tree."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from browser import needs_browser, open_scene

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene

pytestmark = needs_browser

NAMED = ("button", "checkbox", "combobox", "image", "img", "slider", "spinbutton")


def test_each_control_chart_and_picture_has_a_name_of_its_own(
    chromium: Any, tmp_path: Path
) -> None:
    time = np.linspace(0.0, 2.0, 21)
    turned = a5.named_pose("home") + 0.1 * np.sin(time)[:, None]
    motion = a5.trajectory.motion(time, turned)
    scene = build_scene(a5.load(), motion=motion)
    tab = open_scene(chromium, scene, tmp_path, (1280, 900))
    tab.run("""() => {
      for (const each of document.querySelectorAll('details')) each.open = true;
      alpha5.change({ shown: { ghosts: true } });
    }""")
    tab.settle()
    session = tab.page.context.new_cdp_session(tab.page)
    nodes = session.send("Accessibility.getFullAXTree")["nodes"]
    found = [
        (node["role"]["value"], node["name"]["value"])
        for node in nodes
        if not node["ignored"] and node["role"]["value"] in NAMED
    ]
    roles = Counter(role for role, _ in found)
    assert roles["slider"] == 6
    assert roles["image"] + roles["img"] == 4, "three charts and the arm"
    assert [each for each in found if not each[1].strip()] == []
    assert [each for each, count in Counter(found).items() if count > 1] == []
    assert ("slider", "axis_d") in found
    force = a5.trajectory.analyse(motion, a5.load()).base_wrench[:, :3]
    span = f"\u2212{-force.min():.1f} to {max(force.max(), 0.0):.1f} N"
    assert ("image", f"Force on the mount over time, {span}") in found
    assert ("spinbutton", "axis_d in \u00b0") in found

    tab.page.keyboard.press("Tab")
    assert tab.run("() => document.activeElement.id") == "tip"
    assert tab.complaints == []
    tab.page.close()
