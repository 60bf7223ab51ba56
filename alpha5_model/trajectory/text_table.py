"""The lines of a table in a text file: encoding, comments, separator, decimal sign.

Nothing here knows what the columns mean; see `alpha5_model.trajectory.csv_table`.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.other_formats import refuse_other_formats
from alpha5_model.trajectory.ros_columns import echoed_names

#: Separators of columns, and their names in messages.
_SEPARATORS = {",": "','", ";": "';'", "\t": "a tab"}
#: Separates the columns if none of those stands between the names.
_BLANK = " "
_COMMENT = "#"
#: Bytes of a text in an encoding of one byte per character.
_TEXT_BYTES = bytes([*b"\t\n\r", *range(0x20, 0x7F), *range(0x80, 0x100)])
#: The first line of a file that Git LFS has not fetched.
_GIT_LFS = b"version https://git-lfs.github.com/spec/"


@dataclass(frozen=True)
class TextTable:
    """A table of texts.

    Attributes:
        names: Names of the columns.
        head: Number of the line with the names, from 1.
        rows: The lines below it, without blank lines and comments. A decimal comma is
            a point already.
        line_numbers: Which line each row is, from 1.
        separator: What stands between two columns.
    """

    names: list[str]
    head: int
    rows: list[str]
    line_numbers: list[int]
    separator: str


class _Line(NamedTuple):
    """A line of the file.

    Attributes:
        number: From 1.
        text: Without the blanks around it.
    """

    number: int
    text: str


def text_table(path: PathLike, content: bytes) -> TextTable:
    """The lines of a file as a table.

    The text is UTF-8, or UTF-16 with a byte order mark. Columns are separated by
    commas, semicolons or tabs: by whichever splits the names into most columns, unless
    a first line ``sep=;`` says it, as Excel writes it. If none of them stands between
    the names, any blanks separate the columns. Where commas do not separate columns
    they are decimal commas. Lines that start with ``#`` are comments; the last
    comment above the numbers holds the names if no other line does.

    Args:
        path: The file, for messages.
        content: Its bytes.

    Raises:
        FileFormatError: No such text, no names, another format, or a Git LFS pointer.
    """
    refuse_git_lfs_pointer(path, content)
    refuse_other_formats(path, content)
    lines = _lines(path, content)
    separator = _stated_separator(path, lines[0])
    if separator is not None:
        lines = lines[1:]

    names, rows = _names_and_rows(path, lines, separator)
    if separator is None:
        separator = _separator(names.text)

    texts = [line.text for line in rows]
    if separator == _BLANK:
        texts = [_with_single_blanks(text) for text in texts]
    if separator != ",":
        texts = [text.replace(",", ".") for text in texts]
    header = _fields(path, names, separator)
    if rows and names is rows[0]:
        header = echoed_names(header) or header
    return TextTable(
        names=header,
        head=names.number,
        rows=texts,
        line_numbers=[line.number for line in rows],
        separator=separator,
    )


def refuse_git_lfs_pointer(path: PathLike, content: bytes) -> None:
    """Refuse the small text that stands for a file that Git LFS has not fetched.

    Args:
        path: The file, for the message.
        content: Its bytes, or the first hundred of them.

    Raises:
        FileFormatError: It is such a text.
    """
    if content.startswith(_GIT_LFS):
        problem = "is a Git LFS pointer, not the recording: run git lfs pull first"
        raise FileFormatError(path, problem)


def fields(line: str, separator: str) -> list[str]:
    """The texts between the separators of a line.

    Raises:
        csv.Error: A field of more than 131 072 characters.
    """
    return [text.strip() for text in next(csv.reader([line], delimiter=separator))]


def widths(lines: list[str], separator: str) -> Iterable[int]:
    """Number of fields in each line.

    Raises:
        csv.Error: A line that is no CSV.
    """
    if any('"' in line for line in lines):
        return map(len, csv.reader(lines, delimiter=separator))
    return (line.count(separator) + 1 for line in lines)


def is_number(text: str) -> bool:
    """Whether a text is a number, finite or not.

    Python also reads ``1_0`` and digits of other scripts; a table has neither.
    """
    if "_" in text or not text.isascii():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


def _lines(path: PathLike, content: bytes) -> list[_Line]:
    """The lines of a file that are not blank.

    Raises:
        FileFormatError: Another encoding, or an empty file.
    """
    marks = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
    encoding = "utf-16" if content.startswith(marks) else "utf-8-sig"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text = _windows_text(path, content)

    text = text.replace("\r\n", "\n").replace("\r", "\n")
    # A tab may stand for an empty last field: only spaces are blanks around a line.
    filled = [
        _Line(number=number, text=line.strip(" "))
        for number, line in enumerate(text.split("\n"), start=1)
        if not _is_blank(line)
    ]
    if not filled:
        raise FileFormatError(path, "is empty", "line 1")
    return filled


def _windows_text(path: PathLike, content: bytes) -> str:
    """A text in Windows-1252, as Excel saves it.

    Raises:
        FileFormatError: Bytes that no text has.
    """
    no_text = content.translate(None, delete=_TEXT_BYTES)
    if not no_text:
        with suppress(UnicodeDecodeError):
            return content.decode("cp1252")
    problem = "is not UTF-8, UTF-16 or Windows-1252 text, a CSV file is expected"
    raise FileFormatError(path, problem)


def _is_blank(line: str) -> bool:
    """Whether a line has no text; a spreadsheet writes ``;;;`` for an empty row."""
    return not line.strip(" \t;,")


def _stated_separator(path: PathLike, first: _Line) -> str | None:
    """The separator in Excel's line ``sep=;``; None if there is no such line."""
    text = first.text.strip('"')
    if text[:4].lower() != "sep=":
        return None
    separator = text[4:] or ","
    if separator not in _SEPARATORS:
        expected = ", ".join(_SEPARATORS.values())
        problem = f"separator {separator[:40]!r}, expected one of {expected}"
        raise FileFormatError(path, problem, _place(first))
    return separator


