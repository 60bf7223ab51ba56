"""Tables of joint motion: columns of CSV and Parquet files, read when they are needed."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, NamedTuple, NoReturn

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import FileFormatError, InputError, MissingDependencyError
from alpha5_model.files import PathLike, read_named
from alpha5_model.trajectory.motion import JOINTS, MotionWarning, Progress

PARQUET = (".parquet", ".pq")
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
#: Lines parsed between two reports of progress.
CHUNK = 50_000


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


def prefixes(
    names: Collection[str], suffixes: Sequence[str] = ("",), asked: str | None = None
) -> list[str]:
    """What stands before the names of the four arm joints, where all four are among these names."""
    joint, there = JOINTS[0], set(names)
    ends = [joint + suffix for suffix in suffixes]
    found = {name.removesuffix(end) for name in names for end in ends if name.endswith(end)}

    def whole(before: str) -> bool:
        return all(any(before + j + s in there for s in suffixes) for j in JOINTS[:4])

    return sorted(filter(whole, found if asked is None else {asked}))


def only(what: str, found: Sequence[str]) -> str:
    """The only one of some prefixes or topics; ``""`` if it is among them.

    Joints named exactly are the arm's, whatever else there is; only then prefixes count.

    Raises:
        InputError: There are several.
    """
    if "" in found:
        return ""
    if len(found) > 1:
        raise InputError(what, None, f"one of {', '.join(found)}: each has the joints of an arm")
    return found[0]


def seconds(whole: Iterable[int | None], per_second: int) -> FloatArray:
    """Times to the last digit; nanoseconds since 1970 do not fit a float, Python's numbers do."""
    return np.array([np.nan if x is None else x / per_second for x in whole])


def parquet_table(path: PathLike) -> Table:
    """A Parquet file; rows count from 1.

    Raises:
        MissingDependencyError: Without pyarrow.
        FileFormatError: No Parquet file, or, once they are read, columns that are no numbers.
    """
    try:
        from pyarrow import BufferReader, parquet, types
    except ImportError:
        remedy = "python -m pip install 'alpha5-model[parquet]'"
        raise MissingDependencyError("pyarrow", f"reading {path}", remedy) from None
    content = read_named(path, "a Parquet file of joint motion")

    def place(row: int, column: int) -> str:
        return f"row {row + 1} ({header[column]})"

    def numbers(column: Any) -> FloatArray:
        unit = getattr(column.type, "unit", None)
        if unit is None:
            return np.asarray(column.cast("float64").to_numpy())
        return seconds(column.cast("int64").to_pylist(), int(PER_SECOND[unit]))

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str | None]:
        names = [header[k] for k in (*needed, *efforts)]
        with _errors_of(path):
            data = file.read(names)
            table = np.stack([numbers(data[name]) for name in names], axis=1)
        for row, k in np.argwhere(~np.isfinite(table[:, : len(needed)])):
            problem = f"expected a finite number, got {table[row, k]:g}"
            raise FileFormatError(path, problem, place(int(row), needed[k]))
        return table, "s" if types.is_temporal(data[names[0]].type) else None

    with _errors_of(path):
        file = parquet.ParquetFile(BufferReader(content))
        header = file.schema_arrow.names
    return Table(header, read, place)


@contextmanager
def _errors_of(path: PathLike) -> Iterator[None]:
    try:
        yield
    except Exception as error:
        raise FileFormatError(path, f"cannot be read as a table of numbers: {error}") from None


def csv_table(path: PathLike, progress: Progress | None) -> Table:
    """A CSV file; lines and columns count from 1.

    Raises:
        FileFormatError: No table with column names, or, once they are read, what is no number.
    """
    lines = _lines(path)
    header = _header(path, lines[0])
    rows = np.flatnonzero([bool(line) for line in lines])[1:] if "" in lines else None

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, None]:
        table = None
        # With text among the efforts these are ignored, as other columns are.
        for used in ([*needed, *efforts], needed):
            with suppress(ValueError, csv.Error):
                table = _parse(lines, used, len(header), progress)
                break
        if table is None or not np.isfinite(table[:, : len(needed)]).all():
            _complain(path, lines, header, needed)
        return table, None

    def place(row: int, column: int) -> str:
        return _place(row + 2 if rows is None else int(rows[row]) + 1, column, header)

    return Table(header, read, place, "line 1")


def _lines(path: PathLike) -> list[str]:
    content = read_named(path, "a CSV file of joint motion (or Parquet, or a ROS bag)")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "is not UTF-8 text, a CSV file is expected") from None
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    lines = [line.strip() for line in text.rstrip().split("\n")]
    if not lines[0]:
        problem = "is empty" if len(lines) == 1 else "no column names in line 1"
        raise FileFormatError(path, problem, "line 1")
    return lines


def _fields(path: PathLike, line: str, number: int) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:  # a field of more than 131 072 characters
        problem = f"is not a table of numbers: {error}"
        raise FileFormatError(path, problem, f"line {number}") from None


def _header(path: PathLike, line: str) -> list[str]:
    if "," not in line:
        for separator, name in ((";", "';'"), ("\t", "a tab"), (" ", "a space")):
            if separator in line:
                problem = f"columns are separated by {name}, expected ','"
                raise FileFormatError(path, problem, "line 1")
    header = [name.strip() for name in _fields(path, line, 1)]
    if _number(header[0]) is not None:
        raise FileFormatError(path, "starts with numbers, expected column names", "line 1")
    for k, name in enumerate(header):
        if name and name in header[:k]:
            problem = f"column {name[:40]!r} stands twice"
            raise FileFormatError(path, problem, f"line 1, column {k + 1}")
    return header


def _parse(lines: list[str], used: list[int], width: int, progress: Progress | None) -> FloatArray:
    read = partial(np.loadtxt, delimiter=",", usecols=used, ndmin=2, comments=None, quotechar='"')
    blocks = []
    for start in range(1, len(lines), CHUNK):
        block = lines[start : start + CHUNK]
        filled = [line for line in block if line] if "" in block else block
        quoted = any('"' in line for line in filled)
        widths = map(len, csv.reader(filled)) if quoted else (x.count(",") + 1 for x in filled)
        if any(found != width for found in widths):
            raise ValueError
        if filled:
            blocks.append(read(filled))
        if progress:
            progress("read", min(start + CHUNK, len(lines)) / len(lines))
    return np.concatenate(blocks) if blocks else np.empty((0, len(used)))


def _complain(path: PathLike, lines: list[str], header: list[str], used: list[int]) -> NoReturn:
    """Find the first line that cannot be read, and say what is wrong with it."""
    for number, line in enumerate(lines[1:], start=2):
        if not line:
            continue
        fields = _fields(path, line, number)
        if len(fields) != len(header):
            problem = f"{len(fields)} fields, expected {len(header)} as in line 1"
            raise FileFormatError(path, problem, f"line {number}")
        for column in used:
            text = fields[column].strip()
            if (value := _number(text)) is None or not math.isfinite(value):
                problem = f"expected a finite number, got {text[:40]!r}"
                raise FileFormatError(path, problem, _place(number, column, header))
    raise FileFormatError(path, "cannot be read as a table of numbers")


def _place(line: int, column: int, header: list[str]) -> str:
    return f"line {line}, column {column + 1} ({header[column]})"


def _number(text: str) -> float | None:
    with suppress(ValueError):
        return float(text)
    return None
