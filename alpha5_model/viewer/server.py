"""The live viewer's server: its page, the poses both ways, and meshcat's protocol.

The page comes over HTTP, poses and commands over a WebSocket; other programs speak
meshcat's protocol over ZMQ. All of them share one thread. Each request gets one answer,
and nothing that a page sends reaches the arm before it is checked.
"""

from __future__ import annotations

import asyncio
import base64
import errno
import itertools
import json
import logging
import re
import socket
import threading
from collections import deque
from collections.abc import Awaitable, Callable, Collection, Iterator
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, Protocol, TypeVar

import numpy as np
import tornado.httpserver
import tornado.web
import tornado.websocket
import umsgpack  # type: ignore[import-untyped]
import zmq
from meshcat.servers.tree import SceneTree, find_node, walk
from tornado.httputil import (
    HTTPConnection,
    HTTPHeaders,
    HTTPMessageDelegate,
    ResponseStartLine,
)
from zmq.eventloop.zmqstream import ZMQStream

from alpha5_model._support.checks import FloatArray, shaped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import (
    Alpha5Error,
    InputError,
    JointLimitError,
    PortInUseError,
    ViewerError,
)
from alpha5_model.viewer import page
from alpha5_model.viewer.scene import Scene

_HOST = "127.0.0.1"
#: How a browser on this machine names it; the port may be a tunnel's.
_THIS_MACHINE = re.compile(r"(127\.0\.0\.1|localhost)(:\d{1,5})?")
#: Longest wait of a caller for the server's thread [s].
PATIENCE = 5.0
#: Longest wait for something that a page must do: be opened, or send a picture [s].
PAGE_PATIENCE = 60.0
#: Longest wait for the next request on an open connection [s].
_IDLE = 2.0
#: Most connections at a time, pages included.
_MOST_CONNECTIONS = 64
#: Longest life of a connection that is not a page's [s]; a slow tunnel takes a while.
_LONGEST_VISIT = 120.0
#: How often a page must say that it still reads [s].
_PING = 20.0
#: Longest message with positions of joints [characters].
_LONGEST_POSE = 4096
#: Longest message of a page, a picture [bytes].
_LARGEST_PICTURE = 32 * 2**20
#: Largest request of another program [bytes].
_LARGEST_REQUEST = 64 * 2**20
#: Largest part of a request that is read to be refused [bytes].
_LARGEST_READ = 512 * 2**20
#: What may wait for a page that reads too slowly, before it is disconnected [bytes].
_BACKLOG = 64 * 2**20
#: Longest path of a node of the scene, in parts and in bytes.
_DEEPEST_PATH, _LONGEST_PATH = 64, 4096
#: How far beyond a limit rounding may put a joint [rad or m].
_ROUNDING = 1e-9

_COMMANDS = {
    b"set_object",
    b"set_transform",
    b"set_property",
    b"set_animation",
    b"delete",
}
_ERROR = b"error: "
#: How meshcat's page begins the message that holds a picture.
_PICTURE = '{"type":"img",'
_DATA_URL = re.compile(r"data:image/\w+;base64,")
_CONTEXT = zmq.Context()
_LOG = logging.getLogger(__name__)

Answer = Callable[[bytes], None]
Result = TypeVar("Result")


class Shown(Protocol):
    """What the server shows: an arm at a pose."""

    arm: Arm
    scene: Scene

    @property
    def q(self) -> FloatArray:
        """Where the arm is shown, (nq,)."""

    def place(self, q: FloatArray, mover: Any = None) -> None:
        """Show the arm at q (nq,), which a page has sent if there is a mover."""


