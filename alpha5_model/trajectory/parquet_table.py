"""Joint motion from Parquet files."""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.file_table import (
    EXPANSION,
    PER_SECOND,
    FileTable,
    library,
    seconds,
)
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.text_table import refuse_git_lfs_pointer

#: Any Parquet file may expand to this size [bytes], because equal rows take almost no
#: space in it.
_LEAST_EXPANSION = 100_000_000


class ParquetTable(FileTable):
    """A Parquet file; rows count from 1.

    Raises:
        MissingDependencyError: pyarrow is not installed.
        FileFormatError: The file is not a Parquet file.
    """

    def __init__(self, path: PathLike, joints: JointMap) -> None:
        self._path = path
        with library(path, "parquet"):
            from pyarrow import BufferReader, parquet

            content = read_named(path, "a Parquet file of joint motion")
            refuse_git_lfs_pointer(path, content)
            self._file = parquet.ParquetFile(BufferReader(content))
            self._largest = _LEAST_EXPANSION + EXPANSION * len(content)
            self._names = self._file.schema_arrow.names
            self.header = joints.renamed(self._names)

    def read(
        self, needed: list[int], efforts: list[int]
    ) -> tuple[FloatArray, str | None]:
        """The numbers of some columns; see `FileTable.read`."""
        names = [self._names[column] for column in (*needed, *efforts)]
        with library(self._path, "parquet"):
            from pyarrow import types

            self._check_expansion(names)
            table = self._file.read(names)
            columns = [_float_column(table[name]) for name in names]
            numbers = np.stack(columns, axis=1)

        self._check_finite(numbers, needed)
        time = table[names[0]]
        unit = "s" if types.is_temporal(time.type) else None
        return numbers, unit

    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""
        return f"row {row + 1} ({self.header[column]})"

    def _check_finite(self, numbers: FloatArray, needed: list[int]) -> None:
        """Refuse needed columns with something that is no finite number."""
        not_finite = np.argwhere(~np.isfinite(numbers[:, : len(needed)]))
        if not_finite.size:
            row, k = not_finite[0].tolist()
            problem = f"expected a finite number, got {numbers[row, k]:g}"
            place = self.place(row, needed[k])
            raise FileFormatError(self._path, problem, place)

    def _check_expansion(self, names: list[str]) -> None:
        """Refuse columns that take far more memory than the file does.

        Raises:
            FileFormatError: They expand to more than is allowed.
        """
        if _expanded_size(self._file.metadata, names) > self._largest:
            most = f"{self._largest / 1e6:.3g} MB, {EXPANSION} times its size"
            raise FileFormatError(self._path, f"expands to more than {most}")


def _expanded_size(metadata: Any, names: list[str]) -> int:
    """Bytes of some columns: as the file states them, or as numbers if that is more."""
    stated = 0
    for group_number in range(metadata.num_row_groups):
        group = metadata.row_group(group_number)
        for column_number in range(group.num_columns):
            column = group.column(column_number)
            if column.path_in_schema in names:
                stated += column.total_uncompressed_size

    as_numbers = 8 * metadata.num_rows * len(names)
    return int(max(stated, as_numbers))


def _float_column(column: Any) -> FloatArray:
    """A column as numbers; times and durations in seconds."""
    unit = getattr(column.type, "unit", None)
    if unit is None:
        return np.asarray(column.cast("float64").to_numpy())
    return seconds(column.cast("int64").to_pylist(), int(PER_SECOND[unit]))
