"""``alpha5 view``: the arm in a browser, on a page, in a picture."""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path
from typing import Annotated

import numpy as np
from rich.console import Console
from rich.progress import track as progress
from typer import Option, echo

from alpha5_model._support.files import atomic_write_all, check_outputs
from alpha5_model.cli import options
from alpha5_model.errors import InputError, NoDisplayError
from alpha5_model.trajectory import read_motion
from alpha5_model.viewer import build, page, picture, scene


def view(
    pose: Annotated[
        str | None, Option(help="stow, home, reach, or positions (rad).")
    ] = None,
    target: Annotated[
        str | None, Option(help="x y z (m): show all solutions of its IK.")
    ] = None,
    motion: Annotated[
        Path | None, Option(help="Recording (CSV, Parquet, ROS bag).")
    ] = None,
    show: Annotated[str | None, Option(help=options.HELP["groups"])] = None,
    gripper: options.Gripper = "jaws",
    fluid: options.Fluid = "sea",
    current: Annotated[str | None, Option(help=options.HELP["arrow"])] = None,
    html: Annotated[
        Path | None, Option(help="Write a page that works from disk.")
    ] = None,
    image: Annotated[Path | None, Option(help="Draw a PNG without a screen.")] = None,
    video: Annotated[
        Path | None, Option(help="Write the motion as .mp4 or .gif.")
    ] = None,
    size: Annotated[str, Option(help="Pixels of PNG and video.")] = "1600x1000",
    port: Annotated[int, Option(help="Of the live viewer; 0 for a free one.")] = 0,
    serve: Annotated[bool, Option("--serve", help="Do not open a browser.")] = False,
) -> None:
    """Look at the arm: live in a browser, or as a page or a picture.

    With --html, --image or --video it writes these and ends; else it serves the
    live viewer.

    Example: alpha5 view --pose reach --show bodies,com,cob,weight,buoyancy --html arm.html
    """
    pixels = _size(size)
    pages, films = (".html", ".htm"), picture.VIDEO_FORMATS
    check_outputs(
        [motion], html=(html, pages), image=(image, (".png",)), video=(video, films)
    )
    if video is not None and motion is None:
        raise InputError("video", str(video), "a --motion to show in it")

    arm = options.arm_in(fluid, options.DOWN, gripper, "0 0 0", None)
    if pose and pose.endswith(("deg", "mm")):
        pose = " ".join(map(repr, options.joint_numbers("pose", pose, "rad", (4, 5))))
    q = None if pose is None else build.pose_of(arm, pose)
    point = None if target is None else options.numbers("target", target, (3,), "m")
    moved = None if motion is None else read_motion(motion)
    groups = None if show is None else options.names(show)
    flow = options.current_vector(current)
    shown = build.build_scene(
        arm, q, target=point, motion=moved, show=groups, current=flow
    )
    displays = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not (
        html
        or image
        or video
        or serve
        or displays
        or sys.platform in ("darwin", "win32")
    ):
        remedy = (
            "give --html FILE, --image FILE.png, or --serve for a browser elsewhere"
        )
        raise NoDisplayError(remedy)
    played = shown.motion
    track = (
        np.array([build.with_base(arm, q) for q in played.q])
        if played
        else np.zeros((0, 4))
    )
    along = [build.posed(shown, arm, q).poses for q in track[:: 1 + len(track) // 24]]
    seen = scene.framed(shown, pixels, also=along)
    files: dict[Path, str | bytes] = (
        {} if html is None else {html: page.static_page(shown)}
    )
    if image is not None:
        files[image] = picture.picture_png(seen, pixels)
    atomic_write_all(files)
    if video is not None and played is not None:
        with picture.video(video, 25.0) as (rate, add):
            frames = list(build.resampled(arm, played.time, track, rate))
            for q in progress(
                frames, "drawing", console=Console(stderr=True), transient=True
            ):
                add(picture.picture(build.posed(seen, arm, q), pixels))
    if written := [path for path in (*files, video) if path is not None]:
        options.show(False, None, (), *written)
        return
    from alpha5_model.viewer.visualizer import ArmVisualizer

    visualizer = ArmVisualizer(arm, shown, port)
    echo(f"{visualizer.url()} (Ctrl-C ends)")
    if not serve:
        visualizer.open()
    over = threading.Event()
    # A service manager stops it as a user does.
    before = {
        s: signal.signal(s, lambda *_: over.set())
        for s in (signal.SIGINT, signal.SIGTERM)
    }
    while not over.wait(timeout=0.5):
        pass
    for number, handler in before.items():
        signal.signal(number, handler)
    visualizer.close()


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise InputError(
            "size", text, "WIDTHxHEIGHT in pixels, such as 1600x1000"
        ) from None
    return scene.check_size((width, height))
