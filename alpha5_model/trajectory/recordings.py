"""Joint motion from files: CSV, Parquet and ROS bags."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray, flag
from alpha5_model._support.files import PathLike
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.checks import (
    GAP_FACTOR,
    MINIMUM_SAMPLES,
    Origin,
    checked,
    most_amperes,
)
from alpha5_model.trajectory.column_names import (
    JointMap,
    Roles,
    find_roles,
    likely_time_unit,
    without_other_joints,
)
from alpha5_model.trajectory.csv_file import read_csv
from alpha5_model.trajectory.motions import Motion, MotionWarning
from alpha5_model.trajectory.parquet_file import read_parquet
from alpha5_model.trajectory.tables import PER_SECOND, Progress, Table

_BAGS = (".bag", ".db3", ".mcap")
_PARQUET = (".parquet", ".pq")
#: One of so many rows may be bad; one of fewer may be, too.
_ROWS_FOR_A_BAD_ONE = 100
_MILLI = 1e-3


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

    A table has these columns, in any order:

    - the time: ``time_secs`` or ``time`` [s], ``time_ms``, ``time [us]`` and the like;
    - positions of ``axis_e, axis_d, axis_c, axis_b`` [rad], optionally also of the jaw
      rod ``axis_a`` [m]: ``axis_b_pos``, ``axis_b_position``, ``axis_b`` or
      ``q_axis_b``;
    - velocities, optional, of all these joints or none: ``axis_b_vel`` and the like;
    - efforts [N m], optional, NaN if unknown: ``axis_b_effort``;
    - currents of the motors, optional, NaN if unknown: ``axis_b_current``, in A, or in
      mA if no motor could take as many A at 24 V.

    Or each row is about the joint that its column ``joint`` names. A name is read only
    if each of its words is known; other columns are listed in `Motion.ignored`. A unit
    may follow, as in ``axis_e_pos [deg]`` or ``axis_e_current_mA``. A bag (ROS 1
    ``.bag``, ROS 2 ``.db3``, ``.mcap``, or the folder with its ``metadata.yaml``)
    holds ``sensor_msgs/JointState`` messages.

    Faults of recordings are repaired with a warning, or refused; the guide "A recorded
    motion to torque and current" lists them, and all forms of files and times.

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
            with its unit (``s``, ``ms``, ``us``, ``ns`` or ``min``); None to find it.
        episode: Number of the recording in a Parquet file of several, as its column
            ``episode_index`` counts them.

    Raises:
        InputError: Not a path, fewer than 5 samples, a topic for a file that is no bag,
            several topics or prefixes to choose from, a name of a joint that the file
            does not have.
        UnknownNameError: A topic that the bag does not have, or no joint of the arm.
        MissingFileError: No such file.
        MissingDependencyError: rosbags or pyarrow is not installed.
        FileFormatError: A missing or doubled column, an empty file, a Git LFS pointer,
            angles that are in degrees, more than one bad row in a hundred, several
            episodes in one file, or time that runs back; the message names the place.
            Or a bag that is damaged or has no joint states of the arm.
    """
    named = JointMap(joints)
    is_bag = _is_bag(path)
    is_parquet = Path(str(path)).suffix.lower() in _PARQUET
    if episode is not None and not is_parquet:
        expected = "no value: only a Parquet file has episodes"
        raise InputError("episode", episode, expected)
    if topic is not None and not is_bag:
        raise InputError("topic", topic, "no value: only a ROS bag has topics")
    if time is not None and is_bag:
        raise InputError("time", time, "no value: a bag's messages have stamps")

    if is_bag:
        from alpha5_model.trajectory.bags import read_bag

        table = read_bag(path, topic, prefix, named, progress)
        header = table.header
        prefix = None
    else:
        table = read_parquet(path, episode) if is_parquet else read_csv(path, progress)
        header = named.renamed(table.header)

    roles = find_roles(path, table, header, prefix, flag("degrees", degrees), time)
    table = without_other_joints(table, roles)
    record = chosen_arm(arm)
    raw, rows = _recorded(path, table, header, roles, record, named)
    return checked(raw, record, _FileOrigin(path, table, roles, rows))


