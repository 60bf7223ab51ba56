"""Motion from a file: CSV, Parquet or a ROS bag; every problem with its place in the file."""

from __future__ import annotations

import csv
import math
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import NoReturn

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.files import PathLike, read_named
from alpha5_model.trajectory.bags import is_bag, read_bag
from alpha5_model.trajectory.columns import table_motion
from alpha5_model.trajectory.motion import Motion, Place, Progress, checked
from alpha5_model.trajectory.parquet import SUFFIXES, read_parquet

#: Lines parsed between two reports of progress.
CHUNK = 50_000


def read_motion(
    path: PathLike,
    progress: Progress | None = None,
    *,
    topic: str | None = None,
    prefix: str | None = None,
) -> Motion:
    """Read joint motion from a CSV or Parquet file, or from a ROS bag.

    A table has columns in any order: ``time_secs`` or ``time`` [s], or ``time_ms``, ``time [us]`` and
    the like; ``axis_b_pos`` (also ``axis_b_position``, ``axis_b``) and so on for ``axis_e, axis_d,
    axis_c, axis_b`` [rad] and, optionally, for the jaw rod ``axis_a`` [m]; ``axis_b_vel``
    (``axis_b_velocity``) and so on, optional, for all of these joints or none; ``axis_b_effort``
    [N m], optional, NaN where it is not known. Other columns are ignored and named in
    `Motion.ignored`. A column ``time`` in steps of a second or more is read in milliseconds or a
    smaller unit if the joints can be so fast; a warning says so. Parquet (``.parquet``, needs
    pyarrow) may have times of its own types instead.

    A bag (ROS 1 ``.bag``, ROS 2 ``.db3``, ``.mcap``, or the folder with its ``metadata.yaml``; needs
    rosbags) holds ``sensor_msgs/JointState`` messages. Their stamps are the time; the bag's own where
    a message has none. Messages without all joints, or with positions that are not finite, are left
    out, and messages out of order are sorted; each with a warning.

    Args:
        path: The file.
        progress: Called with a stage's name and the part done, 0 to 1.
        topic: Of a bag; None takes the only one that names the arm's joints.
        prefix: What stands before the joints' names, as ``left_`` in ``left_axis_e``; None takes the
            names as they are, else the only prefix.

    Raises:
        InputError: Not a path, fewer than 5 samples, a topic for a file that is no bag, several
            topics or prefixes to choose from.
        UnknownNameError: A topic that the bag has not.
        MissingFileError: No such file.
        MissingDependencyError: rosbags or pyarrow is not installed.
        FileFormatError: A missing or doubled column, another separator, an empty file, a line of
            another length, text or NaN for a number, time that runs back, with line and column or
            row; a bag that is damaged or has no joint states of the arm.
    """
    if is_bag(path):
        raw, place = read_bag(path, topic, prefix, progress)
    elif topic is not None:
        raise InputError("topic", topic, "no value: only a ROS bag has topics")
    elif Path(str(path)).suffix.lower() in SUFFIXES:
        raw, place = read_parquet(path, prefix)
    else:
        raw, place = _read_csv(path, prefix, progress)

    def refuse(sample: int, joint: str | None, value: float, expected: str) -> Alpha5Error:
        return FileFormatError(path, f"expected {expected}", place(sample, joint))

    return checked(raw, place, refuse)


def _read_csv(
    path: PathLike, prefix: str | None, progress: Progress | None
) -> tuple[Motion, Place]:
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

    return table_motion(path, header, read, place, prefix, "line 1")


def _lines(path: PathLike) -> list[str]:
    try:
        text = read_named(path, "a CSV file of joint motion (or Parquet, or a ROS bag)").decode(
            "utf-8-sig"
        )
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
