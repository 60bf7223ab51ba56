"""The live viewer without a browser: who may connect, what is sent, what is refused."""

from __future__ import annotations

import base64
import http.client
import json
import queue
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import page_script
import pytest
import umsgpack
from websockets.sync.client import connect

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.errors import Alpha5Error, InputError, ShapeError, ViewerError
from alpha5_model.viewer.visualizer import ArmVisualizer

POSE = np.array([2.0, 1.0, 2.2, 0.4, 0.005])
ELSEWHERE = [1.0, 1.5, 2.0, 2.5, 0.002]
#: Longest wait [s], on a machine that does other work, too.
SOON = 60.0


@pytest.fixture(scope="module")
def opened() -> Iterator[ArmVisualizer]:
    found = a5.view(a5.load(gripper="jaws"), POSE)
    yield found
    found.close()


@pytest.fixture
def viewer(
    opened: ArmVisualizer,
    capfd: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> Iterator[ArmVisualizer]:
    """A viewer that works afterwards, has not moved, and has printed nothing."""
    yield opened
    opened._listeners.clear()  # a viewer has no public way to stop calling back
    np.testing.assert_array_equal(opened.q, POSE)
    works(opened)
    assert capfd.readouterr() == ("", "")
    assert [record.getMessage() for record in caplog.records] == []


def works(viewer: ArmVisualizer) -> None:
    """The page is served, and a page moves the arm."""
    assert status(viewer) == 200
    with page_of(viewer) as page:
        until(page, "pose")
        page.send(json.dumps({"q": ELSEWHERE}))
        wait_for(lambda: viewer.q.tolist() == ELSEWHERE)
        viewer.display(POSE)
        while until(page, "pose")["q"] != POSE.tolist():
            pass


def wait_for(condition: Any) -> None:
    ends = time.monotonic() + SOON
    while not condition():
        assert time.monotonic() < ends
        time.sleep(0.005)


def page_of(viewer: ArmVisualizer) -> Any:
    url = viewer.url()
    origin = url[: url.index("/", 8)]
    return connect(url.replace("http", "ws"), origin=origin, max_size=None)


def until(page: Any, kind: str) -> Any:
    """The next command of a kind that a page is sent."""
    while True:
        said = umsgpack.unpackb(page.recv(timeout=SOON))
        if said["type"] == kind:
            return said


# ---- who may connect

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "x3JJHMbDL1EzLkh9GBhXDw==",
}


def status(viewer: ArmVisualizer, path: str | None = None, **headers: str) -> int:
    _, _, host, *rest = viewer.url().split("/")
    connection = http.client.HTTPConnection(host, timeout=SOON)
    own = "/" + "/".join(rest)
    connection.request("GET", own if path is None else path, headers=headers)
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status


def test_it_serves_its_page_on_this_machine_only(viewer: ArmVisualizer) -> None:
    url = viewer.url()
    assert url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(url, timeout=SOON) as answer:
        assert "<title>Reach Alpha 5</title>" in answer.read().decode("utf-8")
        assert answer.headers["Cache-Control"] == "no-store"
    port = int(url.split(":")[2].split("/")[0])
    # A server on all interfaces would answer here, too.
    for other in ("127.0.0.2", "::1"):
        with pytest.raises(OSError, match=r"refused|not supported|Cannot assign"):
            socket.create_connection((other, port), timeout=2).close()


def test_the_address_holds_a_secret(viewer: ArmVisualizer) -> None:
    """Another account of this machine finds the port, but not the page."""
    secret = viewer.url().split("/")[3]
    assert len(secret) >= 16
    for path in ("/", "/static/", f"/{secret[:-1]}/", f"/{secret}/../", "/.%2e/"):
        assert status(viewer, path) == 404
        origin = viewer.url().rsplit("/", 2)[0]
        assert status(viewer, path, **UPGRADE, Origin=origin) == 404
    other = a5.view(a5.load())
    assert other.url().split("/")[3] != secret
    other.close()