class _FileOrigin(Origin):
    """Samples from the rows of a file.

    Args:
        path: The file.
        table: Its numbers.
        roles: What its columns are.
        rows: Row of the table of each sample.
    """

    to_radians = (
        "name the columns axis_e_pos [deg] and so on, or give --degrees (read_motion: "
        "degrees=True)"
    )

    def __init__(
        self, path: PathLike, table: Table, roles: Roles, rows: NDArray[np.intp]
    ) -> None:
        self._path = path
        self._table = table
        self._roles = roles
        self._rows = rows

    def place(self, sample: int, joint: str | None) -> str:
        """Where the time or the position of a sample is in the file."""
        roles = self._roles
        column = roles.time
        if joint is not None:
            column = roles.positions[roles.joints.index(joint)]
        return self._table.place(int(self._rows[sample]), column)

    def error(
        self, sample: int, joint: str | None, value: float, expected: str
    ) -> Alpha5Error:
        """The error about a number of a sample."""
        place = self.place(sample, joint)
        return FileFormatError(self._path, f"expected {expected}", place)


def _is_bag(path: PathLike) -> bool:
    """Whether a path is a ROS bag: by its suffix, or a folder's ``metadata.yaml``."""
    file = Path(str(path))
    if file.suffix.lower() in _BAGS:
        return True
    with suppress(OSError, ValueError):  # a name that no file can have
        return (file / "metadata.yaml").is_file()
    return False


class _Samples(NamedTuple):
    """What is read of each sample, in the model's directions.

    Attributes:
        row: Of the table, (N,).
        time: (N,) In the unit of the file.
        position: (N, n) [rad], jaw rod [m].
        velocity, effort, current: (N, n) In SI units, NaN if unknown; None if the file
            has none.
    """

    row: NDArray[np.intp]
    time: FloatArray
    position: FloatArray
    velocity: FloatArray | None
    effort: FloatArray | None
    current: FloatArray | None


def _recorded(
    path: PathLike,
    table: Table,
    header: Sequence[str],
    roles: Roles,
    parameters: Alpha5Parameters,
    named: JointMap,
) -> tuple[Motion, NDArray[np.intp]]:
    """The motion in a file before it is checked, and the row of each sample.

    Args:
        path: The file, for messages.
        table: Its numbers.
        header: Names of its columns, with the arm's joints.
        roles: What they mean.
        parameters: The arm.
        named: The joints that turn the other way in the file.
    """
    roles = _without_missing_rod(table.values, roles)
    signs = parameters.signs[: len(roles.joints)] * named.signs(roles.joints)
    rows, warnings = _usable_rows(path, table, roles)
    samples = _samples(table, roles, rows, signs)
    if np.isnan(samples.position).any():
        samples, more = _joined(path, table, roles, samples)
        warnings += more
    velocity, more = _whole_velocity(table, roles, samples)
    warnings += more

    current = samples.current
    states_unit = roles.scales.keys() & {*roles.currents.values()}
    if current is not None and not states_unit:
        most = most_amperes(parameters)
        too_large = int(np.count_nonzero(np.abs(current) > most))
        if too_large:
            current = current * _MILLI
            warning = MotionWarning(
                kind="current_unit",
                count=too_large,
                first=table.head or "all samples",
                text=f"currents read in mA: in A they exceed the {most:.3g} A of a "
                "stalled motor; call the columns axis_e_current_A if they are in A",
            )
            warnings.append(warning)

    unit, more = _time_unit(table, header, roles, samples, parameters)
    warnings += more
    read = {k for k in roles.columns if np.isfinite(table.values[:, k]).any()}
    unused = [name for k, name in enumerate(header) if k not in read]
    motion = Motion(
        time=samples.time / PER_SECOND[unit],
        joints=roles.joints,
        position=samples.position,
        velocity=velocity,
        warnings=(*table.warnings, *roles.warnings, *warnings),
        source=str(path),
        ignored=(*unused, *table.ignored),
        time_unit=unit,
        effort=samples.effort,
        current=current,
    )
    return motion, samples.row


