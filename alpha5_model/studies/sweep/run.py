"""Compute a study in parts and write what it gives."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from alpha5_model._support.checks import count
from alpha5_model._support.files import (
    PathLike,
    atomic_write,
    atomic_write_all,
    check_outputs,
    read_named,
)
from alpha5_model.codegen.kernels.choice import backend
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingDependencyError,
    MissingFileError,
    OutputError,
)

if TYPE_CHECKING:
    from alpha5_model.studies.sweep.rows import Reduction
    from alpha5_model.studies.sweep.study import Study

_PART = "a part of this study"


class Sweep(NamedTuple):
    """What came of a study.

    Attributes:
        study: As read.
        rows: How many there are; none of a recording that failed.
        failures: Recording -> why it could not be used.
        outputs: Output -> its columns by name. A table is not here: it is the data set ``rows`` in the folder.
    """

    study: Study
    rows: int
    failures: dict[str, str]
    outputs: dict[str, dict[str, Any]]

    def inputs(self, row: int) -> dict[str, Any]:
        """What stands behind a row: the value of each axis, or the recording and its sample."""
        from alpha5_model.studies.sweep.rows import inputs

        return inputs(self.study, row)


def sweep(
    study: PathLike,
    folder: PathLike,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    rows: int = 1_000_000,
    progress: Callable[[str, float], None] | None = None,
) -> Sweep:
    """Compute a study: the same bytes for any number of workers and any size of chunks.

    Args:
        study: TOML file.
        folder: For the results, made if missing; of a run of this study that was stopped, what is left is computed.
        workers: Processes on this machine, through Dask; 0 for none but this one.
        scheduler: Address of a Dask scheduler, whose workers have this package, and read the recordings.
        rows: About how many of them one process holds.
        progress: Called with a stage and the part done, 0 to 1.

    Raises:
        FileFormatError: Of the study, with its place; of a part that is damaged or of something else.
        InputError: A folder with another study, or other chunks; no scheduler at the address.
        OutputError: The folder cannot be written, or the workers are lost; what is finished stays.
        MissingDependencyError: Without ``alpha5-model[sweep]``.
    """
    for package in ("pyarrow", "distributed"):
        if find_spec(package) is None:
            remedy = "python -m pip install 'alpha5-model[sweep]'"
            raise MissingDependencyError(package, "a sweep", remedy)
    from alpha5_model.studies.sweep.rows import reductions
    from alpha5_model.studies.sweep.study import BLOCK, read_study

    made, target = read_study(study), Path(folder)
    check_outputs([study], folder=(target / "study.toml", (".toml",)))
    for name in reductions(made):
        check_outputs((), output=(target / f"{name}.parquet", (".parquet",)))
    check_outputs((), output=(target / "summary.json", (".json",)))
    (cases, states, each), recordings = made.sizes(), made.cases.get("recording", ())
    total, size = cases * each, max(1, count("rows", rows) // min(BLOCK, states))
    size = total // len(recordings) if recordings else size  # each is a chunk
    head = f"# {_made_by()}\n{made.text}"
    head += "".join(f"# recording {k}: {name}\n" for k, name in enumerate(recordings))
    files = [
        target / "parts" / f"part-{k:06}.parquet" for k in range(-(-total // size))
    ]
    chunks = [k for k, file in enumerate(files) if not _finished(file, head, size)]
    atomic_write(target / "study.toml", head)
    work = partial(_work, made, head, size, total)
    for done, (k, parts) in enumerate(
        _results(work, chunks, workers, scheduler, target)
    ):
        atomic_write_all(
            {target / room / files[k].name: part for room, part in parts.items()}
        )
        if progress:
            progress("compute", (len(files) - len(chunks) + done + 1) / len(files))
    whole, found, failures = reductions(made), 0, {}
    for k, file in enumerate(files):
        count_of_part, problem = _merged(file, whole)
        found += count_of_part
        if problem:
            failures[recordings[k]] = problem
    outputs = {name: reduction.result() for name, reduction in whole.items()}
    tables = {
        target / f"{n}.parquet": _parquet(table, study=head)
        for n, table in outputs.items()
    }
    summary = {
        "made_by": _made_by(),
        "seed": made.seed,
        "rows": found,
        "failures": failures,
    }
    atomic_write_all({**tables, target / "summary.json": json.dumps(summary, indent=1)})
    return Sweep(made, found, failures, outputs)


def _made_by() -> str:
    """What the digits depend on beside the study."""
    from alpha5_model import __version__

    return f"alpha5-model {__version__}, {backend().partition(' ')[0]} kernels"


def _finished(file: Path, head: str, size: int) -> bool:
    """Whether a part is there already, without a failure that may be mended by now.

    Raises:
        InputError: It is a part of another study, or of another size.
        FileFormatError: A folder, or a table of something else, stands in its place.
    """
    from pyarrow import ArrowException, BufferReader, parquet

    try:
        content = read_named(file, _PART)
    except MissingFileError:
        return False
    try:
        facts = parquet.read_schema(BufferReader(content)).metadata or {}
    except (OSError, ArrowException):  # cut off: computed again
        return False
    if not {b"study", b"blocks", b"problem"} <= {*facts}:
        problem = (
            "is a table of something else; expected another folder for the results"
        )
        raise FileFormatError(file, problem)
    if (facts[b"study"], facts[b"blocks"]) != (head.encode(), str(size).encode()):
        expected = "a new one, or one with a part of this study in chunks of this size"
        raise InputError("folder", str(file.parents[1]), expected)
    return not facts[b"problem"]


def _merged(file: Path, reductions: dict[str, Reduction]) -> tuple[int, str]:
    """Add a part to the reductions: its number of rows, and why it has none.

    Raises:
        FileFormatError: It is damaged, which its head did not show.
    """
    from pyarrow import ArrowException, BufferReader, parquet

    content = read_named(file, _PART)
    try:
        part = parquet.read_table(BufferReader(content))
        for name, reduction in reductions.items():
            own = part["output"].to_numpy() == name
            columns = (part[column].to_numpy() for column in ("key", "value", "count"))
            reduction.merge(*(column[own] for column in columns))
        facts = part.schema.metadata
        return int(facts[b"rows"]), facts[b"problem"].decode()
    except (OSError, ArrowException, LookupError, ValueError, TypeError) as error:
        problem = f"is damaged ({error}); remove it, and it is computed again"
        raise FileFormatError(file, problem) from None


def _work(
    study: Study, head: str, size: int, total: int, k: int
) -> tuple[int, dict[str, bytes]]:
    """A chunk's rows and its part of the reductions, as Parquet files by their folder."""
    from alpha5_model.studies.sweep.rows import blocks, columns, reductions

    if not head.startswith(f"# {_made_by()}\n"):
        raise InputError(
            "worker", _made_by(), f"what asks: {head.partition(chr(10))[0]}"
        )
    found, tables, rows, problem = reductions(study), [], 0, ""
    try:
        for block in blocks(study, k * size, min(total, (k + 1) * size)):
            rows += len(block[0])
            for reduction in found.values():
                reduction.add(block[3][reduction.output.quantity], block[1], block[0])
            tables += [columns(study, block)] if len(found) < len(study.outputs) else []
    except Exception as error:
        if "recording" not in study.cases:
            raise
        found, tables, rows, problem = (
            reductions(study),
            [],
            0,
            str(error) or repr(error),
        )
    parts = [reduction.parts(name) for name, reduction in found.items()]
    facts = {"rows": str(rows), "blocks": str(size), "problem": problem}
    # The part last: where it is, all of the chunk is.
    files = {"rows": _parquet(*tables, study=head)} if tables else {}
    return k, files | {"parts": _parquet(*parts, study=head, **facts)}


def _parquet(*tables: dict[str, Any], **metadata: str) -> bytes:
    import pyarrow
    from pyarrow import parquet

    whole = (
        pyarrow.concat_tables(map(pyarrow.table, tables))
        if tables
        else pyarrow.table({})
    )
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(whole.replace_schema_metadata(metadata), sink)
    return bytes(sink.getvalue())


def _results(
    work: Callable[[int], Any],
    chunks: list[int],
    workers: int,
    scheduler: str | None,
    folder: Path,
) -> Iterator[Any]:
    """What the work makes of each chunk, in any order."""
    if not workers and scheduler is None:
        yield from map(work, chunks)
        return
    from concurrent.futures import CancelledError

    from distributed import Client, KilledWorker, as_completed

    here = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    try:
        client = Client(scheduler, timeout=10) if scheduler else Client(**here)
    except (OSError, ValueError):
        raise InputError(
            "scheduler", scheduler, "the address of a Dask scheduler"
        ) from None
    with client:
        try:
            for future in as_completed(client.map(work, chunks, pure=False)):
                yield future.result()
        except (KilledWorker, CancelledError, OSError) as error:
            problem = f"the workers are lost ({error}); run it again to go on"
            raise OutputError(folder, problem) from None
