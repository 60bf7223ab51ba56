"""Motion from a Parquet file: columns by name as in a CSV file, times also of Parquet's own types."""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError, MissingDependencyError
from alpha5_model.files import PathLike, read_named
from alpha5_model.trajectory.columns import PER_SECOND, table_motion
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

    def place(row: int, column: int) -> str:
        return f"row {row + 1} ({header[column]})"

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str | None]:
        names = [header[k] for k in (*needed, *efforts)]
        data = file.read(names)
        table = np.stack([_numbers(data[name]) for name in names], axis=1)
        for row, k in np.argwhere(~np.isfinite(table[:, : len(needed)])):
            problem = f"expected a finite number, got {table[row, k]:g}"
            raise FileFormatError(path, problem, place(int(row), needed[k]))
        return table, "s" if types.is_temporal(data[names[0]].type) else None

    try:
        file = parquet.ParquetFile(BufferReader(content))
        header = file.schema_arrow.names
        return table_motion(path, header, read, place, prefix)
    except Alpha5Error:
        raise
    except Exception as error:  # of the file, or of a column
        raise FileFormatError(path, f"cannot be read as a table of numbers: {error}") from None


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
