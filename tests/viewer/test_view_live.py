"""The live viewer without a browser: its server, its clients' protocol."""

from __future__ import annotations

import asyncio
import gc
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.errors import Alpha5Error, InputError, ShapeError, ViewerError
from alpha5_model.viewer.visualizer import ArmVisualizer

POSE = np.array([2.0, 1.0, 2.2, 0.4])
#: Longest wait [s], on a machine that does other work, too.
SOON = 60.0


@pytest.fixture(scope="module")
def visualizer() -> Iterator[ArmVisualizer]:
    found = a5.view(a5.load(), POSE)
    yield found
    found.close()


def in_scene(visualizer: ArmVisualizer, link: str) -> np.ndarray:
    """Pose of a link in the server's scene tree."""
    import umsgpack
    from meshcat.servers.tree import find_node

    node = find_node(
        visualizer.window.server.live.tree, ["meshcat", "alpha5", "bodies", link]
    )
    return np.reshape(umsgpack.unpackb(node.transform)["matrix"], (4, 4)).T


def test_it_is_meshcats_visualizer(visualizer: ArmVisualizer) -> None:
    import meshcat

    assert isinstance(visualizer, meshcat.Visualizer)
    visualizer["mine"].set_transform(np.eye(4))
    visualizer["mine"].delete()


def test_deleting_a_node_leaves_its_neighbours(visualizer: ArmVisualizer) -> None:
    """As in meshcat, deleting a node deletes all below it; it may be missing, too."""
    tree = visualizer.window.server.live.tree
    for path in ("mine/kept", "mine/deleted/below"):
        visualizer[path].set_transform(np.eye(4))
    visualizer["mine/deleted"].delete()
    visualizer["mine/never there"].delete()
    assert list(tree["meshcat"]["mine"]) == ["kept"]
    visualizer["mine"].delete()
    assert "mine" not in tree["meshcat"]
    assert "alpha5" in tree["meshcat"]


def test_it_serves_its_page_on_this_machine_only(visualizer: ArmVisualizer) -> None:
    url = visualizer.url()
    assert url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(url, timeout=SOON) as answer:
        text = answer.read().decode("utf-8")
        assert answer.headers["Cache-Control"] == "no-store"
    assert "<title>Reach Alpha 5</title>" in text
    port = int(url.split(":")[2].split("/")[0])
    for other in (
        "127.0.0.2",
        "::1",
    ):  # a server on all interfaces would answer here too
        with pytest.raises(OSError, match=r"refused|not supported|Cannot assign"):
            socket.create_connection((other, port), timeout=2).close()


def test_display_places_links_where_pinocchio_does(visualizer: ArmVisualizer) -> None:
    for q in (POSE, [0.3, 2.5, 1.0, 5.0]):
        visualizer.display(q)
        for link in ("link_0", "link_2", "link_4"):
            expected = visualizer.arm.forward_kinematics(q, frame=link).homogeneous
            np.testing.assert_allclose(in_scene(visualizer, link), expected, atol=1e-14)


def test_other_programs_connect_by_its_address(visualizer: ArmVisualizer) -> None:
    """As Pinocchio's MeshcatVisualizer does with a viewer of its own."""
    script = (
        "import meshcat, numpy as np, sys;"
        "v = meshcat.Visualizer(zmq_url=sys.argv[1]); t = np.eye(4); t[0, 3] = 5.0;"
        "v['guest'].set_transform(t); print(v.url())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, visualizer.window.zmq_url],
        check=False,
        capture_output=True,
        text=True,
        timeout=SOON,
    )
    assert visualizer.url() in done.stdout, done.stderr
    assert "guest" in visualizer.window.server.live.tree["meshcat"]
    visualizer["guest"].delete()


def test_static_html_holds_the_scene_as_it_stands(visualizer: ArmVisualizer) -> None:
    import base64

    import umsgpack

    q = [1.5, 1.0, 1.0, 1.0]
    visualizer.display(q)
    html = visualizer.static_html()
    data = json.loads(html.split('type="application/json">')[1].split("</script>")[0])
    commands = [umsgpack.unpackb(base64.b64decode(c)) for c in data["commands"]]
    (placed,) = [
        c["matrix"]
        for c in commands
        if c["type"] == "set_transform" and c["path"].endswith("bodies/link_4")
    ]
    expected = visualizer.arm.forward_kinematics(q, frame="link_4").homogeneous
    np.testing.assert_allclose(np.reshape(placed, (4, 4)).T, expected)
    assert data["q"] == dict(zip(visualizer.scene.sliders, q, strict=True))


def status(visualizer: ArmVisualizer, path: str = "/static/", **headers: str) -> int:
    import http.client

    connection = http.client.HTTPConnection(
        visualizer.url().split("/")[2], timeout=SOON
    )
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status


