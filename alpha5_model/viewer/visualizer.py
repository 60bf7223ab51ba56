"""meshcat's visualizer of an arm, with `display` and `play` as in Pinocchio's.

meshcat starts its server as another process on all network interfaces. This one
(`alpha5_model.viewer.server`) is a thread of the caller, listens on this machine only,
and is ready in milliseconds. It speaks meshcat's protocol, so other programs can
connect to it by `zmq_url`.
"""

from __future__ import annotations

import logging
import queue
import tempfile
import threading
import time as clock
from collections.abc import Callable, Iterable, Iterator
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
from alpha5_model.viewer.commands import (
    Command,
    pose_commands,
    pose_message,
    scene_commands,
    set_visible,
)
from alpha5_model.viewer.film_frames import pictures
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.live_controls import Slider, curve_name, slider
from alpha5_model.viewer.picture import Pixels, picture
from alpha5_model.viewer.poses import posed
from alpha5_model.viewer.scene import DRAWN, VIEWS, Scene, Size
from alpha5_model.viewer.tracks import resampled
from alpha5_model.viewer.video_file import film
from alpha5_model.viewer.window import Window

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


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    `display`, `captureImage`, ``displayFrames`` and the other names in camel case are
    those of Pinocchio's visualizers; pictures and videos are drawn here, without a
    browser. Calls of a viewer that is closed, or that does not answer within 5 s, raise
    `alpha5_model.errors.ViewerError`.

    Attributes:
        arm: The arm that it shows.
        scene: The scene as it is now; its ``q`` are the positions of the sliders.
    """

    __slots__ = [
        "_began",
        "_listeners",
        "_listening",
        "_page_moves",
        "_video",
        "arm",
        "scene",
    ]

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm = arm
        self.scene = scene
        self._listeners: list[Callable[[FloatArray], object]] = []
        #: Positions to which pages have moved the arm, and sliders that they have
        #: moved; None ends the thread.
        self._page_moves: queue.SimpleQueue[FloatArray | Slider | None] = (
            queue.SimpleQueue()
        )
        self._listening: threading.Thread | None = None
        self._began = clock.monotonic()
        self._video: _Video | None = None
        super().__init__(window=Window(port, self))
        for command in scene_commands(scene):
            self.window.send(command)

    @property
    def q(self) -> FloatArray:
        """Joint positions at which the arm is shown, (nq,)."""
        if not self.arm.floating_base:
            return self.scene.q.copy()
        base = self.scene.poses[self.scene.tree[0].parent]
        return np.concatenate([pin.SE3ToXYZQUAT(pin.SE3(base)), self.scene.q])

    def display(self, q: ArrayLike) -> None:
        """Show the arm at joint positions q (nq,)."""
        position = shaped("q", q, (self.arm.model.nq,))
        self.window.server.call(lambda: self.place(position))

    def place(self, q: FloatArray, mover: Any = None) -> None:
        """Show the arm at q (nq,); called in the server's thread.

        Args:
            q: Joint positions.
            mover: The page that moved the arm there and so does not get the pose, or
                None.
        """
        self.scene = posed(self.scene, self.arm, q)
        live = self.window.server.live
        for command in pose_commands(self.scene):
            live.store_transform(command)
        live.broadcast(pose_message(self.scene), mover)
        if mover and self._listeners:
            self._page_moves.put(q)

    def on_change(
        self, callback: Callable[[FloatArray], object]
    ) -> Callable[[FloatArray], object]:
        """Call a function with q (nq,) when a page has moved the arm; also a decorator.

        Positions from a page are within the joints' limits; others are refused. The
        function runs in a thread of its own and may call `display`. While it is busy,
        newer positions replace older ones.
        """
        self._start_listening()
        self._listeners.append(callback)
        return callback

    def _start_listening(self) -> None:
        """Start the thread that calls back, once."""
        if self._listening is not None:
            return
        self._listening = threading.Thread(
            target=self._listen, name="alpha5-on-change", daemon=True
        )
        self._listening.start()

    def _listen(self) -> None:
        """Call back with the latest positions and the latest value of each slider."""
        while True:
            moves = [self._page_moves.get()]
            while not self._page_moves.empty():
                moves.append(self._page_moves.get())
            if any(move is None for move in moves):
                return

            positions = [move for move in moves if isinstance(move, np.ndarray)]
            for callback in self._listeners if positions else ():
                self._call_back(callback, positions[-1])
            sliders = {id(move): move for move in moves if isinstance(move, Slider)}
            for moved in sliders.values():
                if moved.on_change is not None:
                    self._call_back(moved.on_change, moved.value)

    def _call_back(self, callback: Callable[[Any], object], value: Any) -> None:
        try:
            callback(value)
        except Exception:
            if not self.window.server.closed:
                _LOG.exception("on_change")

    def curve(self, name: str, value: float, time: float | None = None) -> None:
        """Add a number to a curve of the pages, under the arm.

        Args:
            name: Of the curve, which the first number makes.
            value: The number, in any unit.
            time: When it was true [s]; since this viewer was made if None. Times of a
                curve do not decrease. The pages show the last 600 numbers.

        Raises:
            InputError: A name, number or time that cannot be, or more than 20 curves.
        """
        known = curve_name(name)
        number = real("value", value)
        now = clock.monotonic() - self._began
        at = now if time is None else real("time", time)
        live = self.window.server.live

        def add() -> None:
            live.show_control(live.controls.add_sample(known, at, number))

        self.window.server.call(add)

    def slider(
        self,
        name: str,
        low: float,
        high: float,
        value: float | None = None,
        on_change: Callable[[float], object] | None = None,
    ) -> Slider:
        """Add a slider to the pages, or replace the one of its name.

        Args:
            name: On the page.
            low, high: Its ends.
            value: Where it begins; in the middle if None.
            on_change: Called with the value if a page has moved it, in the thread of
                `on_change`.

        Returns:
            The slider; its ``value`` is where the pages have it.

        Raises:
            InputError: A name, an end or a value that cannot be, or more than 20
                sliders.
        """
        added = slider(name, low, high, value, on_change)
        live = self.window.server.live
        self._start_listening()
        self.window.server.call(
            lambda: live.show_control(live.controls.add_slider(added))
        )
        return added

    def move_slider(self, name: str, value: float, mover: Any) -> None:
        """Take a slider to a checked value; called in the server's thread."""
        live = self.window.server.live
        moved = live.controls.sliders[name]
        moved.value = value
        live.show_control(moved.command(), mover)
        self._page_moves.put(moved)

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
        positions = resampled(self.arm, ticks, track, video.rate)
        for frame in pictures(self._scenes_at(positions), video.size):
            video.add(frame)

    def _scenes_at(self, positions: Iterable[FloatArray]) -> Iterator[Scene]:
        """The scene at some joint positions, at which the pages show it, too."""
        for position in positions:
            self.display(position)
            yield self.scene

    def show(self, *groups: str, visible: bool = True) -> None:
        """Show or hide groups of `alpha5_model.viewer.scene.DRAWN`."""
        for group in groups:
            if group not in DRAWN:
                raise InputError("group", group, f"one of {', '.join(DRAWN)}")
            self.window.send(set_visible(group, visible))
            others = [name for name in self.scene.show if name != group]
            self._change_scene(show=(*others, group) if visible else tuple(others))

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
        camera = replace(self.scene.camera, **changes)
        self._change_scene(camera=camera)
        command = Command(
            type="camera", eye=camera.eye.tolist(), target=camera.target.tolist()
        )
        self.window.server.call(lambda: self.window.server.live.broadcast(command))

    def _change_scene(self, **changes: Any) -> None:
        """Change fields of the scene, in the server's thread."""

        def change() -> None:
            self.scene = replace(self.scene, **changes)

        self.window.server.call(change)

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
