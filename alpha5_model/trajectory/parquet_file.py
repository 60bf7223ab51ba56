"""Joint motion from Parquet files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.trajectory.column_names import JOINT_COLUMNS, with_columns_of_joints
from alpha5_model.trajectory.tables import (
    EXPANSION,
    PER_SECOND,
    Problem,
    Table,
    library,
    refuse_expansion,
    refuse_git_lfs_pointer,
    seconds,
)

#: Any Parquet file may expand to this size [bytes], because equal rows take almost no
#: space in it.
_LEAST_EXPANSION = 100_000_000
#: The column of LeRobot's data sets that says which recording a row belongs to.
_EPISODE = "episode_index"
#: The column with the robot's state; ``meta/info.json`` of the data set names its
#: numbers. Of the largest one that is read [bytes].
_STATE = "observation.state"
_MOST_INFO = 1_000_000
#: Episodes that a message lists.
_LISTED = 20


def read_parquet(path: PathLike, episode: int | None = None) -> Table:
    """A Parquet file as a table; rows count from 1.

    Each number of a column of lists is a column, ``observation.state[0]`` and so on.

    Args:
        path: The file.
        episode: Number of the recording, of a file with several.

    Raises:
        InputError: No such episode, or an episode of a file without.
        MissingFileError: No such file.
        MissingDependencyError: pyarrow is not installed.
        FileFormatError: No Parquet file, no numbers, several episodes, or one that
            expands to more than 100 times its size.
    """
    with library(path, "parquet"):
        from pyarrow import BufferReader, parquet, types

        content = read_named(path, "a Parquet file of joint motion")
        refuse_git_lfs_pointer(path, content)
        file = parquet.ParquetFile(BufferReader(content))
        wanted = [
            field.name
            for field in file.schema_arrow
            if _is_numeric(field.type) or field.name.lower() in JOINT_COLUMNS
        ]
        if not wanted:
            got = ", ".join(file.schema_arrow.names)[:200]
            text = f"no column holds numbers (convert its texts): got {got}"
            raise FileFormatError(path, text)
        most = _LEAST_EXPANSION + EXPANSION * len(content)
        refuse_expansion(path, _expanded_size(file.metadata, wanted), most)
        rows, first_row = _rows_of_episode(path, file.read(wanted), episode)

        header: list[str] = []
        parts: list[FloatArray] = []
        in_seconds = []
        for name in rows.column_names:
            column = rows[name].combine_chunks()
            if types.is_temporal(column.type):
                in_seconds.append(len(header))
            numbers, names = _numbers(path, name, column)
            parts.append(numbers)
            header += names
        values = np.concatenate(parts or [np.empty((len(rows), 0))], axis=1)
        values[~np.isfinite(values)] = np.nan

    def place(row: int, column: int) -> str:
        return f"row {first_row + row + 1} ({header[column]})"

    def problem(row: int, columns: Sequence[int]) -> Problem:
        wrong = next(k for k in columns if np.isnan(values[row, k]))
        return Problem(place(row, wrong), "expected a finite number, got none")

    table = Table(
        header=header,
        values=values,
        place=place,
        problem=problem,
        in_seconds=frozenset(in_seconds),
        ignored=tuple(x for x in file.schema_arrow.names if x not in wanted),
    )
    joint = [k for k, name in enumerate(header) if name.lower() in JOINT_COLUMNS]
    if len(joint) != 1:
        return table
    joints = [str(x) for x in rows[header[joint[0]]].to_pylist()]
    return with_columns_of_joints(table, joint[0], joints)


def _is_numeric(kind: Any) -> bool:
    """Whether a type holds numbers, times, or lists of numbers."""
    from pyarrow import types

    if types.is_list(kind) or types.is_fixed_size_list(kind):
        return bool(types.is_floating(kind.value_type))
    numeric = (
        types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind)
    )
    return bool(numeric or types.is_temporal(kind))


def _numbers(path: PathLike, name: str, column: Any) -> tuple[FloatArray, list[str]]:
    """The numbers of a column, (N, k), and their names; NaN for texts."""
    from pyarrow import compute, types

    kind = column.type
    if types.is_list(kind) or types.is_fixed_size_list(kind):
        lengths = compute.list_value_length(column).unique().to_pylist()
        if len(lengths) != 1 or not lengths[0]:
            problem = f"lists of {lengths[:5]} numbers, expected one length"
            raise FileFormatError(path, problem, name)
        flat = compute.list_flatten(column).cast("float64")
        numbers = np.array(flat.to_numpy(zero_copy_only=False))
        return numbers.reshape(len(column), -1), _names_of_list(path, name, lengths[0])
    if types.is_temporal(kind):
        unit = getattr(kind, "unit", None)
        if unit is None:
            return np.full((len(column), 1), np.nan), [name]
        whole = column.cast("int64").to_pylist()
        return seconds(whole, int(PER_SECOND[unit]))[:, None], [name]
    if not _is_numeric(kind):
        return np.full((len(column), 1), np.nan), [name]
    # Whole nanoseconds since 1970 are rounded, as in a CSV.
    numbers = column.cast("float64", safe=False).to_numpy(zero_copy_only=False)
    return np.array(numbers, dtype=float)[:, None], [name]


def _names_of_list(path: PathLike, column: str, count: int) -> list[str]:
    """Names of the numbers in a column of lists: its number, or the data set's name."""
    if column == _STATE:
        # A file is in ``data/chunk-000/`` of its data set.
        for folder in Path(path).absolute().parents[:3]:
            with suppress(Alpha5Error, ValueError, KeyError, TypeError, RecursionError):
                file = folder / "meta" / "info.json"
                info = json.loads(read_named(file, "a data set's info", _MOST_INFO))
                names = info["features"][_STATE]["names"]
                if len(names) == count and all(isinstance(x, str) for x in names):
                    return [*names]
    return [f"{column}[{k}]" for k in range(count)]