def test_only_its_own_page_is_answered(visualizer: ArmVisualizer) -> None:
    address = visualizer.url().split("/")[2]
    port = address.split(":")[1]
    assert status(visualizer, "/") == 200, (
        "the address without a path leads to the page"
    )
    for host in (
        address,
        f"localhost:{port}",
        "localhost:9000",
    ):  # the last one by a tunnel
        assert status(visualizer, Host=host) == 200
    for host in (
        "attacker.example",
        f"attacker.example:{port}",
        f"127.0.0.1.example:{port}",
        "",
    ):
        assert status(visualizer, Host=host) in (400, 403)
    for origin in (
        "http://attacker.example",
        "null",
        f"http://localhost:{port}",
        "http://127.0.0.1:1",
    ):
        assert status(visualizer, Origin=origin) == 403
    assert status(visualizer, Origin=f"http://{address}") == 200
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "x3JJHMbDL1EzLkh9GBhXDw==",
    }
    assert status(visualizer, "/", **upgrade) == 403, "no browser leaves the origin out"
    assert status(visualizer, "/", **upgrade, Origin="http://attacker.example") == 403
    assert status(visualizer, "/", **upgrade, Origin=f"http://localhost:{port}") == 403
    rebound = {**upgrade, "Host": f"attacker.example:{port}"}
    assert (
        status(visualizer, "/", **rebound, Origin=f"http://attacker.example:{port}")
        == 403
    )
    assert status(visualizer, "/", **upgrade, Origin=f"http://{address}") == 101


def test_pages_call_back_and_tell_each_other(visualizer: ArmVisualizer) -> None:
    import umsgpack
    from websockets.sync.client import connect

    called, seen = threading.Event(), []

    @visualizer.on_change
    def follow(q: np.ndarray) -> None:
        seen.append(q)
        visualizer.display(q + 0.25)  # a callback may move the arm
        called.set()

    address = visualizer.url().split("/")[2]

    def pose(page: object) -> list[float]:
        while True:
            said = umsgpack.unpackb(page.recv(timeout=SOON))
            if said["type"] == "pose":
                return said["q"]

    two = [
        connect(f"ws://{address}/", origin=f"http://{address}", max_size=None)
        for _ in "ab"
    ]
    with two[0] as one, two[1] as other:
        visualizer.display(POSE)
        assert [pose(one)[-4:], pose(other)[-4:]] != [], "what they were opened with"
        one.send(json.dumps({"q": [1.0, 1.5, 2.0, 2.5]}))
        assert called.wait(SOON)
        while (heard := pose(other)) != [1.0, 1.5, 2.0, 2.5]:
            pass
        while pose(one) != [1.25, 1.75, 2.25, 2.75]:
            pass
        assert heard == [1.0, 1.5, 2.0, 2.5]
    np.testing.assert_array_equal(seen[0], [1.0, 1.5, 2.0, 2.5])
    visualizer._listeners.clear()


def test_a_busy_callback_gets_the_latest_pose() -> None:
    """Of those that a page has sent meanwhile."""
    from websockets.sync.client import connect

    poses = np.array([1.0, 1.1, 1.2, 1.3])[:, None] * np.ones(4)
    heard: queue.Queue[np.ndarray] = queue.Queue()
    may_go_on = threading.Event()
    viewer = a5.view(a5.load(), POSE)
    try:

        @viewer.on_change
        def follow(q: np.ndarray) -> None:
            heard.put(q)
            may_go_on.wait(SOON)

        address = viewer.url().split("/")[2]
        with connect(
            f"ws://{address}/",
            origin=f"http://{address}",
            max_size=None,
            max_queue=None,
        ) as page:
            page.send(json.dumps({"q": poses[0].tolist()}))
            np.testing.assert_array_equal(heard.get(timeout=SOON), poses[0])
            for q in poses[1:]:
                page.send(json.dumps({"q": q.tolist()}))
            ends = time.monotonic() + SOON
            while not np.array_equal(viewer.q, poses[-1]):
                assert time.monotonic() < ends
                time.sleep(0.005)
            # This call is carried out after what moved the arm there.
            viewer.show("frames", visible=False)
            may_go_on.set()
            np.testing.assert_array_equal(heard.get(timeout=SOON), poses[-1])
    finally:
        may_go_on.set()
        viewer.close()
    assert heard.empty()


def test_pinocchios_names(visualizer: ArmVisualizer) -> None:
    """Each has the arguments of Pinocchio's own, and does what it says."""
    import inspect

    from pinocchio.visualize import MeshcatVisualizer

    names = (
        "captureImage",
        "setCameraPreset",
        "setCameraTarget",
        "setCameraPosition",
        "create_video_ctx",
        "displayCollisions",
        "displayVisuals",
        "displayFrames",
    )
    for name in names:
        theirs = list(inspect.signature(getattr(MeshcatVisualizer, name)).parameters)
        ours = list(inspect.signature(getattr(ArmVisualizer, name)).parameters)
        for mine, other in zip(ours, theirs, strict=False):
            assert other in (mine, "kwargs"), name
    visualizer.display(POSE)
    small = (160, 100)
    plain = visualizer.captureImage(*small).astype(int)
    assert plain.shape == (100, 160, 3)
    for change, back in (
        (
            lambda: visualizer.displayFrames(True),
            lambda: visualizer.displayFrames(False),
        ),
        (
            lambda: visualizer.displayCollisions(True),
            lambda: visualizer.displayCollisions(False),
        ),
        (
            lambda: visualizer.displayVisuals(False),
            lambda: visualizer.displayVisuals(True),
        ),
    ):
        change()
        assert (
            np.abs(visualizer.captureImage(*small) - plain).max(axis=2) > 8
        ).sum() > 60
        back()
        np.testing.assert_array_equal(visualizer.captureImage(*small), plain)
    visualizer.setCameraTarget([0.1, 0.0, 0.1])
    visualizer.setCameraPosition([0.1, -3.0, 0.1])
    back = visualizer.scene.camera.axes()[2]
    np.testing.assert_allclose(back, [0, -1, 0], atol=1e-12)
    for view, direction in (
        ("front", [1, 0, 0]),
        ("side", [0, -1, 0]),
        ("top", [0, 0, 1]),
    ):
        visualizer.setCameraPreset(view)
        np.testing.assert_allclose(
            visualizer.scene.camera.axes()[2], direction, atol=1e-3
        )
    visualizer.setCameraPreset("home")
    with pytest.raises(Alpha5Error, match="home, front, side, top"):
        visualizer.setCameraPreset("preset0")


