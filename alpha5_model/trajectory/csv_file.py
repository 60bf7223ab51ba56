"""Joint motion from CSV files: encoding, comments, separator, numbers and times."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.clock_times import (
    Clock,
    clock_of,
    date_seconds,
    is_date,
    is_slashed_date,
)
from alpha5_model.trajectory.column_names import JOINT_COLUMNS, with_columns_of_joints
from alpha5_model.trajectory.tables import (
    Problem,
    Progress,
    Table,
    refuse_git_lfs_pointer,
)

_EXPECTED = "a CSV file of joint motion (or Parquet, or a bag)"
#: Separators of columns, and their names in messages.
_SEPARATORS = {",": "','", ";": "';'", "\t": "a tab"}
#: Separates the columns if none of those stands between the names.
_BLANK = " "
#: What a blank line has; a spreadsheet writes ``;;;`` for an empty row.
_BLANKS = " \t;,"
#: Bytes of a text in an encoding of one byte per character.
_TEXT_BYTES = bytes([*b"\t\n\r", *range(0x20, 0x7F), *range(0x80, 0x100)])
#: Rows that show what the columns hold.
_FIRST_ROWS = 10
#: Rows that are parsed at once.
_CHUNK = 10_000
#: ``field.position0``, ``position[0]``, ``/joint_states/position.0``: what, and which.
_NUMBERED = re.compile(r"(?:.*[./])?(name|position|velocity|effort)[\[.]?(\d{1,4})\]?")
#: Fields of an echoed message before the joints' names: two of the stamp, the frame.
_BEFORE_NAMES = 3


def read_csv(
    path: PathLike, progress: Progress | None = None, expected: str = _EXPECTED
) -> Table:
    """A CSV file as a table; lines and columns count from 1.

    The text is UTF-8, UTF-16 with a byte order mark, or Windows-1252. Columns are
    separated by commas, semicolons or tabs: by whichever splits the names into most
    columns, unless a first line ``sep=;`` says it, as Excel writes it. If none of them
    stands between the names, any blanks separate the columns. Where commas do not
    separate columns they are decimal commas. Lines that start with ``#`` are comments;
    the last comment above the numbers holds the names if no other line does.

    Args:
        path: The file.
        progress: Called with ``"read"`` and the part done, 0 to 1.
        expected: What the caller can read, for messages.

    Raises:
        InputError: Not a path.
        MissingFileError: No such file.
        FileFormatError: No such text, no names, or a Git LFS pointer.
    """
    lines = _lines(path, expected)
    first = next((k for k, line in enumerate(lines) if not _is_blank(line)), None)
    if first is None:
        raise FileFormatError(path, "is empty", "line 1")
    separator = _stated_separator(path, lines[first], first + 1)
    start = first if separator is None else first + 1

    while _is_blank(lines[-1]):
        lines.pop()
    # There may be a million lines: their first signs tell most of them.
    odd = {
        k
        for k, line in enumerate(lines)
        if line[:1] in "#\t;," and (line[:1] == "#" or _is_blank(line))
    }
    rows: Sequence[int] = range(start, len(lines))
    if odd:
        rows = [k for k in rows if k not in odd]
    if not rows:
        raise FileFormatError(path, "has comments only", "line 1")
    head, header, separator = _names(path, lines, start, rows[0], separator)
    if head == rows[0] and not _starts_with_a_number(lines[head]):
        rows = rows[1:]
    return _CsvTable(lines, rows, header, head, separator).table(path, progress)


class _CsvTable:
    """The rows of a table of texts.

    Args:
        lines: Of the file.
        rows: Which of them are rows.
        header: Names of the columns.
        head: The line with the names, from 0.
        separator: What stands between two columns.
    """

    def __init__(
        self,
        lines: list[str],
        rows: Sequence[int],
        header: list[str],
        head: int,
        separator: str,
    ) -> None:
        self._lines = lines
        self._rows = rows
        self._names = header
        self._head = f"line {head + 1}"
        self._separator = separator
        #: Column -> the text that each row has there: the name of a numbered joint.
        self._fixed: dict[int, str] = {}
        #: The column that names the joint of each row.
        self._joint: int | None = None
        #: Column -> how its times are written, if they are no numbers.
        self._clocks: dict[int, Clock] = {}
        #: Columns that hold words.
        self._words: set[int] = set()
        self._look_at_rows()

    def table(self, path: PathLike, progress: Progress | None) -> Table:
        """All numbers."""
        count = len(self._rows)
        values = np.empty((count, len(self._names)))
        joints: list[str] = []
        for start in range(0, count, _CHUNK):
            end = min(start + _CHUNK, count)
            texts = self._texts(start, end)
            values[start:end] = self._parsed(texts)
            if self._joint is not None:
                fields = (self._fields(text) for text in texts)
                joints += [x[self._joint] if x else "" for x in fields]
            if progress:
                progress("read", end / count)
        values[~np.isfinite(values)] = np.nan

        for column, clock in self._clocks.items():
            if clock.time_of_day and not self._add_date(values, column):
                values[:, column] = clock.without_midnight(values[:, column])
        table = Table(
            header=self._renamed(),
            values=values,
            place=self._place,
            problem=self._problem,
            head=self._head,
            in_seconds=frozenset(self._clocks),
        )
        if self._joint is None:
            return table
        return with_columns_of_joints(table, self._joint, joints)

    def _look_at_rows(self) -> None:
        """Find columns of names and of times that are no numbers, by the first rows."""
        numbered = [k for k, x in enumerate(self._names) if _is_name(x)]
        joint = [k for k, x in enumerate(self._names) if x.lower() in JOINT_COLUMNS]
        rows = [self._fields(text) for text in self._texts(0, _FIRST_ROWS)]
        first = [fields for fields in rows if fields]
        if not first:
            return
        self._fixed = {k: first[0][k] for k in numbered}
        self._joint = joint[0] if len(joint) == 1 else None
        for column, texts in enumerate(zip(*first, strict=True)):
            words = [text for text in texts if not _is_number(text)]
            has_numbers = any(np.isfinite(_number(text)) for text in texts)
            if column in self._fixed or not words or has_numbers:
                continue
            clock = clock_of(words[0])
            if clock is None:
                self._words.add(column)
            else:
                self._clocks[column] = clock

    def _renamed(self) -> list[str]:
        """Names of the columns; ``axis_e_position`` if ``name[0]`` is ``axis_e``."""
        joints = {}
        for column, joint in self._fixed.items():
            match = _NUMBERED.fullmatch(self._names[column])
            if match:
                joints[match[2]] = joint
        names = []
        for name in self._names:
            match = _NUMBERED.fullmatch(name)
            joint = joints.get(match[2], "") if match else ""
            numbered = match and match[1] != "name" and joint
            names.append(f"{joint}_{match[1]}" if match and numbered else name)
        return names

    def _texts(self, start: int, end: int) -> list[str]:
        """Some rows with points for decimal commas, and one blank for any number."""
        texts = [self._lines[line] for line in self._rows[start:end]]
        if self._separator == _BLANK:
            texts = [" ".join(text.split()) for text in texts]
        if self._separator != ",":
            texts = [text.replace(",", ".") for text in texts]
        return texts

    def _fields(self, text: str) -> list[str] | None:
        """The texts of a row; None if it has another number of them, or other names."""
        fields = split(text, self._separator)
        if fields is None or len(fields) != len(self._names):
            return None
        if any(fields[column] != name for column, name in self._fixed.items()):
            return None
        return fields

    def _parsed(self, texts: list[str]) -> FloatArray:
        """The numbers of some rows, (n, k), NaN for what is none."""
        width = len(self._names)
        numbers = np.full((len(texts), width), np.nan)
        used = [k for k in range(width) if k not in self._words]
        # `numpy.loadtxt` checks the number of fields only if it reads all of them.
        plain = not self._words or all(
            text.count(self._separator) == width - 1 and '"' not in text
            for text in texts
        )
        if plain and not self._fixed:
            with suppress(ValueError):
                read = np.loadtxt(
                    texts,
                    delimiter=self._separator,
                    comments=None,
                    quotechar='"',
                    ndmin=2,
                    encoding=None,
                    usecols=used if self._words else None,
                    converters={k: x.seconds for k, x in self._clocks.items()} or None,
                )
                if read.shape == (len(texts), len(used)):
                    numbers[:, used] = read
                    return numbers

        for row, text in enumerate(texts):
            fields = self._fields(text)
            if fields is not None:
                numbers[row] = [_number(x) for x in fields]
                for column, clock in self._clocks.items():
                    with suppress(ValueError):
                        numbers[row, column] = clock.seconds(fields[column])
        return numbers

    def _add_date(self, values: FloatArray, column: int) -> bool:
        """Add the days of the only column of dates to the times of day, if there is."""
        dates = [k for k, x in enumerate(self._names) if is_date(x) and k != column]
        if len(dates) != 1:
            return False
        for row, text in enumerate(self._texts(0, len(values))):
            fields = self._fields(text)
            try:
                values[row, column] += date_seconds(fields[dates[0]] if fields else "")
            except ValueError:
                values[row, column] = np.nan
        return True

    def _place(self, row: int, column: int) -> str:
        line = self._rows[row] + 1
        return f"line {line}, column {column + 1} ({self._names[column]})"

    def _problem(self, row: int, columns: Sequence[int]) -> Problem:
        line = f"line {self._rows[row] + 1}"
        [text] = self._texts(row, row + 1)
        fields = split(text, self._separator)
        if fields is None:
            return Problem(line, "is not a table of numbers: a field without end")
        width = len(self._names)
        if len(fields) != width:
            count = f"{len(fields)} fields, expected {width} as in {self._head}"
            return Problem(line, count)
        for column, name in self._fixed.items():
            if fields[column] != name:
                text = f"expected {name[:40]!r}, got {fields[column][:40]!r}"
                return Problem(self._place(row, column), text)

        for column, got in enumerate(fields):
            read = column in columns or is_date(self._names[column])
            if read and is_slashed_date(got):
                expected = "2026-11-27 or 27.11.2026, which exchange no day and month"
                text = f"expected a date like {expected}, got {got[:40]!r}"
                return Problem(self._place(row, column), text)
        for column in columns:
            got = fields[column]
            expected = "finite number"
            if column in self._clocks:
                clock = self._clocks[column]
                expected = clock.what
                with suppress(ValueError):
                    clock.seconds(got)
                    continue
            elif np.isfinite(_number(got)):
                continue
            text = f"expected a {expected}, got {got[:40]!r}"
            return Problem(self._place(row, column), text)
        return Problem(line, "numbers that cannot be used")


def split(text: str, separator: str) -> list[str] | None:
    """The texts between the separators of a line; None if a quote has no end."""
    if '"' not in text:
        return [field.strip() for field in text.split(separator)]
    try:
        return [x.strip() for x in next(csv.reader([text], delimiter=separator))]
    except csv.Error:
        return None


def _is_number(text: str) -> bool:
    return np.isfinite(_number(text)) or text.lower() in ("", "nan", "inf", "-inf")


def _number(text: str) -> float:
    """A text as a number, NaN if it is none.

    Python also reads ``1_0`` and digits of other scripts; a table has neither.
    """
    try:
        value = float(text)
    except ValueError:
        return np.nan
    return value if text.isascii() and "_" not in text else np.nan


def _lines(path: PathLike, expected: str) -> list[str]:
    """The lines of a file, without the spaces around them.

    Raises:
        FileFormatError: Bytes that no text has.
    """
    content = read_named(path, expected)
    refuse_git_lfs_pointer(path, content)
    start = content[:200].removeprefix(codecs.BOM_UTF8).lstrip().removeprefix(b"---")
    if start.lstrip().startswith(b"header:"):
        problem = (
            "is what ros2 topic echo prints: record it with ros2 topic echo --csv, or "
            "with ros2 bag record"
        )
        raise FileFormatError(path, problem)

    marks = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
    encodings = ["utf-16"] if content.startswith(marks) else ["utf-8-sig"]
    if not content.translate(None, delete=_TEXT_BYTES):
        encodings.append("cp1252")  # as Excel saves it
    for encoding in encodings:
        with suppress(UnicodeDecodeError):
            text = content.decode(encoding)
            del content
            # A tab may stand for an empty last field: only spaces are blanks.
            text = text.replace("\r\n", "\n").replace("\r", "\n")
            lines = text.split("\n")
            if " \n" in text or "\n " in text or text != text.strip(" "):
                lines = [line.strip(" ") for line in lines]
            return lines
    problem = "is no table of text in UTF-8, UTF-16 or Windows-1252"
    problem += f": {expected} is expected"
    raise FileFormatError(path, problem)


def _is_blank(line: str) -> bool:
    return not line.strip(_BLANKS)


def _stated_separator(path: PathLike, line: str, number: int) -> str | None:
    """The separator in Excel's line ``sep=;``; None if there is no such line."""
    text = line.strip('"')
    if text[:4].lower() != "sep=":
        return None
    separator = text[4:] or ","
    if separator not in _SEPARATORS:
        expected = ", ".join(_SEPARATORS.values())
        problem = f"separator {separator[:40]!r}, expected one of {expected}"
        raise FileFormatError(path, problem, f"line {number}")
    return separator


