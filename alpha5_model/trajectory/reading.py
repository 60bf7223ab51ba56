"""Motion from a CSV file: columns by joint name, every problem with its line and column."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import NoReturn

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError
from alpha5_model.files import PathLike, read_named
from alpha5_model.parameters import parameters
from alpha5_model.trajectory.motion import JOINTS, Motion, MotionWarning, checked

TIME_COLUMNS = ("time_secs", "time")
#: Other names of the time, with a unit: ``time_ms``, ``time [ms]``, ``Time (us)``.
_TIME_WITH_UNIT = re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE)
_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
POSITION_SUFFIXES = ("_pos", "_position", "")
VELOCITY_SUFFIXES = ("_vel", "_velocity")
#: Lines parsed between two reports of progress.
CHUNK = 50_000

Progress = Callable[[str, float], None]


def read_motion(path: PathLike, progress: Progress | None = None) -> Motion:
    """Read joint motion from a CSV file with a header line.

    Columns in any order: ``time_secs`` or ``time`` [s], or ``time_ms``, ``time [us]`` and the like;
    ``axis_b_pos`` (also ``axis_b_position``, ``axis_b``) and so on for ``axis_e, axis_d, axis_c,
    axis_b`` [rad] and, optionally, for the jaw rod ``axis_a`` [m]; ``axis_b_vel``
    (``axis_b_velocity``) and so on, optional, for all of these joints or none. Other columns are
    ignored and named in `Motion.ignored`. A column ``time`` in steps of a second or more is read in
    milliseconds or a smaller unit if the joints can be so fast; a warning says so.

    Args:
        path: The file.
        progress: Called with a stage's name and the part done, 0 to 1.

    Raises:
        InputError: Not a path, or fewer than 5 samples.
        MissingFileError: No such file.
        FileFormatError: A missing or doubled column, another separator, an empty file, a line of
            another length, text or NaN for a number, time that runs back; with line and column.
    """
    lines = _lines(path)
    header = _header(path, lines[0])
    time_column, joints, positions, velocities = _columns(path, header)
    used = [time_column, *positions, *velocities]
    try:
        table = _parse(lines, used, len(header), progress)
    except (ValueError, csv.Error):
        table = None
    if table is None or not np.isfinite(table).all():
        _complain(path, lines, header, used)
    rows = np.flatnonzero([bool(line) for line in lines])[1:] if "" in lines else None
    joint_columns = dict(zip(joints, positions, strict=True))

    def place(sample: int, joint: str | None) -> str:
        line = sample + 2 if rows is None else int(rows[sample]) + 1
        column = time_column if joint is None else joint_columns[joint]
        return _place(line, column, header)

    def refuse(sample: int, joint: str | None, value: float, expected: str) -> Alpha5Error:
        return FileFormatError(path, f"expected {expected}", place(sample, joint))

    n = len(joints)
    name = header[time_column]
    guess = _likely_unit(table[:, 0], table[:, 1 : 1 + n])
    stated = _TIME_WITH_UNIT.fullmatch(name)
    unit = guess if stated is None else stated[1].lower()
    warnings: tuple[MotionWarning, ...] = ()
    if guess != "s" and (unit == "s" or stated is None):
        text = f"{name} read as {guess}, which its steps and speeds fit; call it time_secs if it is in seconds"
        if stated is not None:
            text = f"{name} read as seconds, though its steps and speeds fit {guess}: is it time_{guess}?"
        warnings = (MotionWarning("time_unit", 1, place(0, None), text),)
    raw = Motion(
        table[:, 0] / _PER_SECOND[unit],
        joints,
        position=table[:, 1 : 1 + n],
        velocity=table[:, 1 + n :] if velocities else None,
        warnings=warnings,
        source=str(path),
        ignored=tuple(name for k, name in enumerate(header) if k not in used),
        time_unit=unit,
    )
    return checked(raw, place, refuse)


def _likely_unit(time: FloatArray, position: FloatArray) -> str:
    """Largest unit in which a time step is shorter than a second, if the joints can be so fast.

    Seconds where some joint's mean speed would exceed twice its rating, as in a plan of few points.
    """
    with np.errstate(over="ignore"):
        steps, path = np.diff(time), np.abs(np.diff(position, axis=0)).sum(axis=0)
    steps = steps[steps > 0]
    if not steps.size or float(np.median(steps)) < 1.0:
        return "s"
    unit = next((u for u, n in _PER_SECOND.items() if float(np.median(steps)) < n), "ns")
    rated = np.array([joint.velocity for joint in parameters().joints[: path.size]])
    fast = path / (steps / _PER_SECOND[unit]).sum() > 2 * rated
    return "s" if fast.any() else unit


def _lines(path: PathLike) -> list[str]:
    try:
        text = read_named(path, "a CSV file of joint motion").decode("utf-8-sig")
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


def _columns(
    path: PathLike, header: list[str]
) -> tuple[int, tuple[str, ...], list[int], list[int]]:
    """Columns of the time, and of the positions and velocities of the joints base to tip."""

    def column(names: Sequence[str], what: str, why: str = "") -> int:
        there = [name for name in names if name in header]
        if len(there) == 1:
            return header.index(there[0])
        problem = f"two columns for {what}: {', '.join(there)}"
        if not there:
            got = ", ".join(header)[:200]
            problem = f"no column for {what}{why}: expected {' or '.join(names)}, got {got}"
        raise FileFormatError(path, problem, "line 1")

    def of(joints: Sequence[str], suffixes: Sequence[str], what: str, why: str = "") -> list[int]:
        return [column([j + suffix for suffix in suffixes], f"{what} of {j}", why) for j in joints]

    def given(joints: Sequence[str], suffixes: Sequence[str]) -> bool:
        return any(joint + suffix in header for joint in joints for suffix in suffixes)

    plain = [name for name in TIME_COLUMNS if name in header]
    with_unit = [name for name in header if _TIME_WITH_UNIT.fullmatch(name)]
    time_column = column(plain or with_unit or (*TIME_COLUMNS, "time_ms"), "the time")
    joints = JOINTS if given(JOINTS[4:], POSITION_SUFFIXES) else JOINTS[:4]
    positions, velocities = of(joints, POSITION_SUFFIXES, "the position"), []
    if given(joints, VELOCITY_SUFFIXES):
        why = ", while others have one"
        velocities = of(joints, VELOCITY_SUFFIXES, "the velocity", why)
    return time_column, joints, positions, velocities


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