def _rows_of_episode(
    path: PathLike, table: Any, episode: int | None
) -> tuple[Any, int]:
    """The rows of one recording, whose times start anew, and the number of the first.

    Raises:
        InputError: No such episode.
        FileFormatError: Several episodes to choose from.
    """
    if _EPISODE not in table.column_names:
        if episode is not None:
            expected = f"no value: the file has no column {_EPISODE}"
            raise InputError("episode", episode, expected)
        return table, 0

    every = table[_EPISODE].to_numpy()
    episodes = np.unique(every).tolist()
    listed = ", ".join(map(str, episodes[:_LISTED]))
    if len(episodes) > _LISTED:
        listed += f", ... {episodes[-1]}"
    if episode is None:
        if len(episodes) > 1:
            problem = (
                f"holds {len(episodes)} episodes ({listed}): choose one by --episode "
                "(read_motion: episode=)"
            )
            raise FileFormatError(path, problem)
        return table, 0
    rows = np.flatnonzero(every == episode)
    if not rows.size:
        raise InputError("episode", episode, f"one of {listed}")
    return table.take(rows), int(rows[0])


def _expanded_size(metadata: Any, names: list[str]) -> int:
    """Bytes of some columns: as the file states them, or as numbers if that is more."""
    stated = 0
    as_numbers = 0
    wanted = {*names}
    for group_number in range(metadata.num_row_groups):
        group = metadata.row_group(group_number)
        for column_number in range(group.num_columns):
            column = group.column(column_number)
            path = column.path_in_schema
            # A column of lists has ``.list.element`` behind its name.
            if path in wanted or path.rsplit(".", 2)[0] in wanted:
                stated += column.total_uncompressed_size
                as_numbers += 8 * column.num_values
    as_numbers = max(as_numbers, 8 * metadata.num_rows * len(names))
    return int(max(stated, as_numbers))
