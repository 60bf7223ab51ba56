"""Tables of joint motion: columns of CSV and Parquet files, read when they are needed."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import compress
from typing import Any, NamedTuple

import numpy as np

from alpha5_model import errors
from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.numbers.tables import JOINT_NAMES

#: Base to tip; the first four are the arm, the last is the jaw rod, which a motion may leave out.
JOINTS = JOINT_NAMES
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
#: Lines of CSV parsed between two reports of progress.
CHUNK = 50_000
#: A bag or Parquet file may expand to this many times its size. Joint states of an arm at rest,
#: compressed by zstd, expand to 10 times.
EXPANSION = 100
#: What any Parquet file may expand to [bytes]: equal rows take next to no room in one.
LEAST_PARQUET = 100_000_000
#: (stage, part done, 0 to 1)
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class MotionWarning:
    """Something odd in a motion that does not stop the computation.

    Attributes:
        kind: ``"repeated_time"``, ``"gap"``, ``"jump"``, ``"outside_limits"``, ``"velocity"``,
            ``"effort"``, ``"time_unit"``, ``"time_column"`` or ``"command"``; of a bag also ``"missing_joints"``,
            ``"not_finite"``, ``"no_stamp"``, ``"out_of_order"`` or ``"publishers"``.
        count: How often.
        first: Where it happens first.
        text: What it is, and what is done about it.
    """

    kind: str
    count: int
    first: str
    text: str

    def __str__(self) -> str:
        return f"{self.text}: {self.count} x, first: {self.first}"


class Table(NamedTuple):
    """What any file of joint motion is read as.

    Attributes:
        header: Names of all columns; see `read_motion`.
        read: (columns that must be finite, the time first; columns of efforts) -> their numbers,
            (N, k), without efforts if these are no numbers; and the unit of the time if the file's
            format says it, else None.
        place: (row, column) -> words, for messages.
        head: Where the names stand in the file, for messages.
        warnings: What was found odd so far.
        ignored: What is not a column and not used either.
    """

    header: Sequence[str]
    read: Callable[[list[int], list[int]], tuple[FloatArray, str | None]]
    place: Callable[[int, int], str]
    head: str = ""
    warnings: tuple[MotionWarning, ...] = ()
    ignored: tuple[str, ...] = ()


def only(what: str, found: Sequence[str]) -> str:
    """The only one of some prefixes or topics; ``""`` if it is among them.

    Joints named exactly are the arm's, whatever else there is; only then prefixes count.

    Raises:
        InputError: There are several.
    """
    if len(found) > 1 and "" not in found:
        expected = f"one of {', '.join(found)}: each has the joints of an arm"
        raise errors.InputError(what, None, expected)
    return min(found)


def parquet_table(path: PathLike) -> Table:
    """A Parquet file; rows count from 1.

    Raises:
        MissingDependencyError: Without pyarrow.
        FileFormatError: No Parquet file, or, once they are read, columns that are no numbers.
    """
    with library(path, "parquet"):
        from pyarrow import BufferReader, parquet, types

        content = read_named(path, "a Parquet file of joint motion")
        file = parquet.ParquetFile(BufferReader(content))
        header = file.schema_arrow.names

    def place(row: int, column: int) -> str:
        return f"row {row + 1} ({header[column]})"

    def numbers(column: Any) -> FloatArray:
        unit = getattr(column.type, "unit", None)
        if unit is None:
            return np.asarray(column.cast("float64").to_numpy())
        return seconds(column.cast("int64").to_pylist(), int(PER_SECOND[unit]))

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str | None]:
        names = [header[k] for k in (*needed, *efforts)]
        most = LEAST_PARQUET + EXPANSION * len(content)
        if _expanded(file.metadata, names) > most:
            problem = (
                f"expands to more than {most / 1e6:.3g} MB, {EXPANSION} times its size"
            )
            raise errors.FileFormatError(path, problem)
        with library(path, "parquet"):
            data = file.read(names)
            table = np.stack([numbers(data[name]) for name in names], axis=1)
        for row, k in np.argwhere(~np.isfinite(table[:, : len(needed)])):
            problem = f"expected a finite number, got {table[row, k]:g}"
            raise errors.FileFormatError(path, problem, place(int(row), needed[k]))
        return table, "s" if types.is_temporal(data[names[0]].type) else None

    return Table(header, read, place)


def _expanded(metadata: Any, names: list[str]) -> int:
    """Bytes that columns of a Parquet file take, as numbers and as it states itself."""
    stated = 0
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        columns = (group.column(k) for k in range(group.num_columns))
        stated += sum(
            x.total_uncompressed_size for x in columns if x.path_in_schema in names
        )
    return int(max(stated, 8 * metadata.num_rows * len(names)))


@contextmanager
def library(path: PathLike, extra: str) -> Iterator[None]:
    """What a library raises, or its lack, as an error about the file."""
    try:
        with errors.needing(
            f"reading {path}", f"python -m pip install 'alpha5-model[{extra}]'"
        ):
            yield
    except errors.Alpha5Error:
        raise
    except Exception as error:  # whatever a damaged file makes it raise
        problem = f"cannot be read as a table of numbers: {error}"
        if extra == "bags":
            problem = f"cannot be read as a ROS bag ({type(error).__name__}: {error}); if it was "
            problem += "cut off: rosbag reindex, ros2 bag reindex or mcap recover"
        raise errors.FileFormatError(path, problem) from None


def seconds(whole: Iterable[int | None], per_second: int) -> FloatArray:
    """Times to the last digit; nanoseconds since 1970 do not fit a float, Python's numbers do."""
    return np.array([np.nan if x is None else x / per_second for x in whole])


