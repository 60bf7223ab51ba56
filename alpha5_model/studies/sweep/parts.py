"""The parts of a study: a worker computes one at a time, and each has its files.

A part is a block of states of a large case, several small cases, or a recording.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.studies.sweep.cases import case_of, case_values, quantities_of
from alpha5_model.studies.sweep.reductions import Columns, Reduction, reductions_of
from alpha5_model.studies.sweep.states import States, recorded_states, states_of
from alpha5_model.studies.sweep.study import Output, Study, made_by

#: States of a part at most: with all quantities they take some 100 MB.
STATES = 2**18
#: Small cases of a part at most: to make an arm takes as long as 100 000 states.
CASES = 64


class Part(NamedTuple):
    """What a worker gives back.

    Attributes:
        number: Of the part.
        name: Of its files.
        kept: The entries of its reductions as Parquet.
        rows: Its table as Parquet; None if the study keeps no table.
        problem: Why there is none of these: its recording cannot be used.
    """

    number: int
    name: str = ""
    kept: bytes = b""
    rows: bytes | None = None
    problem: str = ""


def count_parts(study: Study) -> int:
    """Number of parts of a study."""
    blocks, several = _division(study)
    return -(-study.cases * blocks // several)


def _division(study: Study) -> tuple[int, int]:
    """Blocks of each case, and how many of them are a part; one of both is 1."""
    if study.recordings:
        return 1, study.cases // len(study.recordings)
    blocks = -(-study.states // STATES)
    return blocks, max(1, min(CASES, STATES // study.states))


def _pieces(study: Study, part: int) -> Iterator[tuple[int, int, int]]:
    """Cases of a part, with the first state and that after the last one."""
    blocks, several = _division(study)
    last = min((part + 1) * several, study.cases * blocks)
    for number in range(part * several, last):
        case, block = divmod(number, blocks)
        yield case, block * STATES, min((block + 1) * STATES, study.states)


def rows_of(
    study: Study, case_number: int, first: int, last: int
) -> tuple[States, dict[str, FloatArray]]:
    """Rows of a case, and their quantities by name, (n, columns) each.

    Args:
        study: The study.
        case_number: Of the case.
        first: Number of its first state; no matter for a recording, which is read
            whole.
        last: Number after that of the last one.

    Raises:
        Alpha5Error: A recording, or an arm, that cannot be used.
    """
    _, values = case_values(study, case_number)
    own = study.arm_of(values)
    if study.recordings:
        states = recorded_states(study, study.folder / values["recording"], own)
    else:
        states = states_of(study, own, first, last)
    case = case_of(study, case_number)
    wanted = {output.quantity for output in study.outputs.values()}
    quantities = quantities_of(case, states, wanted)
    rows = replace(
        states,
        number=case_number * study.states + states.number,
        index={**case.axes, **states.index},
    )
    return rows, quantities


def compute(study: Study, number: int) -> Part:
    """Compute a part; one of a recording that cannot be used says why.

    Raises:
        InputError: This process has another version than the one that read the study.
        Alpha5Error: Impossible values of an arm.
    """
    if study.made_by != made_by():
        raise InputError("worker", made_by(), f"{study.made_by}, as the sweep has")
    if not study.recordings:
        return _computed(study, number, digest="")
    path = study.folder / study.recordings[number]
    recorded_states.cache_clear()  # the file may have changed
    digest = digest_of(path)
    try:
        part = _computed(study, number, digest)
    except Exception as error:
        return Part(number=number, problem=str(error) or repr(error))
    if digest_of(path) != digest:
        return Part(number=number, problem="has changed while it was read")
    return part


def _computed(study: Study, number: int, digest: str) -> Part:
    """A part with its rows."""
    reductions = reductions_of(study)
    tables = []
    count = 0
    for case, first, last in _pieces(study, number):
        rows, quantities = rows_of(study, case, first, last)
        if not rows.number.size:
            continue
        count += rows.number.size
        for name, reduction in reductions.items():
            values = quantities[study.outputs[name].quantity]
            reduction.add(values, rows.index, rows.number)
        if study.has_table:
            tables.append(table_of(study, rows, quantities))

    entries = []
    for k, reduction in enumerate(reductions.values()):
        entry = reduction.entries()
        entries.append({"output": np.full(len(entry["group"]), k), **entry})
    table = None
    if study.has_table:
        table = parquet_file(
            tables,
            units=_units_of_rows(study),
            # Numbers that hardly repeat would take most of the time.
            repeated=[*study.axes.grid],
            compression="none",
            study=study.head,
        )
    name = part_name(study, number, digest)
    return Part(
        number=number,
        name=name,
        kept=parquet_file(entries, units={}, rows=str(count), part=name),
        rows=table,
    )


def inputs_of(study: Study, row: Any) -> dict[str, Any]:
    """Column -> value of a row, see `table_of`.

    Raises:
        InputError: There is no such row.
    """
    expected = "the number of a row of this study"
    is_number = isinstance(row, int | np.integer) and not isinstance(row, bool)
    if not is_number or not 0 <= row < study.cases * study.states:
        raise InputError("row", row, expected)
    case, state = divmod(int(row), study.states)
    rows, quantities = rows_of(study, case, state, state + 1)
    at = np.flatnonzero(rows.number == row)
    if not at.size:
        raise InputError("row", row, f"{expected}; this one is left out of it")
    return {
        name: x[at[0]].item() for name, x in table_of(study, rows, quantities).items()
    }


def table_of(
    study: Study, rows: States, quantities: Mapping[str, FloatArray]
) -> Columns:
    """Rows as a table: numbers, axes, and the quantities kept as tables."""
    table: Columns = {"row": rows.number}
    for name, index in rows.index.items():
        table[name] = np.array(study.axes.grid[name])[index]
    table |= rows.columns
    for output in study.outputs.values():
        if output.form == "table":
            values = quantities[output.quantity]
            table |= dict(zip(_columns_of(output), values.T, strict=True))
    shape = rows.number.shape
    return {name: np.broadcast_to(column, shape) for name, column in table.items()}


def _columns_of(output: Output) -> list[str]:
    """Names of the columns of a quantity in the table of rows."""
    return [f"{output.quantity}.{column}" for column in output.columns]


def _units_of_rows(study: Study) -> dict[str, str]:
    """Column of the rows of a study -> its unit."""
    units = {**study.axes.units, "time": "s"}
    for output in study.outputs.values():
        units |= dict.fromkeys(_columns_of(output), output.unit)
    return units


def merge(file: Path, reductions: Mapping[str, Reduction]) -> int:
    """Add the entries of a part to reductions.

    Returns:
        Its number of rows.

    Raises:
        FileFormatError: It cannot be read.
    """
    from pyarrow import ArrowException, parquet

    try:
        table = parquet.read_table(file)
        columns = {name: table[name].to_numpy() for name in table.column_names}
        count = int(table.schema.metadata[b"rows"])
        if table.schema.metadata[b"part"] != file.name.encode():
            raise ValueError("it is another part")
        for k, reduction in enumerate(reductions.values()):
            own = columns["output"] == k
            reduction.merge({name: values[own] for name, values in columns.items()})
    except (OSError, ArrowException, LookupError, ValueError, TypeError) as error:
        problem = f"is damaged ({error}); remove it, and it is computed again"
        raise FileFormatError(file, problem) from None
    return count


def part_names(study: Study) -> list[str]:
    """Name of the files of each part."""
    if not study.recordings:
        return [part_name(study, k, "") for k in range(count_parts(study))]
    paths = [study.folder / name for name in study.recordings]
    return [part_name(study, k, digest_of(path)) for k, path in enumerate(paths)]


def part_name(study: Study, number: int, digest: str) -> str:
    """Name of the files of a part: hashes of all that its rows depend on, its number.

    Args:
        study: The study.
        number: Of the part.
        digest: Of its recording; "" without one.
    """
    return f"{study.key}-{number:06}{digest}.parquet"


def digest_of(recording: Path) -> str:
    """A hash of a recording, for `part_name`; "" if it cannot be read."""
    try:
        with recording.open("rb") as stream:
            return f"-{hashlib.file_digest(stream, 'sha256').hexdigest()[:16]}"
    except OSError:  # said when it is computed
        return ""


def parquet_file(
    tables: Sequence[Columns],
    units: Mapping[str, str],
    repeated: Sequence[str] = (),
    compression: str = "snappy",
    **metadata: str,
) -> bytes:
    """Tables with the same columns, one below the other, as Parquet.

    Args:
        tables: Column -> values.
        units: Column -> its unit, for the metadata of its field.
        repeated: Columns with few different values, for a dictionary.
        compression: Of the columns.
        **metadata: Of the whole table.
    """
    import pyarrow
    from pyarrow import parquet

    whole = pyarrow.table({})
    if tables:
        whole = pyarrow.concat_tables([pyarrow.table(table) for table in tables])
    fields = [
        field.with_metadata({"unit": units[field.name]})
        if field.name in units
        else field
        for field in whole.schema
    ]
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(
        whole.cast(pyarrow.schema(fields, metadata=metadata)),
        sink,
        compression=compression,
        use_dictionary=[*repeated],
    )
    return bytes(sink.getvalue())