def test_only_its_own_page_is_answered(viewer: ArmVisualizer) -> None:
    address = viewer.url().split("/")[2]
    port = address.split(":")[1]
    # The last one comes by a tunnel.
    for host in (address, f"localhost:{port}", "localhost:9000"):
        assert status(viewer, Host=host) == 200
    for host in (
        "attacker.example",
        f"127.0.0.1.example:{port}",
        "[::1",
        "",
    ):
        assert status(viewer, Host=host) in (400, 403)
    foreign = "http://attacker.example"
    for origin in (foreign, "null", f"http://localhost:{port}", "http://[::1"):
        assert status(viewer, Origin=origin) == 403
        assert status(viewer, **UPGRADE, Origin=origin) == 403
    assert status(viewer, Origin=f"http://{address}") == 200
    assert status(viewer, **UPGRADE) == 403, "no browser leaves the origin out"
    rebound = {**UPGRADE, "Host": f"attacker.example:{port}"}
    assert status(viewer, **rebound, Origin=f"{foreign}:{port}") == 403
    assert status(viewer, **UPGRADE, Origin=f"http://{address}") == 101


def raw(viewer: ArmVisualizer, sent: bytes, last: bytes = b"\r\n\r\n") -> bytes:
    """What comes back, up to some bytes or the end of the connection."""
    host, port = viewer.url().split("/")[2].split(":")
    with socket.create_connection((host, int(port)), timeout=SOON) as connection:
        connection.sendall(sent)
        answer = b""
        with suppress(ConnectionResetError):
            while last not in answer and (part := connection.recv(65536)):
                answer += part
        return answer


@pytest.mark.parametrize(
    "sent",
    [
        bytes(range(256)) * 40,
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
        b"GET http://[::1/ HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + b"9" * 5000,
    ],
)
def test_what_is_no_request_is_refused(viewer: ArmVisualizer, sent: bytes) -> None:
    answer = raw(viewer, sent)
    # The end of a connection counts as 0.
    code = int(answer.split()[1]) if answer else 0
    assert code in (0, 400, 404, 405, 413, 431, 505)


# ---- what a page sends


def poses(*numbers: str) -> str:
    """A message with numbers as JSON has them; the pose itself but for the first."""
    return '{"q": [' + ", ".join([*numbers, *map(str, POSE[len(numbers) :])]) + "]}"


MESSAGES: dict[str, tuple[str | bytes, str]] = {
    "far": (poses("99"), "axis_e: 99 rad is above the upper limit"),
    "open_jaws": (poses("2", "1", "2.2", "0.4", "5"), "axis_a: 5 m is above"),
    "too_large": (poses("1e999"), "finite"),
    "endless_integer": (poses("9" * 5000), "JSON"),
    "short": ('{"q": [1, 1, 1, 1]}', "shape (5,)"),
    "word": ('{"q": "home"}', "real numbers"),
    "base": (poses()[:-1] + ', "root": {"base_link": [[9]]}}', "expected"),
    "no_json": ("q", "JSON"),
    "many": ('{"q": [' + ",".join(["1"] * 400_000) + "]}", "shape (5,)"),
    "html_picture": ('{"type":"img","data":"data:text/html;base64,AA=="}', "picture"),
    "command": ('{"type":"set_object","path":"/meshcat"}', "expected"),
    "binary": (poses().encode(), "bytes"),
}


@pytest.mark.parametrize("name", MESSAGES)
def test_a_page_is_refused_and_told_where_the_arm_is(
    viewer: ArmVisualizer, name: str
) -> None:
    message, reason = MESSAGES[name]
    heard: queue.Queue[np.ndarray] = queue.Queue()
    viewer.on_change(heard.put)
    with page_of(viewer) as page:
        until(page, "pose")
        for _ in range(2):  # the connection is as good as before
            page.send(message)
            refused = until(page, "refused")["reason"]
            assert reason in refused
            assert len(refused) < 500
            assert until(page, "pose")["q"] == POSE.tolist()
    assert heard.empty()


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
            wait_for(lambda: viewer.q[-1] == 1.0)
        np.testing.assert_allclose(viewer.q, [*base, 1.0, 1.0, 1.0, 1.0], atol=1e-15)
    finally:
        viewer.close()


