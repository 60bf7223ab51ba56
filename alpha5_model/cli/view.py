"""``alpha5 view``: the arm in a browser, on a page, in a picture."""

from __future__ import annotations

import os
import signal
import sys
import threading
from argparse import ArgumentTypeError, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import LENGTH, Vector
from alpha5_model.errors import InputError, ViewerError
from alpha5_model.planning.obstacle_file import read_obstacles
from alpha5_model.trajectory import read_motion
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.framing import check_size, framed
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.picture import picture, picture_png
from alpha5_model.viewer.poses import posed, with_base
from alpha5_model.viewer.scene import Scene, Size
from alpha5_model.viewer.tracks import resampled
from alpha5_model.viewer.video_file import VIDEO_FORMATS, film

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Frames per second of a video.
_FRAME_RATE = 15.0
#: Pixels of a picture and of a video, unless the user chooses.
PICTURE_SIZE = (1600, 1000)
_VIDEO_SIZE = (1280, 720)
#: A picture shows all of this many poses of a motion.
_FRAMED_POSES = 24

HELP = """
With --html, --image or --video it writes a file and ends. Otherwise it serves
the live viewer.

Example:
alpha5 view --pose reach --show bodies,com,cob,weight,buoyancy --html arm.html
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "--pose",
        type=common.POSITION,
        metavar="Q",
        help=f"stow, home, reach, or positions: {common.JOINTS} (rad), axis_a (m)",
    )
    parser.add_argument(
        "--target",
        type=Vector(LENGTH, LENGTH, LENGTH),
        metavar="X Y Z",
        help="point in base_link (m); show its solutions",
    )
    parser.add_argument(
        "--motion",
        type=Path,
        metavar="FILE",
        help="recording or plan to play (CSV, Parquet, ROS bag)",
    )
    common.reading(parser)
    parser.add_argument(
        "--obstacles",
        type=Path,
        metavar="FILE",
        help="TOML file with a table for each obstacle in base_link",
    )
    parser.add_argument(
        "--show",
        type=common.names,
        help="groups to show, with commas: bodies, see-through, labels, frames, com, "
        "cob, weight, buoyancy, workspace, surface, ghosts, collision, current, "
        "payload, obstacles",
    )
    common.gripper(parser, "jaws")
    common.fluid(parser)
    common.payload(parser)
    common.mount(parser)
    parser.set_defaults(gravity=[0.0, 0.0, -9.81])
    common.water_velocity(
        parser, "Shows an arrow, and adds its estimated load to the torques"
    )
    parser.add_argument(
        "--html", type=Path, metavar="FILE", help="write a page that works from disk"
    )
    parser.add_argument(
        "--image",
        type=Path,
        metavar="FILE",
        help="write a picture, .png; needs no screen",
    )
    parser.add_argument(
        "--video",
        type=Path,
        metavar="FILE",
        help="write the motion as .mp4 or .gif, 15 frames/s",
    )
    parser.add_argument(
        "--size",
        type=_size,
        help="width x height in pixels. Default: 1600x1000, for a video 1280x720",
    )
    parser.add_argument(
        "--port",
        type=int,
        default=0,
        help="port of the live viewer; 0 takes a free one. Default: 0",
    )
    parser.add_argument(
        "--serve",
        action="store_true",
        help="serve the page without opening a browser",
    )
    common.arm_file(parser)


def run(given: Namespace) -> None:
    html, image, video = given.html, given.image, given.video
    if given.size is not None:
        check_size(given.size)
    check_outputs(
        [path for path in (given.motion, given.obstacles) if path is not None],
        html=(html, (".html", ".htm")),
        image=(image, (".png",)),
        video=(video, VIDEO_FORMATS),
    )
    written = [path for path in (html, image, video) if path is not None]
    _check_effect(given, bool(written))

    record = common.record_of(given)
    arm = common.arm_of(given, given.gripper, record, payload=False)
    q = None
    if given.pose is not None:
        q = common.joint_position(given.pose, arm, record)
    motion = None
    if given.motion is not None:
        motion = read_motion(
            given.motion, arm=arm.parameters, **common.reading_of(given)
        )
    shown = build_scene(
        arm,
        q,
        target=given.target,
        motion=motion,
        show=given.show,
        water_velocity=given.water_velocity,
        payload=None if given.payload is None else common.payload_of(given.payload),
        obstacles=() if given.obstacles is None else read_obstacles(given.obstacles),
    )

    if written:
        _write(arm, shown, given.size, html, image, video)
        printing.show(False, None, (), *written)
        return
    if not given.serve:
        _check_display()
    _serve(arm, shown, given.port, open_browser=not given.serve)


def _check_effect(given: Namespace, writes: bool) -> None:
    """Refuse options that do nothing beside the others."""
    if given.video is not None and given.motion is None:
        raise InputError("--video", str(given.video), "a --motion to show in it")
    of_motion = ("topic", "prefix", "map", "degrees", "time", "episode")
    for names, has_effect, needed in (
        (of_motion, given.motion, "a --motion beside it"),
        (("size",), given.image or given.video, "an --image or --video beside it"),
        (("port", "serve"), not writes, "no --html, --image or --video beside it"),
    ):
        for name in names:
            if getattr(given, name) and not has_effect:
                raise InputError(f"--{name}", getattr(given, name), needed)


def _size(text: str) -> Size:
    """The type of ``--size``."""
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        expected = "WIDTHxHEIGHT in pixels, such as 1600x1000"
        raise ArgumentTypeError(f"expected {expected}, got {text!r}") from None
    return width, height


def _check_display() -> None:
    """Check that there is a screen to open a browser on.

    Raises:
        ViewerError: There is none.
    """
    displays = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not displays and sys.platform not in ("darwin", "win32"):
        raise ViewerError(
            "no display to open a browser on: give --html FILE, --image FILE.png, or "
            "--serve for a browser elsewhere"
        )


def _write(
    arm: Arm,
    shown: Scene,
    pixels: Size | None,
    html: Path | None,
    image: Path | None,
    video: Path | None,
) -> None:
    track = _track(arm, shown)

    files: dict[Path, str | bytes] = {}
    if html is not None:
        files[html] = static_page(shown)
    if image is not None:
        size = pixels or PICTURE_SIZE
        files[image] = picture_png(_framed(arm, shown, size, track), size)
    atomic_write_all(files)

    if video is not None and shown.motion is not None:
        size = pixels or _VIDEO_SIZE
        seen = _framed(arm, shown, size, track)
        _film(arm, seen, size, shown.motion.time, track, video)


def _track(arm: Arm, shown: Scene) -> FloatArray:
    """Joint positions of the motion, (N, nq); none without a motion."""
    if shown.motion is None:
        return np.zeros((0, 4))
    return np.array([with_base(arm, q) for q in shown.motion.q])


def _framed(arm: Arm, shown: Scene, pixels: Size, track: FloatArray) -> Scene:
    """The scene with a camera that sees the whole motion."""
    step = 1 + len(track) // _FRAMED_POSES
    along = [posed(shown, arm, q).poses for q in track[::step]]
    return framed(shown, pixels, also=along)


def _film(
    arm: Arm,
    seen: Scene,
    pixels: Size,
    time: FloatArray,
    track: FloatArray,
    path: Path,
) -> None:
    with film(path, _FRAME_RATE) as (rate, add):
        frames = list(resampled(arm, time, track, rate))
        for q in printing.progress_over(frames, "drawing", len(frames)):
            add(picture(posed(seen, arm, q), pixels))


def _serve(arm: Arm, shown: Scene, port: int, open_browser: bool) -> None:
    """Serve the live viewer until it is stopped."""
    from alpha5_model.viewer.visualizer import ArmVisualizer

    visualizer = ArmVisualizer(arm, shown, port)
    print(f"{visualizer.url()} (Ctrl-C ends)", flush=True)
    if open_browser:
        visualizer.open()
    _wait_until_stopped()
    visualizer.close()


def _wait_until_stopped() -> None:
    """Wait for Ctrl-C, or for the signal of a service manager."""
    over = threading.Event()
    before = {
        number: signal.signal(number, lambda *_: over.set())
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    while not over.wait(timeout=0.5):
        pass
    for number, handler in before.items():
        signal.signal(number, handler)
