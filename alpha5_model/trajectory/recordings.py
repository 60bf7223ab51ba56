"""Joint motion from files: CSV, Parquet and ROS bags."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray, flag
from alpha5_model._support.files import PathLike
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.trajectory.bag_table import BagTable
from alpha5_model.trajectory.checks import (
    GAP_FACTOR,
    MINIMUM_SAMPLES,
    Origin,
    checked,
)
from alpha5_model.trajectory.csv_table import CsvTable
from alpha5_model.trajectory.current_units import in_amperes
from alpha5_model.trajectory.file_table import PER_SECOND, FileTable, Progress
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.motions import Motion
from alpha5_model.trajectory.parquet_table import ParquetTable
from alpha5_model.trajectory.roles import Roles, find_roles
from alpha5_model.trajectory.time_units import time_unit
from alpha5_model.trajectory.warning import MotionWarning

_BAGS = (".bag", ".db3", ".mcap")
_PARQUET = (".parquet", ".pq")
#: One of so many rows may be bad; one of fewer may be, too.
_ROWS_FOR_A_BAD_ONE = 100


def read_motion(
    path: PathLike,
    progress: Progress | None = None,
    *,
    topic: str | None = None,
    prefix: str | None = None,
    arm: Alpha5Parameters | None = None,
    joints: Mapping[str, str] | None = None,
    degrees: bool = False,
    time: str | None = None,
    episode: int | None = None,
) -> Motion:
    """Read joint motion from a CSV or Parquet file, or from a ROS bag.

    A CSV is UTF-8, UTF-16 or Windows-1252 text. Commas, semicolons, tabs or blanks
    separate its columns; where commas do not, they are decimal commas. Lines that start
    with ``#`` are comments, of which the last may hold the names of the columns. One
    row in a hundred may be unreadable: it is left out with a warning. More are an
    error. If most rows have some joints only, as a bus that is polled joint by joint
    writes them, they are joined by time, and gaps are interpolated with a warning.

    Angles that start again after a full turn go on (warning ``wrapped``). Up to three
    samples that leave and return faster than the joint can are left out (``spike``), as
    are values that all joints hold in the middle of a motion until one jumps
    (``drop_out``). A motion is smoothed on each side of a jump on its own.

    A table has these columns, in any order:

    - the time: ``time_secs`` or ``time`` [s], ``time_ms``, ``time [us]`` and the like;
    - positions of ``axis_e, axis_d, axis_c, axis_b`` [rad], optionally also of the jaw
      rod ``axis_a`` [m]: ``axis_b_pos``, ``axis_b_position``, ``axis_b`` or
      ``q_axis_b``;
    - velocities, optional, of all these joints or none: ``axis_b_vel``,
      ``axis_b_velocity`` or ``dq_axis_b``;
    - efforts [N m], optional, NaN if unknown: ``axis_b_effort`` or ``effort_axis_b``;
    - currents of the motors, optional, NaN if unknown: ``axis_b_current`` or
      ``current_axis_b``, in A, or in mA if no motor could take as many A at 24 V.

    The name of a robot may come before the joint; capitals do not matter. A column
    holds positions only if each word of its name agrees: torques, commands,
    errors and unknown words do not. Such columns are ignored and listed in
    `Motion.ignored`; a warning names commands. If there are no positions, the error
    explains what the columns are.

    A unit may stand behind the name of a column, as in ``axis_e_pos [deg]``,
    ``axis_e_deg``, ``axis_e_vel [deg/s]``, ``axis_a_pos [mm]`` or
    ``axis_e_current_mA``. Efforts in A or mA are currents.

    Numbered columns (``position[0]``, ``field.position0``) belong to the joints that
    ``name[0]`` and so on name in each row. A CSV of ``ros2 topic echo --csv`` has no
    names of columns.

    A column ``time`` with steps of a second or more is read in milliseconds, or in a
    smaller unit, if the joints can move that fast; a warning says so. If there is no
    such column, the time is the first of ``t``, ``timestamp``, ``ros_time``,
    ``sim_time``, ``wall_time_sec`` and the like, of PlotJuggler's ``__time``, of
    ``%time`` as ``rostopic echo -p`` writes it, or of a stamp's ``header.stamp.sec``
    and ``header.stamp.nanosec``. In a CSV it may be a date and time of ISO 8601
    (``2026-11-23 18:53:54.25``), a time of day or duration (``hh:mm:ss.fff``,
    ``0 days 00:00:00.02``, ``0.02 sec``), with a column ``Date`` beside it or without;
    in Parquet files (``.parquet``, needs pyarrow) one of Parquet's types of time.

    A Parquet file may have a column ``observation.state`` with a list of numbers per
    row, as LeRobot's data sets do. Their names stand in ``meta/info.json`` of the data
    set, or in the file's metadata; without names they are ``observation.state[0]`` and
    so on, for `joints`. ``action`` is a command.

    A bag (ROS 1 ``.bag``, ROS 2 ``.db3``, ``.mcap``, or the folder with its
    ``metadata.yaml``; needs rosbags) holds ``sensor_msgs/JointState`` messages. Their
    stamps are the time. If a message has no stamp, the times of recording are used for
    all. Messages without all joints or with positions that are not finite are left out,
    and messages that were late are sorted, each with a warning. A clock that was set
    back is an error. Messages of one joint each are joined like rows. MCAP files that
    are no ROS 2 bags need mcap, too; their messages may be JSON, CDR or ROS 1.

    Args:
        path: The file.
        progress: Called with a stage's name and the part done, 0 to 1.
        topic: Topic of a bag; None for the only one with the arm's joints.
        prefix: Prefix of the joints' names, such as ``left_`` in ``left_axis_e``. None
            for names without a prefix, or else for the only prefix. If you give it,
            columns whose prefix says command, or nothing known, are read as positions.
            Torques never are.
        arm: Record of an arm of your own, for its ranges, rated speeds and signs; None
            for the catalogue's. A joint whose sign is -1 is turned into the model's
            direction, with its velocity, effort and current.
        joints: Joint of the arm -> its name in the file, for a file with other names:
            ``{"axis_e": "joint_1", ...}`` reads ``joint_1_pos`` as ``axis_e_pos``.
            ``"-joint_1"`` turns the other way in the file: its positions, velocities,
            efforts and currents change their signs.
        degrees: Whether angles are in degrees, and their velocities in deg/s, if the
            columns name no unit.
        time: Name of the column of the time in a table, ``"NAME"``, or ``"NAME:ms"``
            with its unit (``s``, ``ms``, ``us`` or ``ns``); None to find it.
        episode: Number of the recording in a Parquet file of several, as its column
            ``episode_index`` counts them.

    Raises:
        InputError: Not a path, fewer than 5 samples, a topic for a file that is no bag,
            several topics or prefixes to choose from, a name of a joint that the file
            does not have.
        UnknownNameError: A topic that the bag does not have, or no joint of the arm.
        MissingFileError: No such file.
        MissingDependencyError: rosbags or pyarrow is not installed.
        FileFormatError: A missing or doubled column, another separator, an empty file,
            a Git LFS pointer, angles that are in degrees, several rows of another
            length or with text or NaN for a number, several episodes in one file, or
            time that runs back; the message names the place. Or a bag that is damaged
            or has no joint states of the arm.
    """
    table: FileTable
    named = JointMap(joints)
    is_parquet = _file(path).suffix.lower() in _PARQUET
    if episode is not None and not is_parquet:
        expected = "no value: only a Parquet file has episodes"
        raise InputError("episode", episode, expected)
    if _is_bag(path):
        if time is not None:
            raise InputError("time", time, "no value: a bag's messages have stamps")
        bag = BagTable(path, topic, prefix, named, progress)
        table = bag
        prefix = bag.prefix
    elif topic is not None:
        raise InputError("topic", topic, "no value: only a ROS bag has topics")
    elif is_parquet:
        table = ParquetTable(path, named, episode)
    else:
        table = CsvTable(path, named, progress)

    roles = find_roles(path, table, prefix, flag("degrees", degrees), time)
    record = chosen_arm(arm)
    signs = record.signs[: len(roles.joints)] * named.signs(roles.joints)
    raw, rows = _recorded(path, table, roles, record, signs)
    return checked(raw, record, _FileOrigin(path, table, roles, rows))


class _FileOrigin(Origin):
    """Samples from the rows of a file."""

    def __init__(
        self,
        path: PathLike,
        table: FileTable,
        roles: Roles,
        rows: NDArray[np.intp],
    ) -> None:
        self._path = path
        self._table = table
        self._roles = roles
        #: Row of the table of each sample.
        self._rows = rows

    def name(self, motion: Motion) -> str:
        """The file with its warnings, which may explain why there are few samples."""
        odd = "; ".join(map(str, motion.warnings))
        return f"{motion.source} ({odd})" if odd else motion.source

    def place(self, sample: int, joint: str | None) -> str:
        """Where the time or the position of a sample is in the file."""
        roles = self._roles
        column = roles.time
        if joint is not None:
            column = roles.positions[roles.joints.index(joint)]
        return self._table.place(int(self._rows[sample]), column)

    @property
    def to_radians(self) -> str:
        """What to do with angles in degrees."""
        return (
            "name the columns axis_e_pos [deg] and so on, or give --degrees "
            "(read_motion: degrees=True)"
        )

    def error(
        self, sample: int, joint: str | None, value: float, expected: str
    ) -> Alpha5Error:
        """The error about a number of a sample."""
        place = self.place(sample, joint)
        return FileFormatError(self._path, f"expected {expected}", place)


def _file(path: PathLike) -> Path:
    """The path that the caller gave; `read_named` checks later that it is one."""
    return Path(str(path))


def _is_bag(path: PathLike) -> bool:
    """Whether a path is a ROS bag: by its suffix, or a folder's ``metadata.yaml``."""
    file = _file(path)
    if file.suffix.lower() in _BAGS:
        return True
    with suppress(OSError, ValueError):  # a name that no file can have
        return (file / "metadata.yaml").is_file()
    return False


