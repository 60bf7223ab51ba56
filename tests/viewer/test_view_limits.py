"""Sizes, counts and times that bound what the live viewer takes, at their edges."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import pytest
import tornado.httpserver
import umsgpack
import zmq

import alpha5_model as a5
from alpha5_model.errors import InputError, PortInUseError, ViewerError
from alpha5_model.viewer import server
from alpha5_model.viewer.connections import HTTPServer, PageConnection
from alpha5_model.viewer.live_scene import LiveScene
from alpha5_model.viewer.messages import read_command, read_move
from alpha5_model.viewer.protocol import Requests

MEBIBYTE = 1024 * 1024


def run(coroutine: Coroutine[Any, Any, None]) -> None:
    """In a thread of its own: a browser of another test may keep this thread's loop."""
    with ThreadPoolExecutor(1) as threads:
        threads.submit(asyncio.run, coroutine).result()


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load()


def test_what_tornado_and_zmq_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """No bodies, pictures of 32 MiB, 2 s for a request, a sign of life in 20 s."""
    made = []

    class Kept(HTTPServer):
        def initialize(self, application: Any, **options: Any) -> None:
            made.append((application, options))
            super().initialize(application, **options)

    monkeypatch.setattr(server, "HTTPServer", Kept)
    running = server.Server(0, viewer=None)  # type: ignore[arg-type]
    try:
        ((application, options),) = made
        assert options == {
            "idle_connection_timeout": 2.0,
            "body_timeout": 2.0,
            "max_body_size": 0,
        }
        settings = application.settings
        assert settings["websocket_max_message_size"] == 32 * MEBIBYTE
        assert settings["websocket_ping_interval"] == 20.0
        router = running._zmq_socket
        assert router.getsockopt(zmq.MAXMSGSIZE) == 512 * MEBIBYTE
        assert router.getsockopt(zmq.SNDHWM) == 16
        assert router.getsockopt(zmq.LINGER) == 0
    finally:
        running.close()


def test_callers_wait_five_seconds_and_for_a_page_a_minute_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waited = []

    def within(seconds: float, result: Any) -> Any:
        waited.append(seconds)
        return result.result(10.0)

    running = server.Server(0, viewer=None)  # type: ignore[arg-type]
    try:
        monkeypatch.setattr(server, "_within", within)
        assert running.call(lambda: 7) == 7
        assert running.ask(b"url") == running.web_url.encode()
        assert waited == [5.0, 5.0, 65.0]
        joined = []
        thread = running._thread
        ended = thread.join

        def join(timeout: float) -> None:
            joined.append(timeout)
            ended(timeout)

        monkeypatch.setattr(thread, "join", join)
    finally:
        running.close()
    assert joined == [5.0]
    assert not thread.is_alive()