def csv_table(path: PathLike, progress: Progress | None) -> Table:
    """A CSV file; lines and columns count from 1.

    Raises:
        FileFormatError: No table with column names, or, once they are read, what is no number.
    """
    content = read_named(path, "a CSV file of joint motion (or Parquet, or a ROS bag)")
    try:
        text = (
            content.decode("utf-8-sig")
            .rstrip()
            .replace("\r\n", "\n")
            .replace("\r", "\n")
        )
    except UnicodeDecodeError:
        raise errors.FileFormatError(
            path, "is not UTF-8 text, a CSV file is expected"
        ) from None
    every = [line.strip() for line in text.split("\n")]
    if not every[0]:
        problem = "is empty" if len(every) == 1 else "no column names in line 1"
        raise errors.FileFormatError(path, problem, "line 1")
    lines, numbers = (
        [*filter(None, every)],
        [*compress(range(1, len(every) + 1), every)],
    )
    header = _header(path, lines[0])

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, None]:
        # With text among the efforts these are ignored, as other columns are.
        for used in ([*needed, *efforts], needed):
            with suppress(ValueError, csv.Error):
                table = _parse(lines, used, len(header), progress)
                if np.isfinite(table[:, : len(needed)]).all():
                    return table, None
        for row, line in enumerate(lines[1:]):  # which one cannot be read, and why
            number = f"line {numbers[row + 1]}"
            fields = _fields(path, line, number)
            if len(fields) != len(header):
                problem = f"{len(fields)} fields, expected {len(header)} as in line 1"
                raise errors.FileFormatError(path, problem, number)
            for column in needed:
                value = _number(fields[column])
                if value is None or not math.isfinite(value):
                    problem = f"expected a finite number, got {fields[column][:40]!r}"
                    raise errors.FileFormatError(path, problem, place(row, column))
        raise errors.FileFormatError(path, "cannot be read as a table of numbers")

    def place(row: int, column: int) -> str:
        return f"line {numbers[row + 1]}, column {column + 1} ({header[column]})"

    return Table(header, read, place, "line 1")


def _fields(path: PathLike, line: str, place: str) -> list[str]:
    try:
        return [text.strip() for text in next(csv.reader([line]))]
    except csv.Error as error:  # a field of more than 131 072 characters
        raise errors.FileFormatError(
            path, f"is not a table of numbers: {error}", place
        ) from None


def _header(path: PathLike, line: str) -> list[str]:
    others = {";": "';'", "\t": "a tab", " ": "a space"}.items()
    if found := [
        name for separator, name in others if separator in line and "," not in line
    ]:
        problem = f"columns are separated by {found[0]}, expected ','"
        raise errors.FileFormatError(path, problem, "line 1")
    header = _fields(path, line, "line 1")
    if _number(header[0]) is not None:
        raise errors.FileFormatError(
            path, "starts with numbers, expected column names", "line 1"
        )
    seen: set[str] = set()
    for k, name in enumerate(header):
        if name and name in seen:
            problem = f"column {name[:40]!r} stands twice"
            raise errors.FileFormatError(path, problem, f"line 1, column {k + 1}")
        seen.add(name)
    return header


def _parse(
    lines: list[str], used: list[int], width: int, progress: Progress | None
) -> FloatArray:
    blocks = [np.empty((0, len(used)))]
    for start in range(0, len(lines), CHUNK):
        block = lines[max(1, start) : start + CHUNK]
        quoted = any('"' in line for line in block)
        widths = (
            map(len, csv.reader(block)) if quoted else (x.count(",") + 1 for x in block)
        )
        if any(found != width for found in widths):
            raise ValueError
        if block:
            how: dict[str, Any] = {"delimiter": ",", "comments": None, "quotechar": '"'}
            blocks.append(np.loadtxt(block, usecols=used, ndmin=2, **how))
        if progress:
            progress("read", min(start + CHUNK, len(lines)) / len(lines))
    return np.concatenate(blocks)


def _number(text: str) -> float | None:
    with suppress(ValueError):
        return float(text)
    return None
