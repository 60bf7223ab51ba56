"""The live viewer's server: its page, poses in both directions, meshcat's protocol.

The page comes over HTTP, poses and commands over a WebSocket; other programs speak
meshcat's protocol over ZMQ. All of them share one thread. Each request gets one answer,
and nothing that a page sends reaches the arm before it is checked.
"""

from __future__ import annotations

import asyncio
import errno
import socket
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

import tornado.web
import zmq
from zmq.eventloop.zmqstream import ZMQStream

from alpha5_model.errors import InputError, ViewerError
from alpha5_model.viewer import protocol
from alpha5_model.viewer.connections import HTTPServer, PageConnection
from alpha5_model.viewer.live_scene import LiveScene, Shown

_HOST = "127.0.0.1"
#: Longest wait of a caller for the server's thread [s].
PATIENCE = 5.0
#: Longest wait for the next request on an open connection [s].
_IDLE = 2.0
#: How often a page must say that it still reads [s].
_PING = 20.0
#: Longest message of a page, a picture [bytes].
_LARGEST_PICTURE = 32 * 2**20
#: Larger requests are not even read [bytes].
_LARGEST_READ = 512 * 2**20
_CONTEXT = zmq.Context()

Result = TypeVar("Result")


class Server:
    """The live viewer's server, in a thread of its own.

    Attributes:
        live: The scene that its pages show; changed in the server's thread only.
        web_url: Address of the page.
        zmq_url: Where other programs connect.
    """

    def __init__(self, port: int, viewer: Shown) -> None:
        """Listen on a port of this machine; 0 for a free one.

        Raises:
            ViewerError: The port is taken.
            InputError: It is not a port, or may not be opened.
        """
        self.live = LiveScene(viewer)
        self._web_socket = _listening(port)
        self._zmq_socket = _router()
        endpoint = self._zmq_socket.getsockopt_string(zmq.LAST_ENDPOINT)
        self.zmq_url = endpoint.rstrip("\0")
        self.web_url = f"http://{_HOST}:{self._web_socket.getsockname()[1]}/static/"
        self._requests = protocol.Requests(self.live, self.web_url)

        ready = threading.Event()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(ready)),
            name="alpha5-viewer",
            daemon=True,
        )
        self._thread.start()
        ready.wait()

    async def _serve(self, ready: threading.Event) -> None:
        """Serve until `close` is called."""
        self._loop = asyncio.get_running_loop()
        self._over = asyncio.Event()
        http = self._http_server()
        stream = ZMQStream(self._zmq_socket)
        stream.on_recv(
            lambda frames: self._requests.receive(frames, stream.send_multipart)
        )
        ready.set()

        await self._over.wait()
        for page in list(self.live.pages):
            page.close()
        http.stop()
        # A browser would wait for ever on a connection that it keeps open.
        await http.close_all_connections()
        stream.close()

    def _http_server(self) -> HTTPServer:
        arguments = {"live": self.live, "requests": self._requests}
        handlers: list[Any] = [(r"/(?:static/?)?", PageConnection, arguments)]
        application = tornado.web.Application(
            handlers,
            log_function=lambda handler: None,
            websocket_max_message_size=_LARGEST_PICTURE,
            websocket_ping_interval=_PING,
        )
        http = HTTPServer(
            application,
            idle_connection_timeout=_IDLE,
            body_timeout=_IDLE,
            max_body_size=0,
        )
        http.pages = self.live.pages
        http.add_sockets([self._web_socket])
        return http

    @property
    def closed(self) -> bool:
        """Whether it has been told to stop."""
        return self._over.is_set()

    def close(self) -> None:
        """Stop, and free the port."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._over.set)
            self._thread.join(timeout=PATIENCE)

    # ---- called by this program, in any thread

    def call(self, change: Callable[[], Result]) -> Result:
        """Make a change in the server's thread, so that all pages see the same order.

        Raises:
            ViewerError: The viewer is closed, or does not answer.
        """
        result: Future[Result] = Future()

        def make() -> None:
            try:
                result.set_result(change())
            except BaseException as error:
                result.set_exception(error)

        try:
            self._loop.call_soon_threadsafe(make)
        except RuntimeError:
            raise ViewerError("the viewer is closed: start another one") from None
        return _within(PATIENCE, result)

    def ask(self, *request: bytes) -> bytes:
        """Send a request of meshcat's protocol, which a page answers.

        Raises:
            ViewerError: The viewer is closed, or no page does what was asked.
        """
        result: Future[bytes] = Future()
        self.call(lambda: self._requests.carry_out(list(request), result.set_result))
        answer = _within(protocol.PAGE_PATIENCE + PATIENCE, result)
        if answer.startswith(protocol.ERROR):
            raise ViewerError(answer.removeprefix(protocol.ERROR).decode())
        return answer


def _within(seconds: float, result: Future[Result]) -> Result:
    try:
        return result.result(seconds)
    except TimeoutError:
        # The call itself may have raised a TimeoutError.
        if result.done():
            raise
        raise ViewerError(f"the viewer did not answer within {seconds:g} s") from None


def _router() -> zmq.Socket[bytes]:
    """A socket for requests of other programs, on a free port of this machine."""
    router = _CONTEXT.socket(zmq.ROUTER)
    router.setsockopt(zmq.LINGER, 0)
    router.setsockopt(zmq.SNDHWM, 16)
    router.setsockopt(zmq.MAXMSGSIZE, _LARGEST_READ)
    router.bind(f"tcp://{_HOST}:*")
    return router


def _listening(port: int) -> socket.socket:
    """A socket that listens on a port of this machine, for browsers."""
    if type(port) is not int or not 0 <= port <= 65535:
        raise InputError("port", port, "a number from 0 to 65535")
    try:
        opened = socket.create_server((_HOST, port))
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            remedy = "choose another, or 0 for a free one"
            raise ViewerError(f"port {port} is in use: {remedy}") from None
        expected = f"one that may be opened ({error.strerror})"
        raise InputError("port", port, expected) from None
    opened.setblocking(False)
    return opened
