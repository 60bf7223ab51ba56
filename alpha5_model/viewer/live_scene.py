"""The scene that the open pages of a live viewer show."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Any, Protocol

from meshcat.servers.tree import SceneTree, find_node, walk

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.viewer.commands import Command
from alpha5_model.viewer.live_controls import Controls
from alpha5_model.viewer.messages import path_parts
from alpha5_model.viewer.scene import Scene


class Shown(Protocol):
    """What the viewer shows: an arm at a pose."""

    arm: Arm
    scene: Scene

    @property
    def q(self) -> FloatArray:
        """Joint positions at which the arm is shown, (nq,)."""

    def place(self, q: FloatArray, mover: Any = None) -> None:
        """Show the arm at q (nq,).

        Args:
            q: Joint positions.
            mover: The page that sent them, or None.
        """

    def move_slider(self, name: str, value: float, mover: Any) -> None:
        """Take a slider of the program to a checked value, where a page moved it."""


class Page(Protocol):
    """The connection of an open page.

    Attributes:
        asked: Numbers of the pictures that the page was asked for and has yet to send.
    """

    asked: deque[int]

    def send(self, message: bytes) -> None:
        """Send a packed command."""

    def close(self) -> None:
        """Disconnect."""


class LiveScene:
    """The scene that all open pages show, and that a new page gets.

    All methods are called in the server's thread.

    Attributes:
        viewer: What the pages show.
        tree: meshcat's tree of the scene.
        pages: The pages that are open.
        controls: Curves and sliders of the program.
    """

    def __init__(self, viewer: Shown) -> None:
        self.viewer = viewer
        self.tree: Any = SceneTree()
        self.pages: set[Page] = set()
        self.controls = Controls()
        #: Type -> last command of that type, which a new page gets after the scene.
        self._last_broadcasts: dict[str, bytes] = {}

    def enter(self, page: Page) -> None:
        """Show the scene to a new page."""
        self.pages.add(page)
        for message in (*self.messages(), *self._last_broadcasts.values()):
            page.send(message)
        for command in self.controls.commands():
            page.send(command.packed())

    def show_control(self, command: Command, mover: Any = None) -> None:
        """Send the command of a curve or slider to the open pages but the mover."""
        packed = command.packed()
        for page in self.pages - {mover}:
            page.send(packed)

    def broadcast(self, command: Command, mover: Any = None) -> None:
        """Send a command to all pages, also to those that open later.

        Args:
            command: The command; it replaces the last one of its type.
            mover: The page that caused it, which does not get it.
        """
        packed = command.packed()
        self._last_broadcasts[command["type"]] = packed
        for page in self.pages - {mover}:
            page.send(packed)

    def store_transform(self, command: Command) -> None:
        """Store the transform of a node for pages that open later.

        Open pages compute it themselves, from the pose that `broadcast` sends.
        """
        node = find_node(self.tree, path_parts(command["path"]))
        node.transform = command.packed()

    def carry_out(self, kind: str, path: list[str], data: bytes) -> None:
        """Carry out a command of meshcat's protocol, here and in all pages.

        Args:
            kind: Name of the command, such as ``set_transform``.
            path: Parts of the path of the node.
            data: The packed command.
        """
        # Pages need not load again an object that they show already.
        is_shown = kind == "set_object" and find_node(self.tree, path).object == data
        if not is_shown:
            for page in self.pages:
                page.send(data)

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

    def messages(self) -> Iterator[bytes]:
        """The packed commands that build the scene as it is now."""
        for node in walk(self.tree):
            for part in (node.object, *node.properties, node.transform, node.animation):
                if part is not None:
                    yield part