def _names_and_rows(
    path: PathLike, lines: list[_Line], stated: str | None
) -> tuple[_Line, list[_Line]]:
    """The line with the names of the columns, and the lines with their numbers.

    The first of the rows stands for the names if ``ros2 topic echo`` wrote them.

    Args:
        path: The file, for messages.
        lines: All lines but ``sep=;``.
        stated: The separator that the file states; None if it does not.

    Raises:
        FileFormatError: Only comments, or numbers without names.
    """
    rows = [line for line in lines if not line.text.startswith(_COMMENT)]
    if not rows:
        raise FileFormatError(path, "has comments only", "line 1")
    first = rows[0]
    if not _starts_with_a_number(first.text):
        return first, rows[1:]

    comments = [line for line in lines if line.number < first.number]
    if comments:
        named = comments[-1]
        separator = stated or _separator(named.text)
        names = _fields(path, named, separator)
        numbers = _fields(path, first, separator)
        if len(names) == len(numbers):
            return named, rows
    if echoed_names(_fields(path, first, ",")) is not None:
        return first, rows
    problem = "starts with numbers, expected column names"
    raise FileFormatError(path, problem, _place(first))


def _starts_with_a_number(line: str) -> bool:
    """Whether a line has a number before its first separator, whichever that is."""
    first, *_ = re.split("[,; \t]", line.strip('" '), maxsplit=1)
    return is_number(first.strip('" '))


def _separator(line: str) -> str:
    """The separator that splits a line into most columns.

    If there is none, it is a blank between words, and a comma for a single word.
    """
    most = max(_SEPARATORS, key=line.count)
    words = line.lstrip(_COMMENT).split()
    return _BLANK if most not in line and len(words) > 1 else most


def _with_single_blanks(text: str) -> str:
    """A line with one blank for any number of blanks between its words."""
    return _BLANK.join(text.split())


def _fields(path: PathLike, line: _Line, separator: str) -> list[str]:
    """The texts between the separators of a line, without the sign of a comment.

    Raises:
        FileFormatError: A field of more than 131 072 characters.
    """
    text = line.text.lstrip(_COMMENT)
    if separator == _BLANK:
        text = _with_single_blanks(text)
    try:
        return fields(text, separator)
    except csv.Error as error:
        problem = f"is not a table of numbers: {error}"
        raise FileFormatError(path, problem, _place(line)) from None


def _place(line: _Line) -> str:
    """Where a line is in the file, for messages."""
    return f"line {line.number}"
