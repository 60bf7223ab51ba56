"""meshcat's visualizer of an arm, with `display` and `play` as in Pinocchio's, and its server.

meshcat starts its server as another process on all network interfaces. This one is a thread of the
caller, listens on this machine only, and is ready in milliseconds. It speaks meshcat's protocol, so
other programs can connect to it by `zmq_url`.
"""

from __future__ import annotations

import errno
import json
import logging
import queue
import socket
import tempfile
import threading
import time
from asyncio import new_event_loop, set_event_loop
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import urlsplit

import meshcat
import numpy as np
import pinocchio as pin
import tornado.httpserver
import tornado.web
import zmq
from meshcat.servers.tree import find_node
from meshcat.servers.zmqserver import WebSocketHandler, ZMQWebSocketBridge
from meshcat.visualizer import ViewerWindow
from numpy.typing import ArrayLike
from tornado.websocket import WebSocketClosedError

from alpha5_model.checks import FloatArray, choice, float_array, real, shaped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import InputError, PortInUseError, ShapeError
from alpha5_model.files import PathLike
from alpha5_model.view import build, page, picture
from alpha5_model.view.scene import DRAWN, VIEWS, Scene, framed

_HOST = "127.0.0.1"


class _Connection(WebSocketHandler):  # type: ignore[misc]
    """The page, and meshcat's connection to it with the pose both ways."""

    def prepare(self) -> None:
        """Answer the viewer's own page only, so that no other one in the browser can drive the arm.

        A name that someone lets lead to this machine (DNS rebinding) stands in the request as its host,
        the page that asks as its origin. A tunnel (``ssh -L``) may change the port, so that is free.
        """
        own, asked = f"http://{self.request.host}", self.request.headers
        origin = asked.get("Origin", "" if "Upgrade" in asked else own)
        if urlsplit(own).hostname not in (_HOST, "localhost") or origin != own:
            raise tornado.web.HTTPError(403)

    async def get(self) -> None:
        if "Upgrade" in self.request.headers:
            await super().get()
            return
        self.set_header("Cache-Control", "no-store")
        # A notebook on this machine may hold the page; on another site clicks could be led astray.
        here = "http://127.0.0.1:* http://localhost:*"
        self.set_header("Content-Security-Policy", f"frame-ancestors {here}")
        self.finish(page.live_page(self.bridge.viewer.scene))

    def open(self) -> None:
        self.bridge.websocket_pool.add(self)
        self.bridge.send_scene(self)

    def write_message(self, message: Any, binary: bool = False) -> None:
        with suppress(WebSocketClosedError):  # a page that is gone by now
            super().write_message(message, binary).add_done_callback(lambda done: done.exception())

    def on_message(self, message: str | bytes) -> None:
        viewer = self.bridge.viewer
        try:
            said = json.loads(message)
            if "data" in said:  # a picture that meshcat asked for
                super().on_message(message)
                return
            joints = shaped("q", said["q"], viewer.scene.q.shape)
        except (ValueError, TypeError, KeyError):
            self.close(1007, "expected the positions of the joints")
        else:
            viewer.place(np.concatenate([viewer.q[: -len(joints)], joints]), self)

    def on_close(self) -> None:
        self.bridge.websocket_pool.discard(self)


class _Bridge(ZMQWebSocketBridge):  # type: ignore[misc]
    def __init__(self, opened: socket.socket, viewer: ArmVisualizer) -> None:
        self._opened, self.viewer = opened, viewer
        super().__init__(host=_HOST, port=opened.getsockname()[1])

    def make_app(self) -> Any:
        handlers: list[Any] = [(r"/(?:static/?)?", _Connection, {"bridge": self})]
        self.server = tornado.httpserver.HTTPServer(tornado.web.Application(handlers))
        self.server.add_sockets([self._opened])
        # meshcat would listen to the whole network here; this server's socket is open already.
        return SimpleNamespace(listen=lambda port: None)

    def setup_zmq(self, url: str) -> tuple[Any, Any, str]:
        # A port of the system's choice: meshcat would try 6000, 6001, ... and print each.
        endpoint, stream, _ = super().setup_zmq(url.rsplit(":", 1)[0] + ":*")
        return endpoint, stream, endpoint.getsockopt(zmq.LAST_ENDPOINT).decode().rstrip("\0")

    def handle_zmq(self, frames: list[bytes]) -> None:
        if frames[0] != b"get_scene":
            super().handle_zmq(frames)
            return
        commands: list[bytes] = []
        self.send_scene(SimpleNamespace(write_message=lambda part, binary: commands.append(part)))
        self.zmq_socket.send(page.static_page(self.viewer.scene, commands).encode("utf-8"))


