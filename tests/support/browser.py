"""A real browser for tests: the system's Chromium, driven by Playwright, headless."""

from __future__ import annotations

import importlib.util
import io
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.scene import Scene


def chromium_program() -> str | None:
    """The path of Chromium: ALPHA5_CHROMIUM, or the first that is installed."""
    names = ("chromium", "chromium-browser", "google-chrome")
    installed = [found for name in names if (found := shutil.which(name))]
    return os.environ.get("ALPHA5_CHROMIUM") or next(iter(installed), None)


CHROMIUM = chromium_program()
MISSING = [
    what
    for what, there in (
        ("a Chromium (chromium on the path, or ALPHA5_CHROMIUM)", CHROMIUM),
        ("playwright", importlib.util.find_spec("playwright")),
    )
    if not there
]
needs_browser = pytest.mark.browser
#: WebGL in software, so that it works on any machine.
_ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZE = (1000, 640)
#: Longest wait [s], on a machine that does other work, too.
LONGEST = 120.0
#: Smooth edges take four samples for each pixel, half of the time of a software canvas.
_ONE_SAMPLE = """
{ const own = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return own.call(this, kind, { ...options, antialias: false });
  }; }
"""


@dataclass
class Tab:
    """A page and what it did.

    Attributes:
        page: Playwright's page.
        complaints: Errors and warnings of the console, and uncaught errors.
        requests: Addresses that it asked for.
    """

    page: Any
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def open(self, url: str) -> None:
        """Open and wait until the page's script has run and drawn."""
        self.page.goto(url)

        def ready() -> Any:
            assert not self.complaints, self.complaints
            return self.run("() => document.documentElement.dataset.ready")

        self.wait(ready)
        self.settle()

    def wait(self, condition: Callable[[], Any]) -> None:
        """Wait for something, while the page's events arrive."""
        ends = time.monotonic() + LONGEST
        while not condition():
            assert time.monotonic() < ends
            self.page.wait_for_timeout(20)

    def settle(self) -> None:
        """Wait until all that was asked for is drawn."""
        self.page.evaluate("""() => new Promise((done) => {
          const next = (then) => () => requestAnimationFrame(then);
          next(next(next(done)))();
        })""")

    def run(self, script: str, *arguments: Any) -> Any:
        """Value of a script in the page."""
        return self.page.evaluate(script, *arguments)

    def pixels(self) -> np.ndarray:
        """The WebGL canvas alone, (height, width, 3), drawn now."""
        self.settle()
        shot = self.run("() => alpha5.viewer.capture_image()")
        import base64

        data = base64.b64decode(shot.split(",", 1)[1])
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)

    def message(self) -> str:
        """The messages of the page, one a line."""
        paragraphs = self.page.locator("#message p").all_text_contents()
        return "\n".join(paragraphs)

    def joints(self) -> np.ndarray:
        """Where the arm is, (n,)."""
        return np.array(self.run("() => alpha5.state.q"))

    def type_into(self, label: str, text: str) -> str:
        """Type into a field that has an accessible name; what it shows afterwards."""
        field = self.page.get_by_label(label, exact=True).last
        field.click(click_count=3)
        field.press("Delete")
        self.page.keyboard.type(text)
        field.press("Enter")
        field.blur()
        self.settle()
        return str(field.input_value())

    def slide(self, joint: str, value: float) -> None:
        """Move the slider that stands beside the name of a joint."""
        row = self.page.locator("#joints > div").filter(has_text=joint)
        script = """(slider, value) => {
          slider.value = value;
          slider.dispatchEvent(new Event('input'));
        }"""
        row.locator("input[type=range]").evaluate(script, value)
        self.settle()

    def change(self, by: str = "hand", **part: Any) -> None:
        """Change entries of the page's state."""
        self.run("([part, by]) => alpha5.change(part, by)", [part, by])

    def reset(self) -> None:
        """At home, as it was opened, without a target."""
        self.run("""() => {
          alpha5.pause();
          const { groups, poses } = alpha5.data;
          const shown = Object.fromEntries(groups.map((g) => [g.name, g.shown]));
          alpha5.change({ aim: null, q: poses.home, shown });
          alpha5.look('home', false);
        }""")
        self.settle()

    def show_only(self, *shown: str) -> None:
        """Show these groups of the scene and hide the others."""
        groups = self.run("() => alpha5.data.groups.map((g) => g.name)")
        self.change(shown={name: name in shown for name in groups})

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels (N, 2) of points (N, 3) in the world, by the camera's own matrices."""
        clip = np.column_stack([points, np.ones(len(points))]) @ self.projection().T
        corner, size = self.stage()
        return corner + (clip[:, :2] / clip[:, 3:] * [1, -1] + 1) / 2 * size

    def shifted(self, point: np.ndarray, pixels: tuple[float, float]) -> np.ndarray:
        """The point (3,) some pixels beside another, at the same depth."""
        matrix = self.projection()
        clip = matrix @ [*point, 1.0]
        _, size = self.stage()
        clip[:2] += clip[3] * 2 * np.array([1, -1]) * pixels / size
        found = np.linalg.solve(matrix, clip)
        return found[:3] / found[3]

    def size(self) -> np.ndarray:
        """Width and height of the window, in pixels."""
        return np.array([self.page.viewport_size[side] for side in ("width", "height")])

    def stage(self) -> tuple[np.ndarray, np.ndarray]:
        """Corner (2,) and size (2,) of the canvas in the window, in pixels."""
        box = self.page.locator("#pane canvas").bounding_box()
        corner = np.array([box["x"], box["y"]])
        return corner, np.array([box["width"], box["height"]])

    def projection(self) -> np.ndarray:
        """World to clip coordinates, (4, 4)."""
        matrices = self.run("""() => {
          const { camera, scene } = alpha5.viewer;
          camera.updateMatrixWorld();
          scene.updateMatrixWorld();
          const { projectionMatrix, matrixWorldInverse } = camera;
          const matrices = [projectionMatrix, matrixWorldInverse, scene.matrixWorld];
          return matrices.map((m) => m.elements);
        }""")
        projection, camera, scene = (np.reshape(m, (4, 4)).T for m in matrices)
        return np.asarray(projection @ camera @ scene)


@contextmanager
def browser() -> Iterator[Any]:
    """Chromium, running."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=_ARGUMENTS)
        try:
            yield running
        finally:
            running.close()


def new_tab(running: Any, size: tuple[int, int] = SIZE, **options: Any) -> Tab:
    """An empty page that is watched; ``options`` are Playwright's.

    The arm does not travel unless ``reduced_motion`` is "no-preference".
    """
    viewport = {"width": size[0], "height": size[1]}
    options = {"reduced_motion": "reduce", **options}
    page = running.new_page(viewport=viewport, **options)
    page.set_default_timeout(1e3 * LONGEST)
    page.add_init_script(_ONE_SAMPLE)
    tab = Tab(page)
    page.on(
        "console",
        lambda m: (
            m.type in ("error", "warning")
            and tab.complaints.append(f"{m.type}: {m.text}")
        ),
    )
    page.on("pageerror", lambda error: tab.complaints.append(str(error)))
    page.on("request", lambda request: tab.requests.append(request.url))
    return tab


def open_scene(
    running: Any,
    scene: Scene,
    folder: Path,
    size: tuple[int, int] = SIZE,
    **options: Any,
) -> Tab:
    """The page of a scene, opened from a file of a folder."""
    path = folder / "page.html"
    path.write_text(static_page(scene), "utf-8")
    tab = new_tab(running, size, **options)
    tab.open(path.as_uri())
    return tab
