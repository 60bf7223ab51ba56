"""Connections of browsers to the live viewer, and the WebSocket of a page."""

from __future__ import annotations

import asyncio
import logging
import re
from collections import deque
from collections.abc import Awaitable, Collection
from contextlib import suppress
from typing import Any

import numpy as np
import tornado.httpserver
import tornado.web
import tornado.websocket
from tornado.httputil import (
    HTTPConnection,
    HTTPHeaders,
    HTTPMessageDelegate,
    ResponseStartLine,
)

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import Alpha5Error
from alpha5_model.viewer.commands import Command, pose_message
from alpha5_model.viewer.live_scene import LiveScene, Page
from alpha5_model.viewer.messages import SliderMove, read_move
from alpha5_model.viewer.page import live_page
from alpha5_model.viewer.protocol import Requests

#: Names of this machine in a browser. A tunnel may change the port, so any is allowed.
_THIS_MACHINE = re.compile(r"(127\.0\.0\.1|localhost)(:\d{1,5})?")
#: Most connections at a time, pages included.
_MOST_CONNECTIONS = 64
#: Longest life of a connection that is not a page's [s]; a slow tunnel takes a while.
_LONGEST_VISIT = 120.0
#: Most bytes that may wait for a page that reads too slowly, before it is disconnected.
_BACKLOG = 64 * 2**20
#: How meshcat's page begins the message that holds a picture.
_PICTURE = '{"type":"img",'
_LOG = logging.getLogger(__name__)


class PageConnection(tornado.websocket.WebSocketHandler):
    """A request for the page, or the WebSocket of an open page.

    Attributes:
        asked: Numbers of the pictures that the page was asked for and has not sent yet.
    """

    def initialize(self, live: LiveScene, requests: Requests) -> None:
        self._live = live
        self._requests = requests
        #: Bytes sent to the page that it has not read yet.
        self._unread = 0
        #: The positions that the page sent last, until they are shown.
        self._wanted: FloatArray | None = None
        self._refusal: Alpha5Error | None = None
        #: Where the page has moved sliders of the program, until it is told.
        self._moved: dict[str, float] = {}
        self.asked: deque[int] = deque()

    def prepare(self) -> None:
        """Answer only the viewer's own page: no other page may drive the arm."""
        headers = self.request.headers
        own = f"http://{self.request.host}"
        without_origin = "" if "Upgrade" in headers else own
        if headers.get("Origin", without_origin) != own:
            raise tornado.web.HTTPError(403)

    async def get(self, *args: Any, **kwargs: Any) -> None:
        if "Upgrade" in self.request.headers:
            await super().get(*args, **kwargs)
            return
        self.set_header("Cache-Control", "no-store")
        # A notebook on this machine may hold the page in a frame. Any other site could
        # trick a user into clicking in it.
        here = "http://127.0.0.1:* http://localhost:*"
        self.set_header("Content-Security-Policy", f"frame-ancestors {here}")
        self.finish(live_page(self._live.viewer.scene))

    def log_exception(self, kind: Any, value: Any, trace: Any) -> None:
        """Log the errors of this program; a refused request has had its answer."""
        if not isinstance(value, tornado.web.HTTPError):
            _LOG.error("viewer", exc_info=(kind, value, trace))

    def open(self, *args: str, **kwargs: str) -> None:
        self._live.enter(self)
        self._requests.page_opened(self)

    def send(self, message: bytes) -> None:
        """Send a packed command, or disconnect a page that has stopped reading."""
        if self._unread > _BACKLOG and self.ws_connection and self.ws_connection.stream:
            self.ws_connection.stream.close()
            return
        # The page may be closed by now.
        with suppress(tornado.websocket.WebSocketClosedError):
            sent = asyncio.ensure_future(self.write_message(message, binary=True))
            self._unread += len(message)
            sent.add_done_callback(lambda done: self._note_read(len(message), done))

    def _note_read(self, size: int, done: asyncio.Future[None]) -> None:
        self._unread -= size
        if not done.cancelled():
            # asyncio logs an exception that nobody takes. Here the page is just closed.
            done.exception()

    def on_message(self, message: str | bytes) -> None:
        """Store what a page sends; only the last of several messages is shown."""
        if self._wanted is None and self._refusal is None and not self._moved:
            asyncio.get_running_loop().call_soon(self._act)
        try:
            if self.asked and isinstance(message, str) and message.startswith(_PICTURE):
                self._requests.receive_picture(self.asked.popleft(), message)
            else:
                sliders = self._live.controls.sliders
                move = read_move(message, self._live.viewer.arm, sliders)
                if isinstance(move, SliderMove):
                    self._moved[move.name] = move.value
                else:
                    self._wanted = move
        except Alpha5Error as refusal:
            self._refusal = refusal

    def _act(self) -> None:
        """Show the positions that the page sent last, and tell it what was refused."""
        viewer = self._live.viewer
        wanted = self._wanted
        refusal = self._refusal
        moved = self._moved
        self._wanted = None
        self._moved = {}
        self._refusal = None

        if wanted is not None:
            base = viewer.q[: -len(wanted)]
            viewer.place(np.concatenate([base, wanted]), self)
        for name, value in moved.items():
            viewer.move_slider(name, value, self)
        if refusal is not None:
            self.send(Command(type="refused", reason=str(refusal)).packed())
            self.send(pose_message(viewer.scene).packed())

    def on_close(self) -> None:
        self._live.pages.discard(self)


