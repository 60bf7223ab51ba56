"""meshcat's visualizer of an arm, with `display` and `play` as in Pinocchio's."""

from __future__ import annotations

import logging
import queue
import tempfile
import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import meshcat
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, choice, float_array, real, shaped
from alpha5_model._support.files import PathLike
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.kinematics.limits import within
from alpha5_model.viewer.commands import Command, pose_message, scene_commands
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.live import LiveWindow, PageConnection
from alpha5_model.viewer.page import live_page, static_page
from alpha5_model.viewer.picture import Pixels, picture
from alpha5_model.viewer.poses import posed
from alpha5_model.viewer.scene import GROUPS, VIEWS, Scene, Size
from alpha5_model.viewer.tracks import resampled
from alpha5_model.viewer.video_file import film

_LOG = logging.getLogger(__name__)


class _Video(NamedTuple):
    """A video that is being written.

    Attributes:
        rate: Frames per second.
        size: Width and height in pixels.
        add: Adds a picture to it.
    """

    rate: float
    size: Size
    add: Callable[[Pixels], None]


def read_move(content: Any, arm: Arm) -> FloatArray:
    """Read what a page sends if something was moved, ``{"q": [...]}``.

    Args:
        content: What the page has sent, unchecked.
        arm: The arm whose joints may have moved.

    Returns:
        Positions within the limits, (n,) [rad, and m for axis_a].

    Raises:
        InputError: Not such a message (`ShapeError`, `NonFiniteError`).
        JointLimitError: A joint is beyond a limit.
    """
    if not isinstance(content, dict) or set(content) != {"q"}:
        raise InputError("message", content, '{"q": [...]}')
    names = arm.joint_names
    limits = arm.limits
    joints = shaped("q", content["q"], (len(names),))
    return within(names, joints, limits.lower, limits.upper)


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    `display`, `captureImage`, ``displayFrames`` and the other names in camel case are
    those of Pinocchio's visualizers; pictures and videos are drawn here, without a
    browser. Calls of a viewer that is closed raise `alpha5_model.errors.ViewerError`.

    Attributes:
        arm: The arm that it shows.
        scene: The scene as it is now; its ``q`` are the positions of the sliders.
    """

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm = arm
        self.scene = scene
        #: Protects the scene, which any thread may change.
        self._changing = threading.RLock()
        self._listeners: list[Callable[[FloatArray], object]] = []
        #: Positions to which pages have moved the arm; None ends the thread.
        self._page_moves: queue.SimpleQueue[FloatArray | None] = queue.SimpleQueue()
        self._listening: threading.Thread | None = None
        self._video: _Video | None = None
        window = LiveWindow(
            port,
            page=lambda: live_page(self.scene),
            scene=lambda drawn: static_page(self.scene, drawn),
            receive=self._receive,
        )
        super().__init__(window=window)
        for command in scene_commands(scene):
            window.send(command)
        window.send(pose_message(scene))

    @property
    def q(self) -> FloatArray:
        """Joint positions at which the arm is shown, (nq,)."""
        scene = self.scene
        if not self.arm.floating_base:
            return scene.q.copy()
        base = scene.poses[scene.tree[0].parent]
        return np.concatenate([pin.SE3ToXYZQUAT(pin.SE3(base)), scene.q])

    def display(self, q: ArrayLike) -> None:
        """Show the arm at joint positions q (nq,)."""
        self._place(shaped("q", q, (self.arm.model.nq,)))

    def _place(self, q: FloatArray, mover: PageConnection | None = None) -> None:
        """Show the arm at q (nq,) in all pages but the one that moved it there."""
        with self._changing:
            placed = posed(self.scene, self.arm, q)
            self.window.send(pose_message(placed), mover)
            self.scene = placed

    def _receive(self, content: Any, page: PageConnection) -> None:
        """Move the arm as a page has moved it; called in the server's thread."""
        joints = read_move(content, self.arm)
        with self._changing:
            base = self.q[: -len(joints)]
            q = np.concatenate([base, joints])
            self._place(q, page)
        if self._listeners:
            self._page_moves.put(q)

    def on_change(
        self, callback: Callable[[FloatArray], object]
    ) -> Callable[[FloatArray], object]:
        """Call a function with q (nq,) when a page has moved the arm; also a decorator.

        Positions from a page are within the joints' limits; others are refused. The
        function runs in a thread of its own and may call `display`. While it is busy,
        newer positions replace older ones.
        """
        if self._listening is None:
            self._listening = threading.Thread(
                target=self._listen, name="alpha5-on-change", daemon=True
            )
            self._listening.start()
        self._listeners.append(callback)
        return callback

    def _listen(self) -> None:
        """Call back with the latest positions."""
        while (latest := self._page_moves.get()) is not None:
            while not self._page_moves.empty():
                newer = self._page_moves.get()
                if newer is None:
                    return
                latest = newer
            for callback in self._listeners:
                try:
                    callback(latest)
                except Exception:
                    if not self.window.closed:
                        _LOG.exception("on_change")

    def play(self, q: ArrayLike, dt: float) -> float:
        """Play joint positions in real time, dropping frames if they are late.

        Within `create_video_ctx` they go into the video instead, at its rate.

        Args:
            q: (N, nq), one row for each time step.
            dt: Time step [s].

        Returns:
            Time that it took [s].
        """
        track = float_array("q", q, (self.arm.model.nq,))
        if track.ndim != 2 or len(track) < 1:
            raise ShapeError("q", track.shape, f"shape (N, {self.arm.model.nq})")
        step = real("dt", dt, minimum=0.0, strict=True)
        start = clock.perf_counter()
        if self._video is None:
            self._show_in_real_time(track, step, start)
        else:
            self._add_to_video(track, step, self._video)
        return clock.perf_counter() - start

    def _show_in_real_time(self, track: FloatArray, step: float, start: float) -> None:
        last = len(track) - 1
        row = -1
        while row < last:
            due = start + (row + 1) * step
            clock.sleep(max(0.0, due - clock.perf_counter()))
            row = min(int((clock.perf_counter() - start) / step), last)
            self.display(track[row])

    def _add_to_video(self, track: FloatArray, step: float, video: _Video) -> None:
        ticks = step * np.arange(float(len(track)))
        for position in resampled(self.arm, ticks, track, video.rate):
            self.display(position)
            video.add(picture(self.scene, video.size))

    def show(self, *groups: str, visible: bool = True) -> None:
        """Show or hide groups of `alpha5_model.viewer.scene.GROUPS`."""
        chosen = [choice("group", group, tuple(GROUPS)) for group in groups]
        with self._changing:
            others = [name for name in self.scene.show if name not in chosen]
            shown = (*others, *chosen) if visible else tuple(others)
            self.window.send(
                Command(type="show", groups={name: name in shown for name in GROUPS})
            )
            self.scene = replace(self.scene, show=shown)

    def displayVisuals(self, visibility: bool) -> None:
        """Show or hide the bodies."""
        self.show("bodies", visible=visibility)

    def displayCollisions(self, visibility: bool) -> None:
        """Show or hide the collision bodies."""
        self.show("collision", visible=visibility)

    def displayFrames(self, visibility: bool) -> None:
        """Show or hide the link frames."""
        self.show("frames", visible=visibility)

    def setCameraPreset(self, preset_key: str) -> None:
        """Look at all that is shown from ``home``, ``front``, ``side`` or ``top``."""
        view = choice("view", preset_key, tuple(VIEWS))
        self._move_camera(**vars(framed(self.scene, view=view).camera))

    def setCameraTarget(self, target: ArrayLike) -> None:
        """Look at a point of the world, (3,) [m]."""
        self._move_camera(target=shaped("target", target, (3,)))

    def setCameraPosition(self, position: ArrayLike) -> None:
        """Look from a point of the world, (3,) [m]."""
        self._move_camera(eye=shaped("position", position, (3,)))

    def _move_camera(self, **changes: Any) -> None:
        with self._changing:
            camera = replace(self.scene.camera, **changes)
            self.window.send(
                Command(
                    type="camera",
                    eye=camera.eye.tolist(),
                    target=camera.target.tolist(),
                )
            )
            self.scene = replace(self.scene, camera=camera)

    def captureImage(self, w: int = 1600, h: int = 1000) -> Pixels:
        """The arm and its groups, drawn without a browser, (h, w, 3).

        It does not show what else was put into the pages. `get_image` asks a page for
        its picture.
        """
        return picture(self.scene, (w, h))

    @contextmanager
    def create_video_ctx(
        self,
        filename: PathLike | None = None,
        fps: float = 30.0,
        directory: PathLike | None = None,
        size: Size = (1280, 720),
    ) -> Iterator[Path]:
        """Write what `play` shows inside the ``with`` block into a video, in real time.

        Args:
            filename: ``.mp4`` or ``.gif``; by default MP4, named by the time of
                day.
            fps: Frames per second.
            directory: Of the default name; the system's temporary folder if None.
            size: Width and height in pixels.

        Raises:
            UnknownNameError, InputError: Another suffix; a size or rate that makes no
                video.
            MissingDependencyError: The extra ``video`` is not installed.
            OutputError: It cannot be written.
        """
        if filename:
            path = Path(filename)
        else:
            name = clock.strftime("%Y%m%d_%H%M%S.mp4")
            path = Path(directory or tempfile.gettempdir(), name)
        with film(path, fps) as (rate, add):
            self._video = _Video(rate=rate, size=size, add=add)
            try:
                yield path
            finally:
                self._video = None

    def close(self) -> None:
        """Stop the server and free its port."""
        self._page_moves.put(None)
        self.window.close()
