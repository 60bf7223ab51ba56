"""Texts of the page that overlap or are cut off, by their bounding boxes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from browser import Tab, new_tab

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

WIDTHS = {390: 844, 768: 1024, 820: 1180, 1024: 768, 1440: 900}
SCHEMES = ("light", "dark")
#: Name of a state -> script that brings the page there from any other state.
STATES = {
    "as opened": "",
    "all sections open": "for (const d of document.querySelectorAll('details'))"
    " d.open = true;",
    "forces": "alpha5.change({ shown: { weight: true, buoyancy: true, current: true },"
    " payload: { mass: 0.3, com: [0, 0, 0], volume: 5e-5 } });",
    "radians": "alpha5.change({ degrees: false });",
    "out of reach": "alpha5.follow([0.5, 0.3, 0.2], 0);",
    "collision": "alpha5.change({ q: [5.8968, 0.33, 0.9704, 0, 0.005] });",
    "beyond the limits": "alpha5.change({ q: [7, 4, -1, 12, 0.03] }, 'python');",
    "solutions": "alpha5.change({ shown: { ghosts: true } });"
    " alpha5.follow([0.06, 0.05, 0.36], 0);",
    "tilted, limited": "alpha5.change({ attitude: [-2.5, -1.2],"
    " limits: [0.1, 0.2, 0.3, 0.4], density: 1012.345 });",
    "in the motion": "alpha5.seek(2.0);",
}
_RESET = """() => {
  alpha5.change({
    degrees: true, density: 1025, attitude: [0, 0], limits: [null, null, null, null],
    payload: { mass: 0, com: [0, 0, 0], volume: 0 },
  });
  for (const each of document.querySelectorAll('details')) each.open = false;
  document.getElementById('panel').scrollTop = 0;
}"""
#: Faults, [[kind, text, other text], ...]. A text is measured line by line, where
#: scrolling leaves it to be seen.
_FAULTS = """() => {
  const LEAST = 1.5; // pixels by which letters do not fill their box
  const skipped = ".dg, #pane, script, style, option, title";
  const texts = [];
  const faults = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const clipping = (element) => {
    const found = [];
    for (let e = element; e && e !== document.body; e = e.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(e);
      if (overflowX !== "visible" || overflowY !== "visible")
        found.push([e.getBoundingClientRect(), overflowY === "auto"]);
    }
    return found;
  };
  const note = (element, rect, text, clips) => {
    let { top, bottom } = rect;
    for (const [edge, auto] of clips) {
      const beside = rect.left < edge.left - LEAST || rect.right > edge.right + LEAST;
      if (beside) faults.push(["cut", text]);
      if (!auto && (top < edge.top - LEAST || bottom > edge.bottom + LEAST))
        faults.push(["cut", text]);
      if (auto) {
        top = Math.max(top, edge.top);
        bottom = Math.min(bottom, edge.bottom);
      }
    }
    if (bottom - top < LEAST) return;
    const outside = rect.left < -LEAST || rect.right > innerWidth + LEAST ||
      top < -LEAST || bottom > innerHeight + LEAST;
    if (outside) faults.push(["outside", text]);
    texts.push({ element, text, left: rect.left, right: rect.right, top, bottom });
  };
  while (walker.nextNode()) {
    const node = walker.currentNode;
    const element = node.parentElement;
    const text = node.textContent.trim();
    if (!text || element.closest(skipped)) continue;
    if (!element.checkVisibility({ visibilityProperty: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const clips = clipping(element);
    for (const rect of range.getClientRects()) note(element, rect, text, clips);
  }
  for (const element of document.querySelectorAll("input[type=number], select")) {
    if (element.closest(skipped)) continue;
    if (!element.checkVisibility({ visibilityProperty: true })) continue;
    const text = element.value || element.name || element.className;
    const clips = clipping(element.parentElement);
    note(element, element.getBoundingClientRect(), text, clips);
    if (element.scrollWidth > element.clientWidth + 1) faults.push(["cut", text]);
  }
  texts.forEach((one, i) => {
    for (const other of texts.slice(0, i)) {
      const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
      const down = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
      if (across > LEAST && down > LEAST && one.element !== other.element)
        faults.push(["over", one.text, other.text]);
    }
  });
  return faults;
}"""


def write_page(folder: Path) -> Path:
    """A page with a recording, jaws and signals."""
    arm = a5.load(gripper="jaws")
    time = np.linspace(0.0, 4.0, 81)
    swing = 0.2 * np.sin(time)[:, None] * np.array([1.0, 1.0, -1.0, 2.0, 0.0])
    home = np.append(a5.named_pose("home"), 0.005)
    moved = a5.trajectory.motion(time, home + swing)
    model = a5.trajectory.analyse(moved, arm)
    recorded = replace(moved, effort=model.torque + 0.05, source="a long recording.csv")
    curves = {"battery (V)": 24 - 0.1 * time}
    path = folder / "page.html"
    scene = build_scene(arm, home, motion=recorded, curves=curves)
    path.write_text(static_page(scene), "utf-8")
    return path


def open_page(chromium: Any, page: Path, width: int, scheme: str) -> Tab:
    tab = new_tab(chromium, (width, WIDTHS[width]), color_scheme=scheme)
    tab.open(page.as_uri())
    return tab


def faults(tab: Tab, state: str, unfolded: bool = False) -> list[list[str]]:
    """Faults of the page in one of `STATES`, with the panel of a phone unfolded."""
    tab.reset()
    tab.run(_RESET)
    folded = tab.page.locator("#panel.folded").count() > 0
    if folded == unfolded and tab.size()[0] < 760:
        tab.page.locator("#fold").click()
    tab.run(f"() => {{ {STATES[state]} alpha5.look('home', false); }}")
    tab.settle()
    found: list[list[str]] = tab.run(_FAULTS)
    return found