def positions_said(message: str | bytes, arm: Arm) -> FloatArray:
    """Joint positions that a page sends as ``{"q": [...]}``.

    Args:
        message: What it sent; anything.
        arm: Whose joints they are.

    Returns:
        Positions within the limits, (n,) [rad, and m for axis_a].

    Raises:
        InputError: No such message (`ShapeError`, `NonFiniteError`).
        JointLimitError: A joint beyond a limit.
    """
    expected = '{"q": [...]} as text'
    if not isinstance(message, str):
        raise InputError("message", f"{len(message)} bytes", expected)
    if len(message) > _LONGEST_POSE:
        raise InputError("message", f"{len(message)} characters", expected)
    said = _json(message)
    if not isinstance(said, dict) or set(said) != {"q"}:
        raise InputError("message", message, expected)

    names, limits = arm.joint_names, arm.limits
    joints = shaped("q", said["q"], (len(names),))
    inside = np.clip(joints, limits.lower, limits.upper)
    for name, value, bound in zip(names, joints, inside, strict=True):
        if abs(value - bound) > _ROUNDING:
            unit = "m" if name == "axis_a" else "rad"
            raise JointLimitError(name, float(value), float(bound), unit)
    return inside


def _json(message: str) -> Any:
    try:
        return json.loads(message)
    except (ValueError, RecursionError):
        raise InputError("message", message, "JSON") from None


def picture_said(message: str) -> bytes:
    """A picture that a page sends, as the bytes of its file.

    Raises:
        InputError: No such message.
    """
    said = _json(message)
    address = said.get("data")
    start = _DATA_URL.match(address) if isinstance(address, str) else None
    try:
        if start is None:
            raise ValueError
        return base64.b64decode(address[start.end() :], validate=True)
    except ValueError:
        raise InputError("data", address, "a picture as a data URL") from None


def command_said(kind: bytes, path: bytes, data: bytes) -> list[str]:
    """Check a command of meshcat's protocol, as pages will read it.

    Args:
        kind: What to do, such as ``set_transform``.
        path: Of the node in the scene.
        data: The same and all else, in MessagePack.

    Returns:
        The parts of the path.

    Raises:
        InputError: A command that pages could not read, or would read as another one.
    """
    if len(path) > _LONGEST_PATH:
        raise InputError("path", f"{len(path)} bytes", f"at most {_LONGEST_PATH}")
    try:
        parts = _parts(path.decode())
    except UnicodeDecodeError:
        raise InputError("path", path, "UTF-8") from None
    if len(parts) > _DEEPEST_PATH:
        raise InputError("path", f"{len(parts)} parts", f"at most {_DEEPEST_PATH}")

    try:
        said = umsgpack.unpackb(data)
    except Exception:  # umsgpack has many, and NumPy's and Python's own come through
        said = None
    if not isinstance(said, dict) or said.get("type") != kind.decode():
        raise InputError("data", data[:40], f"{kind.decode()} in MessagePack")
    inside = said.get("path", "")
    if not isinstance(inside, str) or _parts(inside) != parts:
        raise InputError("path in the data", inside, f"{path.decode()!r}, as beside it")
    return parts


def _parts(path: str) -> list[str]:
    return [part for part in path.split("/") if part]


