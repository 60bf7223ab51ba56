"""Compute what is missing of a study, and write its results."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.files import PathLike, errors_of
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.writing import atomic_write, atomic_write_all
from alpha5_model.errors import InputError, MissingDependencyError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.sweep.parts import (
    count_parts,
    inputs_of,
    merge,
    parquet_file,
    part_names,
)
from alpha5_model.studies.sweep.reductions import reductions_of
from alpha5_model.studies.sweep.study import Output, Study, read_study
from alpha5_model.studies.sweep.workers import computed

#: Most parts of a study: more files make a folder slow.
_MOST_PARTS = 2**20
#: Names of the files of parts of any study.
_PART_NAME = re.compile(r"[0-9a-f]{16}-\d{6,7}(-[0-9a-f]{16})?\.parquet")


class Sweep(NamedTuple):
    """The results of a study.

    Attributes:
        study: As read.
        rows: Number of rows; a recording that failed has none.
        failures: Recording -> why it could not be used.
        outputs: Output -> its columns by name. Outputs of the form ``table`` are not
            here, but in the data set ``rows`` in the folder.
    """

    study: Study
    rows: int
    failures: dict[str, str]
    outputs: dict[str, dict[str, Any]]

    def inputs(self, row: int) -> dict[str, Any]:
        """The values of the axes of a row, or its recording and sample.

        Raises:
            InputError: The study has no such row: it is not one of its numbers, or
                was left out.
        """
        return inputs_of(self.study, row)


def sweep(
    study: PathLike,
    folder: PathLike,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    restart: bool = False,
    progress: Callable[[str, float], None] | None = None,
    arm: Alpha5Parameters | None = None,
) -> Sweep:
    """Compute a study: the same numbers for any number of workers.

    Args:
        study: TOML file.
        folder: For the results, made if missing. A run of this study that was stopped
            is continued: parts that are there are not computed again, unless their
            recording has changed.
        workers: Processes on this machine, through Dask; 0 for this process alone.
        scheduler: Address of a Dask scheduler. Its workers need this package and read
            the recordings.
        restart: Remove the parts of any study in the folder, and compute all of this.
        progress: Called with a stage and the share done, 0 to 1.
        arm: Record of an arm of your own: its bodies, lengths, limits, motors, and its
            mount if no axis of the study is the mount's. None for the catalogue's.

    Raises:
        FileFormatError: A mistake in the study, with its place; states beyond the
            limits of ``arm``; a damaged part.
        InputError: A folder with parts of another study, or other files among them; no
            scheduler at the address, or one without workers; a study of more than a
            million parts.
        OutputError: The folder cannot be written, or the workers are lost. Finished
            parts stay.
        MissingDependencyError: Without ``alpha5-model[sweep]``.
    """
    for package in ("pyarrow", "distributed") if workers or scheduler else ("pyarrow",):
        if find_spec(package) is None:
            remedy = "python -m pip install 'alpha5-model[sweep]'"
            raise MissingDependencyError(package, "a sweep", remedy)
    found = read_study(study, arm)
    target = Path(folder)
    reductions = reductions_of(found)
    check_outputs([study], folder=(target / "study.toml", (".toml",)))
    check_outputs((), output=(target / "summary.json", (".json",)))
    for name in reductions:
        check_outputs((), output=(target / f"{name}.parquet", (".parquet",)))
    if count_parts(found) > _MOST_PARTS:
        size = f"{found.cases * found.states:.3g} rows"
        raise InputError("study", size, f"at most {_MOST_PARTS} parts: a smaller one")

    names = part_names(found)
    _remove_old(target, found, names, restart)
    folders = [target / "parts"]
    if found.has_table:
        folders.append(target / "rows")
    missing = [
        number
        for number, name in enumerate(names)
        if not all((folder / name).is_file() for folder in folders)
    ]
    atomic_write(target / "study.toml", found.text)
    failed = {}
    done = len(names) - len(missing)
    for part in computed(found, missing, workers, scheduler, target):
        if part.problem:
            failed[part.number] = part.problem
        else:
            names[part.number] = part.name
            files = {target / "parts" / part.name: part.kept}
            if part.rows is not None:
                files[target / "rows" / part.name] = part.rows
            atomic_write_all(files)
        done += 1
        if progress:
            progress("compute", done / len(names))

    rows = 0
    for number, name in enumerate(names):
        if number not in failed:
            rows += merge(target / "parts" / name, reductions)
    failures = {found.recordings[k]: problem for k, problem in sorted(failed.items())}
    outputs = {name: reduction.table() for name, reduction in reductions.items()}
    result = Sweep(study=found, rows=rows, failures=failures, outputs=outputs)
    _write_results(target, result)
    return result


def _remove_old(target: Path, study: Study, names: list[str], restart: bool) -> None:
    """Remove parts of recordings that have changed, or with ``restart`` all parts.

    Raises:
        InputError: Files that are none of this study's parts: readers of the data set
            would take them in.
        OutputError: A file cannot be removed.
    """
    old = [*target.glob(".alpha5-*")]  # of processes that were killed
    for file in chain(target.glob("parts/*"), target.glob("rows/*")):
        is_part = _PART_NAME.fullmatch(file.name) is not None
        is_changed = file.name.startswith(study.key) and file.name not in names
        if file.name.startswith(".alpha5-") or (is_part and (restart or is_changed)):
            old.append(file)
        elif file.name not in names and not file.name.startswith("."):
            expected = f"only parts of this study; move {file.name} away"
            if is_part:
                expected = "another one, or to restart: it has parts of another study"
            raise InputError("folder", str(file.parent), expected)
    for file in old:
        with errors_of(file):
            file.unlink()


def _write_results(target: Path, found: Sweep) -> None:
    """Write a table for each output, then the summary."""
    study = found.study
    files: dict[Path, str | bytes] = {}
    for name, table in found.outputs.items():
        units = _units(study, study.outputs[name])
        content = parquet_file([table], units, study=study.head)
        files[target / f"{name}.parquet"] = content
    summary = {
        "made_by": study.made_by,
        "seed": study.seed,
        "rows": found.rows,
        "failures": found.failures,
        "units": {
            "axes": study.axes.units,
            "outputs": {name: output.unit for name, output in study.outputs.items()},
        },
    }
    if study.arm is not None:
        summary["arm"] = study.arm.name
    files[target / "summary.json"] = json.dumps(summary, indent=1)
    atomic_write_all(files)


def _units(study: Study, output: Output) -> dict[str, str]:
    """Column of the table of an output -> its unit."""
    if output.form == "histogram":  # the other columns are counts
        return {"low": output.unit, "high": output.unit}
    if output.form == "quantile":
        ends = [
            f"{column}_{end}" for column in output.columns for end in ("low", "high")
        ]
        return dict.fromkeys(ends, output.unit)
    return {**study.axes.units, **dict.fromkeys(output.columns, output.unit)}
