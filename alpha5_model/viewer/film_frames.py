"""The pictures of a film, several at once."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

from alpha5_model.viewer.picture import Pixels, picture
from alpha5_model.viewer.scene import Scene, Size


def pictures(scenes: Iterable[Scene], size: Size) -> Iterator[Pixels]:
    """The pictures of some scenes, in their order.

    As many are drawn at once as there are processors: NumPy lets other threads run
    while it computes. Scenes are taken as they are needed.

    Args:
        scenes: What to draw.
        size: Width and height in pixels.
    """
    workers = os.cpu_count() or 1
    waiting: deque[Future[Pixels]] = deque()
    with ThreadPoolExecutor(workers) as pool:
        try:
            for scene in scenes:
                waiting.append(pool.submit(picture, scene, size))
                if len(waiting) > workers:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            # A reader that stops early does not wait for pictures that nobody sees.
            for future in waiting:
                future.cancel()