class _Connection(tornado.websocket.WebSocketHandler):
    """A request for the page, or the page's connection."""

    def initialize(self, server: Server) -> None:
        self._server = server
        self._unread = 0
        self._wanted: FloatArray | None = None
        self._refusal: Alpha5Error | None = None
        #: Numbers of the pictures that it was asked for.
        self.asked: deque[int] = deque()

    def prepare(self) -> None:
        """Answer the viewer's own page only, so that no other one can drive the arm."""
        headers = self.request.headers
        own = f"http://{self.request.host}"
        if headers.get("Origin", "" if "Upgrade" in headers else own) != own:
            raise tornado.web.HTTPError(403)

    async def get(self, *args: Any, **kwargs: Any) -> None:
        if "Upgrade" in self.request.headers:
            await super().get(*args, **kwargs)
            return
        self.set_header("Cache-Control", "no-store")
        # A notebook on this machine may hold the page. Another site could lead clicks astray.
        here = "http://127.0.0.1:* http://localhost:*"
        self.set_header("Content-Security-Policy", f"frame-ancestors {here}")
        self.finish(page.live_page(self._server.viewer.scene))

    def log_exception(self, kind: Any, value: Any, trace: Any) -> None:
        """Log errors of this program; a request that is refused has had its answer."""
        if not isinstance(value, tornado.web.HTTPError):
            _LOG.error("viewer", exc_info=(kind, value, trace))

    def open(self, *args: str, **kwargs: str) -> None:
        self._server.enter(self)

    def send(self, message: bytes) -> None:
        """Send a packed command, or leave a page that has stopped reading."""
        if self._unread > _BACKLOG and self.ws_connection and self.ws_connection.stream:
            self.ws_connection.stream.close()
            return
        # The page may be gone by now.
        with suppress(tornado.websocket.WebSocketClosedError):
            sent = asyncio.ensure_future(self.write_message(message, binary=True))
            self._unread += len(message)
            sent.add_done_callback(lambda done: self._read(len(message), done))

    def _read(self, size: int, done: asyncio.Future[None]) -> None:
        self._unread -= size
        if not done.cancelled():
            done.exception()  # of a page that is gone by now

    def on_message(self, message: str | bytes) -> None:
        """Note what a page wants; of many messages at once only the last one counts."""
        if self._wanted is None and self._refusal is None:
            asyncio.get_running_loop().call_soon(self._act)
        try:
            if self.asked and isinstance(message, str) and message.startswith(_PICTURE):
                self._server.receive_picture(self.asked.popleft(), message)
            else:
                self._wanted = positions_said(message, self._server.viewer.arm)
        except Alpha5Error as refusal:
            self._refusal = refusal

    def _act(self) -> None:
        wanted, self._wanted = self._wanted, None
        refusal, self._refusal = self._refusal, None
        viewer = self._server.viewer
        if wanted is not None:
            viewer.place(np.concatenate([viewer.q[: -len(wanted)], wanted]), self)
        if refusal is not None:
            self.send(page.Command(type="refused", reason=str(refusal)).packed())
            self.send(page.pose_message(viewer.scene).packed())

    def on_close(self) -> None:
        self._server.pages.discard(self)


