"""Motion from a file: CSV, Parquet or a ROS bag; every problem with its place in the file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.files import PathLike
from alpha5_model.parameters import parameters
from alpha5_model.trajectory import tables
from alpha5_model.trajectory.bags import bag_table, is_bag
from alpha5_model.trajectory.motion import JOINTS, Motion, MotionWarning, Progress, checked

_TIME = ("time_secs", "time")
#: Other names of the time, with a unit: ``time_ms``, ``time [ms]``, ``Time (us)``.
_TIME_WITH_UNIT = re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE)
_POSITION = ("_pos", "_position", "")
_VELOCITY = ("_vel", "_velocity")


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
    before = prefix
    if is_bag(path):
        table, before = bag_table(path, topic, prefix, progress)
    elif topic is not None:
        raise InputError("topic", topic, "no value: only a ROS bag has topics")
    elif Path(str(path)).suffix.lower() in tables.PARQUET:
        table = tables.parquet_table(path)
    else:
        table = tables.csv_table(path, progress)
    header = table.header
    # Without any that names all joints, the message below says what is missing.
    before = tables.only("prefix", tables.prefixes(header, _POSITION, before) or [before or ""])

    def there(joint: str, suffixes: Sequence[str]) -> list[str]:
        return [before + joint + suffix for suffix in suffixes if before + joint + suffix in header]

    def column(names: Sequence[str], what: str, why: str = "") -> int:
        found = [name for name in names if name in header]
        if len(found) == 1:
            return header.index(found[0])
        problem = f"two columns for {what}: {', '.join(found)}"
        if not found:
            got = ", ".join(header)[:200]
            problem = f"no column for {what}{why}: expected {' or '.join(names)}, got {got}"
        raise FileFormatError(path, problem, table.head)

    def of(joint: str, suffixes: Sequence[str], what: str, why: str = "") -> int:
        names = [before + joint + suffix for suffix in suffixes]
        return column(names, f"the {what} of {joint}", why)

    timed = [name for name in header if name in _TIME]
    timed = timed or [name for name in header if _TIME_WITH_UNIT.fullmatch(name)]
    joints = JOINTS if there(JOINTS[4], _POSITION) else JOINTS[:4]
    needed = [column(timed or (*_TIME, "time_ms"), "the time")]
    needed += [of(joint, _POSITION, "position") for joint in joints]
    if any(there(joint, _VELOCITY) for joint in joints):
        why = ", while others have one"
        needed += [of(joint, _VELOCITY, "velocity", why) for joint in joints]
    recorded = [there(joint, ["_effort"]) for joint in joints]
    efforts = [header.index(name) for names in recorded for name in names]
    numbers, unit = table.read(needed, efforts)
    n, known, name = len(joints), len(needed), header[needed[0]]
    time, position = numbers[:, 0], numbers[:, 1 : 1 + n]

    def place(sample: int, joint: str | None) -> str:
        return table.place(sample, needed[joints.index(joint) + 1 if joint else 0])

    def refuse(sample: int, joint: str | None, value: float, expected: str) -> Alpha5Error:
        return FileFormatError(path, f"expected {expected}", place(sample, joint))

    warnings = table.warnings
    if unit is None:
        guess, stated = _likely_unit(time, position), _TIME_WITH_UNIT.fullmatch(name)
        unit = guess if stated is None else stated[1].lower()
        if guess != "s" and (unit == "s" or stated is None):
            text = f"{name} read as {guess}, which its steps and speeds fit; call it time_secs if it is in seconds"
            if stated is not None:
                text = f"{name} read as seconds, though its steps and speeds fit {guess}: is it time_{guess}?"
            warnings += (MotionWarning("time_unit", 1, place(0, None), text),)
    effort = None
    if numbers.shape[1] > known:
        effort = np.full_like(position, np.nan)
        effort[:, [bool(names) for names in recorded]] = numbers[:, known:]
        needed += efforts
    ignored = (*(name for k, name in enumerate(header) if k not in needed), *table.ignored)
    velocity = numbers[:, 1 + n : known] if known > 1 + n else None
    state = time / tables.PER_SECOND[unit], joints, position, velocity
    raw = Motion(*state, warnings, str(path), ignored, unit, effort)
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
    unit = next((u for u, n in tables.PER_SECOND.items() if float(np.median(steps)) < n), "ns")
    rated = np.array([joint.velocity for joint in parameters().joints[: path.size]])
    fast = path / (steps / tables.PER_SECOND[unit]).sum() > 2 * rated
    return "s" if fast.any() else unit