class Window(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process.

    Args:
        port: Of the page; 0 for a free one.
        viewer: What its pages show.

    Raises:
        PortInUseError: The port is taken.
        InputError: It is none, or may not be opened.
    """

    def __init__(self, port: int, viewer: ArmVisualizer) -> None:
        if not isinstance(port, int) or not 0 <= port <= 65535:
            raise InputError("port", port, "a number from 0 to 65535")
        try:
            opened = socket.create_server((_HOST, port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise PortInUseError(port) from None
            raise InputError("port", port, f"one that may be opened ({error.strerror})") from None
        opened.setblocking(False)
        ready = threading.Event()

        def serve() -> None:
            set_event_loop(new_event_loop())
            self._bridge = _Bridge(opened, viewer)
            ready.set()
            self._bridge.run()
            self._bridge.ioloop.close()

        self._thread = threading.Thread(target=serve, name="alpha5-viewer", daemon=True)
        self._thread.start()
        ready.wait()
        self._one_sender = threading.Lock()
        self.zmq_url, self.web_url = self._bridge.zmq_url, self._bridge.web_url
        self.connect_zmq()

    def send(self, command: Any) -> None:
        """Send one of meshcat's commands, from any thread."""
        with self._one_sender:
            super().send(command)

    def run(self, change: Callable[[], object]) -> None:
        """Let the server's thread make a change, so that every page sees changes in one order."""
        done = threading.Event()
        for step in (change, done.set):
            self._bridge.ioloop.add_callback(step)
        done.wait(timeout=5.0)

    def move(self, commands: Iterable[page.Command]) -> None:
        """Move the server's scene; in its thread."""
        for command in commands:
            path = command["path"].strip("/").split("/")
            find_node(self._bridge.tree, path).transform = command.packed()

    def tell(self, command: page.Command, mover: Any = None) -> None:
        """Send a command to all pages but one, and to those that come; in the server's thread."""
        find_node(self._bridge.tree, [command["type"]]).object = command.packed()
        for connection in self._bridge.websocket_pool - {mover}:
            connection.write_message(command.packed(), binary=True)

    def close(self) -> None:
        """Stop the server and free its port."""
        bridge = self._bridge

        async def stop() -> None:
            for connection in list(bridge.websocket_pool):
                connection.close()
            bridge.server.stop()
            # A browser would wait for ever on a connection that it keeps for the next request.
            await bridge.server.close_all_connections()
            bridge.zmq_stream.close()
            bridge.ioloop.stop()

        if self._thread.is_alive():
            bridge.ioloop.add_callback(stop)
            self._thread.join(timeout=5.0)
            self.zmq_socket.close(linger=0)


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    `display`, `captureImage`, ``displayFrames`` and the other names in camel case are those of Pinocchio's
    visualizers; pictures and videos are drawn here, without a browser.

    Attributes:
        arm: What it shows.
        scene: What is drawn of it, as it stands; its ``q`` is what the pages' sliders say.
    """

    __slots__ = ["_listeners", "_news", "_video", "arm", "scene"]

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm, self.scene = arm, scene
        self._listeners: list[Callable[[FloatArray], object]] = []
        self._news: queue.SimpleQueue[FloatArray | None] = queue.SimpleQueue()
        self._video: tuple[float, tuple[int, int], Callable[[picture.Pixels], None]] | None = None
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
        self.window.run(lambda: self.place(position))

    def place(self, q: FloatArray, mover: Any = None) -> None:
        """`display` in the server's thread, for the page that moved the arm to q (nq,)."""
        self.scene = build.posed(self.scene, self.arm, q)
        self.window.move(page.pose_commands(self.scene))
        self.window.tell(page.pose_message(self.scene), mover)
        if mover and self._listeners:
            self._news.put(q)

    def on_change(self, callback: Callable[[FloatArray], object]) -> Callable[[FloatArray], object]:
        """Call a function with q (nq,) whenever a page has moved the arm; also a decorator.

        It runs in a thread of its own and may call `display`. While it is busy, older positions give
        way to the newest.
        """
        if not self._listeners:
            threading.Thread(target=self._listen, name="alpha5-on-change", daemon=True).start()
        self._listeners.append(callback)
        return callback

    def _listen(self) -> None:
        while (q := self._news.get()) is not None:
            if self._news.empty():
                for callback in self._listeners:
                    try:
                        callback(q)
                    except Exception:
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
        """Show or hide groups of `alpha5_model.view.scene.DRAWN`."""
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
        """Look from one of `alpha5_model.view.scene.VIEWS` at all that is shown."""
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
        self.window.run(lambda: self.window.tell(page.Command(type="camera", **seen)))

    def _alter(self, **changes: Any) -> None:
        self.window.run(lambda: setattr(self, "scene", replace(self.scene, **changes)))

    def captureImage(self, w: int = 1600, h: int = 1000) -> picture.Pixels:
        """The scene as the pages show it, drawn here, (h, w, 3)."""
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
