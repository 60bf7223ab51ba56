"""A joint motion over time, recorded or planned, from arrays or a file, checked."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, frozen, listed, named
from alpha5_model._support.files import PathLike
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError, ShapeError
from alpha5_model.numbers.parameters import parameters
from alpha5_model.trajectory import bags, tables
from alpha5_model.trajectory.names import (
    COMMAND,
    EFFORT,
    POSITION,
    VELOCITY,
    explained,
    groups,
    joint_columns,
)
from alpha5_model.trajectory.tables import JOINTS, MotionWarning, Progress

#: Fewer samples give no useful acceleration.
MINIMUM_SAMPLES = 5
#: A step is a jump beyond this share of the joint's range plus twice its rated speed.
JUMP_SHARE = 0.1
#: A position beyond a limit by less than this share of the joint's range is at the limit.
LIMIT_SLACK = 1e-3
#: A gap is longer than this many median sample times.
GAP_FACTOR = 10.0

_BAGS, _PARQUET = (".bag", ".db3", ".mcap"), (".parquet", ".pq")
_TIME = ("time_secs", "time")
#: Other names of the time, with a unit: ``time_ms``, ``time [ms]``, ``Time (us)``.
_TIME_WITH_UNIT = re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE)
#: What loggers call it, of which the first column counts: ``timestamp``, ``wall_time_sec``.
_CLOCK = re.compile(
    r"(?:timestamp|(?:elapsed|replay|ros|sim|wall)_time)(?:[ _\[(]+([mun]?s)(?:ecs?)?[\])]?)?"
)


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of a joint motion, as given; times strictly increase.

    Attributes:
        time: (N,) [s].
        joints: Names of the n joints, base to tip: four, or five with the jaw rod ``axis_a``.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n) [rad/s], jaw rod [m/s]; None if not given.
        warnings: What was found odd.
        source: File name, or ``"arrays"``.
        ignored: Columns of the file that were not used.
        time_unit: Of the file's time column: ``"s"``, ``"ms"``, ``"us"``, ``"ns"``; `time` is in s.
        effort: Joint torques as recorded, (N, n) [N m], jaw rod [N], NaN where there is none; None
            if not given. Compared with the model's torque, never used for it.
    """

    time: FloatArray
    joints: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray | None = None
    warnings: tuple[MotionWarning, ...] = ()
    source: str = "arrays"
    ignored: tuple[str, ...] = ()
    time_unit: str = "s"
    effort: FloatArray | None = None


def motion(
    time: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    effort: ArrayLike | None = None,
) -> Motion:
    """A motion from arrays, with the same checks as one from a file.

    Args:
        time: (N,) [s], increasing, uniform or not. Of samples with the same time the first counts.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n), optional.
        joints: Names of the columns, in any order; base to tip if None.
        effort: Recorded joint torques, (N, n) [N m], jaw rod [N], optional.

    Raises:
        InputError: Time runs back, a joint is missing or named twice, too few samples, not finite.
    """
    t = float_array("time", time, ())
    if t.ndim != 1:
        raise ShapeError("time", t.shape, "shape (N,)")
    q = float_array("position", position, ())
    if q.ndim != 2 or q.shape[0] != t.size or q.shape[1] not in (4, 5):
        raise ShapeError(
            "position", q.shape, f"shape ({t.size}, 4), or ({t.size}, 5) with axis_a"
        )
    wanted = JOINTS[: q.shape[1]]
    names = (
        wanted if joints is None else tuple(listed("joints", joints, "names of joints"))
    )
    more: dict[str, Any] = {}
    for name, value in {"velocity": velocity, "effort": effort}.items():
        if value is not None:
            more[name] = float_array(name, value, ())
            if more[name].shape != q.shape:
                expected = f"the shape of position, {q.shape}"
                raise ShapeError(name, more[name].shape, expected)
    named("joint", names, JOINTS)
    if sorted(names) != sorted(wanted):
        raise InputError("joints", names, f"each of {', '.join(wanted)} once")
    order = [names.index(name) for name in wanted]
    more = {name: table[:, order] for name, table in more.items()}
    return _checked(Motion(t, wanted, q[:, order], **more))


