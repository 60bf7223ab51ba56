"""The live viewer's server: meshcat's bridge, with our page in front of it, in a thread.

meshcat starts its server as another process on all network interfaces. This one is a thread of the caller,
listens on this machine only, and is ready in milliseconds. It speaks meshcat's protocol, so that other
programs can connect to it by `zmq_url` too.
"""

from __future__ import annotations

import asyncio
import errno
import threading
from collections.abc import Callable, Iterable
from typing import Any

import tornado.httpserver
import tornado.ioloop
import tornado.netutil
import tornado.web
import zmq
from meshcat.servers.tree import find_node, walk
from meshcat.servers.zmqserver import WebSocketHandler, ZMQWebSocketBridge
from meshcat.visualizer import ViewerWindow

from alpha5_model.errors import Alpha5Error, InputError
from alpha5_model.view.commands import Command


class PortInUseError(Alpha5Error, OSError):
    """The port of the viewer is taken. ``port`` is the one asked for."""

    def __init__(self, port: int) -> None:
        self.port = port
        super().__init__(f"port {port} is in use: choose another, or 0 for a free one")


class _Page(tornado.web.RequestHandler):
    def initialize(self, html: Callable[[], str]) -> None:
        self._html = html

    def get(self) -> None:
        self.set_header("Cache-Control", "no-store")
        self.finish(self._html())


class _Connection(WebSocketHandler):  # type: ignore[misc]
    """meshcat's connection to a browser, without its messages on the terminal."""

    def open(self) -> None:
        self.bridge.websocket_pool.add(self)
        self.bridge.send_scene(self)

    def on_close(self) -> None:
        self.bridge.websocket_pool.discard(self)


class _Application(tornado.web.Application):
    def listen(self, port: int, address: str | None = None, **options: Any) -> Any:
        [socket] = tornado.netutil.bind_sockets(port, address or "127.0.0.1")
        self.port: int = socket.getsockname()[1]
        self.server = tornado.httpserver.HTTPServer(self, **options)
        self.server.add_sockets([socket])
        return self.server


class _Bridge(ZMQWebSocketBridge):  # type: ignore[misc]
    def __init__(self, port: int, live: Callable[[], str], static: Callable[[list[bytes]], str]):
        self._live, self._static = live, static
        super().__init__(port=port)
        self.fileserver_port = self.app.port
        self.web_url = f"http://127.0.0.1:{self.app.port}/static/"

    def make_app(self) -> _Application:
        page = {"html": self._live}
        return _Application(
            [
                (r"/static/?", _Page, page),
                (r"/", _Connection, {"bridge": self}),
            ]
        )

    def setup_zmq(self, url: str) -> tuple[Any, Any, str]:
        # A port of the system's choice: meshcat would try 6000, 6001, ... aloud.
        host = url.rsplit(":", 1)[0]
        socket, stream, _ = super().setup_zmq(f"{host}:*")
        return socket, stream, socket.getsockopt(zmq.LAST_ENDPOINT).decode("ascii").rstrip("\0")

    def handle_zmq(self, frames: list[bytes]) -> None:
        if frames[0] != b"get_scene":
            super().handle_zmq(frames)
            return
        commands = []
        for node in walk(self.tree):
            parts = [node.object, *node.properties, node.transform, node.animation]
            commands += [part for part in parts if part is not None]
        self.zmq_socket.send(self._static(commands).encode("utf-8"))


class Window(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process.

    Args:
        port: Of the page; 0 for a free one.
        live: Text of the page to serve.
        static: Text of a page on disk, from packed meshcat commands.

    Raises:
        PortInUseError: The port is taken.
    """

    def __init__(
        self, port: int, live: Callable[[], str], static: Callable[[list[bytes]], str]
    ) -> None:
        if not isinstance(port, int) or not 0 <= port <= 65535:
            raise InputError("port", port, "a number from 0 to 65535")
        ready = threading.Event()
        state: dict[str, Any] = {}

        def serve() -> None:
            asyncio.set_event_loop(asyncio.new_event_loop())
            try:
                state["bridge"] = _Bridge(port, live, static)
            except Exception as error:
                state["error"] = error
                return
            finally:
                ready.set()
            state["bridge"].run()

        threading.Thread(target=serve, name="alpha5-viewer", daemon=True).start()
        ready.wait()
        if "error" in state:
            error = state["error"]
            if isinstance(error, OSError) and error.errno in (errno.EADDRINUSE, errno.EACCES):
                raise PortInUseError(port) from None
            raise error
        self._bridge = state["bridge"]
        self.server_proc = None
        self.zmq_url: str = self._bridge.zmq_url
        self.web_url: str = self._bridge.web_url
        self.connect_zmq()

    def move(self, commands: Iterable[Command]) -> None:
        """Send many transforms at once: a pose of the arm is one step, not a question and answer each."""
        bridge, done = self._bridge, threading.Event()
        moves = [(c.content["path"].strip("/").split("/"), c.packed()) for c in commands]

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
        done = threading.Event()

        def stop() -> None:
            for connection in list(bridge.websocket_pool):
                connection.close()
            bridge.app.server.stop()
            bridge.zmq_stream.close()
            bridge.ioloop.stop()
            done.set()

        bridge.ioloop.add_callback(stop)
        done.wait(timeout=5.0)
        self.zmq_socket.close(linger=0)
