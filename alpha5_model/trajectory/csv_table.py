"""Joint motion from CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import chain
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.file_table import CHUNK, FileTable, Progress
from alpha5_model.trajectory.iso_times import is_iso_time, iso_seconds
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.ros_columns import joint_name_columns, with_joint_names
from alpha5_model.trajectory.text_table import fields, is_number, text_table, widths
from alpha5_model.trajectory.warning import MotionWarning

#: One of so many rows may be bad; one of fewer may be, too.
_ROWS_FOR_A_BAD_ONE = 100


class CsvTable(FileTable):
    """A CSV file; lines and columns count from 1.

    `alpha5_model.trajectory.text_table` says which forms of it can be read. A row that
    cannot be read is left out with a warning, up to one in a hundred.

    Raises:
        FileFormatError: The file is not a table with column names.
    """

    def __init__(
        self, path: PathLike, joints: JointMap, progress: Progress | None
    ) -> None:
        content = read_named(path, "a CSV file of joint motion (or Parquet, or a bag)")
        table = text_table(path, content)
        self._path = path
        self._progress = progress
        self._rows = table.rows
        self._line_numbers = table.line_numbers
        self._separator = table.separator
        #: The column with dates for times; None if its times are numbers.
        self._dates: int | None = None

        self.head = f"line {table.head}"
        #: Column -> the joint's name that each of its rows has.
        self._joint_names: dict[int, str] = {}
        self.header = joints.renamed(self._named(table.names))
        _refuse_doubled(path, self.header, self.head)

    def read(
        self, needed: list[int], optional: Sequence[list[int]]
    ) -> tuple[FloatArray, str | None]:
        """The numbers of some columns; see `FileTable.read`."""
        if self._has_dates(needed[0]):
            self._dates = needed[0]

        numbers = self._numbers(needed, optional)
        if numbers is None:
            self._leave_out_bad_rows(needed)
            numbers = self._numbers(needed, optional)
        if numbers is None:
            problem = "cannot be read as a table of numbers"
            raise FileFormatError(self._path, problem)
        return numbers, None if self._dates is None else "s"

    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""
        line = self._line_numbers[row]
        return f"line {line}, column {column + 1} ({self.header[column]})"

    def _named(self, header: list[str]) -> list[str]:
        """The names of the columns, with the joints' names that stand in the rows."""
        columns = joint_name_columns(header).values()
        if not columns or not self._rows:
            return header
        with suppress(csv.Error):
            first = fields(self._rows[0], self._separator)
            if len(first) == len(header):
                self._joint_names = {column: first[column] for column in columns}
                return with_joint_names(header, first)
        return header

    def _has_dates(self, time: int) -> bool:
        """Whether the first time that can be read is a date."""
        for line in self._rows:
            texts = line.split(self._separator, time + 1)
            text = texts[time].strip(' "') if time < len(texts) else ""
            if is_number(text):
                return False
            if is_iso_time(text):
                return True
        return False

    def _numbers(
        self, needed: list[int], optional: Sequence[list[int]]
    ) -> FloatArray | None:
        """The numbers of some columns, (N, k); None if a row cannot be read.

        Groups of optional columns that hold text are ignored, as other columns are.
        """
        for groups in range(len(optional), -1, -1):
            used = [*needed, *chain.from_iterable(optional[:groups])]
            with suppress(ValueError, csv.Error):
                numbers = self._parsed(used)
                if np.isfinite(numbers[:, : len(needed)]).all():
                    return numbers
        return None

    def _parsed(self, used: list[int]) -> FloatArray:
        """The numbers of some columns, (N, k).

        Raises:
            ValueError: A line of another length, or something that is no number.
            csv.Error: A line that is no CSV.
        """
        count = len(self._rows)
        blocks = [np.empty((0, len(used)))]
        for start in range(0, count, CHUNK):
            end = start + CHUNK
            block = self._rows[start:end]
            expected = len(self.header)
            if any(width != expected for width in widths(block, self._separator)):
                raise ValueError
            if not self._same_joints(block):
                raise ValueError
            blocks.append(self._block_numbers(block, used))
            if self._progress:
                self._progress("read", min(end, count) / count)
        return np.concatenate(blocks)

    def _same_joints(self, lines: list[str]) -> bool:
        """Whether each line has the joints' names of the first one.

        Raises:
            csv.Error: A line that is no CSV.
        """
        if not self._joint_names:
            return True
        expected = [*self._joint_names.values()]
        return all(
            [texts[column].strip() for column in self._joint_names] == expected
            for texts in csv.reader(lines, delimiter=self._separator)
        )

    def _block_numbers(self, lines: list[str], used: list[int]) -> FloatArray:
        """The numbers of some columns of some lines, (N, k)."""
        dates: dict[int | str, Callable[[str], float]] | None = None
        if self._dates is not None:
            dates = {self._dates: iso_seconds}
        return np.loadtxt(
            lines,
            delimiter=self._separator,
            comments=None,
            quotechar='"',
            usecols=used,
            ndmin=2,
            converters=dates,
            encoding=None,
        )

    def _leave_out_bad_rows(self, needed: list[int]) -> None:
        """Leave out the rows that cannot be read, with a warning.

        Raises:
            FileFormatError: There are too many of them; it is about the first.
        """
        allowed = max(1, len(self._rows) // _ROWS_FOR_A_BAD_ONE)
        problems: dict[int, _Problem] = {}
        for row in range(len(self._rows)):
            problem = self._row_problem(row, needed)
            if problem is not None:
                problems[row] = problem
            if len(problems) > allowed:
                break
        if not problems:
            return

        first = next(iter(problems.values()))
        if len(problems) > allowed:
            raise FileFormatError(self._path, first.text, first.place)
        warning = MotionWarning(
            kind="bad_row",
            count=len(problems),
            first=first.place,
            text=f"row left out ({first.text})",
        )
        self.warnings = (*self.warnings, warning)
        kept = [row for row in range(len(self._rows)) if row not in problems]
        self._rows = [self._rows[row] for row in kept]
        self._line_numbers = [self._line_numbers[row] for row in kept]

    def _row_problem(self, row: int, needed: list[int]) -> _Problem | None:
        """Why a row cannot be read; None if it can."""
        line = f"line {self._line_numbers[row]}"
        try:
            texts = fields(self._rows[row], self._separator)
        except csv.Error as error:
            return _Problem(line, f"is not a table of numbers: {error}")
        width = len(self.header)
        if len(texts) != width:
            text = f"{len(texts)} fields, expected {width} as in {self.head}"
            return _Problem(line, text)

        for column, joint in self._joint_names.items():
            if texts[column] != joint:
                text = f"expected {joint[:40]!r}, got {texts[column][:40]!r}"
                return _Problem(self.place(row, column), text)

        for column in needed:
            got = texts[column]
            dated = column == self._dates
            if not (is_iso_time(got) if dated else _is_finite(got)):
                what = "date and time" if dated else "finite number"
                text = f"expected a {what}, got {got[:40]!r}"
                return _Problem(self.place(row, column), text)
        return None


class _Problem(NamedTuple):
    """Why a row cannot be read.

    Attributes:
        place: Where it is in the file.
        text: What is wrong.
    """

    place: str
    text: str


def _refuse_doubled(path: PathLike, header: list[str], head: str) -> None:
    """Refuse names that repeat.

    Raises:
        FileFormatError: A name that repeats.
    """
    seen: set[str] = set()
    for column, name in enumerate(header, start=1):
        if name and name in seen:
            problem = f"column {name[:40]!r} stands twice"
            raise FileFormatError(path, problem, f"{head}, column {column}")
        seen.add(name)


def _is_finite(text: str) -> bool:
    """Whether a text is a finite number."""
    return is_number(text) and math.isfinite(float(text))
