"""Compute the parts of a study in this process, in others here, or on a cluster."""

from __future__ import annotations

import pickle
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

from alpha5_model.errors import InputError, OutputError
from alpha5_model.studies.sweep.parts import Part, compute
from alpha5_model.studies.sweep.study import Study

#: A cluster that has no worker for so long is refused [s].
_PATIENCE = 5.0
#: Leaves Ctrl-C, which goes to every process of a terminal, to the asking one. It ends
#: the workers. Otherwise each would print what it was doing.
_SET_UP = "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"


def computed(
    study: Study,
    parts: Sequence[int],
    workers: int,
    scheduler: str | None,
    folder: Path,
) -> Iterator[Part]:
    """Parts of a study; on workers in any order.

    Args:
        study: The study.
        parts: Their numbers.
        workers: Processes on this machine; 0 for this process alone.
        scheduler: Address of a Dask scheduler, which is used instead.
        folder: Of the results, for messages.

    Raises:
        InputError: No scheduler at the address, or one without workers.
        OutputError: The workers are lost.
        Alpha5Error: Impossible values of an arm.
    """
    if not workers and scheduler is None:
        for number in parts:
            yield compute(study, number)
        return

    from concurrent.futures import CancelledError

    from distributed import KilledWorker, as_completed

    packed = pickle.dumps(study)
    with _client(workers, scheduler) as client:
        try:
            # Each worker gets it once, as large as its axes may be.
            sent = client.scatter(packed, broadcast=True)
            futures = client.map(_compute, parts, study=sent, pure=False)
            for future in as_completed(futures):
                yield future.result()
        except (KilledWorker, CancelledError, OSError) as error:
            problem = f"the workers are lost ({error}); run it again to go on"
            raise OutputError(folder, problem) from None


def _compute(number: int, study: bytes) -> Part:
    """Compute a part in a worker."""
    return compute(_unpacked(study), number)


@lru_cache(maxsize=1)
def _unpacked(study: bytes) -> Study:
    """The study that was sent, kept for the next part, with its arms."""
    found: Study = pickle.loads(study)
    return found


def _client(workers: int, scheduler: str | None) -> Any:
    """A client of a Dask scheduler that has workers, or of processes here."""
    import dask
    from distributed import Client

    if scheduler is None:
        # By default Dask has its workers give their memory back to the system after
        # each array. Getting it again took as long as half of the work.
        name = "distributed.nanny.pre-spawn-environ"
        variables = dict(dask.config.get(name))
        variables.pop("MALLOC_TRIM_THRESHOLD_", None)
        with _interrupts_ignored(), dask.config.set({name: variables}):
            return Client(
                n_workers=workers,
                threads_per_worker=1,
                # A free port: 8787 may be taken by another study.
                dashboard_address=":0",
                preload=_SET_UP,
            )

    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError):
        expected = "the address of a Dask scheduler"
        raise InputError("scheduler", scheduler, expected) from None
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        client.close()
        expected = (
            f"a cluster with workers, but none came within {_PATIENCE:g} s; "
            f"start one with: dask worker {scheduler}"
        )
        raise InputError("scheduler", scheduler, expected) from None
    return client


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Ignore Ctrl-C for about a second, and in the processes that start meanwhile.

    Those would print what they were doing before `_SET_UP` has run.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
