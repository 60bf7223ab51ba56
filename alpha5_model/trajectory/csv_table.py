"""Joint motion from CSV files."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.clock_times import Clock, clock_of, date_seconds, is_date
from alpha5_model.trajectory.file_table import CHUNK, FileTable, Problem, Progress
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.ros_columns import joint_name_columns, with_joint_names
from alpha5_model.trajectory.text_table import fields, is_number, text_table, widths


class CsvTable(FileTable):
    """A CSV file; lines and columns count from 1.

    `alpha5_model.trajectory.text_table` says which forms of it can be read.

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
        #: How times are written that are no numbers, and the column of their dates.
        self._clock: Clock | None = None
        self._date: int | None = None

        self.head = f"line {table.head}"
        #: Column -> the joint's name that each of its rows has.
        self._joint_names: dict[int, str] = {}
        self.names = self._named(table.names)
        self.header = joints.renamed(self.names)
        _refuse_doubled(path, self.header, self.head)

    def read(self, columns: Sequence[int]) -> tuple[FloatArray, str | None]:
        """The numbers of some columns; see `FileTable.read`."""
        self._clock = self._clock_of(columns[0])
        count = len(self._rows)
        blocks = [np.empty((0, len(columns)))]
        for start in range(0, count, CHUNK):
            end = min(start + CHUNK, count)
            block = self._rows[start:end]
            try:
                numbers = self._parsed(block, columns)
            except (ValueError, csv.Error):
                numbers = self._parsed_one_by_one(block, columns)
            blocks.append(numbers)
            if self._progress:
                self._progress("read", end / count)
        numbers = np.concatenate(blocks)
        if self._clock is None:
            return numbers, None
        if self._date is None:
            numbers[:, 0] = self._clock.without_midnight(numbers[:, 0])
        return numbers, "s"

    def problem(self, row: int, columns: Sequence[int]) -> Problem:
        """Why a number of a row cannot be read; see `FileTable.problem`."""
        line = f"line {self._line_numbers[row]}"
        try:
            texts = fields(self._rows[row], self._separator)
        except csv.Error as error:
            return Problem(line, f"is not a table of numbers: {error}")
        width = len(self.header)
        if len(texts) != width:
            text = f"{len(texts)} fields, expected {width} as in {self.head}"
            return Problem(line, text)

        for column, joint in self._joint_names.items():
            if texts[column] != joint:
                text = f"expected {joint[:40]!r}, got {texts[column][:40]!r}"
                return Problem(self.place(row, column), text)

        values = self._row_numbers(self._rows[row], columns)
        wrong = int(np.argmin(np.isfinite(values)))
        column = columns[wrong]
        what = "finite number" if wrong or self._clock is None else self._clock.what
        text = f"expected a {what}, got {texts[column][:40]!r}"
        return Problem(self.place(row, column), text)

    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""
        line = self._line_numbers[row]
        return f"line {line}, column {column + 1} ({self.names[column]})"

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

    def _clock_of(self, time: int) -> Clock | None:
        """How the times are written; None if they are numbers."""
        for line in self._rows:
            texts = line.split(self._separator, time + 1)
            text = texts[time].strip(' "') if time < len(texts) else ""
            if is_number(text):
                return None
            clock = clock_of(text)
            if clock is not None:
                dates = [k for k, name in enumerate(self.header) if is_date(name)]
                has_date = clock.time_of_day and len(dates) == 1
                self._date = dates[0] if has_date and dates[0] != time else None
                return clock
        return None

    def _parsed(self, lines: list[str], columns: Sequence[int]) -> FloatArray:
        """The numbers of some columns of some lines, (N, k), if all are numbers.

        Raises:
            ValueError: A line of another length, or something that is no number.
            csv.Error: A line that is no CSV.
        """
        expected = len(self.header)
        if any(width != expected for width in widths(lines, self._separator)):
            raise ValueError
        if not self._same_joints(lines):
            raise ValueError
        if self._date is not None:
            raise ValueError
        converters: dict[int | str, Callable[[str], float]] | None = None
        if self._clock is not None:
            converters = {columns[0]: self._clock.seconds}
        return np.loadtxt(
            lines,
            delimiter=self._separator,
            comments=None,
            quotechar='"',
            usecols=columns,
            ndmin=2,
            converters=converters,
            encoding=None,
        )

    def _parsed_one_by_one(
        self, lines: list[str], columns: Sequence[int]
    ) -> FloatArray:
        """The same with NaN for what is no number, and for rows of another form."""
        rows = [self._row_numbers(line, columns) for line in lines]
        return np.array(rows, dtype=float).reshape(len(lines), len(columns))

    def _row_numbers(self, line: str, columns: Sequence[int]) -> list[float]:
        """The numbers of a row, NaN for what is none."""
        unread = [np.nan] * len(columns)
        try:
            texts = fields(line, self._separator)
        except csv.Error:
            return unread
        if len(texts) != len(self.header):
            return unread
        if any(texts[column] != name for column, name in self._joint_names.items()):
            return unread

        numbers = [
            float(texts[column]) if is_number(texts[column]) else np.nan
            for column in columns
        ]
        if self._clock is not None:
            numbers[0] = np.nan
            with suppress(ValueError):
                day = 0.0 if self._date is None else date_seconds(texts[self._date])
                numbers[0] = day + self._clock.seconds(texts[columns[0]])
        return numbers

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
