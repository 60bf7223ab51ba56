"""Motion from a Parquet file: columns by name as in a CSV file, times also of Parquet's own types."""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError, MissingDependencyError
from alpha5_model.files import PathLike, read_named
from alpha5_model.trajectory.columns import PER_SECOND, find_columns, table_motion
from alpha5_model.trajectory.motion import Motion, Place

SUFFIXES = (".parquet", ".pq")


def read_parquet(path: PathLike, prefix: str | None) -> tuple[Motion, Place]:
    """Motion, still to be checked, and where its numbers stand; see `read_motion`. Rows count from 1."""
    try:
        from pyarrow import BufferReader, parquet, types
    except ImportError:
        remedy = "python -m pip install 'alpha5-model[parquet]'"
        raise MissingDependencyError("pyarrow", f"reading {path}", remedy) from None
    content = read_named(path, "a Parquet file of joint motion")
    try:
        file = parquet.ParquetFile(BufferReader(content))
        columns = find_columns(path, file.schema_arrow.names, prefix)
        data = file.read([columns.header[k] for k in columns.used])
        table = np.stack([_numbers(data[columns.header[k]]) for k in columns.used], axis=1)
        typed = types.is_temporal(data[columns.header[columns.needed[0]]].type)
    except Alpha5Error:
        raise
    except Exception as error:  # of the file, or of a column
        raise FileFormatError(path, f"cannot be read as a table of numbers: {error}") from None

    def place(row: int, column: int) -> str:
        return f"row {row + 1} ({columns.header[column]})"

    for row, k in np.argwhere(~np.isfinite(table[:, : len(columns.needed)])):
        problem = f"expected a finite number, got {table[row, k]:g}"
        raise FileFormatError(path, problem, place(int(row), columns.needed[k]))
    return table_motion(path, columns, table, place, "s" if typed else None)


def _numbers(column: Any) -> FloatArray:
    """A column as float64, null as NaN; times in seconds, to the last digit."""
    unit = getattr(column.type, "unit", None)
    if unit is None:
        return np.asarray(column.cast("float64").to_numpy())
    # Python divides whole numbers to the last digit; nanoseconds since 1970 do not fit a float.
    per_second = int(PER_SECOND[unit])
    return np.array(
        [np.nan if x is None else x / per_second for x in column.cast("int64").to_pylist()]
    )