def _separator(line: str) -> str:
    """The separator that splits a line into most columns.

    If there is none, it is a blank between words, and a comma for a single word.
    """
    most = max(_SEPARATORS, key=line.count)
    words = line.lstrip("#").split()
    return _BLANK if most not in line and len(words) > 1 else most


def _names(
    path: PathLike, lines: list[str], start: int, row: int, stated: str | None
) -> tuple[int, list[str], str]:
    """The line with the names of the columns, the names, and the separator.

    Args:
        path: The file, for messages.
        lines: Of the file.
        start: The first line that may be a comment.
        row: The first line that is none.
        stated: The separator that the file states; None if it does not.

    Raises:
        FileFormatError: Numbers without names.
    """
    comments = [k for k in range(start, row) if not _is_blank(lines[k])]
    head = row
    numbers_first = _starts_with_a_number(lines[row])
    if numbers_first and comments:
        separator = stated or _separator(lines[comments[-1]])
        names = _header(lines[comments[-1]], separator)
        if names and len(names) == len(_header(lines[row], separator) or []):
            return comments[-1], names, separator
    if numbers_first:
        echoed = _echoed_names(split(lines[row], ",") or [])
        if echoed:
            return row, echoed, ","
        problem = "starts with numbers, expected column names"
        raise FileFormatError(path, problem, f"line {row + 1}")

    separator = stated or _separator(lines[head])
    header = _header(lines[head], separator)
    if header is None:
        problem = "is not a table of numbers: a name without end"
        raise FileFormatError(path, problem, f"line {head + 1}")
    return head, header, separator


