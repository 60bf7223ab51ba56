"""Reading a motion from a CSV file: columns by joint name, every problem with its line and column."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError, MissingFileError
from alpha5_model.trajectory.motion import JOINTS, Motion, checked

TIME_COLUMNS = ("time_secs", "time")
POSITION_SUFFIXES = ("_pos", "_position", "")
VELOCITY_SUFFIXES = ("_vel", "_velocity")
#: Lines parsed between two reports of progress.
CHUNK = 50_000

Progress = Callable[[str, float], None]


def read_motion(path: str | os.PathLike[str], progress: Progress | None = None) -> Motion:
    """Read joint motion from a CSV file with a header line.

    Columns stand in any order: ``time_secs`` or ``time`` [s]; ``axis_b_pos`` (also ``axis_b_position``,
    ``axis_b``) and the like for ``axis_e, axis_d, axis_c, axis_b`` [rad] and, optionally, for the jaw
    rod ``axis_a`` [m]; ``axis_b_vel`` (``axis_b_velocity``) and the like, optional, for all of
    these joints or none. Other columns are ignored and named in `Motion.ignored`.

    Args:
        path: The file.
        progress: Called with a stage's name and the part done, 0 to 1.

    Raises:
        MissingFileError: No such file.
        FileFormatError: A missing or doubled column, another separator, an empty file, a line of
            another length, text or NaN in place of a number, time that runs back; with line and column.
    """
    lines = _lines(Path(path))
    header = _header(path, lines[0])
    time_column, joints, positions, velocities = _columns(path, header)
    used = [time_column, *positions, *velocities]
    try:
        table = _parse(lines, used, len(header), progress)
    except ValueError:
        _complain(path, lines, header, used)
    if not np.isfinite(table).all():
        _complain(path, lines, header, used)
    rows = np.flatnonzero([bool(line) for line in lines])[1:] if "" in lines else None
    joint_columns = dict(zip(joints, positions, strict=True))

    def place(sample: int, joint: str | None) -> str:
        line = sample + 2 if rows is None else int(rows[sample]) + 1
        column = time_column if joint is None else joint_columns[joint]
        return _place(line, column, header)

    def refuse(sample: int, joint: str | None, problem: str) -> Alpha5Error:
        return FileFormatError(path, f"expected {problem}", place(sample, joint))

    n = len(joints)
    return checked(
        table[:, 0],
        joints,
        table[:, 1 : 1 + n],
        table[:, 1 + n :] if velocities else None,
        place,
        refuse,
        source=str(path),
        ignored=tuple(name for k, name in enumerate(header) if k not in used),
    )


def _lines(path: Path) -> list[str]:
    if path.is_dir():
        raise FileFormatError(path, "is a folder, a CSV file is expected")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise MissingFileError(path, "a CSV file of joint motion") from None
    except UnicodeDecodeError:
        raise FileFormatError(path, "is not UTF-8 text, a CSV file is expected") from None
    except OSError as error:
        raise FileFormatError(path, f"cannot be read: {error.strerror}") from None
    lines = [line.strip() for line in text.rstrip().split("\n")]
    if not lines[0]:
        raise FileFormatError(
            path, "is empty" if len(lines) == 1 else "no column names in line 1", "line 1"
        )
    return lines


def _header(path: str | os.PathLike[str], line: str) -> list[str]:
    if "," not in line:
        for separator, name in ((";", "';'"), ("\t", "a tab"), (" ", "a space")):
            if separator in line:
                raise FileFormatError(
                    path, f"columns are separated by {name}, expected ','", "line 1"
                )
    header = [name.strip() for name in next(csv.reader([line]))]
    if _is_number(header[0]):
        raise FileFormatError(path, "starts with numbers, expected column names", "line 1")
    for k, name in enumerate(header):
        if name and name in header[:k]:
            raise FileFormatError(path, f"column {name!r} stands twice", f"line 1, column {k + 1}")
    return header


def _columns(
    path: str | os.PathLike[str], header: list[str]
) -> tuple[int, tuple[str, ...], list[int], list[int]]:
    """Columns of the time, and of the positions and velocities of the joints base to tip."""

    def find(names: Sequence[str], what: str) -> int | None:
        there = [name for name in names if name in header]
        if len(there) > 1:
            raise FileFormatError(path, f"two columns for {what}: {', '.join(there)}", "line 1")
        return header.index(there[0]) if there else None

    def need(names: Sequence[str], what: str) -> int:
        column = find(names, what)
        if column is None:
            raise FileFormatError(
                path,
                f"no column for {what}: expected {' or '.join(names)}, got {', '.join(header)}",
                "line 1",
            )
        return column

    def names(joint: str, suffixes: Sequence[str]) -> list[str]:
        return [joint + suffix for suffix in suffixes]

    time_column = need(TIME_COLUMNS, "the time")
    joints: tuple[str, ...] = JOINTS[:4]
    if find(names("axis_a", POSITION_SUFFIXES), "the position of axis_a") is not None:
        joints = JOINTS
    positions = [need(names(j, POSITION_SUFFIXES), f"the position of {j}") for j in joints]
    speeds = [find(names(j, VELOCITY_SUFFIXES), f"the velocity of {j}") for j in joints]
    given = [s for s in speeds if s is not None]
    if given and len(given) < len(joints):
        j = joints[speeds.index(None)]
        need(names(j, VELOCITY_SUFFIXES), f"the velocity of {j}, while others have one")
    return time_column, joints, positions, given


def _parse(lines: list[str], used: list[int], width: int, progress: Progress | None) -> FloatArray:
    blocks = []
    for start in range(1, len(lines), CHUNK):
        block = lines[start : start + CHUNK]
        filled = [line for line in block if line] if "" in block else block
        commas = sum(line.count(",") for line in filled)
        if commas != len(filled) * (width - 1) and not any('"' in line for line in filled):
            raise ValueError
        if filled:
            blocks.append(
                np.loadtxt(
                    filled, delimiter=",", usecols=used, ndmin=2, comments=None, quotechar='"'
                )
            )
        if progress:
            progress("read", min(start + CHUNK, len(lines)) / len(lines))
    return np.concatenate(blocks) if blocks else np.empty((0, len(used)))


def _complain(
    path: str | os.PathLike[str], lines: list[str], header: list[str], used: list[int]
) -> NoReturn:
    """Find the first line that cannot be read, and say what is wrong with it."""
    for number, line in enumerate(lines[1:], start=2):
        if not line:
            continue
        fields = next(csv.reader([line]))
        if len(fields) != len(header):
            problem = f"{len(fields)} fields, expected {len(header)} as in line 1"
            raise FileFormatError(path, problem, f"line {number}")
        for column in used:
            text = fields[column].strip()
            if not _is_number(text) or not math.isfinite(float(text)):
                problem = f"expected a finite number, got {text[:40]!r}"
                raise FileFormatError(path, problem, _place(number, column, header))
    raise FileFormatError(path, "cannot be read as a table of numbers")


def _place(line: int, column: int, header: list[str]) -> str:
    return f"line {line}, column {column + 1} ({header[column]})"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