class _HostCheck(HTTPMessageDelegate):
    """A request, if its host is this machine.

    A name that someone lets lead to this machine (DNS rebinding) stands in the request
    as its host. A tunnel (``ssh -L``) may change the port, so that is free.
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


class _HTTPServer(tornado.httpserver.HTTPServer):
    """An HTTP server with a largest number of connections.

    Attributes:
        pages: Connections that have become a page's.
    """

    pages: Collection[_Connection] = ()

    def initialize(self, *args: Any, **options: Any) -> None:
        super().initialize(*args, **options)
        #: The end of each connection that is not a page's.
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
        return _HostCheck(
            super().start_request(server_conn, request_conn), request_conn
        )

    def on_close(self, server_conn: Any) -> None:
        self._ends.pop(server_conn.stream).cancel()
        super().on_close(server_conn)


class Server:
    """The live viewer's server, in a thread of its own.

    Attributes:
        viewer: What it shows.
        web_url: Address of the page.
        zmq_url: Where other programs connect.
        tree: meshcat's tree of the scene.
        pages: Connections of the pages that are open.
    """

    def __init__(self, port: int, viewer: Shown) -> None:
        """Listen on a port of this machine; 0 for a free one.

        Raises:
            PortInUseError: The port is taken.
            InputError: It is none, or may not be opened.
        """
        self.viewer = viewer
        self.tree: Any = SceneTree()
        self.pages: set[_Connection] = set()
        self._told: dict[str, bytes] = {}
        self._numbers = itertools.count()
        self._visits: dict[int, Answer] = {}
        self._pictures: dict[int, tuple[Answer, bytes]] = {}

        self._opened = _listening(port)
        self._requests = _CONTEXT.socket(zmq.ROUTER)
        self._requests.setsockopt(zmq.LINGER, 0)
        self._requests.setsockopt(zmq.SNDHWM, 16)
        self._requests.setsockopt(zmq.MAXMSGSIZE, _LARGEST_READ)
        self._requests.bind(f"tcp://{_HOST}:*")
        self.zmq_url = self._requests.getsockopt_string(zmq.LAST_ENDPOINT).rstrip("\0")
        self.web_url = f"http://{_HOST}:{self._opened.getsockname()[1]}/static/"

        ready = threading.Event()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(ready)),
            name="alpha5-viewer",
            daemon=True,
        )
        self._thread.start()
        ready.wait()

    async def _serve(self, ready: threading.Event) -> None:
        self._loop = asyncio.get_running_loop()
        self._over = asyncio.Event()
        handlers: list[Any] = [(r"/(?:static/?)?", _Connection, {"server": self})]
        application = tornado.web.Application(
            handlers,
            log_function=lambda handler: None,
            websocket_max_message_size=_LARGEST_PICTURE,
            websocket_ping_interval=_PING,
        )
        http = _HTTPServer(
            application,
            idle_connection_timeout=_IDLE,
            body_timeout=_IDLE,
            max_body_size=0,
        )
        http.pages = self.pages
        http.add_sockets([self._opened])
        stream = ZMQStream(self._requests)
        stream.on_recv(lambda frames: self._hear(frames, stream.send_multipart))
        ready.set()

        await self._over.wait()
        for connection in list(self.pages):
            connection.close()
        http.stop()
        # A browser would wait for ever on a connection that it keeps open.
        await http.close_all_connections()
        stream.close()

    @property
    def closed(self) -> bool:
        """Whether it has been told to stop."""
        return self._over.is_set()

    def close(self) -> None:
        """Stop, and free the port."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._over.set)
            self._thread.join(timeout=PATIENCE)

    # ---- calls of this program

    def call(self, change: Callable[[], Result]) -> Result:
        """Let the server's thread make a change: every page sees changes in one order.

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
        """Make a request of meshcat's protocol that a page answers.

        Raises:
            ViewerError: The viewer is closed, or no page does what it should.
        """
        result: Future[bytes] = Future()
        self.call(lambda: self._do(list(request), result.set_result))
        answer = _within(PAGE_PATIENCE + PATIENCE, result)
        if answer.startswith(_ERROR):
            raise ViewerError(answer.removeprefix(_ERROR).decode())
        return answer

    # ---- in the server's thread: the scene and its pages

    def enter(self, connection: _Connection) -> None:
        """Show the scene to a new page."""
        self.pages.add(connection)
        for message in (*self._scene(), *self._told.values()):
            connection.send(message)
        for number in list(self._visits):
            self._visits.pop(number)(b"ok")
        for number in self._pictures:
            self._request_picture(number, connection)

    def tell(self, command: page.Command, mover: Any = None) -> None:
        """Send a command to all pages but one, and to those that come."""
        packed = command.packed()
        self._told[command["type"]] = packed
        for connection in self.pages - {mover}:
            connection.send(packed)

    def move(self, command: page.Command) -> None:
        """Move a node for pages that come; those that are open move it themselves."""
        find_node(self.tree, _parts(command["path"])).transform = command.packed()

    def obey(self, kind: str, path: list[str], data: bytes) -> None:
        """Carry out a command of meshcat's protocol, here and in all pages."""
        known = kind == "set_object" and find_node(self.tree, path).object == data
        for connection in () if known else self.pages:
            connection.send(data)

        if kind == "delete":
            self._delete(path)
            return
        node = find_node(self.tree, path)
        if kind == "set_object":
            node.object = data
            node.properties = []
        elif kind == "set_transform":
            node.transform = data
        elif kind == "set_animation":
            node.animation = data
        else:
            node.properties.append(data)

    def _delete(self, path: list[str]) -> None:
        if path:
            find_node(self.tree, path[:-1]).pop(path[-1], None)
        else:
            self.tree = SceneTree()

    def _scene(self) -> Iterator[bytes]:
        for node in walk(self.tree):
            for part in (node.object, *node.properties, node.transform, node.animation):
                if part is not None:
                    yield part

    # ---- in the server's thread: requests of meshcat's protocol

    def _hear(self, frames: list[bytes], send: Callable[[list[bytes]], None]) -> None:
        """Answer a request, behind the frames that lead back to who made it."""
        start = frames.index(b"", 1) + 1 if b"" in frames[1:] else 1
        envelope, request = frames[:start], frames[start:]

        def answer(text: bytes) -> None:
            send([*envelope, text])

        try:
            self._do(request, answer)
        except Alpha5Error as refusal:
            answer(_ERROR + str(refusal).encode())
        except Exception:
            _LOG.exception("viewer")
            answer(_ERROR + b"the viewer failed")

    def _do(self, request: list[bytes], answer: Answer) -> None:
        """Do what is asked, and answer once, perhaps later.

        Raises:
            InputError: No such request.
        """
        size = sum(map(len, request))
        if size > _LARGEST_REQUEST:
            raise InputError("request", f"{size} bytes", f"at most {_LARGEST_REQUEST}")
        match request:
            case [b"url"]:
                answer(self.web_url.encode())
            case [b"get_scene"]:
                answer(page.static_page(self.viewer.scene, self._scene()).encode())
            case [b"wait"]:
                self._wait(answer)
            case [b"capture_image", path, data]:
                command_said(b"capture_image", path, data)
                self._capture(answer, data)
            case [kind, path, data] if kind in _COMMANDS:
                self.obey(kind.decode(), command_said(kind, path, data), data)
                answer(b"ok")
            case _:
                first = request[0][:40] if request else b""
                commands = b", ".join(sorted(_COMMANDS)).decode()
                given = f"{len(request)} frames, {first!r}"
                known = f"url, wait, get_scene, or a command ({commands}), its path and its data"
                raise InputError("request", given, known)

    def _wait(self, answer: Answer) -> None:
        if self.pages:
            answer(b"ok")
            return
        number = next(self._numbers)
        self._visits[number] = answer

        def give_up() -> None:
            if self._visits.pop(number, None):
                answer(
                    _ERROR + f"no page was opened within {PAGE_PATIENCE:g} s".encode()
                )

        self._loop.call_later(PAGE_PATIENCE, give_up)

    def _capture(self, answer: Answer, data: bytes) -> None:
        number = next(self._numbers)
        self._pictures[number] = answer, data
        for connection in self.pages:
            self._request_picture(number, connection)

        def give_up() -> None:
            if self._pictures.pop(number, None):
                answer(
                    _ERROR
                    + f"no page sent a picture within {PAGE_PATIENCE:g} s".encode()
                )

        self._loop.call_later(PAGE_PATIENCE, give_up)

    def _request_picture(self, number: int, connection: _Connection) -> None:
        connection.asked.append(number)
        connection.send(self._pictures[number][1])

    def receive_picture(self, number: int, message: str) -> None:
        """Answer with a page's picture; the first page's is taken.

        Raises:
            InputError: No picture.
        """
        picture = picture_said(message)
        waiting = self._pictures.pop(number, None)
        if waiting:
            waiting[0](picture)


def _within(seconds: float, result: Future[Result]) -> Result:
    try:
        return result.result(seconds)
    except TimeoutError:
        if result.done():  # an error of the call itself
            raise
        raise ViewerError(f"the viewer did not answer within {seconds:g} s") from None


def _listening(port: int) -> socket.socket:
    if type(port) is not int or not 0 <= port <= 65535:
        raise InputError("port", port, "a number from 0 to 65535")
    try:
        opened = socket.create_server((_HOST, port))
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortInUseError(port) from None
        raise InputError(
            "port", port, f"one that may be opened ({error.strerror})"
        ) from None
    opened.setblocking(False)
    return opened
