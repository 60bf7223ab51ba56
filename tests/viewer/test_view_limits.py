"""Sizes and counts that bound what the live viewer takes, at their edges."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError

# Not by public names: through a socket, each edge takes tens of megabytes or seconds.
from alpha5_model.viewer import server
from alpha5_model.viewer.connections import HTTPServer
from alpha5_model.viewer.messages import read_command, read_move
from alpha5_model.viewer.protocol import Requests

MEBIBYTE = 1024 * 1024


class Stream:
    """A connection that is not served yet."""

    closed = False

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("pages", [0, 3, 63, 64])
def test_there_are_at_most_64_connections(
    pages: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pages and all others together."""
    served = []
    monkeypatch.setattr(
        "tornado.httpserver.HTTPServer.handle_stream",
        lambda self, stream, address: served.append(stream),
    )
    monkeypatch.setattr(
        "asyncio.get_running_loop",
        lambda: SimpleNamespace(call_later=lambda *call: None),
    )
    for others in {max(63 - pages, 0), 64 - pages}:
        stream: Any = Stream()
        connections = HTTPServer(lambda request: None)
        connections._ends = dict.fromkeys(range(others))
        connections.pages = [None] * pages  # type: ignore[list-item]
        connections.handle_stream(stream, ("127.0.0.1", 1))
        assert stream.closed == (pages + others >= 64)
        assert (stream in served) != stream.closed


def test_a_message_of_a_page_has_at_most_4096_characters() -> None:
    arm = a5.load()
    message = json.dumps({"q": [1.0, 1.5, 2.0, 2.5]})
    moved: Any = read_move(message.ljust(4096), arm, {})
    assert moved.tolist() == [1.0, 1.5, 2.0, 2.5]
    with pytest.raises(InputError, match="4097 characters"):
        read_move(message.ljust(4097), arm, {})


def test_a_path_has_at_most_64_parts_and_4096_bytes() -> None:
    import umsgpack

    for path, fits in (
        (b"/a" * 64, True),
        (b"/a" * 65, False),
        (b"a" * 4096, True),
        (b"a" * 4097, False),
    ):
        data = umsgpack.packb({"type": "delete", "path": path.decode()})
        if fits:
            read = "/".join(read_command(b"delete", path, data))
            assert read == path.decode().strip("/")
        else:
            with pytest.raises(InputError, match="path"):
                read_command(b"delete", path, data)


def test_a_request_has_at_most_64_mebibytes() -> None:
    requests = Requests(None, "")  # type: ignore[arg-type]
    whole = bytes(64 * MEBIBYTE - 1)
    with pytest.raises(InputError, match="2 frames"):
        requests.carry_out([whole, b"z"], print)
    with pytest.raises(InputError, match="67108865 bytes"):
        requests.carry_out([whole, b"zz"], print)


def test_what_is_no_port_is_refused() -> None:
    for port in (-1, 65536, True, 80.0, "80"):
        with pytest.raises(InputError, match="port"):
            server._listening(port)  # type: ignore[arg-type]
