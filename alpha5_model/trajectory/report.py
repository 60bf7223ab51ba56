"""The key figures of an analysed motion as lines for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from alpha5_model._support.text import readable, table
from alpha5_model.trajectory.key_figures import ROUNDING, SLIDING, TURNING
from alpha5_model.trajectory.smoothing import REST_SHARE

#: A record of `summary`, or a part of it.
_Record = Mapping[str, Any]


class _Column(NamedTuple):
    """A column of a table of joints.

    Attributes:
        title: Its name.
        unit: Its unit, or the quantity whose unit a joint has for it.
        place: Where its number is in a joint's record, keys joined by dots.
        form: How its number is formatted.
        missing: The text if there is no number.
        least: Smaller numbers are rounding and printed as 0.
    """

    title: str
    unit: str
    place: str
    form: str
    missing: str = "-"
    least: float = 0.0


_PEAKS = (
    _Column(
        title="torque",
        unit="torque",
        place="torque_peak.value",
        form="+.4g",
    ),
    _Column(
        title="current",
        unit="A",
        place="current_peak.value",
        form="+.3f",
        missing="needs --screw-lead",
    ),
    _Column(
        title="by friction's tolerance",
        unit="A",
        place="current_peak.interval",
        form="+.3f",
        missing="",
    ),
    _Column(
        title="speed",
        unit="velocity",
        place="velocity_peak.value",
        form="+.4g",
    ),
)
_MARGINS = (
    _Column(
        title="torque",
        unit="torque",
        place="torque_margin",
        form=".4g",
    ),
    _Column(
        title="current",
        unit="A",
        place="current_margin",
        form="+.3f",
    ),
    _Column(
        title="speed",
        unit="velocity",
        place="velocity_margin",
        form="+.3g",
    ),
    _Column(
        title="range",
        unit="position",
        place="position_margin",
        form="+.4g",
    ),
)
_EFFORT = (
    _Column(
        title="effort rms",
        unit="torque",
        place="effort.rms",
        form=".4g",
    ),
    _Column(
        title="mean",
        unit="torque",
        place="effort.difference_mean",
        form="+.4g",
    ),
    _Column(
        title="peak",
        unit="torque",
        place="effort.difference_peak.value",
        form="+.4g",
    ),
    _Column(
        title="rms",
        unit="torque",
        place="effort.difference_rms",
        form=".4g",
    ),
    _Column(
        title="less friction",
        unit="torque",
        place="effort.difference_rms_with_friction",
        form=".4g",
    ),
    _Column(
        title="correlation",
        unit="",
        place="effort.correlation",
        form=".4g",
    ),
)
_CURRENT = (
    _Column(
        title="current rms",
        unit="A",
        place="recorded_current.rms",
        form=".3f",
    ),
    _Column(
        title="mean",
        unit="A",
        place="recorded_current.difference_mean",
        form="+.3f",
    ),
    _Column(
        title="peak",
        unit="A",
        place="recorded_current.difference_peak.value",
        form="+.3f",
    ),
    _Column(
        title="rms",
        unit="A",
        place="recorded_current.difference_rms",
        form=".3f",
    ),
    _Column(
        title="correlation",
        unit="",
        place="recorded_current.correlation",
        form=".4g",
    ),
)


def text(record: dict[str, Any], verbose: bool = False) -> str:
    """The record of `summary` as lines for a terminal; tables fit 80 columns.

    Args:
        record: What `summary` returns.
        verbose: Whether the assumptions behind the figures follow, too.
    """
    joints: dict[str, _Record] = record["joints"]
    lines = [
        *_head(record),
        *_joint_table("peaks", joints, _PEAKS),
        *_digits(joints, own="arm" in record["model"]),
        *_limits(joints),
        *_warnings(record["warnings"]),
        *_margins(record),
        *_joint_table("largest torque by cause", joints, _causes(joints)),
        *_effort(joints),
        *_recorded_current(joints),
        *_water(record),
        *_whole_arm(record),
        *(_notes(record) if verbose else []),
    ]
    return readable("\n".join(lines))


def _head(record: _Record) -> list[str]:
    """The motion, the model and the smoothing."""
    model = record["model"]
    gravity = ", ".join(f"{round(g, 9) + 0.0:g}" for g in model["gravity"])
    smoothing = record["smoothing"]
    bandwidth = smoothing["bandwidth_hz"]
    width = "" if bandwidth is None else f", {bandwidth:.3g} Hz (-3 dB)"
    unit = record["time_unit_of_file"]
    column = "" if unit == "s" else f" (time column in {unit})"
    own = f"{model['arm']}, " if "arm" in model else ""
    payload = f"{model['payload_kg']:g} kg" if model["payload_kg"] else "none"
    return [
        f"{record['source']}: {record['samples']} samples, "
        f"{record['duration_s']:.2f} s{column}",
        f"  model: {own}{model['gripper']} gripper, "
        f"fluid {model['fluid_density']:g} kg/m^3, gravity ({gravity}) m/s^2",
        f"  payload: {payload}",
        f"  smoothing: {smoothing['method']}{width}; "
        f"derivatives from {smoothing['derivatives_from']}",
    ]


def _digits(joints: Mapping[str, _Record], own: bool) -> list[str]:
    """How far the tables' digits leave the arm's torques open, if that is known."""
    arm = [*joints.values()][:4]
    intervals = [joint["torque_peak"].get("interval") for joint in arm]
    if not all(intervals):
        return []
    halves = ", ".join(f"{(high - low) / 2:.1g}" for low, high in intervals)
    source = "half widths of the arm file, else digits" if own else "digits"
    return [f"  {source} of Tables 2, 3: torque peaks ±({halves}) N m"]


def _margins(record: _Record) -> list[str]:
    """The table of what is left to the limits, without those that nobody published."""
    own = "arm" in record["model"]
    with_motors = any(
        joint["current_margin"] is not None for joint in record["joints"].values()
    )
    shown = {"torque": own, "current": with_motors}
    columns = [column for column in _MARGINS if shown.get(column.title, True)]
    title = "left to the limits, negative beyond them"
    return _joint_table(title, record["joints"], columns)


def _causes(joints: Mapping[str, _Record]) -> list[_Column]:
    """The columns of the table of torques by cause."""
    first = next(iter(joints.values()))
    return [
        _Column(
            title=cause.removeprefix("moving_"),
            unit="torque",
            place=f"causes_peak.{cause}",
            form=".4g",
            least=ROUNDING,
        )
        for cause in first["causes_peak"]
    ]


def _effort(joints: Mapping[str, _Record]) -> list[str]:
    """The table of recorded efforts, of the joints that have some."""
    recorded = {name: joint for name, joint in joints.items() if joint.get("effort")}
    if not recorded:
        return []
    title = "recorded effort, and recorded minus computed"
    return _joint_table(title, recorded, _EFFORT)


def _recorded_current(joints: Mapping[str, _Record]) -> list[str]:
    """The table of recorded currents, of the motors that have some."""
    recorded = {
        name: joint for name, joint in joints.items() if joint.get("recorded_current")
    }
    if not recorded:
        return []
    title = "recorded current, and recorded minus computed"
    return _joint_table(title, recorded, _CURRENT)


def _water(record: _Record) -> list[str]:
    """What a current adds to the torques and to the load on the mount."""
    current = record["model"].get("water_current")
    if not current:
        return []
    rows = [["", "peak", "all numbers low .. high", ""]]
    for name, joint in record["joints"].items():
        unit = joint["units"]["torque"]
        rows.append(_water_row(name, joint["moving_water_peak"], unit))
    mount = record["mount"]
    rows.append(_water_row("mount", mount["water_force_peak_n"], "N"))
    rows.append(_water_row("", mount["water_moment_peak_nm"], "N m"))

    speed = ", ".join(f"{component:g}" for component in current)
    title = f"\n  water: current ({speed}) m/s; estimated, not published"
    return [title, *table(rows, "<>><", 2)]


def _water_row(name: str, peak: _Record, unit: str) -> list[str]:
    """A peak with its interval."""
    value = _cell(peak, "value", "+.4g")
    interval = _cell(peak, "interval", "+.4g")
    return [name, value, interval, unit]


def _whole_arm(record: _Record) -> list[str]:
    """Energy, load on the mount and path of the TCP."""
    energy = record["energy"]
    drawn = _cell(energy, "drawn_interval_j", ".4g")
    mount = record["mount"]
    force = mount["force_peak_n"]["value"]
    moment = mount["moment_peak_nm"]["value"]
    tcp = record["tcp"]
    first = _point(tcp["first_m"])
    last = _point(tcp["last_m"])
    lowest = _point(tcp["lowest_m"])
    highest = _point(tcp["highest_m"])
    return [
        "",
        f"  power: peak {energy['electrical_peak_w']:.3g} W; "
        f"drawn {energy['drawn_j']:.4g} J ({drawn}), "
        f"fed back {energy['fed_back_j']:.3g} J, "
        f"mechanical work {energy['mechanical_j']:.3g} J",
        f"  mount: force up to {force:.4g} N, moment up to {moment:.4g} N m",
        f"  TCP: path {tcp['path_length_m']:.4g} m, from {first} to {last} m,",
        f"       within {lowest} .. {highest} m",
    ]


def _point(position: Sequence[float]) -> str:
    """A point in base_link."""
    return f"({', '.join(f'{x:z.3f}' for x in position)})"


def _limits(joints: Mapping[str, _Record]) -> list[str]:
    """The limits that a joint exceeds."""
    lines = []
    for name, joint in joints.items():
        peak = abs(joint["velocity_peak"]["value"])
        rated = peak + joint["velocity_margin"]
        too_fast = joint["beyond_rated_velocity"]
        if too_fast:
            lines.append(
                f"  limit: {name} is beyond its rated speed of "
                f"{rated:.4g} {joint['units']['velocity']} "
                f"in {too_fast} samples, up to {peak:.4g}"
            )
        too_much = joint["beyond_drive_limits"]
        if too_much:
            lines.append(
                f"  limit: {name} is beyond the speed-torque limit "
                f"in {too_much} samples"
            )
    return lines


def _warnings(warnings: Sequence[_Record]) -> list[str]:
    """The warnings about the motion."""
    return [
        f"  warning: {w['text']}: {w['count']} x, first: {w['first']}" for w in warnings
    ]


def _notes(record: _Record) -> list[str]:
    """The assumptions behind the figures."""
    motors = record["motors"]
    own = record["model"].get("arm")
    whose = "the motors'" if own else "Table 4's"
    ratios = ", ".join(
        f"{joint} {ratio:.3f}" for joint, ratio in motors["constants_ratio"].items()
    )
    used = motors["constants"]
    if used == "printed":
        unexplained = record["energy"]["contradiction_j"]
        used += (
            f", which leaves {unexplained:+.3g} J of the electrical energy unexplained"
        )
    notes = [
        f"below {REST_SHARE:.1%} of its rated speed a joint is at rest: "
        "friction holds it, its motor helps with the least current",
        "friction, at the motor, is a cause of its own; "
        "it is in the current, not in the torque",
        f"torque limits are those of {own}"
        if own
        else "no torque limit is published; torque_margin of --json is to the 9 N m "
        "(jaw rod 10 N) of most public models",
        f"{whose} constants contradict each other (K_t/K_v: {ratios}); "
        f"used here: {used}",
        "Table 4 does not say whose efficiency eta_max is; "
        f"taken here for that of the {motors['efficiency']}",
    ]
    limits = motors.get("current_limits", {})
    without_limits = own and not any(limits.values())
    if motors["supply_voltage"] is None or without_limits:
        where = f", here or in {own}'s file" if own else ""
        notes.append(
            f"current limits need --supply-voltage and --current-limit{where}; "
            "neither is published"
        )
    return ["", *(f"  note: {note}" for note in notes)]


def _joint_table(
    title: str, joints: Mapping[str, _Record], columns: Sequence[_Column]
) -> list[str]:
    """A table with one line for each joint, the jaw rod under its own units."""
    rows = [["", *(column.title for column in columns)]]
    for units in (TURNING, SLIDING):
        group = {
            name: joint for name, joint in joints.items() if joint["units"] == units
        }
        if group:
            rows.append(["", *(units.get(x.unit, x.unit) for x in columns)])
        for name, joint in group.items():
            rows.append([name, *(_column_cell(joint, column) for column in columns)])
    return [f"\n  {title}", *table(rows, "<>", 2)]


def _column_cell(joint: _Record, column: _Column) -> str:
    """The number or interval of a joint in a column."""
    return _cell(joint, column.place, column.form, column.missing, column.least)


def _cell(
    record: _Record, place: str, form: str, missing: str = "-", least: float = 0.0
) -> str:
    """The number or interval at a place of a record.

    Args:
        record: Where the place starts.
        place: Keys joined by dots.
        form: How a number is formatted.
        missing: The text if there is no number.
        least: Smaller numbers are printed as 0.
    """
    value: Any = record
    for key in place.split("."):
        value = value and value[key]
    if value is None:
        return missing
    values = value if isinstance(value, list) else [value]
    return " .. ".join(format(x if abs(x) >= least else 0.0, form) for x in values)
