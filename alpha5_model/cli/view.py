"""``alpha5 view``: the arm in a browser, on a page, in a picture."""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path
from typing import Annotated

from typer import Option, echo

from alpha5_model.cli import options
from alpha5_model.errors import InputError, NoDisplayError
from alpha5_model.files import atomic_write_all, check_outputs
from alpha5_model.trajectory import read_motion
from alpha5_model.view.arm_poses import pose_of
from alpha5_model.view.build import build_scene
from alpha5_model.view.page import static_page
from alpha5_model.view.picture import picture_png
from alpha5_model.view.scene import check_size, framed

_GROUPS = (
    "Groups to show, with commas: bodies, see-through, labels, frames, com, cob, weight, "
    "buoyancy, workspace, surface, ghosts, collision, current."
)
_CURRENT = "Velocity of the water (m/s): an arrow, and its estimated load in the torques."


def view(
    pose: Annotated[str, Option(help="stow, home, reach, or joint positions (rad).")] = "home",
    target: Annotated[str | None, Option(help="x y z (m): show all solutions of its IK.")] = None,
    motion: Annotated[Path | None, Option(help="Recording (CSV, Parquet, ROS bag).")] = None,
    show: Annotated[str | None, Option(help=_GROUPS)] = None,
    gripper: options.Gripper = "jaws",
    fluid: options.Fluid = "sea",
    current: Annotated[str | None, Option(help=_CURRENT)] = None,
    html: Annotated[Path | None, Option(help="Write a page that works from disk.")] = None,
    image: Annotated[Path | None, Option(help="Draw a PNG without a screen.")] = None,
    size: Annotated[str, Option(help="Pixels of the PNG.")] = "1600x1000",
    port: Annotated[int, Option(help="Of the live viewer; 0 for a free one.")] = 0,
    serve: Annotated[bool, Option("--serve", help="Do not open a browser.")] = False,
) -> None:
    """Look at the arm: live in a browser, or as a page or a picture.

    With --html or --image it writes these and ends; else it serves the live viewer.

    Example: alpha5 view --pose reach --show bodies,com,cob,weight,buoyancy --html arm.html
    """
    pixels = _size(size)
    check_outputs([motion], html=(html, (".html", ".htm")), image=(image, (".png",)))

    arm = options.arm_in(fluid, options.DOWN, gripper, "0 0 0", None)
    if pose.endswith(("deg", "mm")):
        pose = " ".join(map(repr, options.joint_numbers("pose", pose, "rad", (4, 5))))
    scene = build_scene(
        arm,
        pose_of(arm, pose),
        target=None if target is None else options.numbers("target", target, (3,), "m"),
        motion=None if motion is None else read_motion(motion),
        show=None if show is None else options.names(show),
        current=options.current_vector(current),
    )
    if html is None and image is None and not serve and not _has_display():
        remedy = "give --html FILE, --image FILE.png, or --serve for a browser elsewhere"
        raise NoDisplayError(remedy)
    files: dict[Path, str | bytes] = {}
    if html is not None:
        files[html] = static_page(scene)
    if image is not None:
        files[image] = picture_png(framed(scene, pixels), pixels)
    if files:
        atomic_write_all(files)
        with options.messages_beside(*files):
            options.print_written(*files)
        return
    from alpha5_model.view.visualizer import ArmVisualizer

    visualizer = ArmVisualizer(arm, scene, port)
    echo(f"{visualizer.url()} (Ctrl-C ends)")
    if not serve:
        visualizer.open()
    _wait()
    visualizer.close()


def _has_display() -> bool:
    shown = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    return shown or sys.platform in ("darwin", "win32")


def _wait() -> None:
    over = threading.Event()
    # A service manager stops it as a user does.
    before = {s: signal.signal(s, lambda *_: over.set()) for s in (signal.SIGINT, signal.SIGTERM)}
    try:
        while not over.wait(timeout=0.5):
            pass
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise InputError("size", text, "WIDTHxHEIGHT in pixels, such as 1600x1000") from None
    return check_size((width, height))