def _header(line: str, separator: str) -> list[str] | None:
    """The texts between the separators of a line, without the sign of a comment."""
    text = line.lstrip("#")
    return split(" ".join(text.split()) if separator == _BLANK else text, separator)


def _starts_with_a_number(line: str) -> bool:
    """Whether a line has a number before its first separator, whichever that is."""
    first, *_ = re.split("[,; \t]", line.strip('" '), maxsplit=1)
    return bool(first) and _is_number(first.strip('" '))


def _is_name(column: str) -> bool:
    match = _NUMBERED.fullmatch(column)
    return match is not None and match[1] == "name"


def _echoed_names(row: list[str]) -> list[str] | None:
    """Names of the columns of a row that ``ros2 topic echo --csv`` wrote.

    The row has seconds, nanoseconds, a frame, the names of n joints, and their
    positions, velocities and efforts. If one or two of these three are missing, only
    the positions are named: nothing tells velocities from efforts.
    """
    names = row[_BEFORE_NAMES:]
    count = next((k for k, x in enumerate(names) if _is_number(x)), 0)
    numbers = len(row) - _BEFORE_NAMES - count
    stamped = all(text.isdecimal() for text in row[: _BEFORE_NAMES - 1])
    if not stamped or not count or numbers not in (count, 2 * count, 3 * count):
        return None
    known = ["name", "position"]
    if numbers == 3 * count:
        known += ["velocity", "effort"]
    header = ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"]
    header += [f"{what}[{k}]" for what in known for k in range(count)]
    return header + [f"other[{k}]" for k in range(len(row) - len(header))]