def _time_unit(
    table: Table,
    header: Sequence[str],
    roles: Roles,
    samples: _Samples,
    parameters: Alpha5Parameters,
) -> tuple[str, list[MotionWarning]]:
    """The unit of the time, a key of `PER_SECOND`, and a warning if it is doubtful."""
    if roles.time in table.in_seconds or roles.nanoseconds is not None:
        return "s", []
    likely = likely_time_unit(samples.time, samples.position, parameters)
    stated = roles.time_unit
    if likely == "s" or stated not in (None, "s"):
        return stated or likely, []

    name = header[roles.time]
    place = table.place(int(samples.row[0]), roles.time)
    if likely == "min":
        text = (
            f"{name} read as seconds, in which the arm would move at ten times its "
            f"rated speed; if it is in minutes, name it as the time: {name}:min"
        )
        warning = MotionWarning(kind="time_unit", count=1, first=place, text=text)
        return "s", [warning]
    text = (
        f"{name} read as {likely}, which its steps and speeds fit; "
        "call it time_secs if it is in seconds"
    )
    if stated == "s":
        text = (
            f"{name} read as seconds, though its steps and speeds fit {likely}: "
            f"is it time_{likely}?"
        )
    warning = MotionWarning(kind="time_unit", count=1, first=place, text=text)
    return stated or likely, [warning]


def _without_missing_rod(values: FloatArray, roles: Roles) -> Roles:
    """The roles without the jaw rod, if no row of the arm has a position of it."""
    if len(roles.joints) < 5:
        return roles
    *arm, rod = roles.positions
    rows_of_arm = np.isfinite(values[:, arm]).all(axis=1)
    if not rows_of_arm.any() or np.isfinite(values[rows_of_arm, rod]).any():
        return roles
    of_rod = JOINT_NAMES[4]
    return replace(
        roles,
        joints=roles.joints[:4],
        positions=arm,
        velocities=roles.velocities[:4],
        efforts={j: k for j, k in roles.efforts.items() if j != of_rod},
        currents={j: k for j, k in roles.currents.items() if j != of_rod},
    )