def test_a_page_that_never_pauses_holds_nobody_up(viewer: ArmVisualizer) -> None:
    with page_of(viewer) as page:
        for _ in range(1000):
            page.send("[[[")
        page.send(json.dumps({"q": ELSEWHERE}))
        viewer.show("frames", visible=False)
        wait_for(lambda: viewer.q.tolist() == ELSEWHERE)
    viewer.display(POSE)


# ---- what pages are sent


def test_pages_call_back_and_tell_each_other(viewer: ArmVisualizer) -> None:
    called, seen = threading.Event(), []

    @viewer.on_change
    def follow(q: np.ndarray) -> None:
        seen.append(q)
        viewer.display(POSE)  # a callback may move the arm
        called.set()

    with page_of(viewer) as one, page_of(viewer) as other:
        until(one, "pose")
        assert until(other, "pose")["q"] == POSE.tolist(), "what it was opened with"
        one.send(json.dumps({"q": ELSEWHERE}))
        assert called.wait(SOON)
        assert until(other, "pose")["q"] == ELSEWHERE
        assert until(other, "pose")["q"] == POSE.tolist()
        # The page that moved the arm is not told where it has moved it.
        assert until(one, "pose")["q"] == POSE.tolist()
    np.testing.assert_array_equal(seen[0], ELSEWHERE)


def test_a_busy_callback_gets_the_latest_pose(viewer: ArmVisualizer) -> None:
    """Of those that a page has sent meanwhile."""
    low = viewer.arm.limits.lower
    sent = np.array([low + 0.01 * k * np.ones(5) * [1, 1, 1, 1, 0] for k in range(4)])
    heard: queue.Queue[np.ndarray] = queue.Queue()
    may_go_on = threading.Event()

    @viewer.on_change
    def follow(q: np.ndarray) -> None:
        heard.put(q)
        may_go_on.wait(SOON)

    with page_of(viewer) as page:
        page.send(json.dumps({"q": sent[0].tolist()}))
        np.testing.assert_array_equal(heard.get(timeout=SOON), sent[0])
        for q in sent[1:]:
            page.send(json.dumps({"q": q.tolist()}))
        wait_for(lambda: np.array_equal(viewer.q, sent[-1]))
        time.sleep(0.05)  # what moved the arm there is also queued
        may_go_on.set()
        np.testing.assert_array_equal(heard.get(timeout=SOON), sent[-1])
    viewer.display(POSE)
    assert heard.empty()


def test_a_page_that_opens_later_gets_what_was_added(viewer: ArmVisualizer) -> None:
    """The last of each kind, nothing of a node that was deleted."""
    for path in ("mine/kept", "mine/deleted/below"):
        viewer[path].set_transform(np.eye(4))
    viewer["mine/kept"].set_transform(2.0 * np.eye(4))
    viewer["mine/kept"].set_property("visible", False)
    viewer["mine/deleted"].delete()
    viewer["mine/never there"].delete()
    viewer.show("labels", visible=False)
    viewer.setCameraPosition([0.1, -3.0, 0.1])
    viewer.setCameraTarget([0.1, 0.0, 0.1])
    try:
        with page_of(viewer) as page:
            sent = [umsgpack.unpackb(page.recv(timeout=SOON))]
            while {"pose", "show", "camera"} - {each["type"] for each in sent}:
                sent.append(umsgpack.unpackb(page.recv(timeout=SOON)))
        mine = [each for each in sent if "/mine" in each.get("path", "")]
        assert [each["type"] for each in mine] == ["set_transform", "set_property"]
        assert mine[0]["matrix"][0] == 2.0
        (shown,) = (each["groups"] for each in sent if each["type"] == "show")
        assert not shown["labels"]
        assert shown["bodies"]
        (camera,) = (each for each in sent if each["type"] == "camera")
        assert camera["eye"] == [0.1, -3.0, 0.1]
        drawn = [each["path"] for each in sent if each["type"] == "set_object"]
        assert len(set(drawn)) == len(drawn) > 10
    finally:
        viewer["mine"].delete()
        viewer.show("labels")


