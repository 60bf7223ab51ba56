"""Pictures of the page in use, for the README: a picture, and a GIF of a drag.

    python scripts/figures/page_figures.py [FOLDER]

``page.png``: the arm in a current, with a payload, forces and the ghosts of the other
solutions. ``drag.gif``: a hand drags the tip, and arm and ghosts follow. They need
Chromium (on the path, or named by ALPHA5_CHROMIUM).
"""

from __future__ import annotations

import io
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

import alpha5_model as a5
from alpha5_model._support.writing import atomic_write
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

SIZE = (1280, 776)
#: The window that the GIF shows, and its size; colours, frames, milliseconds of each.
GIF_WINDOW = (960, 560)
GIF_SIZE = (720, 420)
COLORS = 128
FRAMES = 36
STEP = 80
#: Half the width and height of the path of the hand [pixels].
SWAY = (90, 60)
TARGET = (0.24, 0.1, 0.14)
ARGUMENTS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def opened(browser: Any, show: tuple[str, ...], size: tuple[int, int]) -> Any:
    """The page with the arm at a target, ready."""
    scene = build_scene(
        a5.load(gripper="jaws"),
        target=TARGET,
        show=show,
        water_velocity=[0.0, 0.5, 0.0],
    )
    page = browser.new_page(
        viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce"
    )
    with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False) as file:
        file.write(static_page(scene))
    page.goto(Path(file.name).as_uri())
    page.wait_for_function("() => document.documentElement.dataset.ready")
    Path(file.name).unlink()
    return page


def page_picture(browser: Any) -> bytes:
    """The page with water, payload, arrows and ghosts."""
    show = ("bodies", "labels", "weight", "buoyancy", "current", "ghosts", "payload")
    page = opened(browser, show, SIZE)
    page.evaluate("""() => {
      alpha5.change({ payload: { mass: 0.3, com: [0, 0, 0], volume: 4e-5 } });
      for (const id of ["water", "payload"])
        document.querySelector(`#${id} details`).open = true;
      alpha5.look("home", false);
    }""")
    page.wait_for_timeout(800)
    return bytes(page.screenshot())


def drag(browser: Any) -> bytes:
    """The tip on a closed way in the plane of the picture, as a GIF."""
    page = opened(browser, ("bodies", "ghosts", "current", "labels"), GIF_WINDOW)
    page.locator("#fold").click()
    # Shades of a backdrop would take most of the colours.
    page.evaluate("""() => {
      for (const end of ["top_color", "bottom_color"])
        alpha5.viewer.set_property(["Background"], end, [0.8, 0.85, 0.88]);
      alpha5.look("fit", false);
      alpha5.viewer.render();
    }""")
    page.wait_for_timeout(500)
    box = page.locator("#tip").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    frames = []
    for turn in np.linspace(0.0, 2 * np.pi, FRAMES, endpoint=False):
        page.mouse.move(
            x - SWAY[0] * np.sin(turn), y + SWAY[1] * (1 - np.cos(turn)) / 2
        )
        page.wait_for_timeout(60)
        shot = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        frames.append(shot.resize(GIF_SIZE, Image.Resampling.LANCZOS))
    page.mouse.up()
    gif = io.BytesIO()
    first, *others = in_few_colors(frames)
    first.save(
        gif,
        format="GIF",
        save_all=True,
        append_images=others,
        duration=STEP,
        loop=0,
        optimize=True,
    )
    return gif.getvalue()


def in_few_colors(frames: list[Image.Image]) -> list[Image.Image]:
    """The frames in the same colours, so that nothing flickers that stays."""
    few = frames[:: len(frames) // 6]
    pile = np.concatenate([np.asarray(frame) for frame in few])
    colors = np.unique(pile.reshape(-1, 3) // 4 * 4 + 2, axis=0)
    # Each colour counts once: large areas would take all of them.
    palette = Image.fromarray(colors[None]).quantize(COLORS - 1)
    backdrop = frames[0].getpixel((2, GIF_SIZE[1] // 2))
    palette.putpalette([*palette.getpalette()[: 3 * (COLORS - 1)], *backdrop])
    return [
        frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames
    ]


def main(folder: Path) -> None:
    """Make both."""
    program = os.environ.get("ALPHA5_CHROMIUM") or shutil.which("chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program, args=list(ARGUMENTS)
        )
        for name, draw in (("page.png", page_picture), ("drag.gif", drag)):
            print(f"wrote {atomic_write(folder / name, draw(browser))}")
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
