"""Which columns of a table are the time and the quantities of the arm's joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.file_table import PER_SECOND, FileTable
from alpha5_model.trajectory.names import (
    COMMAND,
    CURRENT,
    EFFORT,
    POSITION,
    TORQUE,
    UNKNOWN,
    VELOCITY,
    Column,
    explained,
    groups,
    joint_columns,
    only_choice,
)
from alpha5_model.trajectory.ros_columns import nanoseconds_of
from alpha5_model.trajectory.time_units import CLOCK, TIME_WITH_UNIT
from alpha5_model.trajectory.warning import MotionWarning

#: Meanings of columns that one may take for positions, velocities or efforts.
_NOTABLE = (UNKNOWN, TORQUE, "force", "angle in degrees", "speed of another unit")
#: Columns that a warning lists.
_LISTED = 8
_TIME = ("time_secs", "time")
#: What a turning joint has in rad and rad/s.
_ANGLES = (POSITION, VELOCITY)


@dataclass(frozen=True)
class Roles:
    """The columns that are read, and warnings about the others.

    Attributes:
        time: Column of the time.
        nanoseconds: Column of the nanoseconds of a stamp, if the time is its seconds.
        joints: Joints with a position, base to tip.
        positions, velocities: Columns, joint by joint; no velocities if none is
            recorded.
        efforts, currents: Joint -> column, of the joints that have one.
        warnings: About columns that the caller may miss.
        scales: Column -> SI units in its unit, of the columns that are not in SI.
        time_unit: Unit of the time that the caller gave; None if none.
    """

    time: int
    nanoseconds: int | None
    joints: tuple[str, ...]
    positions: list[int]
    velocities: list[int]
    efforts: dict[str, int]
    currents: dict[str, int]
    warnings: list[MotionWarning]
    scales: dict[int, float]
    time_unit: str | None = None

    @property
    def columns(self) -> list[int]:
        """All columns that are read, the time first."""
        columns = [
            self.time,
            *self.positions,
            *self.velocities,
            *self.efforts.values(),
            *self.currents.values(),
        ]
        return columns if self.nanoseconds is None else [*columns, self.nanoseconds]


def find_roles(
    path: PathLike,
    table: FileTable,
    wanted_prefix: str | None,
    degrees: bool,
    wanted_time: str | None = None,
) -> Roles:
    """Which columns of a table are the time and the joints' quantities.

    Args:
        path: The file, for messages.
        table: Its columns.
        wanted_prefix: The prefix of the joints that the caller gave; None if none.
        degrees: Whether angles are in degrees if their columns name no unit.
        wanted_time: Column of the time that the caller gave, ``NAME`` or
            ``NAME:unit``; None if none.

    Raises:
        InputError: Several arms to choose from, or no such column of the time.
        FileFormatError: A missing or a doubled column.
    """
    columns = _Columns(path, table, wanted_prefix)
    time_unit: str | None = None
    time_warnings: list[MotionWarning] = []
    if wanted_time is None:
        time_names, time_warnings = _time_names(table)
        expected = ": expected time_secs or time or time_ms, or name it by --time"
        time = columns.only(time_names, "the time", expected)
    else:
        time, time_unit = _chosen_time(table, wanted_time)

    has_rod = columns.names(JOINT_NAMES[4], POSITION)
    joints = JOINT_NAMES if has_rod else JOINT_NAMES[:4]
    return Roles(
        time=time,
        nanoseconds=nanoseconds_of(table.header[time], table.header),
        joints=joints,
        positions=[columns.position(joint) for joint in joints],
        velocities=columns.velocities(joints),
        efforts=columns.efforts(joints),
        currents=columns.currents(joints),
        warnings=[
            *time_warnings,
            *columns.command_warnings(),
            *columns.unused_warnings(),
        ],
        scales=columns.scales(degrees),
        time_unit=time_unit,
    )


class _Columns:
    """The columns of a table that name a joint, and which of them are the arm's."""

    def __init__(
        self, path: PathLike, table: FileTable, wanted_prefix: str | None
    ) -> None:
        self._path = path
        self._table = table
        self._named = joint_columns(table.header, wanted_prefix)
        # If no group has all joints, the message of `only` names what is missing.
        complete = groups(self._named, wanted_prefix) or [wanted_prefix or ""]
        self._group = only_choice("prefix", complete)
        self._arm: list[Column] = [
            column for column in self._named if column.group == self._group
        ]

    def names(self, joint: str, meaning: str) -> list[str]:
        """Names of the columns with a quantity of a joint."""
        return [
            column.name
            for column in self._arm
            if column.joint == joint and column.meaning == meaning
        ]

    def only(self, names: list[str], what: str, missing: str = "") -> int:
        """The column of the only name.

        Args:
            names: All names found.
            what: What they stand for, for messages.
            missing: What the message adds if there is none.

        Raises:
            FileFormatError: There is no name, or there are several.
        """
        header = self._table.header
        if len(names) == 1:
            column_of = {name: column for column, name in enumerate(header)}
            return column_of[names[0]]
        if names:
            number = "two" if len(names) == 2 else len(names)
            problem = f"{number} columns for {what}: {', '.join(names)}"
        else:
            got = ", ".join(self._table.names)[:200]
            problem = f"no column for {what}{missing}, got {got}"
        raise FileFormatError(self._path, problem, self._table.head)

    def position(self, joint: str) -> int:
        """The column with the positions of a joint."""
        missing = self._expected(joint, ("_pos", "_position", ""))
        reasons = explained(self._named, joint)
        if reasons:
            missing += f"; {reasons}"
        names = self.names(joint, POSITION)
        return self.only(names, f"the position of {joint}", missing)

    def velocities(self, joints: Sequence[str]) -> list[int]:
        """The columns with the velocities of all joints; none if none is recorded."""
        if not any(self.names(joint, VELOCITY) for joint in joints):
            return []
        columns = []
        for joint in joints:
            expected = self._expected(joint, ("_vel", "_velocity"))
            missing = f", while others have one{expected}"
            names = self.names(joint, VELOCITY)
            columns.append(self.only(names, f"the velocity of {joint}", missing))
        return columns

    def efforts(self, joints: Sequence[str]) -> dict[str, int]:
        """Joint -> column with its efforts, for the joints that have one."""
        columns = {}
        for joint in joints:
            names = self.names(joint, EFFORT)
            if names:
                columns[joint] = self.only(names, f"the effort of {joint}")
        return columns

    def currents(self, joints: Sequence[str]) -> dict[str, int]:
        """Joint -> column with the recorded currents of its motor.

        A current with an interval is one that this package computed and wrote.
        """
        columns = {}
        header = {*self._table.header}
        for joint in joints:
            names = self.names(joint, CURRENT)
            recorded = [name for name in names if f"{name}_lower" not in header]
            if recorded:
                columns[joint] = self.only(recorded, f"the current of {joint}")
        return columns

    def scales(self, degrees: bool) -> dict[int, float]:
        """Column -> SI units in its unit, of those that are not in SI.

        Args:
            degrees: Whether angles are in degrees if their columns name no unit.
        """
        scale_of = {}
        for column in self._arm:
            angle = column.joint != JOINT_NAMES[4] and column.meaning in _ANGLES
            if column.scale is not None:
                scale_of[column.name] = column.scale
            elif degrees and angle:
                scale_of[column.name] = math.pi / 180.0
        header = self._table.header
        return {k: scale_of[name] for k, name in enumerate(header) if name in scale_of}

    def command_warnings(self) -> list[MotionWarning]:
        """A warning about commands, which are not measured, if there are any."""
        commands = [column.name for column in self._named if column.meaning == COMMAND]
        if not commands:
            return []
        head = self._table.head
        warning = MotionWarning(
            kind="command",
            count=len(commands),
            first=f"{commands[0]}, {head}" if head else commands[0],
            text="a command or reference, not measured; ignored",
        )
        return [warning]

    def unused_warnings(self) -> list[MotionWarning]:
        """A warning about columns of the arm that are not understood, or torques.

        Torques beside their causes are those that this package computed and wrote.
        """
        header = {*self._table.header}
        unused = [
            column.name
            for column in self._arm
            if column.meaning in _NOTABLE
            and f"{column.joint}_torque_inertia" not in header
        ]
        if not unused:
            return []
        listed = ", ".join(name[:60] for name in unused[:_LISTED])
        more = ", ..." if len(unused) > _LISTED else ""
        warning = MotionWarning(
            kind="not_used",
            count=len(unused),
            first=self._table.head or unused[0],
            text=f"columns of joints that are not used ({listed}{more})",
        )
        return [warning]

    def _expected(self, joint: str, endings: Sequence[str]) -> str:
        """The names that a column of a joint may have, for messages."""
        names = [self._group + joint + ending for ending in endings]
        return f": expected {' or '.join(names)}"


def _chosen_time(table: FileTable, wanted: str) -> tuple[int, str | None]:
    """The column that the caller named as the time, and its unit if one is given."""
    names = [*table.names]
    name, _, unit = wanted.rpartition(":")
    if wanted in names:
        return names.index(wanted), None
    if name in names and unit in PER_SECOND:
        return names.index(name), unit
    units = ", ".join(PER_SECOND)
    got = ", ".join(names)[:200]
    expected = f"a column of the file ({got}), with :UNIT ({units}) if it has one"
    raise InputError("time", wanted, expected)


def _time_names(table: FileTable) -> tuple[list[str], list[MotionWarning]]:
    """The names of columns that hold the time, and a warning if one was picked."""
    header = table.header
    plain = [name for name in header if name.lower() in _TIME]
    if plain:
        return plain, []
    with_unit = [name for name in header if TIME_WITH_UNIT.fullmatch(name)]
    if with_unit:
        return with_unit, []

    clocks = [name for name in header if CLOCK.fullmatch(name)]
    if len(clocks) < 2:
        return clocks, []
    first, *others = clocks
    warning = MotionWarning(
        kind="time_column",
        count=1,
        first=table.head,
        text=f"{first} read as the time, not {', '.join(others)}",
    )
    return [first], [warning]