# imageio-ffmpeg leaves its pipes to the garbage collector.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_a_video_lasts_as_long_as_the_motion(
    visualizer: ArmVisualizer, tmp_path: Path, suffix: str
) -> None:
    import imageio_ffmpeg

    q = np.linspace([2.0, 1.0, 2.2, 0.4], [3.0, 1.0, 2.2, 0.4], 101)
    with visualizer.create_video_ctx(
        tmp_path / f"arm{suffix}", fps=10, size=(160, 100)
    ) as path:
        visualizer.play(q, dt=0.02)
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
        visualizer.display(q[row])
        off = np.abs(visualizer.captureImage(160, 100).astype(int) - pixels).mean(
            axis=(0, 1)
        )
        assert off.max() < 6
    assert np.abs(first.astype(int) - last).max(axis=2).mean() > 3
    with (
        pytest.raises(InputError, match="at least one frame"),
        visualizer.create_video_ctx(path),
    ):
        pass
    with (
        pytest.raises(Alpha5Error, match=r"mp4, \.gif"),
        visualizer.create_video_ctx("arm.avi"),
    ):
        pass
    del reader
    gc.collect()


def test_bad_input(visualizer: ArmVisualizer) -> None:
    with pytest.raises(ShapeError):
        visualizer.display([1, 2, 3])
    with pytest.raises(ShapeError):
        visualizer.play([1, 2, 3, 4], 0.1)
    with pytest.raises(InputError, match="above 0"):
        visualizer.play([[1, 2, 3, 4]], 0.0)
    with pytest.raises(InputError, match="frames, com"):
        visualizer.show("arrows")
    with pytest.raises(Alpha5Error):
        a5.view(a5.load(), [1, 2, 3])


def test_close_frees_the_port_and_a_taken_one_is_named() -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    first = a5.view(a5.load(), port=port)
    try:
        assert f":{port}/" in first.url()
        with pytest.raises(ViewerError, match=f"port {port} is in use") as caught:
            a5.view(a5.load(), port=port)
        assert isinstance(caught.value, OSError)
    finally:
        first.close()
    second = a5.view(a5.load(), port=port)
    second.close()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_waiting_ends_with_a_signal_and_puts_the_handlers_back(number: int) -> None:
    from alpha5_model.cli.view import _wait_until_stopped

    before = {one: signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM)}
    timer = threading.Timer(0.1, os.kill, (os.getpid(), number))
    timer.start()
    try:
        _wait_until_stopped()
        after = {one: signal.getsignal(one) for one in before}
    finally:
        timer.join()
        for one, handler in before.items():
            signal.signal(one, handler)
    assert after == before


@pytest.mark.slow
@pytest.mark.parametrize("outcome", ["read", "page closed", "cancelled"])
def test_a_message_that_a_page_will_not_read_is_no_error(outcome: str) -> None:
    """asyncio logs an exception that nobody handles, and raises it when cancelled."""
    from alpha5_model.viewer.connections import PageConnection

    logged: list[dict[str, Any]] = []
    loop = asyncio.new_event_loop()
    loop.set_exception_handler(lambda _, context: logged.append(context))
    page = SimpleNamespace(_unread=12)
    sent = loop.create_future()
    if outcome == "read":
        sent.set_result(None)
    elif outcome == "page closed":
        sent.set_exception(ConnectionResetError())
    else:
        sent.cancel()
    PageConnection._note_read(page, 5, sent)  # type: ignore[arg-type]
    assert page._unread == 7
    del sent
    gc.collect()
    loop.close()
    assert logged == []


@pytest.mark.slow
def test_serve_runs_until_it_is_told_to_end() -> None:
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "alpha5_model", "view", "--serve"],
        cwd=REPOSITORY_PATH,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        url = process.stdout.readline().split()[0]
        with urllib.request.urlopen(url, timeout=SOON) as answer:
            assert answer.status == 200
        process.terminate()
        _, errors = process.communicate(timeout=SOON)
        assert process.returncode == 0
        assert errors == ""
    finally:
        process.kill()
        process.communicate()
