"""meshcat's visualizer of an arm, with `display` and `play` as in Pinocchio's.

meshcat starts its server as another process on all network interfaces. This one
(`alpha5_model.viewer.server`) is a thread of the caller, listens on this machine only, and is
ready in milliseconds. It speaks meshcat's protocol, so other programs can connect to it by
`zmq_url`.
"""

from __future__ import annotations

import io
import logging
import queue
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshcat
import numpy as np
import pinocchio as pin
import umsgpack  # type: ignore[import-untyped]
from meshcat.visualizer import ViewerWindow
from numpy.typing import ArrayLike
from PIL import Image

from alpha5_model._support.checks import FloatArray, choice, float_array, real, shaped
from alpha5_model._support.files import PathLike
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.viewer import build, page, picture
from alpha5_model.viewer.scene import DRAWN, VIEWS, Scene, framed
from alpha5_model.viewer.server import Server


class Window(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process, from any thread.

    Args:
        port: Of the page; 0 for a free one.
        viewer: What its pages show.

    Raises:
        PortInUseError: The port is taken.
        InputError: It is none, or may not be opened.
    """

    def __init__(self, port: int, viewer: ArmVisualizer) -> None:
        self.server = Server(port, viewer)
        self.zmq_url = self.server.zmq_url
        self.web_url = self.server.web_url

    def send(self, command: Any) -> None:
        """Send one of meshcat's commands."""
        lowered = command.lower()
        path = [part for part in lowered["path"].split("/") if part]
        packed = umsgpack.packb(lowered)
        self.server.call(lambda: self.server.obey(lowered["type"], path, packed))

    def request_web_url(self) -> str:
        """Address of the page."""
        return self.web_url

    def wait(self) -> str:
        """Wait until a page is open.

        Raises:
            ViewerError: None was within a minute.
        """
        return self.server.ask(b"wait").decode()

    def get_scene(self) -> str:
        """The page as one file."""
        return self.server.ask(b"get_scene").decode()

    def get_image(self) -> Image.Image:
        """A picture by an open page.

        Raises:
            ViewerError: None sent one within a minute.
        """
        packed = umsgpack.packb({"type": "capture_image", "path": ""})
        return Image.open(io.BytesIO(self.server.ask(b"capture_image", b"", packed)))

    def close(self) -> None:
        """Stop the server and free its port."""
        self.server.close()


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    `display`, `captureImage`, ``displayFrames`` and the other names in camel case are those of Pinocchio's
    visualizers; pictures and videos are drawn here, without a browser. A viewer that is closed, or that does
    not answer within 5 s, raises `alpha5_model.errors.ViewerError`.

    Attributes:
        arm: What it shows.
        scene: What is drawn of it, as it stands; its ``q`` is what the pages' sliders say.
    """

    __slots__ = ["_listeners", "_news", "_video", "arm", "scene"]

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm, self.scene = arm, scene
        self._listeners: list[Callable[[FloatArray], object]] = []
        self._news: queue.SimpleQueue[FloatArray | None] = queue.SimpleQueue()
        self._video: (
            tuple[float, tuple[int, int], Callable[[picture.Pixels], None]] | None
        ) = None
        super().__init__(window=Window(port, self))
        for command in page.scene_commands(scene):
            self.window.send(command)

    @property
    def q(self) -> FloatArray:
        """Where the arm is shown, (nq,)."""
        base = self.scene.poses[self.scene.tree[0].parent]
        free = pin.SE3ToXYZQUAT(pin.SE3(base)) if self.arm.floating_base else []
        return np.concatenate([free, self.scene.q])

    def display(self, q: ArrayLike) -> None:
        """Show the arm at joint positions q (nq,)."""
        position = shaped("q", q, (self.arm.model.nq,))
        self.window.server.call(lambda: self.place(position))

    def place(self, q: FloatArray, mover: Any = None) -> None:
        """`display` in the server's thread, for the page that moved the arm to q (nq,)."""
        self.scene = build.posed(self.scene, self.arm, q)
        server = self.window.server
        for command in page.pose_commands(self.scene):
            server.move(command)
        server.tell(page.pose_message(self.scene), mover)
        if mover and self._listeners:
            self._news.put(q)

    def on_change(
        self, callback: Callable[[FloatArray], object]
    ) -> Callable[[FloatArray], object]:
        """Call a function with q (nq,) whenever a page has moved the arm; also a decorator.

        Its joints are within the limits: pages send no others, and what else they send is refused.
        The function runs in a thread of its own and may call `display`. While it is busy, older positions give
        way to the newest.
        """
        if not self._listeners:
            threading.Thread(
                target=self._listen, name="alpha5-on-change", daemon=True
            ).start()
        self._listeners.append(callback)
        return callback

    def _listen(self) -> None:
        while (q := self._news.get()) is not None:
            if self._news.empty():
                for callback in self._listeners:
                    try:
                        callback(q)
                    except Exception:
                        if not self.window.server.closed:
                            logging.getLogger(__name__).exception("on_change")

    def play(self, q: ArrayLike, dt: float) -> float:
        """Play joint positions in real time, dropping frames rather than falling behind.

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
        start, row = time.perf_counter(), -1
        if self._video is not None:
            fps, size, add = self._video
            ticks = step * np.arange(float(len(track)))
            for position in build.resampled(self.arm, ticks, track, fps):
                self.display(position)
                add(self.captureImage(*size))
            return time.perf_counter() - start
        while row < len(track) - 1:
            time.sleep(max(0.0, start + (row + 1) * step - time.perf_counter()))
            row = min(int((time.perf_counter() - start) / step), len(track) - 1)
            self.display(track[row])
        return time.perf_counter() - start

    def show(self, *groups: str, visible: bool = True) -> None:
        """Show or hide groups of `alpha5_model.viewer.scene.DRAWN`."""
        for group in groups:
            if group not in DRAWN:
                raise InputError("group", group, f"one of {', '.join(DRAWN)}")
            self.window.send(page.set_visible(group, visible))
            others = [name for name in self.scene.show if name != group]
            self._alter(show=(*others, group) if visible else tuple(others))

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
        """Look from one of `alpha5_model.viewer.scene.VIEWS` at all that is shown."""
        view = choice("view", preset_key, tuple(VIEWS))
        self._look(**vars(framed(self.scene, view=view).camera))

    def setCameraTarget(self, target: ArrayLike) -> None:
        """Look at a point of the world, (3,) [m]."""
        self._look(target=shaped("target", target, (3,)))

    def setCameraPosition(self, position: ArrayLike) -> None:
        """Look from a point of the world, (3,) [m]."""
        self._look(eye=shaped("position", position, (3,)))

    def _look(self, **changes: Any) -> None:
        camera = replace(self.scene.camera, **changes)
        self._alter(camera=camera)
        seen = {"eye": camera.eye.tolist(), "target": camera.target.tolist()}
        command = page.Command(type="camera", **seen)
        self.window.server.call(lambda: self.window.server.tell(command))

    def _alter(self, **changes: Any) -> None:
        self.window.server.call(
            lambda: setattr(self, "scene", replace(self.scene, **changes))
        )

    def captureImage(self, w: int = 1600, h: int = 1000) -> picture.Pixels:
        """The arm and its groups, drawn without a browser, (h, w, 3).

        What else was put into the pages is not in it: `get_image` asks a page for its picture.
        """
        return picture.picture(self.scene, (w, h))

    @contextmanager
    def create_video_ctx(
        self,
        filename: PathLike | None = None,
        fps: float = 30.0,
        directory: PathLike | None = None,
        size: tuple[int, int] = (1280, 720),
    ) -> Iterator[Path]:
        """Write what `play` shows within into a video, in the time in which it would be played.

        Args:
            filename: ``.mp4`` (extra ``video``) or ``.gif``; by default MP4, named by the time of day.
            fps: Frames per second.
            directory: Of the default name; the system's temporary folder if None.
            size: Width and height in pixels.

        Raises:
            UnknownNameError, InputError: Another suffix; a size or rate that makes no video.
            MissingDependencyError: imageio-ffmpeg is not installed.
            OutputError: It cannot be written.
        """
        name = filename or time.strftime("%Y%m%d_%H%M%S.mp4")
        path = Path("" if filename else directory or tempfile.gettempdir(), name)
        with picture.video(path, fps) as (rate, add):
            self._video = rate, size, add
            try:
                yield path
            finally:
                self._video = None

    def close(self) -> None:
        """Stop the server and free its port."""
        self._news.put(None)
        self.window.close()
