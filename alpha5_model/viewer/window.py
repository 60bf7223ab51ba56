"""meshcat's window on a server in this process."""

from __future__ import annotations

import io
from typing import Any

import umsgpack  # type: ignore[import-untyped]
from meshcat.visualizer import ViewerWindow
from PIL import Image

from alpha5_model.viewer.live_scene import Shown
from alpha5_model.viewer.messages import path_parts
from alpha5_model.viewer.server import Server


class Window(ViewerWindow):  # type: ignore[misc]
    """meshcat's window on a server in this process, usable from any thread.

    Args:
        port: Of the page; 0 for a free one.
        viewer: What its pages show.

    Raises:
        ViewerError: The port is taken.
        InputError: It is not a port, or may not be opened.
    """

    def __init__(self, port: int, viewer: Shown) -> None:
        self.server = Server(port, viewer)
        self.zmq_url = self.server.zmq_url
        self.web_url = self.server.web_url

    def send(self, command: Any) -> None:
        """Send one of meshcat's commands."""
        lowered = command.lower()
        kind = lowered["type"]
        path = path_parts(lowered["path"])
        packed = umsgpack.packb(lowered)
        self.server.call(lambda: self.server.live.carry_out(kind, path, packed))

    def request_web_url(self) -> str:
        """Address of the page."""
        return self.web_url

    def wait(self) -> str:
        """Wait until a page is open.

        Raises:
            ViewerError: No page was opened within a minute.
        """
        return self.server.ask(b"wait").decode()

    def get_scene(self) -> str:
        """The page as one file."""
        return self.server.ask(b"get_scene").decode()

    def get_image(self) -> Image.Image:
        """A picture by an open page.

        Raises:
            ViewerError: No page sent a picture within a minute.
        """
        packed = umsgpack.packb({"type": "capture_image", "path": ""})
        picture = self.server.ask(b"capture_image", b"", packed)
        return Image.open(io.BytesIO(picture))

    def close(self) -> None:
        """Stop the server and free its port."""
        self.server.close()
