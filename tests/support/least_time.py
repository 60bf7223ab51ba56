"""The least processor time of a few tries, on a machine that others use too."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable

TRIES = 5

#: Four times as much takes four times as long; quadratic work would take sixteen times.
FACTOR, MOST = 4, 10.0
#: Seconds below which a clock and a cold cache decide, not the work.
NOISE = 0.2


def least_time(work: Callable[[], object], enough: float) -> float:
    """Seconds of the quickest try; one that takes less than `enough` is the last."""
    least = float("inf")
    for _ in range(TRIES):
        gc.collect()
        start = time.process_time()
        work()
        least = min(least, time.process_time() - start)
        if least < enough:
            break
    return least


def assert_linear_time(
    prepared: Callable[[int], Callable[[], object]], count: int
) -> None:
    """Fail unless the work for four times `count` takes about four times as long.

    Parameters
    ----------
    prepared
        Makes the work for a count; its own time does not matter.
    """
    short = least_time(prepared(count), 0.0)
    enough = MOST * short + NOISE
    assert least_time(prepared(FACTOR * count), enough) < enough
