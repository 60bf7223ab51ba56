"""meshcat's visualizer of an arm, with `display` and `play` as in Pinocchio's, and its server.

meshcat starts its server as another process on all network interfaces. This one is a thread of the
caller, listens on this machine only, and is ready in milliseconds. It speaks meshcat's protocol, so
other programs can connect to it by `zmq_url`.
"""

from __future__ import annotations

import asyncio
import errno
import os
import socket
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import meshcat
import tornado.httpserver
import tornado.web
import zmq
from meshcat.servers.tree import find_node, walk
from meshcat.servers.zmqserver import WebSocketHandler, ZMQWebSocketBridge
from meshcat.visualizer import ViewerWindow
from numpy.typing import ArrayLike

from alpha5_model.checks import float_array, real, shaped
from alpha5_model.errors import InputError, PortInUseError, ShapeError
from alpha5_model.view import page
from alpha5_model.view.arm_poses import link_poses
from alpha5_model.view.scene import DRAWN, Scene

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

_HOST = "127.0.0.1"


class _Page(tornado.web.RequestHandler):
    def get(self) -> None:
        self.set_header("Cache-Control", "no-store")
        self.finish(page.live_page(self.settings["scene"]()))


class _Connection(WebSocketHandler):  # type: ignore[misc]
    """meshcat's connection to a browser, without its messages on the terminal."""

    def open(self) -> None:
        self.bridge.websocket_pool.add(self)
        self.bridge.send_scene(self)

    def on_close(self) -> None:
        self.bridge.websocket_pool.discard(self)


class _Bridge(ZMQWebSocketBridge):  # type: ignore[misc]
    def __init__(self, opened: socket.socket, scene: Callable[[], Scene]) -> None:
        self._opened, self._scene = opened, scene
        super().__init__(host=_HOST, port=opened.getsockname()[1])

    def make_app(self) -> Any:
        handlers: list[Any] = [(r"/static/?", _Page), (r"/", _Connection, {"bridge": self})]
        application = tornado.web.Application(handlers, scene=self._scene)
        self.server = tornado.httpserver.HTTPServer(application)
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
        for node in walk(self.tree):
            parts = [node.object, *node.properties, node.transform, node.animation]
            commands += filter(None, parts)
        self.zmq_socket.send(page.static_page(self._scene(), commands).encode("utf-8"))


class Window(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process.

    Args:
        port: Of the page; 0 for a free one.
        scene: What its pages show, as it stands.

    Raises:
        PortInUseError: The port is taken.
    """

    def __init__(self, port: int, scene: Callable[[], Scene]) -> None:
        opened = _open(port)
        ready = threading.Event()

        def serve() -> None:
            asyncio.set_event_loop(asyncio.new_event_loop())
            self._bridge = _Bridge(opened, scene)
            ready.set()
            self._bridge.run()
            self._bridge.ioloop.close()

        self._thread = threading.Thread(target=serve, name="alpha5-viewer", daemon=True)
        self._thread.start()
        ready.wait()
        self.server_proc = None
        self.zmq_url: str = self._bridge.zmq_url
        self.web_url: str = self._bridge.web_url
        self.connect_zmq()

    def move(self, commands: Iterable[page.Command]) -> None:
        """Send many transforms as one step, without waiting for an answer to each."""
        bridge, done = self._bridge, threading.Event()
        moves = [(c["path"].strip("/").split("/"), c.packed()) for c in commands]

        def apply() -> None:
            for path, data in moves:
                find_node(bridge.tree, path).transform = data
                bridge.forward_to_websockets([b"set_transform", b"", data])
            done.set()

        bridge.ioloop.add_callback(apply)
        done.wait(timeout=5.0)

    def close(self) -> None:
        """Stop the server and free its port."""
        bridge = self._bridge

        def stop() -> None:
            for connection in list(bridge.websocket_pool):
                connection.close()
            bridge.server.stop()
            bridge.zmq_stream.close()
            bridge.ioloop.stop()

        if self._thread.is_alive():
            bridge.ioloop.add_callback(stop)
            self._thread.join(timeout=5.0)
            self.zmq_socket.close(linger=0)


def _open(port: int) -> socket.socket:
    """A listening socket on this machine only."""
    if not isinstance(port, int) or not 0 <= port <= 65535:
        raise InputError("port", port, "a number from 0 to 65535")
    try:
        opened = socket.create_server((_HOST, port))
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortInUseError(port) from None
        reason = os.strerror(error.errno or 0)
        raise InputError("port", port, f"one that may be opened ({reason})") from None
    opened.setblocking(False)
    return opened


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    Attributes:
        arm: What it shows.
        scene: What is drawn of it, as it stands.
    """

    __slots__ = ["arm", "scene"]

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm = arm
        self.scene = scene
        super().__init__(window=Window(port, lambda: self.scene))
        for command in page.scene_commands(scene):
            self.window.send(command)

    def display(self, q: ArrayLike) -> None:
        """Show the arm at joint positions q (nq,)."""
        position = shaped("q", q, (self.arm.model.nq,))
        poses = link_poses(self.arm, self.scene.tree, position)
        joints = position[len(position) - len(self.scene.sliders) :]
        self.scene = replace(self.scene, q=joints, poses=poses)
        self.window.move(page.pose_commands(self.scene))

    def play(self, q: ArrayLike, dt: float) -> float:
        """Play joint positions in real time, dropping frames rather than falling behind.

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
        while row < len(track) - 1:
            passed = time.perf_counter() - start
            due = min(int(passed / step), len(track) - 1)
            if due > row:
                row = due
                self.display(track[row])
            else:
                time.sleep((row + 1) * step - passed)
        return time.perf_counter() - start

    def show(self, *groups: str, visible: bool = True) -> None:
        """Show or hide groups of `alpha5_model.view.scene.DRAWN`."""
        for group in groups:
            if group not in DRAWN:
                raise InputError("group", group, f"one of {', '.join(DRAWN)}")
            self.window.send(page.set_visible(group, visible))
            others = tuple(name for name in self.scene.show if name != group)
            self.scene = replace(self.scene, show=(*others, group) if visible else others)

    def close(self) -> None:
        """Stop the server and free its port."""
        self.window.close()
