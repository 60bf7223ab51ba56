"""Compute the chunks of a study in this process, in others here, or on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

from alpha5_model.errors import InputError, OutputError

Result = TypeVar("Result")


def results(
    work: Callable[[int], Result],
    chunks: Sequence[int],
    workers: int,
    scheduler: str | None,
    folder: Path,
) -> Iterator[Result]:
    """The results of the work for each chunk; on workers in any order.

    Args:
        work: Function of a chunk's number that can be sent to another process.
        chunks: Their numbers.
        workers: Processes on this machine; 0 for this process alone.
        scheduler: Address of a Dask scheduler, which is used instead.
        folder: Of the results, for messages.

    Raises:
        InputError: No scheduler at the address.
        OutputError: The workers are lost.
    """
    if not workers and scheduler is None:
        yield from map(work, chunks)
        return

    from concurrent.futures import CancelledError

    from distributed import KilledWorker, as_completed

    with _client(workers, scheduler) as client:
        try:
            for future in as_completed(client.map(work, chunks, pure=False)):
                yield future.result()
        except (KilledWorker, CancelledError, OSError) as error:
            problem = f"the workers are lost ({error}); run it again to go on"
            raise OutputError(folder, problem) from None


def _client(workers: int, scheduler: str | None) -> Any:
    """A client of a Dask scheduler, or of processes on this machine."""
    from distributed import Client

    try:
        if scheduler:
            return Client(scheduler, timeout=10)
        return Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    except (OSError, ValueError):
        expected = "the address of a Dask scheduler"
        raise InputError("scheduler", scheduler, expected) from None
