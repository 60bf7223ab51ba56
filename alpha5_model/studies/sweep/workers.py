"""Compute the chunks of a study in this process, in others here, or on a cluster."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from alpha5_model.errors import InputError, OutputError

Result = TypeVar("Result")
#: A cluster that has no worker for so long is refused [s].
_PATIENCE = 5.0


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
        InputError: No scheduler at the address, or one without workers.
        OutputError: The workers are lost.
    """
    if not workers and scheduler is None:
        yield from map(work, chunks)
        return

    from concurrent.futures import CancelledError

    from distributed import KilledWorker, as_completed

    with _client(workers, scheduler) as client:
        if scheduler:
            _wait_for_a_worker(client, scheduler)
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
        with _interrupts_ignored(), _memory_kept():
            return Client(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=None,
                preload="alpha5_model.studies.sweep.worker_setup",
            )
    except (OSError, ValueError):
        expected = "the address of a Dask scheduler"
        raise InputError("scheduler", scheduler, expected) from None


def _memory_kept() -> Any:
    """A setting of Dask: workers that start meanwhile reuse the memory of a chunk.

    By default Dask has them give it back to the system after each array. Getting it
    again took as long as half of the work.
    """
    import dask

    name = "distributed.nanny.pre-spawn-environ"
    variables = dict(dask.config.get(name))
    variables.pop("MALLOC_TRIM_THRESHOLD_", None)
    return dask.config.set({name: variables})


def _wait_for_a_worker(client: Any, scheduler: str) -> None:
    """Refuse a cluster that has no worker."""
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        expected = (
            f"a cluster with workers, but none came within {_PATIENCE:g} s; "
            f"start one with: dask worker {scheduler}"
        )
        raise InputError("scheduler", scheduler, expected) from None


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Ignore Ctrl-C for about a second, and in the processes that start meanwhile.

    Those would print what they were doing before `worker_setup` has run.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
