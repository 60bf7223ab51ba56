"""Joint motion from Parquet files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.trajectory.file_table import (
    EXPANSION,
    PER_SECOND,
    FileTable,
    Problem,
    library,
    seconds,
)
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.lerobot_layout import LONGEST_LIST, list_names
from alpha5_model.trajectory.text_table import refuse_git_lfs_pointer

#: Any Parquet file may expand to this size [bytes], because equal rows take almost no
#: space in it.
_LEAST_EXPANSION = 100_000_000
#: The column of LeRobot's data sets that says which recording a row belongs to.
_EPISODE = "episode_index"
#: Episodes that a message lists.
_LISTED = 20


class _Source(NamedTuple):
    """Where the numbers of a column of the table are in the file.

    Attributes:
        column: Name of a column of the file.
        element: Which number of its lists; None if it has no lists.
    """

    column: str
    element: int | None


class ParquetTable(FileTable):
    """A Parquet file; rows count from 1.

    Each number of a column of lists of one length is a column of the table, as LeRobot
    writes a robot's state; see `alpha5_model.trajectory.lerobot_layout`.

    Raises:
        MissingDependencyError: pyarrow is not installed.
        FileFormatError: The file is not a Parquet file.
    """

    def __init__(
        self, path: PathLike, joints: JointMap, episode: int | None = None
    ) -> None:
        self._path = path
        self._episode = episode
        #: Rows of the file before those that are read.
        self._first_row = 0
        with library(path, "parquet"):
            from pyarrow import BufferReader, parquet

            content = read_named(path, "a Parquet file of joint motion")
            refuse_git_lfs_pointer(path, content)
            self._file = parquet.ParquetFile(BufferReader(content))
            self._largest = _LEAST_EXPANSION + EXPANSION * len(content)
            schema = self._file.schema_arrow
            names = list_names(path, schema.metadata, _lists(schema))

        self._columns = schema.names
        self._sources: list[_Source] = []
        header: list[str] = []
        for column in schema.names:
            elements = names.get(column)
            if elements is None:
                header.append(column)
                self._sources.append(_Source(column, element=None))
                continue
            header += elements
            self._sources += [_Source(column, k) for k in range(len(elements))]
        self.names = header
        self.header = joints.renamed(header)

    def read(self, columns: Sequence[int]) -> tuple[FloatArray, str | None]:
        """The numbers of some columns; see `FileTable.read`."""
        sources = [self._sources[column] for column in columns]
        names = [*dict.fromkeys(source.column for source in sources)]
        if _EPISODE in self._columns:
            names.append(_EPISODE)
        with library(self._path, "parquet"):
            from pyarrow import types

            self._check_expansion(names)
            table = self._file.read(names)
            table = self._rows_of_episode(table)
            self._check_lengths(table, sources)
            numbers = np.stack([_numbers(table, x) for x in sources], axis=1)

        time = table[sources[0].column]
        unit = "s" if types.is_temporal(time.type) else None
        return numbers, unit

    def problem(self, row: int, columns: Sequence[int]) -> Problem:
        """Why a number of a row cannot be used; see `FileTable.problem`."""
        numbers = self.read(columns)[0][row]
        wrong = int(np.argmin(np.isfinite(numbers)))
        text = f"expected a finite number, got {numbers[wrong]:g}"
        return Problem(self.place(row, columns[wrong]), text)

    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""
        return f"row {self._first_row + row + 1} ({self.names[column]})"

    def _check_lengths(self, table: Any, sources: list[_Source]) -> None:
        """Refuse lists that are shorter or longer than their names."""
        from pyarrow import compute

        for name in {x.column for x in sources if x.element is not None}:
            expected = sum(source.column == name for source in self._sources)
            lengths = compute.list_value_length(table[name]).unique().to_pylist()
            for length in lengths:
                if length != expected:
                    problem = f"a list of {length} numbers, expected {expected}"
                    raise FileFormatError(self._path, problem, name)

    def _rows_of_episode(self, table: Any) -> Any:
        """The rows of one recording: the time of each starts anew."""
        if _EPISODE not in table.column_names:
            if self._episode is not None:
                expected = f"no value: the file has no column {_EPISODE}"
                raise InputError("episode", self._episode, expected)
            return table

        every = table[_EPISODE].to_numpy()
        episodes = np.unique(every).tolist()
        listed = ", ".join(map(str, episodes[:_LISTED]))
        if len(episodes) > _LISTED:
            listed += f", ... {episodes[-1]}"
        if self._episode is None and len(episodes) > 1:
            problem = (
                f"holds {len(episodes)} episodes ({listed}): choose one by --episode "
                "(read_motion: episode=)"
            )
            raise FileFormatError(self._path, problem)
        if self._episode is None:
            return table
        rows = np.flatnonzero(every == self._episode)
        if not rows.size:
            raise InputError("episode", self._episode, f"one of {listed}")
        self._first_row = int(rows[0])
        return table.take(rows)

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
    as_numbers = 0
    for group_number in range(metadata.num_row_groups):
        group = metadata.row_group(group_number)
        for column_number in range(group.num_columns):
            column = group.column(column_number)
            path = column.path_in_schema
            # A column of lists has ``.list.element`` behind its name.
            if any(path == name or path.startswith(f"{name}.") for name in names):
                stated += column.total_uncompressed_size
                as_numbers += 8 * column.num_values

    as_numbers = max(as_numbers, 8 * metadata.num_rows * len(names))
    return int(max(stated, as_numbers))


def _lists(schema: Any) -> dict[str, int | None]:
    """Column -> how many numbers each of its lists has; None if its type does not say.

    Columns without lists of numbers are left out.
    """
    from pyarrow import types

    lists: dict[str, int | None] = {}
    for field in schema:
        kind = field.type
        fixed = types.is_fixed_size_list(kind)
        if not (fixed or types.is_list(kind)) or not types.is_floating(kind.value_type):
            continue
        if not fixed:
            lists[field.name] = None
        elif kind.list_size <= LONGEST_LIST:
            lists[field.name] = kind.list_size
    return lists


def _numbers(table: Any, source: _Source) -> FloatArray:
    """The numbers of a column, or of one place in each of its lists."""
    column = table[source.column]
    if source.element is None:
        return _float_column(column)
    from pyarrow import compute

    return _float_column(compute.list_element(column, source.element))


def _float_column(column: Any) -> FloatArray:
    """A column as numbers; times and durations in seconds."""
    unit = getattr(column.type, "unit", None)
    if unit is None:
        return np.asarray(column.cast("float64").to_numpy())
    return seconds(column.cast("int64").to_pylist(), int(PER_SECOND[unit]))
