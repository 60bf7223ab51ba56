"""The live viewer's server: it serves the page and sends poses in both directions.

meshcat starts its server as another process on all network interfaces. This one is a
thread of the caller, listens on this machine only, and is ready in milliseconds. The
page comes over HTTP, everything else over one WebSocket for each open page.
"""

from __future__ import annotations

import asyncio
import base64
import errno
import io
import json
import re
import secrets
import socket
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import tornado.httpserver
import tornado.web
import tornado.websocket
import umsgpack  # type: ignore[import-untyped]
from meshcat.visualizer import ViewerWindow
from PIL import Image

from alpha5_model.errors import Alpha5Error, InputError, ViewerError

_HOST = "127.0.0.1"
#: Names of this machine in a browser. A tunnel may change the port, so any is allowed.
_THIS_MACHINE = re.compile(r"(127\.0\.0\.1|localhost)(:\d{1,5})?")
#: Longest wait for something that a page must do: be opened, or send a picture [s].
PAGE_PATIENCE = 60.0
#: Longest wait for the end of the server's thread [s].
_FAREWELL = 5.0
#: Longest wait for the next request on an open connection [s].
_IDLE = 2.0
#: How often a page must answer that it still reads [s]; one that does not is left.
_PING = 20.0
#: Longest message of a page, a picture [bytes].
_LARGEST_PICTURE = 32 * 2**20
#: What meshcat draws. Other commands are the page's own.
_MESHCAT = ("set_object", "set_transform", "set_property", "set_animation")
_PICTURE = re.compile(r"data:image/\w+;base64,")


