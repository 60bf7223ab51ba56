"""The meaning of column names: prefix, joint and quantity.

A name is read only if each of its words is understood, so that no torque is taken for a
position.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from alpha5_model.errors import InputError
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.column_units import CURRENTS, scale, split_unit

POSITION = "position"
VELOCITY = "velocity"
EFFORT = "effort"
#: Of the motor.
CURRENT = "current"
#: A word of a robot's name or place.
NAME = "name"
#: A word such as ``measured`` or ``filtered``, which names no quantity.
MEASURED = "measured"
COMMAND = "command"
UNKNOWN = "unknown"
TORQUE = "torque"

#: Meaning -> the words that have it.
_WORDS = {
    POSITION: "pos position positions q angle angles theta",
    VELOCITY: "vel velocity velocities dq qd qdot dtheta thetadot",
    EFFORT: "eff effort efforts",
    NAME: """
        alpha arm arms aft auv back blueprint bluerov bottom bravo follower fore front
        joint joints leader left main manip manipulator master port primary reach real
        rear right robot rov secondary sim slave starboard stbd top uvms vehicle""",
    MEASURED: """
        act actual est estimate estimated fb feedback filt filtered meas measured
        present recorded sensed sensor smooth smoothed unwrap unwrapped""",
    COMMAND: """
        action actions cmd cmds command commands commanded dcmd ddes ddref demand
        demanded des desired dref goal goals input nominal plan planned ref reference
        references req request requested set setpoint setpoints sp target targets traj
        trajectory""",
    "raw value": "adc cnt cnts count counts enc encoder hall raw resolver tick ticks",
    "limit": "bound bounds lim limit limits lower margin range sat saturation upper",
    TORQUE: "mom moment moments nm taus tau torque torques tq trq",
    "force": "force forces frc load loads strain stress wrench",
    CURRENT: """
        amp ampere amperes amps cur curr current currents iq ma milliamp milliamperes
        milliamps""",
    "voltage": "mv vbus volt voltage voltages volts",
    "power": "energy joule joules pow power watt watts",
    "temperature": "celsius degc heat temp temperature temperatures temps thermal",
    "speed of another unit": "omega rate rates rpm speed speeds",
    "acceleration": """
        acc accel acceleration accelerations accels ddot ddq ddtheta jerk qdd qddot
        snap""",
    "difference": """
        delta der deriv derivative dev deviation diff difference dot err error errors
        inc increment innovation lag mismatch residual residuals step track tracking""",
    "statistic": """
        average avg bias conf confidence cov covariance drift max maximum mean median
        min minimum noise norm off offset peak rms sigma std stddev stdev sum
        uncertainty var variance weight""",
    "gain": """
        damping feedforward ff friction gain gains integral kd kff ki kp kv pid
        stiffness""",
    "model term": "buoyancy coriolis drag gravity inertia mass",
    "control signal": "control controller ctrl duty output outputs pwm",
    "motor side": "gear gearbox motor motors rotor",
    "status": """
        alarm brake code enable enabled fault faults flag flags health homed mode ok
        quality stall stalled status valid warning""",
    "time": "age delay dt latency period stamp time timestamp timestamps",
    "environment": "depth humidity leak pressure",
    "angle in degrees": "deg degree degrees degs",
}
#: Word -> its meaning.
_MEANING = {
    word: meaning for meaning, words in _WORDS.items() for word in words.split()
}
#: Meanings of a prefix that the caller may overrule by giving this prefix.
_ON_REQUEST = {COMMAND, "raw value", "limit", UNKNOWN}
_QUANTITIES = {POSITION, VELOCITY, EFFORT, CURRENT}
#: Number of columns that a message explains.
_REASONS = 4

#: The last joint in a name. ``axis_e2`` is not ``axis_e``.
_JOINT = re.compile(rf"(.*)({'|'.join(JOINT_NAMES)})(?![A-Za-z0-9])(.*)", re.DOTALL)
#: The same in the name of a column, where capitals do not matter.
_JOINT_OF_COLUMN = re.compile(_JOINT.pattern, re.DOTALL | re.IGNORECASE)
#: A word, as in ``tau_``, ``jointVelocity/`` and ``arm2.``. Any other sign is a word.
_WORD = re.compile(r"^-|[A-Z]?[a-z]+|[A-Z]+(?![a-z])|[0-9]+|[^\sA-Za-z0-9_./:\-\[\]()]")
_SEPARATORS = re.compile(r"[\s_./:\-\[\]()]*")


@dataclass(frozen=True)
class Column:
    """A column of a joint.

    Attributes:
        name: As in the file.
        joint: ``"axis_e"`` and so on.
        group: The prefix of the joint without the words of the quantity: ``"left_"`` in
            ``dq_left_axis_e``. Columns of one arm have the same group.
        meaning: ``"position"``, ``"velocity"``, ``"effort"``, ``"current"``, or another
            one, such as ``"torque"``, ``"command"`` or ``"unknown"``.
        scale: SI units in the unit of its name; None if it names none.
    """

    name: str
    joint: str
    group: str
    meaning: str
    scale: float | None = None


def joint_columns(
    header: Iterable[str], wanted_prefix: str | None = None
) -> list[Column]:
    """The columns that name a joint of the arm.

    Args:
        header: Names of all columns.
        wanted_prefix: The prefix of the arm's joints that the caller gave, or None.
    """
    wanted_group = None if wanted_prefix is None else _group(wanted_prefix)
    columns = []
    for name in header:
        match = _JOINT_OF_COLUMN.fullmatch(name)
        if not match:
            continue
        before, joint, after = match.groups()
        group = _group(before)
        on_request = group == wanted_group
        meaning = _meaning(before, after, on_request)
        factor: float | None = None

        after_without_unit, unit = split_unit(after)
        if unit:
            of_stem = _meaning(before, after_without_unit, on_request)
            # Drivers report the current in the field of the effort, and a bare
            # ``axis_e_mA`` is no position.
            bare = of_stem == POSITION and not after_without_unit
            if unit in CURRENTS and (bare or of_stem == EFFORT):
                of_stem = CURRENT
            known = scale(joint.lower(), of_stem, unit)
            if known is not None:
                meaning = of_stem
                factor = known
        column = Column(
            name=name,
            joint=joint.lower(),
            group=group,
            meaning=meaning,
            scale=factor,
        )
        columns.append(column)
    return columns


def groups(columns: Iterable[Column], wanted_prefix: str | None = None) -> list[str]:
    """The groups that have a position of each arm joint, sorted.

    Args:
        columns: From `joint_columns`.
        wanted_prefix: The prefix that the caller gave: only its group counts.
    """
    joints_of: dict[str, set[str]] = {}
    for column in columns:
        if column.meaning == POSITION:
            joints_of.setdefault(column.group, set()).add(column.joint)

    complete = _complete(joints_of)
    if wanted_prefix is not None:
        complete = [group for group in complete if group == _group(wanted_prefix)]
    return sorted(complete)


def prefixes(names: Collection[str], wanted_prefix: str | None = None) -> list[str]:
    """The prefixes of complete arms in the names of a ``JointState`` message, sorted.

    Such a message holds positions by definition, so unknown words are taken for a
    robot's name. A prefix with a known word of another meaning, such as a command, does
    not count.
    """
    joints_of: dict[str, set[str]] = {}
    for name in names:
        match = _JOINT.fullmatch(name)
        if not match:
            continue
        before, joint, after = match.groups()
        if not after:
            joints_of.setdefault(before, set()).add(joint)

    complete = _complete(joints_of)
    if wanted_prefix is not None:
        return [prefix for prefix in complete if prefix == wanted_prefix]
    allowed = {POSITION, NAME, MEASURED, UNKNOWN}
    return sorted(
        prefix for prefix in complete if allowed.issuperset(_meanings(prefix))
    )


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


def explained(columns: Iterable[Column], joint: str) -> str:
    """Why columns of a joint hold no positions; ``""`` if there are no such columns."""
    others = [
        column
        for column in columns
        if column.joint == joint and column.meaning != POSITION
    ]
    reasons = [_reason(column) for column in others[:_REASONS]]
    if len(others) > _REASONS:
        reasons.append(f"{len(others) - _REASONS} more")
    return ", ".join(reasons)


def _reason(column: Column) -> str:
    """Why a column holds no positions, and which prefix would read it as positions."""
    reason = f"{column.name[:60]} is {_with_article(column.meaning)}"
    (on_request,) = joint_columns([column.name], wanted_prefix=column.group)
    if on_request.meaning == POSITION:
        reason += f" (prefix {column.group[:60]} reads it as a position)"
    return reason


def _with_article(meaning: str) -> str:
    """A meaning as it reads after "is"."""
    if meaning == UNKNOWN:
        return "not understood"
    article = "an" if meaning[0] in "aeiou" else "a"
    return f"{article} {meaning}"


def _complete(joints_of: dict[str, set[str]]) -> list[str]:
    """The groups or prefixes that have each of the four arm joints."""
    arm = JOINT_NAMES[:4]
    return [group for group, joints in joints_of.items() if joints.issuperset(arm)]


def _meaning(before: str, after: str, on_request: bool) -> str:
    """The meaning of a column.

    Args:
        before, after: The texts around the joint in its name.
        on_request: Whether the caller gave the prefix of this group.
    """
    ahead = _meanings(before)
    behind = _meanings(after)
    if on_request:
        overruled = {*_ON_REQUEST, MEASURED}
        if behind:
            overruled.add(POSITION)
        ahead = [meaning for meaning in ahead if meaning not in overruled]
    every = ahead + behind

    if COMMAND in every:
        return COMMAND
    harmless = {*_QUANTITIES, NAME, MEASURED, UNKNOWN}
    others = [meaning for meaning in every if meaning not in harmless]
    if others:
        return others[0]

    quantities = _QUANTITIES.intersection(every)
    if len(quantities) > 1 or not {*_QUANTITIES, MEASURED}.issuperset(behind):
        return UNKNOWN
    # ``any_axis_e_pos`` says what it is; ``any_pos_axis_e`` may be the gain of a
    # controller.
    if UNKNOWN in ahead and not _QUANTITIES.intersection(behind):
        return UNKNOWN
    if not quantities:
        return UNKNOWN if MEASURED in every else POSITION
    return quantities.pop()


def _meanings(text: str) -> list[str]:
    """What each word of a text means."""
    return [
        NAME if word.isdecimal() else _MEANING.get(word.lower(), UNKNOWN)
        for word in _WORD.findall(text)
    ]


def _group(before: str) -> str:
    """A prefix without the words that name a quantity."""
    kept = ""
    end = 0
    for match in _WORD.finditer(before):
        kept += before[end : match.start()]
        separators = _SEPARATORS.match(before, match.end())
        end = separators.end() if separators else match.end()
        if _MEANING.get(match[0].lower()) not in _QUANTITIES:
            kept += before[match.start() : end]
    return kept + before[end:]
