"""Columns of a table of joint motion, by their names, and the motion that they hold."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.parameters import parameters
from alpha5_model.trajectory.motion import JOINTS, Motion, MotionWarning, Place

TIME_COLUMNS = ("time_secs", "time")
#: Other names of the time, with a unit: ``time_ms``, ``time [ms]``, ``Time (us)``.
_TIME_WITH_UNIT = re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE)
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
POSITION_SUFFIXES = ("_pos", "_position", "")
VELOCITY_SUFFIXES = ("_vel", "_velocity")
_EFFORT = "_effort"

#: Columns that must be finite, columns of efforts -> numbers (N, k), and the unit of the time.
Read = Callable[[list[int], list[int]], tuple[FloatArray, str | None]]


def table_motion(
    path: Any,
    header: Sequence[str],
    read: Read,
    place: Callable[[int, int], str],
    prefix: str | None = None,
    head: str = "",
) -> tuple[Motion, Place]:
    """The motion of a table, still to be checked, and what says where a number of it stands.

    Args:
        path: The file.
        header: Names of all columns; see `read_motion`.
        read: (columns that must be finite, the time first; columns of efforts) -> their numbers,
            (N, k), without efforts if these are no numbers; and the unit of the time if the file's
            format says it, else None, which judges by name, steps and speeds.
        place: (row, column) -> words.
        prefix: What stands before each joint's name; None finds it.
        head: Where the names stand in the file, for messages.

    Raises:
        FileFormatError: A column that is missing, or there twice.
        InputError: Several prefixes.
    """
    # Without any that names all joints, the message below says what is missing.
    before = only("prefix", prefixes(header, POSITION_SUFFIXES, prefix) or [prefix or ""])

    def named(joint: str, suffixes: Sequence[str]) -> list[str]:
        return [before + joint + suffix for suffix in suffixes]

    def column(names: Sequence[str], what: str, why: str = "") -> int:
        there = [name for name in names if name in header]
        if len(there) == 1:
            return header.index(there[0])
        problem = f"two columns for {what}: {', '.join(there)}"
        if not there:
            got = ", ".join(header)[:200]
            problem = f"no column for {what}{why}: expected {' or '.join(names)}, got {got}"
        raise FileFormatError(path, problem, head)

    def of(joints: Sequence[str], suffixes: Sequence[str], what: str, why: str = "") -> list[int]:
        return [column(named(j, suffixes), f"{what} of {j}", why) for j in joints]

    def given(joints: Sequence[str], suffixes: Sequence[str]) -> bool:
        return any(name in header for joint in joints for name in named(joint, suffixes))

    plain = [name for name in TIME_COLUMNS if name in header]
    with_unit = [name for name in header if _TIME_WITH_UNIT.fullmatch(name)]
    needed = [column(plain or with_unit or (*TIME_COLUMNS, "time_ms"), "the time")]
    joints = JOINTS if given(JOINTS[4:], POSITION_SUFFIXES) else JOINTS[:4]
    needed += of(joints, POSITION_SUFFIXES, "the position")
    if given(joints, VELOCITY_SUFFIXES):
        needed += of(joints, VELOCITY_SUFFIXES, "the velocity", ", while others have one")
    recorded = {k: f"{before}{joint}{_EFFORT}" for k, joint in enumerate(joints)}
    efforts = {k: header.index(name) for k, name in recorded.items() if name in header}
    table, unit = read(needed, list(efforts.values()))
    n, known, name = len(joints), len(needed), header[needed[0]]
    time, position = table[:, 0], table[:, 1 : 1 + n]

    def at(sample: int, joint: str | None) -> str:
        return place(sample, needed[joints.index(joint) + 1 if joint else 0])

    warnings: tuple[MotionWarning, ...] = ()
    if unit is None:
        guess, stated = _likely_unit(time, position), _TIME_WITH_UNIT.fullmatch(name)
        unit = guess if stated is None else stated[1].lower()
        if guess != "s" and (unit == "s" or stated is None):
            text = f"{name} read as {guess}, which its steps and speeds fit; call it time_secs if it is in seconds"
            if stated is not None:
                text = f"{name} read as seconds, though its steps and speeds fit {guess}: is it time_{guess}?"
            warnings = (MotionWarning("time_unit", 1, at(0, None), text),)
    effort = None
    if table.shape[1] > known:
        effort = np.full_like(position, np.nan)
        effort[:, list(efforts)] = table[:, known:]
        needed += efforts.values()
    raw = Motion(
        time / PER_SECOND[unit],
        joints,
        position,
        table[:, 1 + n : known] if known > 1 + n else None,
        warnings=warnings,
        source=str(path),
        ignored=tuple(name for k, name in enumerate(header) if k not in needed),
        time_unit=unit,
        effort=effort,
    )
    return raw, at


def prefixes(
    names: Collection[str], suffixes: Sequence[str] = ("",), asked: str | None = None
) -> list[str]:
    """What stands before the names of the four arm joints, where all four are among these names."""
    joint, there = JOINTS[0], set(names)
    ends = [joint + suffix for suffix in suffixes]
    found = {name.removesuffix(end) for name in names for end in ends if name.endswith(end)}
    return sorted(
        before
        for before in (found if asked is None else {asked})
        if all(any(before + j + s in there for s in suffixes) for j in JOINTS[:4])
    )


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


def _likely_unit(time: FloatArray, position: FloatArray) -> str:
    """Largest unit in which a time step is shorter than a second, if the joints can be so fast.

    Seconds where some joint's mean speed would exceed twice its rating, as in a plan of few points.
    """
    with np.errstate(over="ignore"):
        steps, path = np.diff(time), np.abs(np.diff(position, axis=0)).sum(axis=0)
    steps = steps[steps > 0]
    if not steps.size or float(np.median(steps)) < 1.0:
        return "s"
    unit = next((u for u, n in PER_SECOND.items() if float(np.median(steps)) < n), "ns")
    rated = np.array([joint.velocity for joint in parameters().joints[: path.size]])
    fast = path / (steps / PER_SECOND[unit]).sum() > 2 * rated
    return "s" if fast.any() else unit
