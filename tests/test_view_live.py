"""The live viewer without a browser: its server, its clients' protocol, its speed."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError, ShapeError
from alpha5_model.paths import REPOSITORY_PATH
from alpha5_model.view.visualizer import ArmVisualizer

POSE = np.array([2.0, 1.0, 2.2, 0.4])


@pytest.fixture(scope="module")
def visualizer() -> Iterator[ArmVisualizer]:
    found = a5.view(a5.load(), POSE)
    yield found
    found.close()


def in_scene(visualizer: ArmVisualizer, link: str) -> np.ndarray:
    """Pose of a link in the server's scene tree."""
    import umsgpack
    from meshcat.servers.tree import find_node

    node = find_node(visualizer.window._bridge.tree, ["meshcat", "alpha5", "bodies", link])
    return np.reshape(umsgpack.unpackb(node.transform)["matrix"], (4, 4)).T


def test_it_is_meshcats_visualizer(visualizer: ArmVisualizer) -> None:
    import meshcat

    assert isinstance(visualizer, meshcat.Visualizer)
    visualizer["mine"].set_transform(np.eye(4))
    visualizer["mine"].delete()


def test_it_serves_its_page_on_this_machine_only(visualizer: ArmVisualizer) -> None:
    url = visualizer.url()
    assert url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(url, timeout=5) as answer:
        text = answer.read().decode("utf-8")
        assert answer.headers["Cache-Control"] == "no-store"
    assert "<title>Reach Alpha 5</title>" in text
    port = int(url.split(":")[2].split("/")[0])
    for other in ("127.0.0.2", "::1"):  # a server on all interfaces would answer here too
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
        capture_output=True,
        text=True,
        timeout=30,
    )
    assert visualizer.url() in done.stdout, done.stderr
    assert "guest" in visualizer.window._bridge.tree["meshcat"]
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


def test_play_keeps_up_with_real_time(visualizer: ArmVisualizer) -> None:
    # faster than it can be drawn: frames are dropped, time is not
    q = np.linspace([0.5, 0.5, 0.5, 0.5], [2.0, 2.0, 2.0, 2.0], 4000)
    took = visualizer.play(q, dt=0.00025)
    assert took == pytest.approx(1.0, abs=0.4)
    expected = visualizer.arm.forward_kinematics(q[-1], frame="link_4").homogeneous
    np.testing.assert_allclose(in_scene(visualizer, "link_4"), expected, atol=1e-14)


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
        with pytest.raises(Alpha5Error, match=f"port {port} is in use") as caught:
            a5.view(a5.load(), port=port)
        assert isinstance(caught.value, OSError)
        assert caught.value.port == port
    finally:
        first.close()
    second = a5.view(a5.load(), port=port)
    second.close()


def test_starting_is_quick_after_imports() -> None:
    """1.5 s on a two-core machine; a margin for a busy one."""
    arm = a5.load(gripper="jaws")
    started = time.perf_counter()
    found = a5.view(arm)
    took = time.perf_counter() - started
    found.close()
    assert took < 1.5


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
        with urllib.request.urlopen(url, timeout=10) as answer:
            assert answer.status == 200
        process.terminate()
        _, errors = process.communicate(timeout=10)
        assert process.returncode == 0
        assert errors == ""
    finally:
        process.kill()
        process.communicate()
