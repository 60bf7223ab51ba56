"""Frames per second of the page beside meshcat's, and the time that a video takes.

    python scripts/benchmarks/viewer.py
    python scripts/benchmarks/viewer.py --video-seconds 60

Both pages show the same arm and move all joints in every frame, in turns, in one run of
Chromium. WebGL runs in software unless Chromium finds a graphics card.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Page, sync_playwright

import alpha5_model as a5
from alpha5_model.cli import main as alpha5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

#: Width and height of the window.
SIZE = (1280, 800)
#: Width and height of a video, and its pictures per second, as the command has them.
VIDEO_SIZE = (1280, 720)
FRAME_RATE = 15.0
#: Chromium's options: WebGL in software, as fast as it can draw.
ARGUMENTS = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
#: Moves the arm in every frame for some milliseconds; gives the milliseconds per frame.
_RUN = """async ([duration, poses]) => {
  const viewer = globalThis.alpha5 ? alpha5.viewer : window.viewer;
  const move = MOVE;
  const gl = viewer.renderer.getContext();
  const pixel = new Uint8Array(4);
  const next = () => new Promise((done) => requestAnimationFrame(() => {
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    done();
  }));
  await next();
  const began = performance.now();
  let frames = 0;
  while (performance.now() - began < duration) {
    move(poses[frames++ % poses.length]);
    await next();
  }
  return (performance.now() - began) / frames;
}"""
#: Takes pictures of meshcat's page, each after a move; gives the milliseconds for one.
_TAKE = """async (poses) => {
  const move = MOVE;
  const began = performance.now();
  for (const pose of poses) {
    move(pose);
    viewer.capture_image();
    await new Promise(requestAnimationFrame);
  }
  return (performance.now() - began) / poses.length;
}"""
#: Pictures of meshcat's page that are timed.
_PICTURES = 20
_MOVE_OURS = '(q) => alpha5.setPose(q, "travel")'
_MOVE_MESHCAT = """(places) => {
    for (const [path, matrix] of places) viewer.set_transform(path, matrix);
    viewer.set_dirty();
  }"""


def sway(count: int = 120) -> np.ndarray:
    """Joint positions (N, 4) of a motion about the pose home, which closes."""
    phase = np.linspace(0.0, 2 * np.pi, count, endpoint=False)[:, None]
    return a5.named_pose("home") + 0.3 * np.sin(phase + np.arange(4.0))


def our_page(arm: a5.Arm) -> str:
    """The page as it opens."""
    return static_page(build_scene(arm))


def meshcat_page() -> tuple[str, list[Any]]:
    """Meshcat's own page with the same bodies, and where they are in each pose."""
    import pinocchio as pin
    from pinocchio.visualize import MeshcatVisualizer

    folder = str(Path(a5.URDF_PATH).parent)
    models = pin.buildModelsFromUrdf(a5.URDF_PATH, package_dirs=[folder])
    model, _, visual = models
    viewer = MeshcatVisualizer(*models)
    viewer.initViewer(loadModel=True)
    data, shown = model.createData(), visual.createData()
    moves = []
    for q in sway():
        pin.forwardKinematics(model, data, q)
        pin.updateGeometryPlacements(model, data, visual, shown)
        moves.append(
            [
                [
                    [
                        "meshcat",
                        *f"{viewer.viewerVisualGroupName}/{body.name}".split("/"),
                    ],
                    shown.oMg[k].homogeneous.T.ravel().tolist(),
                ]
                for k, body in enumerate(visual.geometryObjects)
            ]
        )
    return viewer.viewer.static_html(), moves


def frames_of(page: Page, move: str, poses: list[Any], seconds: float) -> float:
    """Milliseconds for a frame of a page while its arm moves."""
    script = _RUN.replace("MOVE", move)
    return float(page.evaluate(script, [1e3 * seconds, poses]))


@contextmanager
def opened(size: tuple[int, int], **texts: str) -> Iterator[dict[str, Page]]:
    """Pages in one browser, by name, once they are drawn."""
    program = os.environ.get("ALPHA5_CHROMIUM") or shutil.which("chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=[*ARGUMENTS])
        pages = {}
        for name, text in texts.items():
            file = Path(folder, f"{name}.html")
            file.write_text(text, encoding="utf-8")
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            page.goto(file.as_uri())
            page.wait_for_timeout(1500)
            pages[name] = page
        yield pages
        browser.close()


def page_times(rounds: int, seconds: float) -> dict[str, float]:
    """Median milliseconds for a frame, of our page and of meshcat's."""
    theirs, moves = meshcat_page()
    work = {
        "ours": (_MOVE_OURS, sway().tolist()),
        "meshcat": (_MOVE_MESHCAT, moves),
    }
    found: dict[str, list[float]] = {name: [] for name in work}
    with opened(SIZE, ours=our_page(a5.load()), meshcat=theirs) as pages:
        for _ in range(rounds):
            for name, page in pages.items():
                page.bring_to_front()
                found[name].append(frames_of(page, *work[name], seconds))
    return {name: statistics.median(times) for name, times in found.items()}


def meshcat_picture() -> float:
    """Seconds for a picture of a moving arm from meshcat's page, of a video's size."""
    theirs, moves = meshcat_page()
    with opened(VIDEO_SIZE, meshcat=theirs) as pages:
        script = _TAKE.replace("MOVE", _MOVE_MESHCAT)
        return 1e-3 * float(pages["meshcat"].evaluate(script, moves[:_PICTURES]))


def video_times(seconds: float) -> dict[str, float]:
    """Seconds that the command takes for an MP4, and of the processors.

    Beside them what meshcat's page needs for the pictures alone, without the film.
    """
    one = meshcat_picture()
    time_secs = np.arange(0.0, seconds, 0.05)
    q = sway(len(time_secs))
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder, "motion.csv")
        names = ["time_secs", *(f"axis_{x}_pos" for x in "edcb")]
        np.savetxt(
            recording,
            np.column_stack([time_secs, q]),
            delimiter=",",
            header=",".join(names),
            comments="",
        )
        film = Path(folder, "motion.mp4")
        wall, cpu = time.perf_counter(), time.process_time()
        alpha5(["view", "--motion", str(recording), "--video", str(film)])
        return {
            "motion": seconds,
            "elapsed": time.perf_counter() - wall,
            "processor": time.process_time() - cpu,
            "pictures_of_meshcat": one * seconds * FRAME_RATE,
        }


def main() -> None:
    """Measure and print as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5, help="turns of each page")
    parser.add_argument("--seconds", type=float, default=2.0, help="of a turn")
    parser.add_argument("--video-seconds", type=float, default=0.0, help="0: no video")
    options = parser.parse_args()
    times = page_times(options.rounds, options.seconds)
    found: dict[str, Any] = {"milliseconds_per_frame": times}
    found["frame_rate_over_meshcat"] = times["meshcat"] / times["ours"]
    if options.video_seconds:
        found["video_s"] = video_times(options.video_seconds)
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