def test_static_html_holds_the_scene_as_it_stands(viewer: ArmVisualizer) -> None:
    viewer["mine"].set_transform(np.eye(4))
    viewer.show("weight")
    data = page_script.data_of(viewer.static_html())
    viewer["mine"].delete()
    viewer.show("weight", visible=False)
    commands = [umsgpack.unpackb(base64.b64decode(c)) for c in data["commands"]]
    assert "/meshcat/mine" in [each["path"] for each in commands]
    assert data["q"] == POSE.tolist()
    assert next(g["shown"] for g in data["groups"] if g["name"] == "weight")
    assert not data["live"]


# ---- calls of this program


def test_pinocchios_names(viewer: ArmVisualizer) -> None:
    """Each has the arguments of Pinocchio's own, and does what it says."""
    import inspect

    import meshcat
    from pinocchio.visualize import MeshcatVisualizer

    assert isinstance(viewer, meshcat.Visualizer)
    for name in (
        "captureImage",
        "setCameraPreset",
        "setCameraTarget",
        "setCameraPosition",
        "create_video_ctx",
        "displayCollisions",
        "displayVisuals",
        "displayFrames",
    ):
        theirs = list(inspect.signature(getattr(MeshcatVisualizer, name)).parameters)
        ours = list(inspect.signature(getattr(ArmVisualizer, name)).parameters)
        for mine, other in zip(ours, theirs, strict=False):
            assert other in (mine, "kwargs"), name
    small = (160, 100)
    plain = viewer.captureImage(*small).astype(int)
    assert plain.shape == (100, 160, 3)
    for change, shown in (
        (viewer.displayFrames, True),
        (viewer.displayCollisions, True),
        (viewer.displayVisuals, False),
    ):
        change(shown)
        changed = np.abs(viewer.captureImage(*small) - plain).max(axis=2)
        assert (changed > 8).sum() > 30
        change(not shown)
        np.testing.assert_array_equal(viewer.captureImage(*small), plain)
    for view, direction in (
        ("front", [1, 0, 0]),
        ("side", [0, -1, 0]),
        ("top", [0, 0, 1]),
    ):
        viewer.setCameraPreset(view)
        back = viewer.scene.camera.axes()[2]
        np.testing.assert_allclose(back, direction, atol=1e-3)
    viewer.setCameraPreset("home")
    with pytest.raises(Alpha5Error, match="home, front, side, top"):
        viewer.setCameraPreset("preset0")


def test_what_is_held_and_what_is_around_is_drawn() -> None:
    """`a5.view` takes a payload and obstacles, as a page does."""
    post = a5.Obstacle.cylinder("post", 0.03, 0.4, [0.3, 0.1, 0.1])
    held = (0.4, (0.0, 0.0, 0.02), 1e-4)
    viewer = a5.view(a5.load(), payload=held, obstacles=[post])
    try:
        data = page_script.data_of(viewer.static_html())
        assert data["payload"] == {"mass": 0.4, "com": [0, 0, 0.02], "volume": 1e-4}
        texts = {label["text"] for label in data["labels"]}
        assert "post" in texts
        assert {"obstacles", "payload"} <= set(viewer.scene.show)
        # The mesh is the cylinder that was given, at its place.
        (shape,) = (s for s in viewer.scene.shapes if s.group == "obstacles")
        vertices = shape.placed(viewer.scene.poses).vertices
        radius = np.hypot(vertices[:, 0] - 0.3, vertices[:, 1] - 0.1)
        assert radius.max() == pytest.approx(0.03)
        assert np.ptp(vertices[:, 2]) == pytest.approx(0.4)
    finally:
        viewer.close()
    for wrong in ((-0.1,), (0.1, (0.0, 0.0)), (0.1, (0, 0, 0), -1e-4), (np.nan,)):
        with pytest.raises(Alpha5Error):
            a5.view(a5.load(), payload=wrong)
    with pytest.raises(InputError, match="obstacles"):
        a5.view(a5.load(), obstacles=["post"])


