"""Compute a study in chunks and write its results."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from alpha5_model._support.checks import count
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import MissingDependencyError
from alpha5_model.studies.sweep.checksums import digest
from alpha5_model.studies.sweep.chunks import (
    Chunks,
    chunks_of,
    compute,
    made_by,
    merge,
)
from alpha5_model.studies.sweep.results_folder import ResultsFolder
from alpha5_model.studies.sweep.tables import parquet_file
from alpha5_model.studies.sweep.workers import results

if TYPE_CHECKING:
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.studies.sweep.extent import Extent
    from alpha5_model.studies.sweep.study import Study


class Sweep(NamedTuple):
    """The results of a study.

    Attributes:
        study: As read.
        rows: Number of rows; a recording that failed has none.
        failures: Recording -> why it could not be used.
        outputs: Output -> its columns by name. Outputs of the form ``table`` are not
            here, but in the data set ``rows`` in the folder.
        repaired: Files in the folder that were missing, damaged or out of date, and
            were made again: a line for each.
        foreign: Names of other files beside the results; nothing was done to them.
    """

    study: Study
    rows: int
    failures: dict[str, str]
    outputs: dict[str, dict[str, Any]]
    repaired: tuple[str, ...] = ()
    foreign: tuple[str, ...] = ()

    def inputs(self, row: int) -> dict[str, Any]:
        """The values of the axes of a row, or its recording and sample."""
        from alpha5_model.studies.sweep.blocks import values_of_row

        return values_of_row(self.study, row)


def sweep(
    study: PathLike,
    folder: PathLike,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    rows: int = 1_000_000,
    progress: Callable[[str, float], None] | None = None,
    arm: Alpha5Parameters | None = None,
    announce: Callable[[Extent], None] | None = None,
) -> Sweep:
    """Compute a study: the same bytes for any number of workers and size of chunks.

    Args:
        study: TOML file.
        folder: For the results, made if missing. A run of this study that was stopped
            is continued. Every file there is compared with its checksum, and what is
            missing, damaged or made from another recording is made again.
        workers: Processes on this machine, through Dask; 0 for this process alone.
        scheduler: Address of a Dask scheduler. Its workers need this package and read
            the recordings.
        rows: Approximate number of rows that one process holds.
        progress: Called with a stage and the share done, 0 to 1.
        arm: Record of an arm of your own: its bodies, lengths, limits, motors, and its
            mount if no axis of the study is the mount's. None for the catalogue's.
        announce: Called once before the work with its size and its approximate time,
            which takes three blocks of it to find. An error that it raises ends the
            sweep before anything is written.

    Raises:
        FileFormatError: A mistake in the study, with its place; states beyond the
            limits of ``arm``; a foreign file among the parts or rows in the folder.
        InputError: A folder with another study, or with other chunks; no scheduler at
            the address, or one without workers; a study of more than a million parts.
        OutputError: The folder cannot be written, or the workers are lost. Finished
            parts stay.
        MissingDependencyError: Without ``alpha5-model[sweep]``.
    """
    _check_packages()
    from alpha5_model.studies.sweep.study import read_study

    target = Path(folder)
    read = read_study(study, arm)
    _check_targets(study, read, target)
    chunks = chunks_of(read, count("rows", rows))
    results_folder = ResultsFolder(target, chunks)
    present = results_folder.inspect()
    if announce:
        from alpha5_model.studies.sweep.extent import extent_of

        announce(extent_of(chunks, len(present.missing), workers))

    total = chunks.count()
    done = total - len(present.missing)
    was_other = _writes_text(chunks, target)
    work = partial(compute, chunks)
    for chunk in results(work, present.missing, workers, scheduler, target):
        results_folder.write_chunk(chunk)
        done += 1
        if progress:
            progress("compute", done / total)

    found = _merged(results_folder)
    files = _result_files(found, chunks, target)
    was_wrong = results_folder.write_results(files)
    repaired = [*present.damage]
    if present.started and was_other:
        repaired.append(was_other)
    if not present.is_new:
        repaired += was_wrong
    foreign = results_folder.foreign_files([target / "study.toml", *files])
    return found._replace(repaired=tuple(repaired), foreign=tuple(foreign))


def _check_packages() -> None:
    """Refuse to start without the packages that a sweep needs."""
    for package in ("pyarrow", "distributed"):
        if find_spec(package) is None:
            remedy = "python -m pip install 'alpha5-model[sweep]'"
            raise MissingDependencyError(package, "a sweep", remedy)


def _check_targets(source: PathLike, study: Study, target: Path) -> None:
    """Refuse a folder in which a result cannot be written."""
    from alpha5_model.studies.sweep.reductions import empty_reductions

    check_outputs([source], folder=(target / "study.toml", (".toml",)))
    for name in empty_reductions(study):
        check_outputs((), output=(target / f"{name}.parquet", (".parquet",)))
    check_outputs((), output=(target / "summary.json", (".json",)))


def _writes_text(chunks: Chunks, target: Path) -> str:
    """Write the text of the study into the folder.

    Returns:
        What was wrong with the file that was there.

    Raises:
        OutputError: It cannot be written.
    """
    file = target / "study.toml"
    problem = f"{file}: is missing"
    if file.is_file():
        is_same = file.read_bytes() == chunks.text.encode()
        problem = "" if is_same else f"{file}: is not the text of this study"
    atomic_write(file, chunks.text)
    return problem


def _merged(folder: ResultsFolder) -> Sweep:
    """The results of all parts together."""
    from alpha5_model.studies.sweep.reductions import empty_reductions

    study = folder.chunks.study
    whole = empty_reductions(study)
    rows = 0
    failures = {}
    for k in range(folder.chunks.count()):
        rows_of_part, problem = merge(folder.part(k), whole)
        rows += rows_of_part
        if problem:
            failures[study.cases["recording"][k]] = problem

    outputs = {name: reduction.result() for name, reduction in whole.items()}
    return Sweep(study=study, rows=rows, failures=failures, outputs=outputs)


def _result_files(found: Sweep, chunks: Chunks, target: Path) -> dict[Path, bytes]:
    """The content of a table for each output, and of the summary."""
    from alpha5_model.studies.sweep.units import units_of_axes, units_of_result

    study = found.study
    files = {}
    for name, table in found.outputs.items():
        units = units_of_result(study, study.outputs[name])
        content = parquet_file([table], units, study=chunks.head)
        files[target / f"{name}.parquet"] = content
    summary = {
        "made_by": made_by(),
        "seed": found.study.seed,
        "rows": found.rows,
        "failures": found.failures,
        "units": {
            "axes": units_of_axes(study),
            "outputs": {name: output.unit for name, output in study.outputs.items()},
        },
        "sha256": {file.name: digest(content) for file, content in files.items()},
    }
    if found.study.arm is not None:
        summary["arm"] = found.study.arm.name
    files[target / "summary.json"] = json.dumps(summary, indent=1).encode()
    return files
