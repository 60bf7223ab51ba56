"""Joint motion from CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from contextlib import suppress

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.file_table import FileTable, Progress

#: Lines parsed between two reports of progress.
CHUNK = 50_000
#: Separators that other programs write, and their names in messages.
_OTHER_SEPARATORS = {";": "';'", "\t": "a tab", " ": "a space"}


class CsvTable(FileTable):
    """A CSV file; lines and columns count from 1, blank lines are skipped.

    Raises:
        FileFormatError: The file is not a table with column names.
    """

    head = "line 1"

    def __init__(self, path: PathLike, progress: Progress | None) -> None:
        every_line = _lines_of(path)
        if not every_line[0]:
            empty = len(every_line) == 1
            problem = "is empty" if empty else "no column names in line 1"
            raise FileFormatError(path, problem, "line 1")

        self._path = path
        self._progress = progress
        self._lines = [line for line in every_line if line]
        self._line_numbers = [k for k, line in enumerate(every_line, 1) if line]
        self.header = _header(path, self._lines[0])

    def read(self, needed: list[int], efforts: list[int]) -> tuple[FloatArray, None]:
        """The numbers of some columns; see `FileTable.read`."""
        # Efforts that hold text are ignored, as other columns are.
        for used in ([*needed, *efforts], needed):
            with suppress(ValueError, csv.Error):
                numbers = self._parsed(used)
                if np.isfinite(numbers[:, : len(needed)]).all():
                    return numbers, None

        raise self._problem(needed)

    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""
        line = self._line_numbers[row + 1]
        return f"line {line}, column {column + 1} ({self.header[column]})"

    def _parsed(self, used: list[int]) -> FloatArray:
        """The numbers of some columns, (N, k).

        Raises:
            ValueError: A line of another length, or something that is no number.
            csv.Error: A line that is no CSV.
        """
        count = len(self._lines)
        blocks = [np.empty((0, len(used)))]
        for start in range(0, count, CHUNK):
            end = start + CHUNK
            block = self._lines[max(1, start) : end]  # without the header
            if any(width != len(self.header) for width in _widths(block)):
                raise ValueError
            if block:
                blocks.append(_block_numbers(block, used))
            if self._progress:
                self._progress("read", min(end, count) / count)
        return np.concatenate(blocks)

    def _problem(self, needed: list[int]) -> FileFormatError:
        """The error about the first line that cannot be read."""
        for row in range(len(self._lines) - 1):
            problem = self._row_problem(row, needed)
            if problem is not None:
                return problem
        return FileFormatError(self._path, "cannot be read as a table of numbers")

    def _row_problem(self, row: int, needed: list[int]) -> FileFormatError | None:
        """The error about a row; None if it can be read."""
        line = f"line {self._line_numbers[row + 1]}"
        fields = _fields(self._path, self._lines[row + 1], line)
        width = len(self.header)
        if len(fields) != width:
            problem = f"{len(fields)} fields, expected {width} as in line 1"
            return FileFormatError(self._path, problem, line)

        for column in needed:
            text = fields[column]
            if not _is_finite(text):
                problem = f"expected a finite number, got {text[:40]!r}"
                return FileFormatError(self._path, problem, self.place(row, column))
        return None


def _lines_of(path: PathLike) -> list[str]:
    """All lines of a text file without the blanks around them."""
    content = read_named(path, "a CSV file of joint motion (or Parquet, or a ROS bag)")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        problem = "is not UTF-8 text, a CSV file is expected"
        raise FileFormatError(path, problem) from None

    text = text.rstrip().replace("\r\n", "\n").replace("\r", "\n")
    return [line.strip() for line in text.split("\n")]


def _header(path: PathLike, line: str) -> list[str]:
    """The names of the columns in the first line.

    Raises:
        FileFormatError: Another separator, numbers for names, or a name that repeats.
    """
    for separator, name in _OTHER_SEPARATORS.items():
        if separator in line and "," not in line:
            problem = f"columns are separated by {name}, expected ','"
            raise FileFormatError(path, problem, "line 1")

    header = _fields(path, line, "line 1")
    if _is_number(header[0]):
        problem = "starts with numbers, expected column names"
        raise FileFormatError(path, problem, "line 1")

    seen: set[str] = set()
    for column, name in enumerate(header, start=1):
        if name and name in seen:
            problem = f"column {name[:40]!r} stands twice"
            raise FileFormatError(path, problem, f"line 1, column {column}")
        seen.add(name)
    return header


def _fields(path: PathLike, line: str, place: str) -> list[str]:
    """The texts between the commas of a line."""
    try:
        return [text.strip() for text in next(csv.reader([line]))]
    except csv.Error as error:  # a field of more than 131 072 characters
        problem = f"is not a table of numbers: {error}"
        raise FileFormatError(path, problem, place) from None


def _widths(lines: list[str]) -> Iterable[int]:
    """Number of fields in each line."""
    if any('"' in line for line in lines):
        return map(len, csv.reader(lines))
    return (line.count(",") + 1 for line in lines)


def _block_numbers(lines: list[str], used: list[int]) -> FloatArray:
    """The numbers of some columns of some lines, (N, k)."""
    return np.loadtxt(
        lines, delimiter=",", comments=None, quotechar='"', usecols=used, ndmin=2
    )


def _is_number(text: str) -> bool:
    """Whether a text is a number, finite or not."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _is_finite(text: str) -> bool:
    """Whether a text is a finite number."""
    return _is_number(text) and math.isfinite(float(text))
