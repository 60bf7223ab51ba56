"""Requests of other programs to the live viewer, in meshcat's protocol.

A request is a list of frames over ZMQ, such as ``[b"set_transform", path, data]``. Each
gets one answer. Two kinds are answered later: ``wait`` as soon as a page is open, and
``capture_image`` as soon as a page has sent its picture.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
from collections.abc import Callable

from alpha5_model.errors import Alpha5Error, InputError
from alpha5_model.viewer.live_scene import LiveScene, Page
from alpha5_model.viewer.messages import read_command, read_picture
from alpha5_model.viewer.page import static_page

#: Longest wait for something that a page must do: be opened, or send a picture [s].
PAGE_PATIENCE = 60.0
#: Largest request [bytes].
_LARGEST_REQUEST = 64 * 2**20
_COMMANDS = {
    b"set_object",
    b"set_transform",
    b"set_property",
    b"set_animation",
    b"delete",
}
#: How the answer to a refused request begins.
ERROR = b"error: "
_LOG = logging.getLogger(__name__)

#: A function that sends the answer to a request.
Answer = Callable[[bytes], None]


class Requests:
    """What other programs have asked for. All methods run in the server's thread.

    Args:
        live: Carries out commands, and knows the open pages.
        web_url: Address of the page.
    """

    def __init__(self, live: LiveScene, web_url: str) -> None:
        self._live = live
        self._web_url = web_url
        self._request_numbers = itertools.count()
        #: Number of a request -> answer to a program that waits for a page.
        self._waiting: dict[int, Answer] = {}
        #: Number of a request -> answer to a program that waits for a picture, and the
        #: packed request to the pages.
        self._pictures: dict[int, tuple[Answer, bytes]] = {}

    def receive(self, frames: list[bytes], send: Callable[[list[bytes]], None]) -> None:
        """Answer a request that came over ZMQ.

        Args:
            frames: The envelope, with the address of the program, then the request.
            send: Sends the same envelope with an answer.
        """
        _, *rest = frames
        start = rest.index(b"") + 2 if b"" in rest else 1
        envelope = frames[:start]
        request = frames[start:]

        def answer(text: bytes) -> None:
            send([*envelope, text])

        try:
            self.carry_out(request, answer)
        except Alpha5Error as refusal:
            answer(ERROR + str(refusal).encode())
        except Exception:
            _LOG.exception("viewer")
            answer(ERROR + b"the viewer failed")

    def carry_out(self, request: list[bytes], answer: Answer) -> None:
        """Carry out a request and answer it once, perhaps later.

        Raises:
            InputError: There is no such request.
        """
        size = sum(map(len, request))
        if size > _LARGEST_REQUEST:
            raise InputError("request", f"{size} bytes", f"at most {_LARGEST_REQUEST}")
        match request:
            case [b"url"]:
                answer(self._web_url.encode())
            case [b"get_scene"]:
                messages = self._live.messages()
                answer(static_page(self._live.viewer.scene, messages).encode())
            case [b"wait"]:
                self._wait_for_page(answer)
            case [b"capture_image", path, data]:
                read_command(b"capture_image", path, data)
                self._capture(answer, data)
            case [kind, path, data] if kind in _COMMANDS:
                parts = read_command(kind, path, data)
                self._live.carry_out(kind.decode(), parts, data)
                answer(b"ok")
            case _:
                raise _unknown(request)

    def page_opened(self, page: Page) -> None:
        """Answer programs that wait for a page, and ask it for wanted pictures."""
        for number in list(self._waiting):
            answer = self._waiting.pop(number)
            answer(b"ok")
        for number in self._pictures:
            self._request_picture(number, page)

    def receive_picture(self, number: int, message: str) -> None:
        """Answer with the picture of a page; the first page's is taken.

        Raises:
            InputError: The message holds no picture.
        """
        picture = read_picture(message)
        waiting = self._pictures.pop(number, None)
        if waiting:
            answer, _ = waiting
            answer(picture)

    def _wait_for_page(self, answer: Answer) -> None:
        if self._live.pages:
            answer(b"ok")
            return
        number = next(self._request_numbers)
        self._waiting[number] = answer

        def give_up() -> None:
            if self._waiting.pop(number, None):
                reason = f"no page was opened within {PAGE_PATIENCE:g} s"
                answer(ERROR + reason.encode())

        asyncio.get_running_loop().call_later(PAGE_PATIENCE, give_up)

    def _capture(self, answer: Answer, data: bytes) -> None:
        number = next(self._request_numbers)
        self._pictures[number] = (answer, data)
        for page in self._live.pages:
            self._request_picture(number, page)

        def give_up() -> None:
            if self._pictures.pop(number, None):
                reason = f"no page sent a picture within {PAGE_PATIENCE:g} s"
                answer(ERROR + reason.encode())

        asyncio.get_running_loop().call_later(PAGE_PATIENCE, give_up)

    def _request_picture(self, number: int, page: Page) -> None:
        page.asked.append(number)
        _, data = self._pictures[number]
        page.send(data)


def _unknown(request: list[bytes]) -> InputError:
    first = request[0][:40] if request else b""
    given = f"{len(request)} frames, {first!r}"
    commands = b", ".join(sorted(_COMMANDS)).decode()
    known = f"url, wait, get_scene, or a command ({commands}), its path and its data"
    return InputError("request", given, known)
