"""The pictures of a film, several at once."""

from __future__ import annotations

import os
import sys
import threading
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import (
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from itertools import islice
from multiprocessing import get_context

from alpha5_model.viewer.picture import Pixels, picture
from alpha5_model.viewer.scene import Scene, Size


def pictures(scenes: Iterable[Scene], size: Size) -> Iterator[Pixels]:
    """The pictures of some scenes, in their order.

    As many are drawn at once as there are processors. The first are begun at once;
    further scenes are taken as they are needed.

    Args:
        scenes: What to draw.
        size: Width and height in pixels.
    """
    workers = os.cpu_count() or 1
    pool = _pool(workers)
    coming = iter(scenes)
    first = [pool.submit(picture, scene, size) for scene in islice(coming, workers)]
    return _in_order(pool, deque(first), coming, size)


def _in_order(
    pool: Executor,
    waiting: deque[Future[Pixels]],
    coming: Iterator[Scene],
    size: Size,
) -> Iterator[Pixels]:
    """The pictures that wait, and those of the scenes to come."""
    with pool:
        try:
            for scene in coming:
                waiting.append(pool.submit(picture, scene, size))
                yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            # A reader that stops early does not wait for pictures that nobody sees.
            for future in waiting:
                future.cancel()


def _pool(workers: int) -> Executor:
    """Processes if they can be forked, else threads, of which one at a time computes.

    A process that is forked beside other threads may wait for their locks forever.
    """
    alone = threading.active_count() == 1
    if sys.platform == "linux" and alone:
        return ProcessPoolExecutor(workers, get_context("fork"))
    return ThreadPoolExecutor(workers)