@pytest.mark.parametrize("kind", [b"wait", b"capture_image"])
def test_a_page_has_a_minute(kind: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    requests = Requests(LiveScene(viewer=None), "")  # type: ignore[arg-type]
    answers: list[bytes] = []
    later: list[tuple[float, Callable[[], None]]] = []
    data = umsgpack.packb({"type": "capture_image", "path": ""})
    rest = [b"", data] if kind == b"capture_image" else []

    async def ask() -> None:
        loop = asyncio.get_running_loop()
        monkeypatch.setattr(loop, "call_later", lambda *call: later.append(call))
        requests.carry_out([kind, *rest], answers.append)

    run(ask())
    ((seconds, give_up),) = later
    assert seconds == 60.0
    assert answers == []
    give_up()
    (answer,) = answers
    assert answer.startswith(b"error: no page")
    assert answer.endswith(b"within 60 s")
    give_up()
    assert len(answers) == 1


class Stream:
    """A connection that is not served yet."""

    closed = False

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("pages", [0, 3])
@pytest.mark.parametrize(("others", "served"), [(63, True), (64, False)])
def test_there_are_at_most_64_connections(
    pages: int, others: int, served: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that is no page's ends after two minutes."""
    kept = []
    monkeypatch.setattr(
        tornado.httpserver.HTTPServer,
        "handle_stream",
        lambda self, stream, address: kept.append(stream),
    )
    stream: Any = Stream()

    async def connect() -> None:
        connections = HTTPServer(lambda request: None)
        connections._ends = dict.fromkeys(range(others - pages))
        connections.pages = [None] * pages  # type: ignore[list-item]
        start = asyncio.get_running_loop().time()
        connections.handle_stream(stream, ("127.0.0.1", 1))
        if served:
            end = connections._ends[stream]
            assert end.when() - start == pytest.approx(120.0, abs=0.5)

    run(connect())
    assert kept == [stream] * served
    assert stream.closed != served


@pytest.mark.parametrize(("more", "left"), [(0, False), (1, True)])
def test_a_page_may_have_64_mebibytes_unread(more: int, left: bool) -> None:
    sent = []

    async def write(message: bytes, binary: bool) -> None:
        assert binary
        sent.append(message)

    stream = Stream()
    page: Any = SimpleNamespace(
        _unread=64 * MEBIBYTE + more,
        ws_connection=SimpleNamespace(stream=stream),
        write_message=write,
        _note_read=lambda size, done: sent.append(size),
    )

    async def send() -> None:
        PageConnection.send(page, b"pose")
        assert page._unread == 64 * MEBIBYTE + (more if left else 4)
        await asyncio.sleep(0.01)

    run(send())
    assert stream.closed == left
    assert sent == ([] if left else [b"pose", 4])


# ---- messages


def test_a_message_of_a_page_has_at_most_4096_characters(arm: a5.Arm) -> None:
    message = json.dumps({"q": [1.0, 1.5, 2.0, 2.5]})
    assert read_move(message.ljust(4096), arm, {}).tolist() == [1.0, 1.5, 2.0, 2.5]  # type: ignore[union-attr]
    with pytest.raises(InputError, match="4097 characters"):
        read_move(message.ljust(4097), arm, {})


@pytest.mark.parametrize(
    ("path", "refusal"),
    [
        (b"/a" * 64, ""),
        (b"/a" * 65, "at most 64, got '65 parts'"),
        (b"a" * 4096, ""),
        (b"a" * 4097, "at most 4096, got '4097 bytes'"),
    ],
)
def test_a_path_has_at_most_64_parts_and_4096_bytes(path: bytes, refusal: str) -> None:
    data = umsgpack.packb({"type": "delete", "path": path.decode()})
    if not refusal:
        assert "/".join(read_command(b"delete", path, data)) == path.decode().strip("/")
        return
    with pytest.raises(InputError, match=refusal):
        read_command(b"delete", path, data)


def test_what_is_refused_is_quoted_by_its_first_40_bytes() -> None:
    for refused in (
        lambda: read_command(b"delete", b"a", b"z" * 41),
        lambda: Requests(None, "").carry_out([b"z" * 41], print),  # type: ignore[arg-type]
    ):
        with pytest.raises(InputError) as caught:
            refused()
        assert "z" * 40 in str(caught.value)
        assert "z" * 41 not in str(caught.value)


def test_a_request_has_at_most_64_mebibytes() -> None:
    requests = Requests(None, "")  # type: ignore[arg-type]
    whole = bytes(64 * MEBIBYTE - 1)
    with pytest.raises(InputError, match="2 frames"):
        requests.carry_out([whole, b"z"], print)
    with pytest.raises(InputError, match="at most 67108864, got '67108865 bytes'"):
        requests.carry_out([whole, b"zz"], print)


@pytest.mark.parametrize(
    ("envelope", "request_"),
    [
        ([b"address", b""], [b"url"]),
        ([b"address"], [b"url"]),
        ([b"address", b"hop", b""], [b"get", b"", b"x"]),
    ],
)
def test_an_answer_has_the_envelope_of_its_request(
    envelope: list[bytes], request_: list[bytes]
) -> None:
    """All up to the first empty frame after the address, or the address alone."""
    requests = Requests(None, "http://here/")  # type: ignore[arg-type]
    sent: list[list[bytes]] = []
    requests.receive([*envelope, *request_], sent.append)
    (answer,) = sent
    assert answer[:-1] == envelope
    assert (answer[-1] == b"http://here/") == (request_ == [b"url"])


@pytest.mark.parametrize("port", [-1, 65536, True, 80.0, "80"])
def test_what_is_no_port_is_refused(port: Any) -> None:
    with pytest.raises(InputError, match="a number from 0 to 65535"):
        server._listening(port)


def test_the_last_port_is_one() -> None:
    """It may be in use."""
    with suppress(PortInUseError):
        server._listening(65535).close()


def test_the_server_waits_for_no_browser_and_holds_no_program_up() -> None:
    """Its socket does not block, and its thread ends with the program."""
    with server._listening(0) as listening:
        assert not listening.getblocking()
    running = server.Server(0, viewer=None)  # type: ignore[arg-type]
    assert running._thread.daemon
    running.close()
    viewer = a5.view(a5.load())
    viewer.on_change(print)
    assert viewer._listening is not None
    assert viewer._listening.daemon
    viewer.close()


def test_a_call_that_times_out_itself_says_so() -> None:
    """Only a server that does not answer is reported as one."""
    running = server.Server(0, viewer=None)  # type: ignore[arg-type]

    def slow() -> None:
        raise TimeoutError("of the call")

    try:
        with pytest.raises(TimeoutError, match="of the call"):
            running.call(slow)
    finally:
        running.close()
    assert running.closed
    with pytest.raises(ViewerError, match="closed"):
        running.call(slow)