def _recorded(
    path: PathLike,
    table: FileTable,
    roles: Roles,
    parameters: Alpha5Parameters,
    signs: FloatArray,
) -> tuple[Motion, NDArray[np.intp]]:
    """The motion in a file before it is checked, and the row of each sample.

    Args:
        path: The file, for messages.
        table: Its columns.
        roles: What they mean.
        parameters: The arm.
        signs: Of the joints' directions in the file, (n,).
    """
    columns = roles.columns
    numbers, unit = table.read(columns)
    for k, column in enumerate(columns):
        if column in roles.scales:
            numbers[:, k] *= roles.scales[column]
    if roles.nanoseconds is not None:
        numbers[:, 0] += numbers[:, -1] / PER_SECOND["ns"]
        unit = "s"

    n = len(roles.joints)
    needed = [roles.time, *roles.positions]
    rows, warnings = _usable_rows(path, table, numbers[:, : n + 1], needed)
    samples = numbers if rows.size == len(numbers) else numbers[rows]
    if np.isnan(samples[:, 1 : n + 1]).any():
        rows, samples, joined = _joined(table, roles, samples, rows)
        warnings += joined

    after_velocities = 1 + n + len(roles.velocities)
    after_efforts = after_velocities + len(roles.efforts)
    velocity: FloatArray | None = None
    if roles.velocities:
        velocity = samples[:, 1 + n : after_velocities]
        unknown = ~np.isfinite(velocity).all(axis=1)
        if unknown.any():
            velocity = None
            missing = MotionWarning(
                kind="velocity",
                count=int(unknown.sum()),
                first=table.place(int(rows[np.argmax(unknown)]), roles.velocities[0]),
                text="no velocities, so none is used",
            )
            warnings.append(missing)
    end = after_efforts + len(roles.currents)
    effort = _by_joint(
        samples[:, after_velocities:after_efforts], roles.efforts, roles.joints
    )
    current = _by_joint(samples[:, after_efforts:end], roles.currents, roles.joints)

    # From the driver's directions to the model's.
    position = signs * samples[:, 1 : n + 1]
    velocity = None if velocity is None else signs * velocity
    effort = None if effort is None else signs * effort
    current = None if current is None else signs * current

    finite = np.isfinite(numbers)
    read = {column for k, column in enumerate(columns) if finite[:, k].any()}
    unused = [name for k, name in enumerate(table.header) if k not in read]

    warnings = [*table.warnings, *roles.warnings, *warnings]
    if current is not None and not roles.scales.keys() & {*roles.currents.values()}:
        current, doubts = in_amperes(current, parameters, table.head)
        warnings += doubts
    time = samples[:, 0]
    unit = unit or roles.time_unit
    if unit is None:
        name = table.header[roles.time]
        unit, doubt = time_unit(name, time, position, parameters)
        if doubt:
            warning = MotionWarning(
                kind="time_unit",
                count=1,
                first=table.place(int(rows[0]), roles.time),
                text=doubt,
            )
            warnings.append(warning)
    motion = Motion(
        time=time / PER_SECOND[unit],
        joints=roles.joints,
        position=position,
        velocity=velocity,
        warnings=tuple(warnings),
        source=str(path),
        ignored=(*unused, *table.ignored),
        time_unit=unit,
        effort=effort,
        current=current,
    )
    return motion, rows