# imageio-ffmpeg leaves its pipes to the garbage collector.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_a_video_lasts_as_long_as_the_motion(
    viewer: ArmVisualizer, tmp_path: Path, suffix: str
) -> None:
    import imageio_ffmpeg

    q = np.linspace(POSE, POSE + np.array([1.0, 0.0, 0.0, 0.0, 0.0]), 101)
    file = tmp_path / f"arm{suffix}"
    with viewer.create_video_ctx(file, fps=10, size=(160, 100)) as path:
        viewer.play(q, dt=0.02)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    # 2 s at 10 a second, and the last pose
    assert frames == 21
    assert seconds == pytest.approx(2.1, abs=0.02)
    reader = imageio_ffmpeg.read_frames(str(path))
    assert next(reader)["size"] == (160, 100)
    first, *_, last = (
        np.frombuffer(frame, np.uint8).reshape(100, 160, 3) for frame in reader
    )
    for pixels, row in ((first, 0), (last, -1)):
        viewer.display(q[row])
        off = np.abs(viewer.captureImage(160, 100).astype(int) - pixels)
        assert off.mean(axis=(0, 1)).max() < 6
    assert np.abs(first.astype(int) - last).max(axis=2).mean() > 3
    with (
        pytest.raises(InputError, match="at least one frame"),
        viewer.create_video_ctx(path),
    ):
        pass
    with (
        pytest.raises(Alpha5Error, match=r"mp4, \.gif"),
        viewer.create_video_ctx("arm.avi"),
    ):
        pass
    viewer.display(POSE)


def test_bad_input(viewer: ArmVisualizer) -> None:
    for wrong in ([1, 2, 3], [float("nan")] * 5, [1e60] * 5):
        with pytest.raises(InputError, match="q"):
            viewer.display(wrong)
    with pytest.raises(ShapeError):
        viewer.play([1, 2, 3, 4, 0], 0.1)
    with pytest.raises(InputError, match="above 0"):
        viewer.play([POSE], 0.0)
    with pytest.raises(Alpha5Error, match="frames, com"):
        viewer.show("arrows")


def test_close_frees_the_port_and_a_taken_one_is_named() -> None:
    first = a5.view(a5.load())
    port = int(first.url().split(":")[2].split("/")[0])
    try:
        with pytest.raises(ViewerError, match=f"port {port} is in use") as caught:
            a5.view(a5.load(), port=port)
        assert isinstance(caught.value, OSError)
    finally:
        first.close()
    for call in (
        lambda: first.display([1, 1, 1, 1]),
        lambda: first.show("frames"),
        first["x"].delete,
        first.static_html,
        first.get_image,
        first.wait,
        lambda: first.setCameraPreset("front"),
    ):
        with pytest.raises(ViewerError, match="the viewer is closed"):
            call()
    first.close()
    a5.view(a5.load(), port=port).close()


@pytest.mark.slow
def test_the_command_serves_until_it_is_told_to_end() -> None:
    """It prints nothing but its address, whatever is sent to its port."""
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "alpha5_model", "view", "--serve"],
        cwd=REPOSITORY_PATH,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    held: list[socket.socket] = []
    try:
        assert process.stdout is not None
        url = process.stdout.readline().split()[0]
        with urllib.request.urlopen(url, timeout=SOON) as answer:
            assert answer.status == 200
        host, port = url.split("/")[2].split(":")
        for sent in (b"", b"GET / HTTP/1.1\r\nHost: ", b"\xff\r\n\r\n"):
            held.append(socket.create_connection((host, int(port)), timeout=SOON))
            held[-1].sendall(sent)
        with connect(url.replace("http", "ws"), origin=url.rsplit("/", 2)[0]) as page:
            page.send('{"data":5}')
            page.send(b"\xff")
            time.sleep(0.2)
            # It ends although some connections are still open.
            process.terminate()
            assert process.communicate(timeout=SOON) == ("", "")
        assert process.returncode == 0
    finally:
        for one in held:
            one.close()
        process.kill()
        process.communicate()