class _HostCheck(HTTPMessageDelegate):
    """Pass a request on if its Host header names this machine; refuse it otherwise.

    Another site can make its own name lead to this machine (DNS rebinding). The browser
    then sends that name as the host. A tunnel (``ssh -L``) may change the port, so any
    port is accepted.
    """

    def __init__(
        self, request: HTTPMessageDelegate, connection: HTTPConnection
    ) -> None:
        self._request: HTTPMessageDelegate | None = request
        self._connection = connection

    def headers_received(
        self, start_line: Any, headers: HTTPHeaders
    ) -> Awaitable[None] | None:
        if self._request and _THIS_MACHINE.fullmatch(headers.get("Host", "")):
            return self._request.headers_received(start_line, headers)

        self._request = None
        refusal = ResponseStartLine("HTTP/1.1", 403, "Forbidden")
        end = HTTPHeaders({"Content-Length": "0", "Connection": "close"})
        self._connection.write_headers(refusal, end)
        self._connection.finish()
        return None

    def data_received(self, chunk: bytes) -> Awaitable[None] | None:
        return self._request.data_received(chunk) if self._request else None

    def finish(self) -> None:
        if self._request:
            self._request.finish()

    def on_connection_close(self) -> None:
        if self._request:
            self._request.on_connection_close()


class HTTPServer(tornado.httpserver.HTTPServer):
    """An HTTP server that limits the number of its connections and their lives.

    Attributes:
        pages: Connections that have become a page's.
    """

    pages: Collection[Page] = ()

    def initialize(self, *args: Any, **options: Any) -> None:
        super().initialize(*args, **options)
        #: When to end each connection that is not a page's.
        self._ends: dict[Any, asyncio.TimerHandle] = {}

    def handle_stream(self, stream: Any, address: Any) -> None:
        if len(self._ends) + len(self.pages) >= _MOST_CONNECTIONS:
            stream.close()
            return
        loop = asyncio.get_running_loop()
        self._ends[stream] = loop.call_later(_LONGEST_VISIT, stream.close)
        super().handle_stream(stream, address)

    def start_request(
        self, server_conn: object, request_conn: HTTPConnection
    ) -> HTTPMessageDelegate:
        request = super().start_request(server_conn, request_conn)
        return _HostCheck(request, request_conn)

    def on_close(self, server_conn: Any) -> None:
        self._ends.pop(server_conn.stream).cancel()
        super().on_close(server_conn)