def _usable_rows(
    path: PathLike, table: FileTable, numbers: FloatArray, needed: list[int]
) -> tuple[NDArray[np.intp], list[MotionWarning]]:
    """The rows with a time and positions, and a warning about those left out.

    Rows with positions of some joints are usable if most rows are such: a bus that is
    polled joint by joint writes them.

    Args:
        path: The file, for messages.
        table: Its columns.
        numbers: Time and positions, (N, n + 1); NaN for what is no number.
        needed: Their columns.

    Raises:
        FileFormatError: More than one row in a hundred cannot be read.
    """
    finite = np.isfinite(numbers)
    complete = finite.all(axis=1)
    partial = finite[:, 0] & finite[:, 1:].any(axis=1) & ~complete
    polled = 2 * np.count_nonzero(partial) > len(numbers)
    each_joint = bool((np.count_nonzero(finite, axis=0) >= MINIMUM_SAMPLES).all())
    usable = complete | partial if polled and each_joint else complete

    bad = np.flatnonzero(~usable)
    if not bad.size:
        return np.arange(len(numbers)), []
    problem = table.problem(int(bad[0]), needed)
    if bad.size > max(1, len(numbers) // _ROWS_FOR_A_BAD_ONE):
        raise FileFormatError(path, problem.text, problem.place)
    warning = MotionWarning(
        kind="bad_row",
        count=bad.size,
        first=problem.place,
        text=f"row left out ({problem.text})",
    )
    return np.flatnonzero(usable), [warning]


def _joined(
    table: FileTable, roles: Roles, samples: FloatArray, rows: NDArray[np.intp]
) -> tuple[NDArray[np.intp], FloatArray, list[MotionWarning]]:
    """Samples with all positions and velocities, from rows with some joints each.

    Numbers of one time are one sample. Positions and velocities are interpolated in
    time between those of the same joint; samples before the first or behind the last
    position of a joint are left out. Efforts and currents stay as they are.

    Args:
        table, roles: The file's columns, and what they mean.
        samples: (N, k) As `Roles.columns`; NaN for what a row does not have.
        rows: Row of the table of each sample, (N,).
    """
    time = samples[:, 0]
    if (np.diff(time) < 0.0).any():
        return rows, samples, []  # `checked` refuses it

    joined_time, first = np.unique(time, return_index=True)
    joined = np.full((joined_time.size, samples.shape[1]), np.nan)
    joined[:, 0] = joined_time
    place_of = np.searchsorted(joined_time, time)
    for k in range(1, samples.shape[1]):
        known = np.isfinite(samples[:, k])
        joined[place_of[known], k] = samples[known, k]

    n = len(roles.joints)
    inside = np.ones(joined_time.size, dtype=bool)
    warnings = []
    for k in range(1, 1 + n + len(roles.velocities)):
        known = np.flatnonzero(np.isfinite(joined[:, k]))
        if not known.size:
            continue
        at = joined_time[known]
        joined[:, k] = np.interp(joined_time, at, joined[known, k])
        if k > n:
            continue
        inside &= (joined_time >= at[0]) & (joined_time <= at[-1])
        steps = np.diff(at)
        long = steps > GAP_FACTOR * np.median(steps)
        if long.any():
            row = int(rows[first[known[1 + int(np.argmax(long))]]])
            gap = MotionWarning(
                kind="gap",
                count=int(long.sum()),
                first=table.place(row, roles.positions[k - 1]),
                text=f"{roles.joints[k - 1]} without a sample for up to "
                f"{steps.max():.3g} of the time's unit, interpolated",
            )
            warnings.append(gap)
    note = MotionWarning(
        kind="joined",
        count=len(rows),
        first=table.place(int(rows[0]), roles.time),
        text="rows without all joints, joined by time and interpolated",
    )
    return rows[first[inside]], joined[inside], [note, *warnings]


def _by_joint(
    columns: FloatArray, column_of: Mapping[str, int], joints: Sequence[str]
) -> FloatArray | None:
    """A quantity of all joints, NaN for a joint without; None if no joint has it.

    Args:
        columns: The quantity of k joints, (N, k).
        column_of: Has the names of these k joints.
        joints: All joints.
    """
    if not columns.shape[1]:
        return None
    recorded = [joint in column_of for joint in joints]
    values = np.full((len(columns), len(joints)), np.nan)
    values[:, recorded] = columns
    return values