def read_motion(
    path: PathLike,
    progress: Progress | None = None,
    *,
    topic: str | None = None,
    prefix: str | None = None,
) -> Motion:
    """Read joint motion from a CSV or Parquet file, or from a ROS bag.

    A table has columns in any order: ``time_secs`` or ``time`` [s], or ``time_ms``, ``time [us]`` and
    the like; ``axis_b_pos`` (also ``axis_b_position``, ``axis_b``, ``q_axis_b``) and so on for
    ``axis_e, axis_d, axis_c, axis_b`` [rad] and, optionally, for the jaw rod ``axis_a`` [m];
    ``axis_b_vel`` (``axis_b_velocity``, ``dq_axis_b``) and so on, optional, for all of these joints or
    none; ``axis_b_effort`` (``effort_axis_b``) [N m], optional, NaN where it is not known. A robot's
    name may stand before the joints. A column is a position only if each word of its name says so:
    torques, currents, commands, errors and words that are not known are not. They are ignored and
    named in `Motion.ignored`, commands with a warning; without positions the error says what they
    are. A column ``time`` in steps of a second or more is read in milliseconds or a smaller unit if
    the joints can be so fast; a warning says so. Without it the first of ``timestamp``,
    ``ros_time``, ``sim_time``, ``wall_time_sec`` and the like counts. Parquet (``.parquet``, needs
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
            names as they are, else the only prefix. One that says command, or nothing that is known,
            is read if it is given here; one that says torque never is.

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
    file, before = Path(str(path)), prefix
    a_bag = file.suffix.lower() in _BAGS
    with suppress(OSError, ValueError):  # a name that none can have
        a_bag = a_bag or (file / "metadata.yaml").is_file()
    if a_bag:
        table, before = bags.bag_table(path, topic, prefix, progress)
    elif topic is not None:
        raise InputError("topic", topic, "no value: only a ROS bag has topics")
    elif file.suffix.lower() in _PARQUET:
        table = tables.parquet_table(path)
    else:
        table = tables.csv_table(path, progress)
    roles = _roles(path, table, before)
    needed = [roles.time, *roles.positions, *roles.velocities]
    numbers, unit = table.read(needed, [*roles.efforts.values()])
    joints, n, known = roles.joints, len(roles.joints), len(needed)
    time, position = numbers[:, 0], numbers[:, 1 : 1 + n]

    def place(sample: int, joint: str | None) -> str:
        return table.place(sample, needed[joints.index(joint) + 1 if joint else 0])

    warnings = [*table.warnings, *roles.warnings]
    if unit is None:
        unit, doubt = _time_unit(table.header[roles.time], time, position)
        if doubt:
            warnings.append(MotionWarning("time_unit", 1, place(0, None), doubt))
    velocity = numbers[:, 1 + n : known] if roles.velocities else None
    effort = None
    if numbers.shape[1] > known:
        effort = np.full_like(position, np.nan)
        effort[:, [joint in roles.efforts for joint in joints]] = numbers[:, known:]
    used = {*needed, *roles.efforts.values()} if effort is not None else {*needed}
    raw = Motion(
        time=time / tables.PER_SECOND[unit],
        joints=joints,
        position=position,
        velocity=velocity,
        warnings=tuple(warnings),
        source=str(path),
        ignored=(
            *(x for k, x in enumerate(table.header) if k not in used),
            *table.ignored,
        ),
        time_unit=unit,
        effort=effort,
    )
    return _checked(raw, path, place)


@dataclass(frozen=True)
class _Roles:
    """Places of the columns that are read, and what is to be said of the others.

    Attributes:
        time: Place of the time.
        joints: Those with a position, base to tip.
        positions, velocities: Places, joint by joint; no velocities if none is recorded.
        efforts: Joint -> place, of those that have one.
        warnings: About columns that somebody may miss.
    """

    time: int
    joints: tuple[str, ...]
    positions: list[int]
    velocities: list[int]
    efforts: dict[str, int]
    warnings: list[MotionWarning]


def _roles(path: PathLike, table: tables.Table, asked: str | None) -> _Roles:
    """Which columns of a table are the time and the joints' quantities.

    Raises:
        InputError: Several arms to choose from.
        FileFormatError: A missing or a doubled column.
    """
    found = joint_columns(table.header, asked)
    # Without any that names all joints, the message below says what is missing.
    group = tables.only("prefix", groups(found, asked) or [asked or ""])
    arm = [column for column in found if column.group == group]
    places = {name: place for place, name in enumerate(table.header)}

    def names(joint: str, meaning: str) -> list[str]:
        return [x.name for x in arm if x.joint == joint and x.meaning == meaning]

    def only(names: list[str], what: str, missing: str) -> int:
        if len(names) == 1:
            return places[names[0]]
        problem = f"two columns for {what}: {', '.join(names)}"
        if not names:
            got = ", ".join(table.header)[:200]
            problem = f"no column for {what}{missing}, got {got}"
        raise FileFormatError(path, problem, table.head)

    def each(meaning: str, suffixes: Sequence[str], why: str = "") -> list[int]:
        chosen = []
        for joint in joints:
            wanted = " or ".join(group + joint + suffix for suffix in suffixes)
            missing = f"{why}: expected {wanted}"
            if meaning == POSITION and (reasons := explained(found, joint)):
                missing += f"; {reasons}"
            chosen.append(
                only(names(joint, meaning), f"the {meaning} of {joint}", missing)
            )
        return chosen

    warnings = []
    timed = [name for name in table.header if name in _TIME]
    timed = timed or [name for name in table.header if _TIME_WITH_UNIT.fullmatch(name)]
    if not timed:
        clocks = [name for name in table.header if _CLOCK.fullmatch(name)]
        timed = clocks[:1]
        if len(clocks) > 1:
            text = f"{timed[0]} read as the time, not {', '.join(clocks[1:])}"
            warnings.append(MotionWarning("time_column", 1, table.head, text))
    time = only(timed, "the time", ": expected time_secs or time or time_ms")
    joints = JOINTS if names(JOINTS[4], POSITION) else JOINTS[:4]
    positions = each(POSITION, ("_pos", "_position", ""))
    velocities = []
    if any(names(joint, VELOCITY) for joint in joints):
        velocities = each(VELOCITY, ("_vel", "_velocity"), ", while others have one")
    efforts = {}
    for joint in joints:
        recorded = names(joint, EFFORT)
        if recorded:
            efforts[joint] = only(recorded, f"the effort of {joint}", "")
    commands = [column.name for column in found if column.meaning == COMMAND]
    if commands:
        text = "a command or reference, not measured; ignored"
        first = f"{commands[0]}, {table.head}" if table.head else commands[0]
        warnings.append(MotionWarning("command", len(commands), first, text))
    return _Roles(time, joints, positions, velocities, efforts, warnings)


def _time_unit(name: str, time: FloatArray, position: FloatArray) -> tuple[str, str]:
    """Unit of a column of time, by its name or else its steps; and what is doubtful about it."""
    likely = _likely_unit(time, position)
    stated = _TIME_WITH_UNIT.fullmatch(name) or _CLOCK.fullmatch(name)
    unit = stated[1].lower() if stated and stated[1] else None
    doubt = f"its steps and speeds fit {likely}" if likely != "s" else ""
    if unit is None:
        text = f"{name} read as {likely}, which its steps and speeds fit; "
        return likely, text + "call it time_secs if it is in seconds" if doubt else ""
    text = f"{name} read as seconds, though {doubt}: is it time_{likely}?"
    return unit, text if doubt and unit == "s" else ""


def _likely_unit(time: FloatArray, position: FloatArray) -> str:
    """Largest unit in which a time step is shorter than a second, if the joints can be so fast.

    Seconds where some joint's mean speed would exceed twice its rating, as in a plan of few points.
    """
    with np.errstate(over="ignore"):
        steps, path = np.diff(time), np.abs(np.diff(position, axis=0)).sum(axis=0)
    steps = steps[steps > 0]
    if not steps.size or float(np.median(steps)) < 1.0:
        return "s"
    unit = next(
        (u for u, n in tables.PER_SECOND.items() if float(np.median(steps)) < n), "ns"
    )
    rated = np.array([joint.velocity for joint in parameters().joints[: path.size]])
    fast = path / (steps / tables.PER_SECOND[unit]).sum() > 2 * rated
    return "s" if fast.any() else unit


def _sample(sample: int, joint: str | None) -> str:
    return f"sample {sample}" + (f" of {joint}" if joint else "")


def _checked(
    raw: Motion,
    path: PathLike | None = None,
    place: Callable[[int, str | None], str] = _sample,
) -> Motion:
    """Check finite samples in joint order; times that repeat are dropped and counted.

    Args:
        path: Of the file, for messages; None for arrays.
        place: (sample, joint or None for the time) -> the place of that number, for messages.
    """

    def refuse(
        sample: int, joint: str | None, value: float, expected: str
    ) -> Alpha5Error:
        if path is None:
            return InputError(f"{joint or 'time'}[{sample}]", float(value), expected)
        return FileFormatError(path, f"expected {expected}", place(sample, joint))

    def warn(kind: str, bad: Any, joint: str | None, text: str) -> None:
        if bad.size:
            found.append(
                MotionWarning(kind, int(bad.size), place(int(bad[0]), joint), text)
            )

    time, effort, found = raw.time, raw.effort, list(raw.warnings)
    if effort is not None:
        effort = np.where(np.isfinite(effort), effort, np.nan)
        effort = None if np.isnan(effort).all() else effort
    if time.size < MINIMUM_SAMPLES:
        why = f" ({'; '.join(map(str, found))})" if found else ""
        name = "time" if path is None else raw.source + why
        raise InputError(name, time.size, f"at least {MINIMUM_SAMPLES} samples")
    rates = {
        "position": raw.position,
        "velocity": raw.velocity,
        "recorded effort": effort,
    }
    for what, table in {"time": time[:, None], **rates}.items():
        most = 1e12 if what == "time" else 1e9  # derivatives of more would overflow
        if table is not None and (beyond := np.argwhere(np.abs(table) > most)).size:
            sample, k = (int(i) for i in beyond[0])
            joint = None if what == "time" else raw.joints[k]
            raise refuse(
                sample, joint, table[sample, k], f"a {what} of at most {most:g} in size"
            )
    steps = np.diff(time)
    if (steps < 0).any():
        k = int(np.argmax(steps < 0)) + 1
        raise refuse(
            k, None, time[k], f"a time of at least {time[k - 1]:.9g} s: time runs back"
        )
    keep = np.concatenate([[True], steps >= 1e-9])  # [s]; nearer times are the same
    samples = np.flatnonzero(keep)
    warn("repeated_time", np.flatnonzero(~keep), None, "time repeated, sample dropped")
    t, q = time[keep], raw.position[keep]
    if t.size < MINIMUM_SAMPLES:
        expected = f"at least {MINIMUM_SAMPLES} samples with different times"
        raise refuse(0, None, time[0], expected)
    steps = np.diff(t)
    gap = GAP_FACTOR * float(np.median(steps))
    warn(
        "gap",
        samples[1:][steps > gap],
        None,
        f"more than {gap:.3g} s without a sample, bridged",
    )
    for column, bound in enumerate(parameters().joints[: len(raw.joints)]):
        name, span = bound.name, bound.upper - bound.lower
        unit = "m" if name == "axis_a" else "rad"
        jump = (
            np.abs(np.diff(q[:, column]))
            > JUMP_SHARE * span + 2 * bound.velocity * steps
        )
        warn("jump", samples[1:][jump], name, f"{name} jumps farther than it can move")
        slack = LIMIT_SLACK * span
        outside = (q[:, column] < bound.lower - slack) | (
            q[:, column] > bound.upper + slack
        )
        text = f"{name} outside its range {bound.lower:.6g} to {bound.upper:.6g} {unit}"
        if np.abs(q[:, column]).max() > 4 * bound.upper:
            text += f" (is it in {'mm' if unit == 'm' else 'degrees'}?)"
        warn("outside_limits", samples[outside], name, text)
    v, e = (
        None if table is None else frozen(table[keep])
        for table in (raw.velocity, effort)
    )
    state: dict[str, Any] = {
        "time": frozen(t),
        "position": frozen(q),
        "velocity": v,
        "effort": e,
    }
    return replace(raw, **state, warnings=tuple(found))
