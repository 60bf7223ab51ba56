"""Side-by-side timing: candidates take turns, so a slow moment hits all of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
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
        success: Share of the inputs that were solved, 0 to 1; None if nothing can fail.
    """

    work: str
    candidate: str
    seconds: float
    success: float | None = None


def installed(module: str) -> bool:
    """Whether a peer can be imported."""
    package = module.partition(".")[0]
    return find_spec(package) is not None and find_spec(module) is not None


def compare(
    work: str,
    functions: Mapping[str, Callable[[], object]],
    units: int | Mapping[str, int] = 1,
    rounds: int = 9,
    success: Mapping[str, float] | None = None,
) -> list[Row]:
    """Median time of each function for the same work, measured in turns.

    Args:
        work: What is computed.
        functions: Candidate -> function without arguments, this package's own first.
            Each is called once beforehand.
        units: Of work in one call, for example the rows of a batch.
        rounds: How often each function has its turn.
        success: Candidate -> share of the inputs that it solves.
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
            start = time.perf_counter()
            for _ in range(repeats[name]):
                function()
            elapsed = time.perf_counter() - start
            samples[name].append(elapsed / repeats[name])

    found = []
    for name, times in samples.items():
        per_call = units if isinstance(units, int) else units[name]
        solved = (success or {}).get(name)
        found.append(Row(work, name, median(times) / per_call, solved))
    return found
