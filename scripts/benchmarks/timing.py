"""Side-by-side timing: candidates take turns, so a slow moment hits all of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median

#: A round of one candidate is repeated until it lasts this long [s], so that the
#: clock's step and the cost of the loop do not show.
SHORTEST_ROUND = 0.01


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes:
        work: What is computed; rows of the same work are compared with each other.
        candidate: Who computes it; the first row of a work is this package's own.
        seconds: Median time per unit [s].
        success: Share of the inputs that were solved, 0 to 1; None where nothing can
            fail.
        setup: How the candidate was set up.
        target: Wanted ratio of this candidate's time to the first row's; None without a
            target.
    """

    work: str
    candidate: str
    seconds: float
    success: float | None = None
    setup: str = ""
    target: float | None = None


def duration(seconds: float) -> str:
    """A time with three digits and the unit that suits it."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def measure(
    functions: Mapping[str, Callable[[], object]], per_call: int = 1, rounds: int = 9
) -> dict[str, float]:
    """Median time of each function, measured in turns.

    Args:
        functions: Name -> function without arguments. Each is called once beforehand.
        per_call: Units of work in one call, for example the rows of a batch.
        rounds: How often each function has its turn.

    Returns:
        Name -> median seconds per unit.
    """
    repeats = {}
    for name, function in functions.items():
        function()
        start = time.perf_counter()
        function()
        once = time.perf_counter() - start
        repeats[name] = max(1, round(SHORTEST_ROUND / max(once, 1e-7)))
    samples: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(rounds):
        for name, function in functions.items():
            turns = range(repeats[name])
            start = time.perf_counter()
            for _ in turns:
                function()
            elapsed = time.perf_counter() - start
            samples[name].append(elapsed / (repeats[name] * per_call))
    return {name: median(times) for name, times in samples.items()}
