"""Names of columns of tables that ROS programs write from ``JointState`` messages.

``rostopic echo -p`` numbers the columns (``field.position0``), others write
``position[0]``; the joints' names are texts in each row. ``ros2 topic echo --csv``
writes no names of columns at all.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

_QUANTITIES = ("position", "velocity", "effort")
#: ``field.position0``, ``position[0]``, ``/joint_states/position.0``: what, and which.
_NUMBERED = re.compile(r"(?:.*[./])?(name|position|velocity|effort)[\[.]?(\d{1,4})\]?")
#: Whole seconds of a stamp; its nanoseconds are in a column of their own.
_STAMP_SECONDS = re.compile(r"((?:.*[./_])?stamp[./_])secs?")
_NANOSECONDS = ("nanosec", "nsecs", "nsec", "nanosecs", "nanoseconds")
#: Fields of a message before the joints' names: two of the stamp, and the frame.
_BEFORE_NAMES = 3


def echoed_names(row: Sequence[str]) -> list[str] | None:
    """Names of the columns of a row that ``ros2 topic echo --csv`` wrote.

    The row has seconds, nanoseconds, a frame, the names of n joints, and their
    positions, velocities and efforts. If one or two of these three are missing, only
    the positions are named: nothing tells velocities from efforts.

    Args:
        row: The texts of a row, from `text_table`.

    Returns:
        One name per column; None if the row is another one.
    """
    stamp = row[: _BEFORE_NAMES - 1]
    if len(stamp) < _BEFORE_NAMES - 1 or not all(text.isdecimal() for text in stamp):
        return None
    count = 0
    for text in row[_BEFORE_NAMES:]:
        if not text[:1].isalpha() and text[:1] not in ("_", "/"):
            break
        count += 1
    numbers = len(row) - _BEFORE_NAMES - count
    if count == 0 or numbers not in (count, 2 * count, 3 * count):
        return None

    complete = numbers == len(_QUANTITIES) * count
    quantities = _QUANTITIES if complete else _QUANTITIES[:1]
    names = ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"]
    for quantity in ("name", *quantities):
        names += [f"{quantity}[{k}]" for k in range(count)]
    names += [f"other[{k}]" for k in range(len(row) - len(names))]
    return names


def joint_name_columns(header: Sequence[str]) -> dict[int, int]:
    """Number of a joint in the messages -> column with its name."""
    columns = {}
    for column, name in enumerate(header):
        match = _NUMBERED.fullmatch(name)
        if match and match[1] == "name":
            columns[int(match[2])] = column
    return columns


def with_joint_names(header: Sequence[str], row: Sequence[str]) -> list[str]:
    """Names of columns with the joints' names for their numbers.

    Args:
        header: Names of the columns.
        row: The texts of a row, with the joints' names.

    Returns:
        ``axis_e_position`` for ``position[0]`` if ``name[0]`` is ``axis_e``; a column
        without such a name keeps its own.
    """
    joints = {
        number: row[column] for number, column in joint_name_columns(header).items()
    }
    names = []
    for name in header:
        match = _NUMBERED.fullmatch(name)
        joint = joints.get(int(match[2])) if match else None
        if match and match[1] in _QUANTITIES and joint:
            names.append(f"{joint}_{match[1]}")
        else:
            names.append(name)
    return names


def nanoseconds_of(time: str, header: Sequence[str]) -> int | None:
    """The column with the nanoseconds of a stamp; None if its seconds are not whole.

    Args:
        time: Name of the column of the time, such as ``header.stamp.sec``.
        header: Names of all columns.
    """
    match = _STAMP_SECONDS.fullmatch(time)
    if match is None:
        return None
    wanted = {match[1] + ending for ending in _NANOSECONDS}
    found = [column for column, name in enumerate(header) if name in wanted]
    if len(found) != 1:
        return None
    (column,) = found
    return column
