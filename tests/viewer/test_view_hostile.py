"""The live viewer under hostile input: HTTP, WebSocket and meshcat's protocol.

The viewer answers each input within two seconds: it refuses, or closes the connection.
Nothing moves, nothing is printed, and the viewer goes on.
"""

from __future__ import annotations

import base64
import json
import queue
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import umsgpack
import zmq
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

import alpha5_model as a5
from alpha5_model.errors import InputError, ViewerError
from alpha5_model.viewer import connections, protocol, server
from alpha5_model.viewer.messages import read_move
from alpha5_model.viewer.visualizer import ArmVisualizer

POSE = np.array([2.0, 1.0, 2.2, 0.4, 0.005])
ELSEWHERE = [1.0, 1.5, 2.0, 2.5, 0.002]
#: Longest wait for an answer [s], on a machine that does other work, too.
SOON = 60.0


@pytest.fixture(scope="module")
def opened() -> Iterator[ArmVisualizer]:
    found = a5.view(a5.load(gripper="jaws"), POSE)
    found.display(POSE)
    found.slider("gain", 0.0, 2.0)
    yield found
    found.close()


@pytest.fixture
def viewer(
    opened: ArmVisualizer,
    capfd: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> Iterator[ArmVisualizer]:
    """A viewer that works afterwards, has not moved, and has printed nothing."""
    heard: queue.Queue[np.ndarray] = queue.Queue()
    opened.on_change(heard.put)
    yield opened
    np.testing.assert_array_equal(opened.q, POSE)
    works(opened)
    # called back, perhaps late, with nothing but what pages may send
    assert heard.get(timeout=SOON).tolist() == ELSEWHERE
    while not heard.empty():
        assert heard.get().tolist() == ELSEWHERE
    opened._listeners.clear()
    assert capfd.readouterr() == ("", "")
    assert [record.getMessage() for record in caplog.records] == []


def works(viewer: ArmVisualizer) -> None:
    """The page is served, a page moves the arm, and other programs are answered."""
    started = time.perf_counter()
    assert raw(viewer, request(viewer)).startswith(b"HTTP/1.1 200")
    with page_of(viewer) as page:
        until(page, "pose")
        page.send(json.dumps({"q": ELSEWHERE}))
        while viewer.q.tolist() != ELSEWHERE:
            assert time.perf_counter() < started + SOON
            time.sleep(0.005)
        viewer.display(POSE)
        while until(page, "pose")["q"] != POSE.tolist():
            pass
    viewer.show("frames", visible=False)
    assert ask(viewer, b"url") == viewer.url().encode()
    assert time.perf_counter() < started + SOON


def address(viewer: ArmVisualizer) -> tuple[str, int]:
    host, port = viewer.url().split("/")[2].split(":")
    return host, int(port)


# ---- poses of a page


def page_of(viewer: ArmVisualizer) -> Any:
    host = viewer.url().split("/")[2]
    return connect(f"ws://{host}/", origin=f"http://{host}", max_size=None)


def until(page: Any, kind: str) -> Any:
    """The next command of a kind that a page is sent."""
    ends = time.perf_counter() + SOON
    while True:
        said = umsgpack.unpackb(page.recv(timeout=max(0.0, ends - time.perf_counter())))
        if said["type"] == kind:
            return said


def poses(*numbers: str) -> str:
    """A message with numbers as JSON has them; the pose itself but for the first."""
    return '{"q": [' + ", ".join([*numbers, *map(str, POSE[len(numbers) :])]) + "]}"


MESSAGES: dict[str, tuple[str | bytes, str]] = {
    "far": (
        poses("99", "99", "99", "99", "99"),
        "axis_e: 99 rad is above the upper limit",
    ),
    "1e60": (poses("1e60"), "axis_e: 1e+60 rad is above"),
    "below": (poses("-1e-6"), "axis_e: -1e-06 rad is below the lower limit"),
    "base_forward": (poses("2", "1", "2.2", "-0.4"), "axis_b: -0.4 rad is below"),
    "open_jaws": (
        poses("2", "1", "2.2", "0.4", "5"),
        "axis_a: 5 m is above the upper limit",
    ),
    "shut_jaws": (poses("2", "1", "2.2", "0.4", "-0.001"), "axis_a: -0.001 m is below"),
    "nan": (poses("NaN"), "finite"),
    "infinity": (poses("2", "-Infinity"), "finite"),
    "too_large": (poses("1e999"), "finite"),
    "huge_integer": (poses("9" * 400), "real numbers"),
    "endless_integer": (poses("9" * 4100), "expected"),
    "text": (poses('"2"'), "real numbers"),
    "true": (poses("true"), "real numbers"),
    "null": (poses("null"), "real numbers"),
    "list": (poses("[2]"), "real numbers"),
    "object": (poses('{"real": 2}'), "real numbers"),
    "none": ('{"q": []}', "shape (5,)"),
    "short": ('{"q": [1, 1, 1, 1]}', "shape (5,)"),
    "long": ('{"q": [1, 1, 1, 1, 0, 0]}', "shape (5,)"),
    "nested": ('{"q": [[1, 1, 1, 1, 0]]}', "shape (5,)"),
    "number": ('{"q": 1}', "shape (5,)"),
    "word": ('{"q": "home"}', "real numbers"),
    "mapping": ('{"q": {"axis_e": 1}}', "real numbers"),
    "base": (poses()[:-1] + ', "root": {"base_link": [[9]]}}', "expected"),
    "time": (poses()[:-1] + ', "time": 5}', "expected"),
    "other": ('{"p": [1, 1, 1, 1, 0]}', "expected"),
    "no_object": ("[1, 1, 1, 1, 0]", "expected"),
    "no_json": ("q", "JSON"),
    "empty": ("", "JSON"),
    "half": ('{"q": [1, 1', "JSON"),
    "nul": ("\0", "JSON"),
    "brackets": ("[" * 100_000, "100000 characters"),
    "few_brackets": ("[" * 4000, "JSON"),
    "braces": ('{"q":' * 800, "JSON"),
    "deep": ('{"q": ' + "[" * 900 + "]" * 900 + "}", "real numbers"),
    "megabytes": (" " * 5_000_000 + "{}", "characters"),
    "many": ('{"q": [' + ",".join(["1"] * 400_000) + "]}", "characters"),
    "picture": ('{"data":5}', "expected"),
    "no_picture": ('{"type":"img","data":5}', "expected"),
    "unwanted_picture": (
        '{"type":"img","data":"data:image/png;base64,AAAA"}',
        "expected",
    ),
    "command": ('{"type":"set_object","path":"/meshcat"}', "expected"),
    "slider_unknown": ('{"slider": "other", "value": 1}', "gain"),
    "slider_null": ('{"slider": null, "value": 1}', "gain"),
    "slider_list": ('{"slider": ["gain"], "value": 1}', "gain"),
    "slider_far": ('{"slider": "gain", "value": 2.1}', "a number from 0 to 2"),
    "slider_nan": ('{"slider": "gain", "value": NaN}', "finite"),
    "slider_text": ('{"slider": "gain", "value": "1"}', "number"),
    "slider_true": ('{"slider": "gain", "value": true}', "number"),
    "slider_nested": ('{"slider": "gain", "value": [1]}', "number"),
    "slider_bare": ('{"slider": "gain"}', "expected"),
    "slider_more": ('{"slider": "gain", "value": 1, "high": 9}', "expected"),
    "binary": (b"\xff", "1 bytes"),
    "binary_pose": (poses().encode(), "bytes"),
    "binary_nothing": (b"", "0 bytes"),
    "binary_megabytes": (b"\0" * 5_000_000, "5000000 bytes"),
    "binary_pack": (umsgpack.packb({"type": "pose", "q": [9.0] * 5}), "bytes"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MESSAGES)
def test_a_page_is_refused_and_told_where_the_arm_is(
    viewer: ArmVisualizer, name: str
) -> None:
    message, reason = MESSAGES[name]
    with page_of(viewer) as page:
        until(page, "pose")
        page.send(message)
        assert reason in until(page, "refused")["reason"]
        assert until(page, "pose")["q"] == POSE.tolist()
        # the connection is as good as before
        page.send(message)
        assert reason in until(page, "refused")["reason"]


def test_what_a_page_sends_is_within_the_limits_exactly() -> None:
    """Rounding may leave a joint a hair beyond; what is called back is not."""
    arm = a5.load(gripper="jaws")
    seed = np.random.default_rng(5)
    low, high = arm.limits.lower, arm.limits.upper
    for _ in range(200):
        q = seed.uniform(low, high)
        ends = seed.integers(0, 3, 5)
        q[ends == 1] = low[ends == 1] - 0.9e-9
        q[ends == 2] = high[ends == 2] + 0.9e-9
        said = read_move(json.dumps({"q": q.tolist()}), arm, {})
        assert ((low <= said) & (said <= high)).all()
        np.testing.assert_allclose(said, q, rtol=0, atol=1e-9)
        joint = seed.integers(5)
        q[joint] = high[joint] + 1.1e-9
        with pytest.raises(a5.errors.JointLimitError, match=arm.joint_names[joint]):
            read_move(json.dumps({"q": q.tolist()}), arm, {})


def test_a_page_leaves_a_floating_base_where_it_is() -> None:
    viewer = a5.view(a5.load(floating_base=True))
    try:
        base = [0.1, 0.2, 0.3, 0.0, 0.0, 0.6, 0.8]
        viewer.display([*base, 2.0, 1.0, 2.2, 0.4])
        with page_of(viewer) as page:
            until(page, "pose")
            page.send(json.dumps({"q": [*base, 1.0, 1.0, 1.0, 1.0]}))
            assert "shape (4,)" in until(page, "refused")["reason"]
            page.send('{"q": [1.0, 1.0, 1.0, 1.0]}')
            page.send("x")
            until(page, "refused")
        np.testing.assert_allclose(viewer.q, [*base, 1.0, 1.0, 1.0, 1.0], atol=1e-15)
    finally:
        viewer.close()


# ---- raw bytes to the page's port


def raw(viewer: ArmVisualizer, sent: bytes, last: bytes = b"\r\n\r\n") -> bytes:
    """What comes back, up to some bytes or the end of the connection."""
    with socket.create_connection(address(viewer), timeout=SOON) as connection:
        connection.sendall(sent)
        answer = b""
        try:
            while last not in answer and (part := connection.recv(65536)):
                answer += part
        except ConnectionResetError:
            pass
        return answer


def request(
    viewer: ArmVisualizer, start: str = "GET / HTTP/1.1", **headers: str
) -> bytes:
    host = viewer.url().split("/")[2]
    fields = {"Host": host, "Connection": "close"} | {
        key.replace("_", "-"): value for key, value in headers.items()
    }
    lines = [start, *(f"{key}: {value}" for key, value in fields.items())]
    return ("\r\n".join(lines) + "\r\n\r\n").encode("latin-1")


def upgrade(viewer: ArmVisualizer, **headers: str) -> bytes:
    fields = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Origin": "http://" + viewer.url().split("/")[2],
        "Sec_WebSocket_Version": "13",
        "Sec_WebSocket_Key": "x3JJHMbDL1EzLkh9GBhXDw==",
    }
    return request(viewer, **{**fields, **headers})


REQUESTS: dict[str, tuple[Callable[[ArmVisualizer], bytes], tuple[int, ...]]] = {
    "open_bracket": (lambda v: request(v, Host="[::1"), (400, 403)),
    "bracket": (lambda v: request(v, Host="["), (400, 403)),
    "brackets": (lambda v: request(v, Host="[::1]:80"), (400, 403)),
    "no_host": (lambda v: request(v, Host=""), (400, 403)),
    "user": (lambda v: request(v, Host="me@127.0.0.1"), (400, 403)),
    "port": (lambda v: request(v, Host="127.0.0.1:x"), (400, 403)),
    "long_port": (lambda v: request(v, Host="127.0.0.1:" + "9" * 5000), (400, 403)),
    "dot": (lambda v: request(v, Host="127.0.0.1.:80"), (400, 403)),
    "latin": (lambda v: request(v, Host="\xff\xfe"), (400, 403)),
    "foreign": (lambda v: request(v, Host="attacker.example"), (403,)),
    "origin": (lambda v: request(v, Origin="http://attacker.example"), (403,)),
    "bracket_origin": (lambda v: request(v, Origin="http://[::1"), (403,)),
    "two_hosts": (
        lambda v: request(v).replace(
            b"Connection", b"Host: attacker.example\r\nConnection"
        ),
        (400, 403),
    ),
    "path": (lambda v: request(v, "GET /static/../../etc/passwd HTTP/1.1"), (404,)),
    "script": (lambda v: request(v, "GET /static/main.min.js HTTP/1.1"), (404,)),
    "percent": (lambda v: request(v, "GET /%ff%00%zz HTTP/1.1"), (400, 404)),
    "query": (lambda v: request(v, "GET /?q=%ff&q=[[[ HTTP/1.1"), (200, 400)),
    "absolute": (lambda v: request(v, "GET http://[::1/ HTTP/1.1"), (400, 404)),
    "long_path": (lambda v: request(v, f"GET /{'a' * 12_000} HTTP/1.1"), (404,)),
    "longer_path": (
        lambda v: request(v, f"GET /{'a' * 100_000} HTTP/1.1"),
        (0, 400, 431),
    ),
    "headers": (
        lambda v: request(v, **{f"X_{i}": "y" for i in range(20_000)}),
        (0, 400, 431),
    ),
    "post": (lambda v: request(v, "POST / HTTP/1.1", Content_Length="0"), (403, 405)),
    "form": (
        lambda v: (
            request(
                v,
                "POST / HTTP/1.1",
                Content_Length="5",
                Content_Type="multipart/form-data; boundary=x",
            )
            + b"--x\xff\xff"
        ),
        (0, 400, 405, 413),
    ),
    "body": (lambda v: request(v, Content_Length="9" * 30), (0, 400, 413)),
    "endless_body": (lambda v: request(v, Content_Length="9" * 5000), (0, 400, 413)),
    "endless_port": (
        lambda v: upgrade(v, Origin="http://127.0.0.1:" + "9" * 5000),
        (403,),
    ),
    "endless_version": (
        lambda v: upgrade(v, Sec_WebSocket_Version="9" * 5000),
        (400, 426),
    ),
    "negative": (lambda v: request(v, Content_Length="-1"), (0, 400)),
    "chunks": (
        lambda v: request(v, Transfer_Encoding="chunked") + b"fffffff\r\n",
        (0, 400, 413),
    ),
    "smuggled": (
        lambda v: (
            request(v, Transfer_Encoding="chunked", Content_Length="3") + b"0\r\n\r\n"
        ),
        (0, 400),
    ),
    "put": (lambda v: request(v, "PUT / HTTP/1.1"), (405,)),
    "head": (lambda v: request(v, "HEAD / HTTP/1.1"), (405,)),
    "options": (lambda v: request(v, "OPTIONS * HTTP/1.1"), (400, 404, 405)),
    "no_method": (lambda v: request(v, "X" * 500 + " / HTTP/1.1"), (400, 405)),
    "version": (lambda v: request(v, "GET / HTTP/9.9"), (0, 400, 505)),
    "no_version": (lambda v: request(v, "GET /"), (0, 400)),
    "nothing": (lambda v: b"\r\n\r\n", (0, 400)),
    "binary": (lambda v: bytes(range(256)) * 400, (0, 400)),
    "colons": (lambda v: b"GET / HTTP/1.1\r\n:::\r\n\r\n", (0, 400)),
    "fold": (lambda v: b"GET / HTTP/1.1\r\n \x00: x\r\n\r\n", (0, 400)),
    "tls": (
        lambda v: b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\r\n\r\n",
        (0, 400),
    ),
    "upgrade_to_http2": (lambda v: upgrade(v, Upgrade="h2c"), (400,)),
    "no_upgrade": (lambda v: upgrade(v, Connection="close"), (400,)),
    "old_websocket": (lambda v: upgrade(v, Sec_WebSocket_Version="8"), (400, 426)),
    "no_key": (lambda v: upgrade(v).replace(b"Sec-WebSocket-Key", b"X"), (400,)),
    "upgrade_from_elsewhere": (
        lambda v: upgrade(v, Origin="http://attacker.example"),
        (403,),
    ),
    "upgrade_from_nowhere": (lambda v: upgrade(v).replace(b"Origin", b"X"), (403,)),
    "upgrade_bracket": (
        lambda v: upgrade(v, Host="[::1", Origin="http://[::1"),
        (400, 403),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", REQUESTS)
def test_a_request_that_is_not_the_pages_is_refused(
    viewer: ArmVisualizer, name: str
) -> None:
    sent, statuses = REQUESTS[name]
    started = time.perf_counter()
    answer = raw(viewer, sent(viewer))
    # the end of a connection counts as 0
    status = int(answer.split()[1]) if answer else 0
    assert status in statuses
    assert time.perf_counter() < started + SOON


def frame(
    code: int, content: bytes = b"", mask: bool = True, length: bytes = b""
) -> bytes:
    """A frame of WebSocket, by RFC 6455; of short content unless a length is given."""
    second = length or bytes([len(content)])
    start = bytes([code, second[0] | 0x80 * mask]) + second[1:]
    return start + bytes(4 * mask) + content


FRAMES = {
    "no_mask": frame(0x81, b"{}", mask=False),
    "reserved": frame(0xF1, b"{}"),
    "compressed": frame(0xC1, b"{}"),
    "code": frame(0x83, b"{}"),
    "control": frame(0x8F),
    "continued": frame(0x80, b"{}"),
    "begun_twice": frame(0x01, b"{") + frame(0x01, b"{"),
    "split_ping": frame(0x09, b"x"),
    "long_ping": frame(0x89, b"x" * 126, length=b"\x7e\x00\x7e"),
    "endless": frame(0x81, b"{}", length=b"\x7f" + b"\xff" * 8),
    "gigabytes": frame(0x82, b"{}", length=b"\x7f" + struct.pack(">Q", 2**40)),
    "no_utf8": frame(0x81, b"\xff\xfe"),
    "close_code": frame(0x88, b"\x00"),
    "close_reason": frame(0x88, struct.pack(">H", 99) + b"\xff"),
    "noise": bytes(range(255, -1, -1)) * 40,
}


@pytest.mark.parametrize("name", FRAMES)
def test_what_is_no_frame_is_refused_or_ends_its_connection(
    viewer: ArmVisualizer, name: str
) -> None:
    started = time.perf_counter()
    answer = raw(viewer, upgrade(viewer) + FRAMES[name], last=b"refused")
    assert answer.startswith(b"HTTP/1.1 101")
    assert time.perf_counter() < started + SOON


def test_a_message_beyond_all_pictures_ends_its_connection(
    viewer: ArmVisualizer,
) -> None:
    with page_of(viewer) as page, suppress(ConnectionClosed):
        page.send("x" * (server._LARGEST_PICTURE + 1))
        while True:
            page.recv(timeout=SOON)


def test_a_message_without_its_end_holds_nobody_up(viewer: ArmVisualizer) -> None:
    with socket.create_connection(address(viewer), timeout=SOON) as slow:
        slow.sendall(upgrade(viewer) + frame(0x01, b'{"q":') + frame(0x00, b"[1"))
        works(viewer)


@pytest.mark.slow
def test_many_connections_and_slow_ones(viewer: ArmVisualizer) -> None:
    """Requests that never end, and connections without one, lose their place."""
    held = [socket.create_connection(address(viewer), timeout=SOON) for _ in range(150)]
    try:
        for connection in held[::2]:
            with suppress(OSError):  # one too many
                connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
        until_served(viewer)
    finally:
        for connection in held:
            connection.close()
    until_served(viewer)


def until_served(viewer: ArmVisualizer) -> None:
    ends = time.perf_counter() + server._IDLE + SOON
    while not raw(viewer, request(viewer)).startswith(b"HTTP/1.1 200"):
        assert time.perf_counter() < ends
        time.sleep(0.05)


@pytest.mark.parametrize("message", [json.dumps({"q": ELSEWHERE}), "[[["])
def test_a_page_that_never_pauses_holds_nobody_up(
    viewer: ArmVisualizer, message: str
) -> None:
    burst = frame(0x81, message.encode()) * 5000
    with socket.create_connection(address(viewer), timeout=SOON) as hasty:
        hasty.sendall(upgrade(viewer))
        raised = hasty.recv(100)
        assert raised.startswith(b"HTTP/1.1 101")
        hasty.sendall(burst)
        started = time.perf_counter()
        viewer.show("frames", visible=False)
        assert time.perf_counter() < started + SOON
        # all of them have been read before its place is given up
        hasty.sendall(frame(0x88))
        hasty.shutdown(socket.SHUT_WR)
        while hasty.recv(1_000_000):
            pass
    viewer.display(POSE)


def test_many_pages(viewer: ArmVisualizer) -> None:
    pages = [page_of(viewer) for _ in range(20)]
    for page in pages:
        until(page, "pose")
    works(viewer)
    for page in pages:
        page.close()


def test_a_page_that_stops_reading_is_left(
    viewer: ArmVisualizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "_BACKLOG", 4_000_000)
    known = set(viewer.window.server.live.pages)
    with socket.create_connection(address(viewer), timeout=SOON) as slow:
        slow.sendall(upgrade(viewer))
        while not viewer.window.server.live.pages - known:
            time.sleep(0.005)
        for _ in range(10):
            viewer["mine"].set_property("note", "x" * 1_000_000)
        while viewer.window.server.live.pages - known:
            time.sleep(0.005)
    viewer["mine"].delete()


def test_an_answer_that_nobody_reads_is_not_kept(
    viewer: ArmVisualizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "_LONGEST_VISIT", 0.5)
    asked = 60
    one = request(viewer).replace(b"close", b"keep-alive")
    whole = len(raw(viewer, request(viewer), last=b"</html>"))
    with socket.create_connection(address(viewer), timeout=SOON) as slow:
        slow.sendall(one * asked)
        time.sleep(1.0)
        answer = 0
        with suppress(ConnectionResetError):
            while part := slow.recv(1_000_000):
                answer += len(part)
        assert answer < asked * whole / 2


def test_a_page_that_answers_no_ping_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "_PING", 0.2)
    viewer = a5.view(a5.load())
    pages = viewer.window.server.live.pages

    def left() -> list[bool]:
        return [page.ws_connection.is_closing() for page in list(pages)]

    try:
        with page_of(viewer) as page:
            until(page, "set_property")
            with socket.create_connection(address(viewer), timeout=SOON) as silent:
                silent.sendall(upgrade(viewer))
                ends = time.perf_counter() + SOON
                while sorted(left()) != [False, True]:
                    assert time.perf_counter() < ends
                    with suppress(TimeoutError):
                        page.recv(timeout=0.01)
    finally:
        viewer.close()


# ---- meshcat's protocol


def ask(viewer: ArmVisualizer, *frames: bytes, kind: int = zmq.REQ) -> bytes:
    """The answer to a request of another program."""
    with zmq.Context() as context, context.socket(kind) as client:
        client.setsockopt(zmq.LINGER, 0)
        client.connect(viewer.window.zmq_url)
        client.send_multipart(frames)
        assert client.poll(1e3 * SOON), "no answer"
        return client.recv_multipart()[-1]


def pack(kind: str, path: object = "/meshcat/x", **rest: object) -> bytes:
    return bytes(umsgpack.packb({"type": kind, "path": path, **rest}))


PLACE = pack("set_transform", matrix=[1.0] * 16)
COMMANDS: dict[str, tuple[bytes, ...]] = {
    "byte": (b"\xff",),
    "nothing": (b"",),
    "nothings": (b"", b"", b""),
    "many_nothings": (b"",) * 5000,
    "unknown": (b"quit",),
    "surrogate": (b"\xed\xa0\x80", b"\xed\xa0\x80", b"\xed\xa0\x80"),
    "url_of": (b"url", b"x"),
    "wait_for": (b"wait", b"x"),
    "scene_of": (b"get_scene", b"", b""),
    "picture_alone": (b"capture_image",),
    "picture_of_nothing": (b"capture_image", b"", b""),
    "picture_of_noise": (b"capture_image", b"\xff", b"\xff"),
    "picture_as_command": (b"capture_image", b"", pack("set_object", "")),
    "two_frames": (b"set_transform", b"/meshcat/x"),
    "four_frames": (b"set_transform", b"/meshcat/x", PLACE, b""),
    "no_data": (b"set_transform", b"/meshcat/x", b""),
    "noise": (b"set_transform", b"/meshcat/x", b"\xc1\xff\x00"),
    "text": (b"set_transform", b"/meshcat/x", b'{"type": "set_transform"}'),
    "list": (b"set_transform", b"/meshcat/x", umsgpack.packb([1, 2])),
    "cut": (b"set_transform", b"/meshcat/x", PLACE[:-1]),
    "deep": (b"set_transform", b"/meshcat/x", b"\x91" * 90_000),
    "promise": (b"set_transform", b"/meshcat/x", b"\xdd\xff\xff\xff\xff"),
    "long_promise": (b"set_transform", b"/meshcat/x", b"\xc6\xff\xff\xff\xff"),
    "stamp": (b"set_transform", b"/meshcat/x", b"\xc7\x0c\xff" + b"\xff" * 12),
    "key": (b"set_transform", b"/meshcat/x", b"\x81\x91\x01\x01"),
    "no_utf8": (b"set_transform", b"/meshcat/x", b"\x81\xa1\xff\x01"),
    "other_type": (b"set_transform", b"/meshcat/x", pack("set_property")),
    # a page would obey these
    "a_pose": (b"set_property", b"/meshcat/x", pack("pose", q=[9.0] * 5, root={})),
    "a_control": (
        b"set_property",
        b"/meshcat/x",
        pack("set_control", callback="alert(1)"),
    ),
    "no_type": (
        b"set_transform",
        b"/meshcat/x",
        umsgpack.packb({"path": "/meshcat/x"}),
    ),
    "other_path": (
        b"set_transform",
        b"/meshcat/x",
        pack("set_transform", "/meshcat/y"),
    ),
    "no_path": (b"set_transform", b"/meshcat/x", pack("set_transform", 5)),
    "path_of_noise": (b"set_transform", b"\xff\xfe", PLACE),
    "deep_path": (b"delete", b"/a" * 2000, pack("delete", "/a" * 2000)),
    "long_path": (b"delete", b"a" * 100_000, pack("delete", "a" * 100_000)),
    "large": (b"set_object", b"/meshcat/x", b"\0" * (protocol._LARGEST_REQUEST + 1)),
    "many_frames": (b"x",) * 20_000,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_another_program_is_refused(viewer: ArmVisualizer, name: str) -> None:
    scene = ask(viewer, b"get_scene")
    started = time.perf_counter()
    answer = ask(viewer, *COMMANDS[name])
    assert time.perf_counter() < started + SOON
    assert answer.startswith(b"error: ")
    assert b"expected" in answer
    assert len(answer) < 500
    assert ask(viewer, b"get_scene") == scene, "nothing of it is kept"


def test_a_request_without_an_envelope_is_refused(viewer: ArmVisualizer) -> None:
    assert ask(viewer, b"\xff", kind=zmq.DEALER).startswith(b"error: ")
    assert ask(viewer, b"", b"url", kind=zmq.DEALER) == viewer.url().encode()


def test_noise_and_silence_on_the_port_of_other_programs(viewer: ArmVisualizer) -> None:
    where = viewer.window.zmq_url.removeprefix("tcp://").split(":")
    for sent in (
        b"",
        request(viewer),
        np.random.default_rng(1).bytes(5000),
        b"\xff" + bytes(8) + b"\x7f\x03" * 50,
    ):
        with socket.create_connection((where[0], int(where[1])), timeout=SOON) as guest:
            guest.sendall(sent)
            works(viewer)


def test_a_request_that_waits_for_a_page_holds_nobody_up(
    viewer: ArmVisualizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "PAGE_PATIENCE", 0.3)
    capture = umsgpack.packb({"type": "capture_image"})
    for frames in ((b"wait",), (b"capture_image", b"", capture)):
        with zmq.Context() as context, context.socket(zmq.REQ) as client:
            client.connect(viewer.window.zmq_url)
            client.send_multipart(frames)
            assert ask(viewer, b"url") == viewer.url().encode()
            assert client.poll(1e3 * SOON)
            assert client.recv().startswith(b"error: no page ")
    for call in (viewer.wait, viewer.get_image):
        started = time.perf_counter()
        with pytest.raises(ViewerError, match=r"no page .* within 0\.3 s"):
            call()
        assert time.perf_counter() < started + SOON


def test_pictures_go_to_who_asked_for_them(viewer: ArmVisualizer) -> None:
    """Of two pages the first one counts; what is no picture counts as none."""
    capture = umsgpack.packb({"type": "capture_image"})
    with page_of(viewer) as one, page_of(viewer) as other, zmq.Context() as context:
        with context.socket(zmq.REQ) as client:
            client.connect(viewer.window.zmq_url)
            for wrong in (
                "5",
                '"data:image/png;base64,?"',
                '"data:text/html;base64,AAAA"',
                "[]",
            ):
                client.send_multipart([b"capture_image", b"", capture])
                for page in (one, other):
                    until(page, "capture_image")
                one.send(f'{{"type":"img","data":{wrong}}}')
                assert "picture" in until(one, "refused")["reason"]
                content = base64.b64encode(wrong.encode()).decode()
                other.send(f'{{"type":"img","data":"data:image/png;base64,{content}"}}')
                assert client.recv() == wrong.encode()
        assert viewer.wait() == "ok"


# ---- calls of this program


def test_calls_of_a_closed_viewer_say_so() -> None:
    viewer = a5.view(a5.load())
    viewer.close()
    started = time.perf_counter()
    for call in (
        lambda: viewer.display([1, 1, 1, 1]),
        lambda: viewer.show("frames"),
        viewer["x"].delete,
        viewer.static_html,
        viewer.get_image,
        viewer.wait,
        lambda: viewer.setCameraPreset("front"),
    ):
        with pytest.raises(ViewerError, match="the viewer is closed"):
            call()
    assert time.perf_counter() < started + SOON
    viewer.close()


def test_calls_of_a_busy_viewer_end(
    viewer: ArmVisualizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "PATIENCE", 0.2)
    viewer.window.server._loop.call_soon_threadsafe(time.sleep, 1.0)
    with pytest.raises(ViewerError, match=r"the viewer did not answer within 0\.2 s"):
        viewer.show("frames", visible=False)
    monkeypatch.undo()


def test_an_error_reaches_who_called(viewer: ArmVisualizer) -> None:
    for wrong in ([1e60] * 5, [float("nan")] * 5, [1.0] * 4):
        with pytest.raises(InputError, match="q"):
            viewer.display(wrong)


@pytest.mark.slow
def test_the_command_prints_nothing_but_its_address() -> None:
    """As a user runs it: to its end, and without pytest's handlers of logs."""
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "alpha5_model", "view", "--serve"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    held: list[socket.socket] = []
    try:
        host = process.stdout.readline().split("/")[2]
        where = (host.split(":")[0], int(host.split(":")[1]))
        start = f"GET / HTTP/1.1\r\nHost: {host}\r\n"
        join = (
            f"{start}Origin: http://{host}\r\n"
            "Connection: Upgrade\r\nUpgrade: websocket\r\n"
            "Sec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: x3JJHMbDL1EzLkh9GBhXDw==\r\n\r\n"
        ).encode()
        texts = ('{"data":5}', "[" * 100, '{"q": [99, 99, 99, 99, 99]}')
        for sent in (
            b"GET / HTTP/1.1\r\nHost: [::1\r\n\r\n",
            f"{start.replace('/ ', '/nowhere ')}\r\n".encode(),
            f"{start}Content-Length: {'9' * 5000}\r\n\r\n".encode(),
            join + b"".join(frame(0x81, text.encode()) for text in texts),
            join + frame(0x82, b"\xff"),
            join,
            start.encode(),
            b"",
        ):
            held.append(socket.create_connection(where, timeout=SOON))
            held[-1].sendall(sent)
        assert held[0].recv(100).startswith(b"HTTP/1.1 403")
        assert held[1].recv(100).startswith(b"HTTP/1.1 404")
        assert held[4].recv(100).startswith(b"HTTP/1.1 101")
        # it ends although some of them are still open
        process.terminate()
        assert process.communicate(timeout=10) == ("", "")
        assert process.returncode == 0
    finally:
        for connection in held:
            connection.close()
        process.kill()
        process.communicate()
