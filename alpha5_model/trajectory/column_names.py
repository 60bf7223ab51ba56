"""What the columns of a table are: the time, and which quantity of which joint.

A name is read only if each of its words is understood, so that no torque, command or
error is taken for a position. The vocabulary is short on purpose: a word of your own in
front of a joint is read if it is given as the prefix.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.motions import MotionWarning
from alpha5_model.trajectory.tables import PER_SECOND, Table

POSITION = "position"
VELOCITY = "velocity"
EFFORT = "effort"
CURRENT = "current"
TORQUE = "torque"
ACCELERATION = "acceleration"
COMMAND = "command"
#: ``measured_axis_e`` may be anything; ``measured_q_axis_e`` is a position.
MEASURED = "measured"
#: A word of a robot's name or place.
NAME = "name"
UNKNOWN = "unknown"
_QUANTITIES = (POSITION, VELOCITY, EFFORT, CURRENT)
#: Meaning -> the words that have it. All others are unknown.
_WORDS = {
    POSITION: "pos position positions q angle angles theta",
    VELOCITY: "vel velocity velocities dq qd qdot",
    EFFORT: "eff effort efforts",
    CURRENT: "current currents",
    TORQUE: "tau torque torques",
    ACCELERATION: "acc acceleration ddq",
    COMMAND: """
        cmd command commands commanded ref reference target goal des desired setpoint
        dref""",
    MEASURED: "measured meas actual recorded state",
    NAME: "joint joints states arm alpha robot my left right front rear port starboard",
}
_MEANING = {
    word: meaning for meaning, words in _WORDS.items() for word in words.split()
}

#: The last joint in a name. ``axis_e2`` is not ``axis_e``.
_JOINT = re.compile(
    rf"(.*)({'|'.join(JOINT_NAMES)})(?![A-Za-z0-9])(.*)", re.DOTALL | re.IGNORECASE
)
#: A word, as in ``tau_``, ``jointVelocity/`` and ``arm2.``. Any other sign is a word.
_WORD = re.compile(r"^-|[A-Z]?[a-z]+|[A-Z]+(?![a-z])|[0-9]+|[^\sA-Za-z0-9_./:\-\[\]()]")
_SEPARATORS = re.compile(r"[\s_./:\-\[\]()]*")

_DEGREE = math.pi / 180.0
_CURRENTS = {"a": 1.0, "amps": 1.0, "ma": 1e-3, "milliamps": 1e-3}
_PER_DEGREE = dict.fromkeys(("deg", "degree", "degrees", "°"), _DEGREE)
#: Quantity -> its units for an arm joint, each in rad, rad/s, N m or A.
_UNITS = {
    POSITION: {**_PER_DEGREE, "rad": 1.0, "radians": 1.0},
    VELOCITY: {"deg/s": _DEGREE, "°/s": _DEGREE, "rad/s": 1.0},
    EFFORT: dict.fromkeys(("nm", "n m", "n*m", "n·m"), 1.0),
    CURRENT: _CURRENTS,
}
#: The same for the jaw rod, each in m, m/s, N or A.
_ROD_UNITS = {
    POSITION: {"mm": 1e-3, "m": 1.0},
    VELOCITY: {"mm/s": 1e-3, "m/s": 1.0},
    EFFORT: {"n": 1.0},
    CURRENT: _CURRENTS,
}
#: Units that may stand behind an underscore, without brackets.
_ENDINGS = {*_PER_DEGREE, "rad", "mm", "nm", *_CURRENTS}
#: Units with a fraction that may, as in ``axis_e_vel_rad_s``.
_RATE = re.compile(r"(.*)_(rad|deg|mm|m)(?:_|/|_per_)s(?:ec)?", re.I | re.DOTALL)

#: Names that loggers give the time: ``t``, ``timestamp``, ``wall_time_sec``;
#: PlotJuggler's ``__time``, ``%time`` of rostopic, and the stamp of a message.
_CLOCK = re.compile(
    r"(?:t|timestamp|(?:elapsed|replay|ros|sim|wall)_time|__time|%time"
    r"|(?:.*[./])?header[./]stamp(?:[./]secs?)?)"
    r"(?:[ _\[(]+([mun]?s)(?:ecs?)?[\])]?)?",
    re.IGNORECASE,
)
#: Names of the time, from the ones that are taken first; group 1 is the unit.
_TIMES = (
    re.compile(r"time(?:_secs)?()", re.IGNORECASE),
    re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE),
    _CLOCK,
)
#: Whole seconds of a stamp; its nanoseconds are in a column of their own.
_STAMP_SECONDS = re.compile(r"((?:.*[./_])?stamp[./_])secs?")
_NANOSECONDS = ("nanosec", "nsecs", "nsec", "nanosecs", "nanoseconds")
#: Names of a column that says which joint a row is about.
JOINT_COLUMNS = ("joint", "joint_name", "joint name", "name", "axis", "variable")
#: Fewer rows are no motion.
_FEWEST_SAMPLES = 5
#: The arm has four joints, and more names than this are no joints.
_FEWEST_JOINTS = 4
_MOST_JOINTS = 100
#: Columns that a message lists or explains.
_LISTED = 8
_REASONS = 4


class JointMap:
    """What a file calls the joints of the arm.

    Args:
        joints: Joint of the arm -> its name in the file, ``-NAME`` if it turns the
            other way there; None or empty if the file has the arm's names.

    Raises:
        UnknownNameError: Not a joint of the arm.
        InputError: No mapping, an empty name, or one of several joints.
    """

    def __init__(self, joints: Mapping[str, str] | None) -> None:
        if joints is not None and not isinstance(joints, Mapping):
            expected = "a mapping from joints of the arm to names in the file"
            raise InputError("joints", joints, expected)
        self._ours: dict[str, str] = {}
        self._reversed: set[str] = set()
        for joint, name in (joints or {}).items():
            choice("joint", joint, JOINT_NAMES)
            own = name.removeprefix("-") if isinstance(name, str) else ""
            if not own.strip() or own in self._ours:
                expected = "a name of the file for each joint, each name once"
                raise InputError(f"joints[{joint}]", name, expected)
            self._ours[own] = joint
            if own != name:
                self._reversed.add(joint)

        longest_first = sorted(self._ours, key=len, reverse=True)
        either = "|".join(map(re.escape, longest_first))
        # ``joint_1`` stands in ``left_joint_1_pos``, not in ``joint_10`` or
        # ``myjoint_1``.
        self._names = re.compile(rf"(?<![A-Za-z0-9])(?:{either})(?![A-Za-z0-9])")

    def signs(self, joints: Sequence[str]) -> FloatArray:
        """-1 for each joint that turns the other way in the file, else 1, (n,)."""
        return np.array([-1.0 if joint in self._reversed else 1.0 for joint in joints])

    def renamed(self, names: Iterable[str]) -> list[str]:
        """Names with the arm's joints for those of the file.

        Raises:
            InputError: A name that the file does not have.
        """
        given = [*names]
        if not self._ours:
            return given
        seen: set[str] = set()

        def ours(match: re.Match[str]) -> str:
            seen.add(match[0])
            return self._ours[match[0]]

        renamed = [self._names.sub(ours, name) for name in given]
        missing = [name for name in self._ours if name not in seen]
        if missing:
            joint = self._ours[missing[0]]
            got = ", ".join(dict.fromkeys(given))[:200]
            raise InputError(f"joints[{joint}]", missing[0], f"a name in {got}")
        return renamed


@dataclass(frozen=True)
class Roles:
    """The columns that are read, and warnings about the others.

    Attributes:
        time: Column of the time.
        time_unit: Its unit if the name or the caller states one; None if neither does.
        nanoseconds: Column of the nanoseconds of a stamp, if the time is its seconds.
        joints: Joints with a position, base to tip.
        positions, velocities: Columns, joint by joint; no velocities if none is
            recorded.
        efforts, currents: Joint -> column, of the joints that have one.
        scales: Column -> SI units in its unit, of the columns that state one.
        warnings: About columns that the caller may miss.
    """

    time: int
    time_unit: str | None
    nanoseconds: int | None
    joints: tuple[str, ...]
    positions: list[int]
    velocities: list[int]
    efforts: dict[str, int]
    currents: dict[str, int]
    scales: dict[int, float]
    warnings: list[MotionWarning] = field(default_factory=list)

    @property
    def columns(self) -> set[int]:
        """All columns that are read."""
        others = [] if self.nanoseconds is None else [self.nanoseconds]
        quantities = [*self.positions, *self.velocities]
        recorded = [*self.efforts.values(), *self.currents.values()]
        return {self.time, *others, *quantities, *recorded}


class _Column(NamedTuple):
    """A column of a joint.

    Attributes:
        number: Of the table.
        name: As in the header.
        joint: ``"axis_e"`` and so on.
        group: The prefix of the joint without the words of the quantity: ``"left_"`` in
            ``dq_left_axis_e``. Columns of one arm have the same group.
        meaning: One of the words of this module.
        scale: SI units in the unit of its name; None if it names none.
    """

    number: int
    name: str
    joint: str
    group: str
    meaning: str
    scale: float | None


def with_columns_of_joints(table: Table, column: int, joints: Sequence[str]) -> Table:
    """A table of rows about one joint each, as one with columns for each joint.

    ``time, joint, position`` becomes ``time, axis_e_position, axis_d_position`` and so
    on, with NaN for all joints but the one of the row. A table whose column does not
    name the joints of an arm stays as it is.

    Args:
        table: With a column that may name the joint.
        column: Its number.
        joints: What the column says in each row, (N,).
    """
    names = [name for name in dict.fromkeys(joints) if name]
    is_wide = any(_JOINT.fullmatch(name) for name in table.header)
    if is_wide or not _FEWEST_JOINTS <= len(names) <= _MOST_JOINTS:
        return table
    own = [k for k, name in enumerate(table.header) if _is_of_a_joint(name)]
    shared = [k for k in range(len(table.header)) if k not in (column, *own)]
    header = [table.header[k] for k in shared]
    sources = [*shared]
    parts = [table.values[:, shared]]
    of_row = np.array(joints)
    of_joints = {}
    for name in names:
        is_its = of_row == name
        of_joints[name] = range(len(header), len(header) + len(own)), is_its
        parts.append(np.where(is_its[:, None], table.values[:, own], np.nan))
        sources += own
        for k in own:
            quantity = table.header[k]
            header.append(name if quantity == "value" else f"{name}_{quantity}")

    return table._replace(
        header=header,
        values=np.concatenate(parts, axis=1),
        place=lambda row, k: table.place(row, sources[k]),
        problem=lambda row, columns: table.problem(row, [sources[k] for k in columns]),
        in_seconds=frozenset(
            k for k, source in enumerate(sources) if source in table.in_seconds
        ),
        of_joints=of_joints,
    )


def without_other_joints(table: Table, roles: Roles) -> Table:
    """A table without the rows about joints that are not read, with a warning."""
    read = roles.columns
    other = {
        name: rows
        for name, (columns, rows) in table.of_joints.items()
        if read.isdisjoint(columns)
    }
    if not other:
        return table
    is_other = np.any(list(other.values()), axis=0)
    kept = np.flatnonzero(~is_other)
    listed = ", ".join(name[:60] for name in [*other][:_LISTED])
    if len(other) > _LISTED:
        listed += ", ..."
    warning = MotionWarning(
        kind="not_used",
        count=int(is_other.sum()),
        first=table.place(int(np.argmax(is_other)), roles.time),
        text=f"rows of joints that are not read ({listed}), left out",
    )
    return table._replace(
        values=table.values[kept],
        place=lambda row, k: table.place(int(kept[row]), k),
        problem=lambda row, columns: table.problem(int(kept[row]), columns),
        warnings=(*table.warnings, warning),
        of_joints={},
    )


def _is_of_a_joint(name: str) -> bool:
    """Whether a column without a joint in its name holds a quantity of joints."""
    known = {*_QUANTITIES, TORQUE, ACCELERATION, COMMAND}
    return name == "value" or not known.isdisjoint(_meanings(split_unit(name)[0]))


def find_roles(
    path: PathLike,
    table: Table,
    header: Sequence[str],
    wanted_prefix: str | None,
    degrees: bool,
    wanted_time: str | None,
    waypoints: bool = False,
) -> Roles:
    """Which columns of a table are the time and the joints' quantities.

    Args:
        path: The file, for messages.
        table: Its columns.
        header: Their names, with the arm's joints for those of the file.
        wanted_prefix: The prefix of the joints that the caller gave; None if none.
        degrees: Whether angles are in degrees if their columns name no unit.
        wanted_time: Column of the time that the caller gave, ``NAME`` or
            ``NAME:unit``; None if none.
        waypoints: Whether rows are no samples of a motion, so that a few are enough.

    Raises:
        InputError: Several arms to choose from, or no such column of the time.
        FileFormatError: A missing or a doubled column.
    """
    seen: set[str] = set()
    for number, name in enumerate(header, start=1):
        if name and name in seen:
            problem = f"column {name[:40]!r} stands twice"
            raise FileFormatError(path, problem, f"{table.head}, column {number}")
        seen.add(name)

    if wanted_time is None:
        time, time_unit, warnings = _found_time(path, table, header)
    else:
        time, time_unit = _chosen_time(table, wanted_time)
        warnings = []

    columns = _columns_of_joints(header, wanted_prefix)
    group = _group_of_the_arm(columns, wanted_prefix)
    arm = [column for column in columns if column.group == group]

    def found(joint: str, meaning: str) -> list[_Column]:
        return [c for c in arm if (c.joint, c.meaning) == (joint, meaning)]

    def only(joint: str, meaning: str) -> int:
        several = found(joint, meaning)
        if len(several) == 1:
            return several[0].number
        if several:
            names = ", ".join(c.name for c in several)
            number = "two" if len(several) == 2 else len(several)
            problem = f"{number} columns for the {meaning} of {joint}: {names}"
        else:
            problem = _missing(table, columns, joint, meaning, group)
            if len(table.values) < _FEWEST_SAMPLES and not waypoints:
                problem += f"; and {len(table.values)} rows are no motion"
        raise FileFormatError(path, problem, table.head)

    joints = JOINT_NAMES if found(JOINT_NAMES[4], POSITION) else JOINT_NAMES[:4]
    has_velocities = any(found(joint, VELOCITY) for joint in joints)
    # A current with an interval is one that this package computed and wrote.
    names = {*header}
    arm = [c for c in arm if c.meaning != CURRENT or f"{c.name}_lower" not in names]
    return Roles(
        time=time,
        time_unit=time_unit,
        nanoseconds=_nanoseconds(header, time),
        joints=joints,
        positions=[only(joint, POSITION) for joint in joints],
        velocities=[only(joint, VELOCITY) for joint in joints if has_velocities],
        efforts={j: only(j, EFFORT) for j in joints if found(j, EFFORT)},
        currents={j: only(j, CURRENT) for j in joints if found(j, CURRENT)},
        scales={c.number: s for c in arm if (s := _scale(c, degrees)) is not None},
        warnings=[*warnings, *_unused(table, columns, arm)],
    )


def arms_in(names: Iterable[str], wanted_prefix: str | None) -> list[str]:
    """The prefixes of complete arms in the names of a ``JointState`` message, sorted.

    Such a message holds positions by definition, so unknown words are taken for a
    robot's name. A prefix that says command or torque does not count unless it is
    wanted.
    """
    joints_of: dict[str, set[str]] = {}
    for name in names:
        for joint in JOINT_NAMES:
            if name.endswith(joint):
                joints_of.setdefault(name.removesuffix(joint), set()).add(joint)
    others = {TORQUE, ACCELERATION, VELOCITY, EFFORT, CURRENT}
    if wanted_prefix is None:
        others.add(COMMAND)
    else:
        joints_of = {wanted_prefix: joints_of.get(wanted_prefix, set())}
    complete = [p for p, joints in joints_of.items() if joints >= {*JOINT_NAMES[:4]}]
    return sorted(prefix for prefix in complete if not others & {*_meanings(prefix)})


def only_choice(what: str, found: Collection[str]) -> str:
    """The only one of some prefixes or topics; ``""`` if it is among them.

    Joints named without a prefix are the arm's, whatever else there is.

    Raises:
        InputError: There are several.
    """
    if len(found) > 1 and "" not in found:
        choices = ", ".join(sorted(found))
        expected = f"one of {choices}: each has the joints of an arm"
        raise InputError(what, None, expected)
    return min(found)


def likely_time_unit(
    time: FloatArray, position: FloatArray, parameters: Alpha5Parameters
) -> str:
    """The largest unit up to seconds that makes a time step shorter than a second.

    But it is seconds if that unit would make the mean speed of a joint exceed twice its
    rated speed. This happens in a plan of few points. It is minutes if in seconds a
    joint would move at ten times its rated speed.

    Args:
        time: (N,) In the unit of the column.
        position: (N, n) [rad], jaw rod [m].
        parameters: The arm, for the rated speeds of its joints.
    """
    with np.errstate(over="ignore"):
        steps = np.diff(time)
    steps = steps[steps > 0]
    if not steps.size:
        return "s"
    with np.errstate(over="ignore"):
        path = np.abs(np.diff(position, axis=0)).sum(axis=0)
    rated = np.array([joint.velocity for joint in parameters.joints[: path.size]])
    fastest = float((path / rated).max()) / steps.sum()
    median = float(np.median(steps))
    if median < 1.0:
        fit_minutes = 10 < fastest < 2 / PER_SECOND["min"]
        return "min" if fit_minutes else "s"

    smaller = [unit for unit, count in PER_SECOND.items() if median < count]
    unit = smaller[0] if smaller else "ns"
    return "s" if fastest * PER_SECOND[unit] > 2 else unit


def _found_time(
    path: PathLike, table: Table, header: Sequence[str]
) -> tuple[int, str | None, list[MotionWarning]]:
    """The column of the time, the unit in its name, and a warning if it was picked."""
    found: list[tuple[int, re.Match[str]]] = []
    is_clock = False
    for names in _TIMES:
        is_clock = names is _CLOCK
        matches = [(k, names.fullmatch(name)) for k, name in enumerate(header)]
        found = [(k, match) for k, match in matches if match]
        if found:
            break
    if not found:
        got = ", ".join(table.header)[:200]
        problem = (
            "no column for the time: expected time_secs or time or time_ms, or its "
            f"name and unit by --time, such as --time tick:ms, got {got}"
        )
        raise FileFormatError(path, problem, table.head)

    others = ", ".join(header[k] for k, _ in found[1:])
    number, match = found[0]
    warnings = []
    if others and not is_clock:
        count = "two" if len(found) == 2 else len(found)
        problem = f"{count} columns for the time: {header[number]}, {others}"
        raise FileFormatError(path, problem, table.head)
    if others:
        warning = MotionWarning(
            kind="time_column",
            count=1,
            first=table.head,
            text=f"{header[number]} read as the time, not {others}",
        )
        warnings.append(warning)
    unit = match[1].lower() if match[1] else None
    if header[number].lower() == "time_secs":
        unit = "s"
    return number, unit, warnings


def _chosen_time(table: Table, wanted: str) -> tuple[int, str | None]:
    """The column that the caller named as the time, and its unit if one is given."""
    name, _, unit = wanted.rpartition(":")
    if wanted in table.header:
        return table.header.index(wanted), None
    if name in table.header and unit in PER_SECOND:
        return table.header.index(name), unit
    units = ", ".join(PER_SECOND)
    got = ", ".join(table.header)[:200]
    expected = f"a column of the file ({got}), with :UNIT ({units}) if it has one"
    raise InputError("time", wanted, expected)


def _nanoseconds(header: Sequence[str], time: int) -> int | None:
    """The column with the nanoseconds of a stamp; None if its seconds are not whole."""
    match = _STAMP_SECONDS.fullmatch(header[time])
    if match is None:
        return None
    wanted = {match[1] + ending for ending in _NANOSECONDS}
    found = [column for column, name in enumerate(header) if name in wanted]
    return found[0] if len(found) == 1 else None


def _columns_of_joints(
    header: Iterable[str], wanted_prefix: str | None
) -> list[_Column]:
    """The columns that name a joint of the arm."""
    wanted_group = None if wanted_prefix is None else _group(wanted_prefix)
    columns = []
    for number, name in enumerate(header):
        match = _JOINT.fullmatch(name)
        if not match:
            continue
        before, joint, after = match.groups()
        group = _group(before)
        given = group == wanted_group
        meaning = _meaning(before, after, given)
        scale: float | None = None

        stem, unit = split_unit(after)
        if unit:
            of_stem = _meaning(before, stem, given)
            # Drivers report the current in the field of the effort, and a bare
            # ``axis_e_mA`` is no position.
            if unit in _CURRENTS and (of_stem == EFFORT or not stem):
                of_stem = CURRENT if of_stem in (EFFORT, POSITION) else of_stem
            known = _ROD_UNITS if joint.lower() == JOINT_NAMES[4] else _UNITS
            scale = known.get(of_stem, {}).get(unit)
            meaning = meaning if scale is None else of_stem
        column = _Column(
            number=number,
            name=name,
            joint=joint.lower(),
            group=group,
            meaning=meaning,
            scale=scale,
        )
        columns.append(column)
    return columns


def split_unit(after: str) -> tuple[str, str]:
    """The end of a name without its unit, and the unit in small letters.

    As in ``_pos [deg]``, ``_deg`` and ``_vel_rad_s``. It is ``""`` if there is none.
    """
    text = after.rstrip()
    if text.endswith(("]", ")")):
        start = max(text.rfind("["), text.rfind("("))
        if start >= 0:
            return text[:start].rstrip(" _"), text[start + 1 : -1].strip().lower()
    rate = _RATE.fullmatch(text)
    if rate:
        return rate[1], f"{rate[2].lower()}/s"
    stem, sign, ending = text.rpartition("_")
    if sign and ending.lower() in _ENDINGS:
        return stem, ending.lower()
    return after, ""


def _group_of_the_arm(columns: Sequence[_Column], wanted_prefix: str | None) -> str:
    """The only group that has a position of each arm joint.

    If there is none, the one that was wanted: the message names what it lacks.
    """
    joints_of: dict[str, set[str]] = {}
    for column in columns:
        if column.meaning == POSITION:
            joints_of.setdefault(column.group, set()).add(column.joint)
    complete = [g for g, joints in joints_of.items() if joints >= {*JOINT_NAMES[:4]}]
    if wanted_prefix is not None:
        return _group(wanted_prefix)
    return only_choice("prefix", complete or [""])


def _scale(column: _Column, degrees: bool) -> float | None:
    """SI units in the unit of a column; None if it is in SI."""
    angle = column.joint != JOINT_NAMES[4] and column.meaning in (POSITION, VELOCITY)
    if column.scale is None and degrees and angle:
        return _DEGREE
    return column.scale


def _unused(
    table: Table, columns: Sequence[_Column], arm: Sequence[_Column]
) -> list[MotionWarning]:
    """Warnings about commands, and about columns of the arm that are not understood.

    Torques beside their causes are those that this package computed and wrote.
    """
    warnings = []
    commands = [column.name for column in columns if column.meaning == COMMAND]
    if commands:
        warning = MotionWarning(
            kind="command",
            count=len(commands),
            first=f"{commands[0]}, {table.head}" if table.head else commands[0],
            text="a command or reference, not measured; ignored",
        )
        warnings.append(warning)

    computed = {c.joint for c in arm if c.name.endswith("_torque_inertia")}
    unused = [
        column.name
        for column in arm
        if column.meaning in (TORQUE, UNKNOWN, MEASURED)
        and column.joint not in computed
    ]
    if unused:
        listed = ", ".join(name[:60] for name in unused[:_LISTED])
        more = ", ..." if len(unused) > _LISTED else ""
        warning = MotionWarning(
            kind="not_used",
            count=len(unused),
            first=table.head or unused[0],
            text=f"columns of joints that are not used ({listed}{more})",
        )
        warnings.append(warning)
    return warnings


def _missing(
    table: Table, columns: Sequence[_Column], joint: str, meaning: str, group: str
) -> str:
    """What is said if a joint has no column of a quantity."""
    problem = f"no column for the {meaning} of {joint}"
    if meaning == VELOCITY:
        expected = f"{group}{joint}_vel or {group}{joint}_velocity"
        problem += f", while others have one: expected {expected}"
    else:
        names = [group + joint + ending for ending in ("_pos", "_position", "")]
        problem += f": expected {' or '.join(names)}"

    others = [c for c in columns if c.joint == joint and c.meaning != meaning]
    if meaning == POSITION and others:
        reasons = [_reason(column) for column in others[:_REASONS]]
        if len(others) > _REASONS:
            reasons.append(f"{len(others) - _REASONS} more")
        problem += f"; {', '.join(reasons)}"
    elif meaning == POSITION:
        problem += " (other names: --map axis_e=NAME,...)"
    return f"{problem}, got {', '.join(table.header)[:200]}"


def _reason(column: _Column) -> str:
    """Why a column holds no positions, and which prefix would read it as positions."""
    meaning = column.meaning
    article = "an" if meaning in (EFFORT, ACCELERATION) else "a"
    said = {UNKNOWN: "not understood", MEASURED: "not understood"}
    reason = f"{column.name[:60]} is {said.get(meaning, f'{article} {meaning}')}"
    [given] = _columns_of_joints([column.name], column.group)
    if given.meaning == POSITION:
        reason += f" (prefix {column.group[:60]} reads it as a position)"
    return reason


def _meaning(before: str, after: str, given: bool) -> str:
    """The meaning of a column.

    Args:
        before, after: The texts around the joint in its name.
        given: Whether the caller gave this prefix: its unknown words are a name then,
            and its commands are what is asked for.
    """
    ahead = _meanings(before)
    behind = _meanings(after)
    if given:
        overruled = (UNKNOWN, COMMAND, MEASURED)
        ahead = [NAME if meaning in overruled else meaning for meaning in ahead]
    every = {*ahead, *behind}
    for meaning in (COMMAND, TORQUE, ACCELERATION, UNKNOWN):
        if meaning in every:
            return meaning
    if NAME in behind:
        return UNKNOWN

    quantities = [meaning for meaning in _QUANTITIES if meaning in every]
    if given and len(quantities) == 2 and POSITION in ahead:
        quantities.remove(POSITION)  # of a name such as ``q_arm_``
    if len(quantities) > 1:
        return UNKNOWN
    if not quantities:
        return MEASURED if MEASURED in every else POSITION
    return quantities[0]


def _meanings(text: str) -> list[str]:
    """What each word of a text means."""
    return [
        NAME if word.isdecimal() else _MEANING.get(word.lower(), UNKNOWN)
        for word in _WORD.findall(text)
    ]


def _group(before: str) -> str:
    """A prefix without the words that name a quantity."""
    kept = []
    end = 0
    for match in _WORD.finditer(before):
        kept.append(before[end : match.start()])
        separators = _SEPARATORS.match(before, match.end())
        end = separators.end() if separators else match.end()
        if _MEANING.get(match[0].lower()) not in _QUANTITIES:
            kept.append(before[match.start() : end])
    return "".join([*kept, before[end:]])
