"""A real browser for tests: the system's Chromium, driven by Playwright, without a screen."""

from __future__ import annotations

import importlib.util
import io
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from PIL import Image

CHROMIUM = os.environ.get("ALPHA5_CHROMIUM") or next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))),
    None,
)  # fmt: skip
_MISSING = [
    what
    for what, there in (
        ("a Chromium (chromium on the path, or ALPHA5_CHROMIUM)", CHROMIUM),
        ("playwright", importlib.util.find_spec("playwright")),
    )
    if not there
]
needs_browser = pytest.mark.skipif(
    bool(_MISSING), reason=f"there is no {' and no '.join(_MISSING)}"
)
#: WebGL in software, so that it works on any machine.
_ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZE = (1000, 640)


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
        self.page.wait_for_selector("html[data-ready=true]", state="attached")
        self.settle()

    def settle(self) -> None:
        """Wait until all that was asked for is drawn."""
        self.page.evaluate(
            "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => "
            "requestAnimationFrame(done))))"
        )

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

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixels (N, 2) of points (N, 3) in the world, through the camera's own matrices."""
        matrices = self.run(
            "() => { const v = alpha5.viewer; v.camera.updateMatrixWorld(); v.scene.updateMatrixWorld(); "
            "return [v.camera.projectionMatrix, v.camera.matrixWorldInverse, v.scene.matrixWorld]"
            ".map((m) => m.elements); }"
        )
        projection, camera, scene = (np.reshape(m, (4, 4)).T for m in matrices)
        clip = np.column_stack([points, np.ones(len(points))]) @ (projection @ camera @ scene).T
        ndc = clip[:, :2] / clip[:, 3:]
        return np.column_stack([(ndc[:, 0] + 1) / 2 * SIZE[0], (1 - ndc[:, 1]) / 2 * SIZE[1]])


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


def new_tab(running: Any) -> Tab:
    """An empty page that is watched."""
    page = running.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
    tab = Tab(page)
    page.on(
        "console",
        lambda m: m.type in ("error", "warning") and tab.complaints.append(f"{m.type}: {m.text}"),
    )
    page.on("pageerror", lambda error: tab.complaints.append(str(error)))
    page.on("request", lambda request: tab.requests.append(request.url))
    return tab