def _usable_rows(
    path: PathLike, table: Table, roles: Roles
) -> tuple[NDArray[np.intp], list[MotionWarning]]:
    """The rows with a time and positions, and a warning about those left out.

    Rows with positions of some joints are usable if most rows are such: a bus that is
    polled joint by joint writes them.

    Args:
        path: The file, for messages.
        table: Its numbers.
        roles: What its columns are.

    Raises:
        FileFormatError: More than one row in a hundred cannot be read.
    """
    known = np.isfinite(table.values[:, roles.positions])
    has_time = np.isfinite(table.values[:, roles.time])
    complete = has_time & known.all(axis=1)
    partial = has_time & known.any(axis=1) & ~complete
    polled = np.count_nonzero(partial) > np.count_nonzero(complete)
    each_joint = bool((np.count_nonzero(known, axis=0) >= MINIMUM_SAMPLES).all())
    usable = complete | partial if polled and each_joint else complete

    bad = np.flatnonzero(~usable)
    rows = np.flatnonzero(usable)
    if not bad.size:
        return rows, []
    problem = table.problem(int(bad[0]), [roles.time, *roles.positions])
    few = max(1, len(usable) // _ROWS_FOR_A_BAD_ONE)
    if table.every_row and bad.size > few:
        raise FileFormatError(path, problem.text, problem.place)
    warning = MotionWarning(
        kind="bad_row" if table.every_row else "missing_joints",
        count=bad.size,
        first=problem.place,
        text=f"{'row' if table.every_row else 'message'} left out ({problem.text})",
    )
    return rows, [warning]


def _samples(
    table: Table, roles: Roles, rows: NDArray[np.intp], signs: FloatArray
) -> _Samples:
    """The samples in some rows of a table.

    Args:
        table: Its numbers.
        roles: What its columns are.
        rows: The rows, (N,).
        signs: Of the joints' directions in the file, (n,).
    """
    values = table.values if rows.size == len(table.values) else table.values[rows]
    time = values[:, roles.time]
    if roles.nanoseconds is not None:
        time = time + values[:, roles.nanoseconds] / PER_SECOND["ns"]

    def quantity(column_of: Mapping[str, int]) -> FloatArray | None:
        if not column_of:
            return None
        found = np.full((len(values), len(roles.joints)), np.nan)
        for k, joint in enumerate(roles.joints):
            if joint in column_of:
                column = column_of[joint]
                scale = signs[k] * roles.scales.get(column, 1.0)
                found[:, k] = values[:, column] * scale
        return found

    position = quantity(dict(zip(roles.joints, roles.positions, strict=True)))
    assert position is not None
    return _Samples(
        row=rows,
        time=time,
        position=position,
        velocity=quantity(dict(zip(roles.joints, roles.velocities, strict=False))),
        effort=quantity(roles.efforts),
        current=quantity(roles.currents),
    )


def _joined(
    path: PathLike, table: Table, roles: Roles, samples: _Samples
) -> tuple[_Samples, list[MotionWarning]]:
    """Samples with all positions and velocities, from rows with some joints each.

    Numbers of one time are one sample. Positions and velocities are interpolated in
    time between those of the same joint; samples before the first or behind the last
    position of a joint are left out. Efforts and currents stay as they are.

    Raises:
        FileFormatError: The times of a joint run back.
    """
    time, first, number = np.unique(
        samples.time, return_index=True, return_inverse=True
    )
    inside = np.ones(time.size, dtype=bool)
    warnings = [
        MotionWarning(
            kind="joined",
            count=len(samples.row),
            first=table.place(int(samples.row[0]), roles.time),
            text="rows without all joints, joined by time and interpolated",
        )
    ]
    for k, joint in enumerate(roles.joints):
        known = np.flatnonzero(np.isfinite(samples.position[:, k]))
        at = samples.time[known]
        steps = np.diff(at)
        if (steps < 0.0).any():
            back = 1 + int(np.argmax(steps < 0.0))
            place = table.place(int(samples.row[known[back]]), roles.time)
            problem = (
                f"the times of {joint} run back from {at[back - 1]:.16g} to "
                f"{at[back]:.16g} (a clock that was set back?); cut the recording there"
            )
            raise FileFormatError(path, problem, place)
        inside &= (time >= at[0]) & (time <= at[-1])
        long = steps > GAP_FACTOR * np.median(steps)
        if long.any():
            row = int(samples.row[known[1 + int(np.argmax(long))]])
            gap = MotionWarning(
                kind="gap",
                count=int(long.sum()),
                first=table.place(row, roles.positions[k]),
                text=f"{joint} without a sample for up to {steps.max():.3g} of the "
                "time's unit, interpolated",
                joint=joint,
            )
            warnings.append(gap)

    def joined(values: FloatArray | None, interpolated: bool) -> FloatArray | None:
        if values is None:
            return None
        found = np.full((time.size, values.shape[1]), np.nan)
        for k in range(values.shape[1]):
            known = np.flatnonzero(np.isfinite(values[:, k]))
            if interpolated and known.size:
                found[:, k] = np.interp(time, samples.time[known], values[known, k])
            else:
                found[number[known], k] = values[known, k]
        return found[inside]

    position = joined(samples.position, interpolated=True)
    assert position is not None
    whole = _Samples(
        row=samples.row[first[inside]],
        time=time[inside],
        position=position,
        velocity=joined(samples.velocity, interpolated=True),
        effort=joined(samples.effort, interpolated=False),
        current=joined(samples.current, interpolated=False),
    )
    return whole, warnings


def _whole_velocity(
    table: Table, roles: Roles, samples: _Samples
) -> tuple[FloatArray | None, list[MotionWarning]]:
    """Velocities if each sample has them, and a warning if only some have."""
    velocity = samples.velocity
    if velocity is None:
        return None, []
    unknown = ~np.isfinite(velocity).all(axis=1)
    if not unknown.any():
        return velocity, []
    if unknown.all():
        return None, []
    first = int(samples.row[np.argmax(unknown)])
    warning = MotionWarning(
        kind="velocity",
        count=int(unknown.sum()),
        first=table.place(first, roles.velocities[0]),
        text="no velocities, so none is used",
    )
    return None, [warning]
