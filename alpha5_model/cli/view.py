"""``alpha5 view``: the arm in a browser, on a page, in a picture."""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from typer import Option, echo

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.cli import options, printing, values
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

# The options of this command.
_Pose = Annotated[str | None, Option(help="stow, home, reach, or positions (rad).")]
_Target = Annotated[
    str | None, Option(help="Point x y z in base_link (m); show its solutions.")
]
_Motion = Annotated[
    Path | None, Option(help="Recording or plan to play (CSV, Parquet, ROS bag).")
]
_Obstacles = Annotated[Path | None, Option(help=options.HELP["obstacles"])]
_Topic = Annotated[
    str | None, Option(help="Topic of the joint states, if a bag has several.")
]
_Prefix = Annotated[
    str | None, Option(help="Prefix of the joints' names, such as left_.")
]
_Map = Annotated[
    str, Option("--map", help="Names of the joints: axis_e=NAME,axis_d=-NAME.")
]
_Degrees = Annotated[
    bool, Option("--degrees", help="Angles are in degrees, if columns name no unit.")
]
_Time = Annotated[
    str | None, Option("--time", help="Column of the time, NAME or NAME:ms.")
]
_Episode = Annotated[
    int | None, Option(help="Episode of a Parquet file that holds several.")
]
_Show = Annotated[str | None, Option(help=options.HELP["groups"])]
_Current = Annotated[str | None, Option(help=options.HELP["arrow"])]
_Html = Annotated[Path | None, Option(help="Write a page that works from disk.")]
_Image = Annotated[Path | None, Option(help="Write a picture, .png; needs no screen.")]
_Video = Annotated[
    Path | None, Option(help="Write the motion as .mp4 or .gif, 15 frames/s.")
]
_Size = Annotated[
    str | None,
    Option(help="Width x height in pixels. Default: 1600x1000, for a video 1280x720."),
]
_Port = Annotated[int, Option(help="Port of the live viewer; 0 takes a free one.")]
_Serve = Annotated[
    bool, Option("--serve", help="Serve the page without opening a browser.")
]


def view(
    pose: _Pose = None,
    target: _Target = None,
    motion: _Motion = None,
    topic: _Topic = None,
    prefix: _Prefix = None,
    joints: _Map = "",
    degrees: _Degrees = False,
    time: _Time = None,
    episode: _Episode = None,
    obstacles: _Obstacles = None,
    show: _Show = None,
    gripper: options.Gripper = "jaws",
    fluid: options.Fluid = "sea",
    payload: options.Payload = None,
    mount: options.Mount = None,
    current: _Current = None,
    html: _Html = None,
    image: _Image = None,
    video: _Video = None,
    size: _Size = None,
    port: _Port = 0,
    serve: _Serve = False,
    arm_file: options.Arm = None,
) -> None:
    """Look at the arm: live in a browser, or as a page or a picture.

    With --html, --image or --video it writes a file and ends. Otherwise it serves
    the live viewer.

    Example: alpha5 view --pose reach --show bodies,com,cob,weight,buoyancy --html arm.html
    """  # noqa: E501 (a line of the help)
    pixels = None if size is None else _size(size)
    check_outputs(
        [path for path in (motion, obstacles) if path is not None],
        html=(html, (".html", ".htm")),
        image=(image, (".png",)),
        video=(video, VIDEO_FORMATS),
    )
    if video is not None and motion is None:
        raise InputError("video", str(video), "a --motion to show in it")

    record = values.arm_record(arm_file)
    arm = values.arm_in(fluid, options.DOWN, gripper, mount, None, record)
    played = None
    if motion is not None:
        played = read_motion(
            motion,
            topic=topic,
            prefix=prefix,
            arm=arm.parameters,
            joints=values.pairs("map", joints.split(","), "="),
            degrees=degrees,
            time=time,
            episode=episode,
        )
    shown = build_scene(
        arm,
        None if pose is None else _position(arm, pose),
        target=None if target is None else values.numbers("target", target, (3,), "m"),
        motion=played,
        show=None if show is None else values.names(show),
        current=values.current_vector(current),
        payload=None if payload is None else values.payload_numbers(payload),
        obstacles=() if obstacles is None else read_obstacles(obstacles),
    )

    written = [path for path in (html, image, video) if path is not None]
    if written:
        _write(arm, shown, pixels, html, image, video)
        printing.show(False, None, (), *written)
        return
    if not serve:
        _check_display()
    _serve(arm, shown, port, open_browser=not serve)


def _size(text: str) -> Size:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        expected = "WIDTHxHEIGHT in pixels, such as 1600x1000"
        raise InputError("size", text, expected) from None
    return check_size((width, height))


def _position(arm: Arm, pose: str) -> FloatArray:
    """The joint position of a named pose, or of numbers; the jaws are closed."""
    count = len(arm.joint_names)
    q = values.joint_positions("pose", pose, (4, count), arm.parameters)
    closed = arm.limits.lower[len(arm.limits.lower) - count + len(q) :]
    return with_base(arm, np.concatenate([q, closed]))


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
    echo(f"{visualizer.url()} (Ctrl-C ends)")
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
