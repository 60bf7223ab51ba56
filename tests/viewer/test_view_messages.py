"""What is sent to open pages, and how many of them there may be."""

from __future__ import annotations

import queue
from collections import deque
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from meshcat.servers.tree import find_node

from alpha5_model.viewer.connections import _MOST_CONNECTIONS, HTTPServer
from alpha5_model.viewer.live_controls import slider
from alpha5_model.viewer.live_scene import LiveScene
from alpha5_model.viewer.visualizer import ArmVisualizer


class Page:
    """A page that keeps what it gets."""

    def __init__(self) -> None:
        self.asked: deque[int] = deque()
        self.got: list[bytes] = []

    def send(self, message: bytes) -> None:
        self.got.append(message)

    def close(self) -> None:
        self.got.append(b"closed")


def test_an_object_is_sent_once_and_all_else_each_time() -> None:
    scene = LiveScene(viewer=None)  # type: ignore[arg-type]
    page = Page()
    scene.pages.add(page)
    path = ["arm", "link_2"]
    scene.carry_out("set_object", path, b"mesh")
    scene.carry_out("set_object", path, b"mesh")
    assert page.got == [b"mesh"]
    scene.carry_out("set_transform", path, b"pose")
    scene.carry_out("set_transform", path, b"pose")
    assert page.got == [b"mesh", b"pose", b"pose"]
    scene.carry_out("set_object", path, b"other mesh")
    assert page.got[3:] == [b"other mesh"]

    node = find_node(scene.tree, path)
    assert (node.object, node.transform) == (b"other mesh", b"pose")
    scene.carry_out("delete", path, b"gone")
    assert page.got[4:] == [b"gone"]
    assert find_node(scene.tree, path).object is None


def test_a_busy_callback_gets_the_latest_of_what_pages_have_moved() -> None:
    """The latest pose, and the latest value of each slider; then the thread ends."""
    heard: list[Any] = []
    moves: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def hear(value: Any) -> None:
        """More is moved while the callback is busy; the third one closes the viewer."""
        heard.append(value)
        if len(heard) == 2:
            for move in (np.full(4, 2.5), np.full(4, 3.0)):
                moves.put(move)
        elif len(heard) == 3:
            moves.put(None)
            moves.put(np.full(4, 9.0))

    gain = slider("gain", 0.0, 9.0, 5.0, hear)
    mute = slider("mute", 0.0, 1.0, None, None)
    for move in (np.zeros(4), gain, mute, gain, np.full(4, 2.0)):
        moves.put(move)
    gain.value = 7.0
    viewer: Any = SimpleNamespace(
        _page_moves=moves,
        _listeners=[lambda q: hear(q.tolist())],
        _call_back=lambda function, value: function(value),
    )
    ArmVisualizer._listen(viewer)
    assert heard == [[2.0] * 4, 7.0, [3.0] * 4]


class Stream:
    """A connection that is not served yet."""

    closed = False

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("pages", [0, 1, _MOST_CONNECTIONS - 1, _MOST_CONNECTIONS])
def test_pages_and_other_connections_are_limited_together(pages: int) -> None:
    server = HTTPServer(lambda request: None)
    server._ends = dict.fromkeys(range(_MOST_CONNECTIONS - pages))
    server.pages = [Page() for _ in range(pages)]  # type: ignore[misc]
    one_more: Any = Stream()
    server.handle_stream(one_more, ("127.0.0.1", 1))
    assert one_more.closed