class LiveWindow(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process; usable from any thread.

    Attributes:
        web_url: Address of the page. It holds a secret, so that no other account of
            this machine can open the page and move the arm.
    """

    def __init__(
        self,
        port: int,
        page: Callable[[], str],
        scene: Callable[[list[bytes]], str],
        receive: Callable[[Any, PageConnection], None],
    ) -> None:
        """Listen on a port of this machine; 0 for a free one.

        Args:
            port: Of the page.
            page: The page as HTML.
            scene: The page as one file, which draws some packed commands.
            receive: Called with what a page sends, and its connection.

        Raises:
            ViewerError: The port is taken.
            InputError: It is not a port, or may not be opened.
        """
        self.page = page
        self.scene = scene
        self.receive = receive
        self._socket = _listening(port)
        path = f"/{secrets.token_urlsafe(12)}/"
        self.web_url = f"http://{_HOST}:{self._socket.getsockname()[1]}{path}"
        #: Protects the three below, which any thread may use.
        self._lock = threading.Lock()
        #: What a page gets that opens later: a command by type, path and property.
        self._kept: dict[tuple[str, ...], bytes] = {}
        self._pages: list[PageConnection] = []
        self._pictures: list[Future[bytes]] = []
        self._has_page = threading.Event()

        ready = threading.Event()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(path, ready)),
            name="alpha5-viewer",
            daemon=True,
        )
        self._thread.start()
        ready.wait()

    async def _serve(self, path: str, ready: threading.Event) -> None:
        """Serve until `close` is called."""
        self._loop = asyncio.get_running_loop()
        self._over = asyncio.Event()
        application = tornado.web.Application(
            [(re.escape(path), PageConnection, {"window": self})],
            log_function=lambda handler: None,
            websocket_max_message_size=_LARGEST_PICTURE,
            websocket_ping_interval=_PING,
        )
        http = tornado.httpserver.HTTPServer(
            application,
            idle_connection_timeout=_IDLE,
            body_timeout=_IDLE,
            max_body_size=0,
        )
        http.add_sockets([self._socket])
        ready.set()

        await self._over.wait()
        for page in list(self._pages):
            page.close()
        http.stop()
        # A browser would wait for ever on a connection that it keeps open.
        await http.close_all_connections()

    @property
    def closed(self) -> bool:
        """Whether it has been told to stop."""
        return self._over.is_set()

    def close(self) -> None:
        """Stop the server and free its port."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._over.set)
            self._thread.join(timeout=_FAREWELL)

    # ---- to the pages

    def send(self, command: Any, mover: PageConnection | None = None) -> None:
        """Send a command to all pages, also to those that open later.

        Args:
            command: meshcat's, or one of the page's own.
            mover: The page that caused it, which does not get it.

        Raises:
            ViewerError: The viewer is closed.
        """
        content = command.lower()
        message = bytes(umsgpack.packb(content))
        kind = content["type"]
        path = content.get("path", "")
        with self._lock:
            if kind == "delete":
                self._forget(path)
            else:
                if kind == "set_object":
                    self._forget(path, "set_property")
                key = (kind, _steady(path), str(content.get("property", "")))
                self._kept[key] = message
            pages = [page for page in self._pages if page is not mover]
            self._send_soon(message, pages)

    def _forget(self, path: str, *kinds: str) -> None:
        """Keep no commands, or none of some kinds, of a node and of those below it."""
        below = f"{_steady(path)}/"
        for key in list(self._kept):
            kind, node, _ = key
            if kind in (kinds or _MESHCAT) and f"{node}/".startswith(below):
                del self._kept[key]

    def _send_soon(self, message: bytes, pages: list[PageConnection]) -> None:
        """Have the server's thread send a message, after all earlier ones."""

        def send() -> None:
            for page in pages:
                page.send(message)

        try:
            self._loop.call_soon_threadsafe(send)
        except RuntimeError:
            raise ViewerError("the viewer is closed: start another one") from None

    def enter(self, page: PageConnection) -> None:
        """Show everything to a new page."""
        with self._lock:
            self._pages.append(page)
            for message in self._kept.values():
                page.send(message)
            if self._pictures:
                page.send(_ASK_FOR_PICTURE)
        self._has_page.set()

    def remind(self, page: PageConnection) -> None:
        """Tell a page where the arm is."""
        with self._lock:
            pose = self._kept.get(("pose", "", ""))
        if pose is not None:
            page.send(pose)

    def leave(self, page: PageConnection) -> None:
        """Forget a page that is closed."""
        with self._lock:
            self._pages = [other for other in self._pages if other is not page]
            if not self._pages:
                self._has_page.clear()

    # ---- meshcat's names

    def request_web_url(self) -> str:
        """Address of the page."""
        return self.web_url

    def wait(self) -> str:
        """Wait until a page is open.

        Raises:
            ViewerError: No page was opened within a minute, or the viewer is closed.
        """
        self._send_soon(b"", [])  # is it open?
        if not self._has_page.wait(PAGE_PATIENCE):
            raise ViewerError(f"no page was opened within {PAGE_PATIENCE:g} s")
        return "ok"

    def get_scene(self) -> str:
        """The page as one file."""
        self._send_soon(b"", [])  # is it open?
        with self._lock:
            drawn = [text for key, text in self._kept.items() if key[0] in _MESHCAT]
        return self.scene(drawn)

    def get_image(self) -> Image.Image:
        """A picture by an open page.

        Raises:
            ViewerError: No page sent a picture within a minute.
        """
        picture: Future[bytes] = Future()
        with self._lock:
            self._pictures.append(picture)
            self._send_soon(_ASK_FOR_PICTURE, self._pages[:1])
        try:
            return Image.open(io.BytesIO(picture.result(PAGE_PATIENCE)))
        except TimeoutError:
            reason = f"no page sent a picture within {PAGE_PATIENCE:g} s"
            raise ViewerError(reason) from None
        finally:
            with self._lock:
                self._pictures = [one for one in self._pictures if one is not picture]

    def take_picture(self, content: Any) -> None:
        """Give the picture of a page to those who wait for one.

        Raises:
            InputError: The message holds no picture.
        """
        address = content.get("data")
        start = _PICTURE.match(address) if isinstance(address, str) else None
        try:
            if start is None:
                raise ValueError
            picture = base64.b64decode(address[start.end() :], validate=True)
        except ValueError:
            raise InputError("data", address, "a picture as a data URL") from None
        with self._lock:
            for waiting in self._pictures:
                if not waiting.done():
                    waiting.set_result(picture)


class PageConnection(tornado.websocket.WebSocketHandler):
    """A request for the page, or the WebSocket of an open page."""

    def initialize(self, window: LiveWindow) -> None:
        self._window = window

    def prepare(self) -> None:
        """Answer only the viewer's own page: no other page may drive the arm.

        Another site can make its own name lead to this machine (DNS rebinding). The
        browser then sends that name as the host.
        """
        host = self.request.host
        headers = self.request.headers
        own = f"http://{host}"
        without_origin = "" if "Upgrade" in headers else own
        is_own = headers.get("Origin", without_origin) == own
        if not is_own or not _THIS_MACHINE.fullmatch(host):
            raise tornado.web.HTTPError(403)

    async def get(self, *args: Any, **kwargs: Any) -> None:
        if "Upgrade" in self.request.headers:
            await super().get(*args, **kwargs)
            return
        self.set_header("Cache-Control", "no-store")
        self.set_header("Referrer-Policy", "no-referrer")
        # A notebook on this machine may hold the page in a frame. Any other site could
        # trick a user into clicking in it.
        here = "http://127.0.0.1:* http://localhost:*"
        self.set_header("Content-Security-Policy", f"frame-ancestors {here}")
        self.finish(self._window.page())

    def open(self, *args: str, **kwargs: str) -> None:
        self._window.enter(self)

    def send(self, message: bytes) -> None:
        """Send a packed command; called in the server's thread."""
        if self.ws_connection is None or self.ws_connection.is_closing():
            return
        sent = asyncio.ensure_future(self.write_message(message, binary=True))
        # asyncio logs an exception that nobody takes. Here the page is just closed.
        sent.add_done_callback(lambda done: done.cancelled() or done.exception())

    def on_message(self, message: str | bytes) -> None:
        """Take a picture or a move, or tell the page why not."""
        try:
            content = read_json(message)
            if isinstance(content, dict) and content.get("type") == "img":
                self._window.take_picture(content)
            else:
                self._window.receive(content, self)
        except Alpha5Error as refusal:
            self.send(umsgpack.packb({"type": "refused", "reason": str(refusal)}))
            self._window.remind(self)

    def on_close(self) -> None:
        self._window.leave(self)


_ASK_FOR_PICTURE = bytes(umsgpack.packb({"type": "capture_image"}))


def read_json(message: str | bytes) -> Any:
    """What a page has sent.

    Raises:
        InputError: Not JSON as text.
    """
    if not isinstance(message, str):
        raise InputError("message", f"{len(message)} bytes", "JSON as text")
    try:
        return json.loads(message)
    except (ValueError, RecursionError):
        raise InputError("message", message[:80], "JSON") from None


def _steady(path: str) -> str:
    """A path of meshcat's scene tree, without empty parts."""
    return "".join(f"/{part}" for part in path.split("/") if part)


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
