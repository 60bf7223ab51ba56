"""An analysed motion as lines for a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.text import readable, table
from alpha5_model.numbers.parameters import is_catalogue
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.key_figures import (
    ROUNDING,
    SLIDING,
    TURNING,
    Comparison,
    JointFigures,
    Peak,
    energy,
    joint_figures,
    mount_peaks,
    tcp_way,
    water_mount_peaks,
)
from alpha5_model.trajectory.smoothing import REST_SHARE

_Joints = dict[str, JointFigures]


class _Column(NamedTuple):
    """A column of a table of joints.

    Attributes:
        title: Its name.
        unit: Its unit, or the quantity whose unit a joint has for it.
        cell: The text for a joint.
    """

    title: str
    unit: str
    cell: Callable[[JointFigures], str]


def text(
    analysis: Analysis,
    verbose: bool = False,
    torque_margin: FloatArray | None = None,
) -> str:
    """The key figures as lines for a terminal; tables fit 80 columns.

    Args:
        analysis: What to summarise.
        verbose: Whether the assumptions behind the figures follow, too.
        torque_margin: As of `alpha5_model.trajectory.summary`.
    """
    joints = joint_figures(analysis, torque_margin)
    lines = [
        *_head(analysis),
        *_table("peaks", joints, _peaks()),
        *_digits(analysis, joints),
        *_limits(joints),
        *(f"  warning: {warning}" for warning in analysis.warnings),
        *_margins(analysis, joints),
        *_table("largest torque by cause", joints, _causes(analysis)),
        *_efforts(joints),
        *_currents(joints),
        *_water(analysis, joints),
        *_whole_arm(analysis),
        *(_notes(analysis) if verbose else []),
    ]
    return readable("\n".join(lines))


def _head(a: Analysis) -> list[str]:
    """The motion, the model and the smoothing."""
    time = a.smooth.time
    unit = a.motion.time_unit
    column = "" if unit == "s" else f" (time column in {unit})"
    own = "" if is_catalogue(a.arm.parameters) else f"{a.arm.parameters.name}, "
    gripper = "jaws" if "axis_a" in a.smooth.joints else "locked"
    gravity = ", ".join(f"{round(g, 9) + 0.0:g}" for g in a.arm.model.gravity.linear)
    mass = a.arm.payload_mass
    width = a.smooth.bandwidth
    smoothed = "" if width is None else f", {width:.3g} Hz (-3 dB)"
    source = "velocities" if a.smooth.from_velocity else "positions"
    return [
        f"{a.motion.source}: {time.size} samples, {time[-1] - time[0]:.2f} s{column}",
        f"  model: {own}{gripper} gripper, fluid {a.arm.fluid_density:g} kg/m^3, "
        f"gravity ({gravity}) m/s^2",
        f"  payload: {f'{mass:g} kg' if mass else 'none'}",
        f"  smoothing: {a.smooth.method}{smoothed}; derivatives from {source}",
    ]


def _peaks() -> list[_Column]:
    """The columns of the peaks."""

    def current(joint: JointFigures) -> str:
        peak = joint.current_peak
        return "needs --screw-lead" if peak is None else f"{peak.value:+.3f}"

    return [
        _Column("torque", "torque", lambda j: _size(j.torque_peak, "+.4g")),
        _Column("current", "A", current),
        _Column(
            "by friction's tolerance",
            "A",
            lambda j: _interval(j.current_peak, "+.3f", missing=""),
        ),
        _Column("speed", "velocity", lambda j: _size(j.velocity_peak, "+.4g")),
    ]


def _digits(a: Analysis, joints: _Joints) -> list[str]:
    """How far the tables' digits leave the arm's torques open, if that is known."""
    intervals = [joint.torque_peak.interval for joint in [*joints.values()][:4]]
    halves = [f"{(x[1] - x[0]) / 2:.1g}" for x in intervals if x is not None]
    if len(halves) < len(intervals):
        return []
    catalogue = is_catalogue(a.arm.parameters)
    source = "digits" if catalogue else "half widths of the arm file, else digits"
    return [f"  {source} of Tables 1 to 3: torque peaks ±({', '.join(halves)}) N m"]


def _limits(joints: _Joints) -> list[str]:
    """The limits that a joint exceeds."""
    lines = []
    for name, joint in joints.items():
        if joint.beyond_rated_velocity:
            unit = joint.units["velocity"]
            lines.append(
                f"  limit: {name} is beyond its rated speed of "
                f"{joint.velocity_limit:.4g} {unit} in "
                f"{joint.beyond_rated_velocity} samples, up to "
                f"{abs(joint.velocity_peak.value):.4g}"
            )
        if joint.beyond_drive_limits:
            lines.append(
                f"  limit: {name} is beyond the speed-torque limit "
                f"in {joint.beyond_drive_limits} samples"
            )
    return lines


def _margins(a: Analysis, joints: _Joints) -> list[str]:
    """The table of what is left to the limits, without those that nobody published."""
    columns = [
        _Column("speed", "velocity", lambda j: f"{j.velocity_margin:+.3g}"),
        _Column("range", "position", lambda j: f"{j.position_margin:+.4g}"),
    ]
    if any(joint.current_margin is not None for joint in joints.values()):
        columns.insert(
            0, _Column("current", "A", lambda j: _cell(j.current_margin, "+.3f"))
        )
    if not is_catalogue(a.arm.parameters):
        columns.insert(
            0, _Column("torque", "torque", lambda j: f"{j.torque_margin:.4g}")
        )
    return _table("left to the limits, negative beyond them", joints, columns)


def _causes(a: Analysis) -> list[_Column]:
    """The columns of the torques by cause."""

    def column(cause: str) -> _Column:
        def cell(joint: JointFigures) -> str:
            peak = joint.causes_peak[cause]
            return _cell(0.0 if peak is not None and peak < ROUNDING else peak, ".4g")

        return _Column(cause.removeprefix("moving_"), "torque", cell)

    return [column(cause) for cause in a.causes()]


def _efforts(joints: _Joints) -> list[str]:
    """The table of recorded efforts, of the joints that have some."""
    recorded = {name: j for name, j in joints.items() if j.effort}
    columns = _compared("effort", "torque", "4g", lambda j: j.effort, friction=True)
    title = "recorded effort, and recorded minus computed"
    return _table(title, recorded, columns) if recorded else []


def _currents(joints: _Joints) -> list[str]:
    """The table of recorded currents, of the motors that have some."""
    recorded = {name: j for name, j in joints.items() if j.recorded_current}
    columns = _compared("current", "A", "3f", lambda j: j.recorded_current)
    title = "recorded current, and recorded minus computed"
    return _table(title, recorded, columns) if recorded else []


def _compared(
    what: str,
    unit: str,
    digits: str,
    of_joint: Callable[[JointFigures], Comparison | None],
    friction: bool = False,
) -> list[_Column]:
    """The columns of a comparison.

    Args:
        what: What was recorded.
        unit: Of `_Column`.
        digits: How numbers are formatted.
        of_joint: The comparison of a joint.
        friction: Whether the difference without friction is a column, too.
    """

    def column(
        title: str,
        form: str,
        number: Callable[[Comparison], float | None],
        unit: str = unit,
    ) -> _Column:
        def cell(joint: JointFigures) -> str:
            found = of_joint(joint)
            return _cell(None if found is None else number(found), form)

        return _Column(title, unit, cell)

    plain = f".{digits}"
    signed = f"+.{digits}"
    columns = [
        column(f"{what} rms", plain, lambda x: x.rms),
        column("mean", signed, lambda x: x.difference_mean),
        column("peak", signed, lambda x: x.difference_peak.value),
        column("rms", plain, lambda x: x.difference_rms),
    ]
    if friction:
        rest = column("less friction", plain, lambda x: x.difference_rms_with_friction)
        columns.append(rest)
    return [*columns, column("correlation", ".4g", lambda x: x.correlation, unit="")]


def _water(a: Analysis, joints: _Joints) -> list[str]:
    """What a current adds to the torques and to the load on the mount."""
    if a.moving_water is None:
        return []
    force, moment = water_mount_peaks(a.moving_water, a.smooth.time)
    peaks = [
        *((name, j.moving_water_peak, j.units["torque"]) for name, j in joints.items()),
        ("mount", force, "N"),
        ("", moment, "N m"),
    ]
    rows = [["", "peak", "all numbers low .. high", ""]]
    for name, peak, unit in peaks:
        value = None if peak is None else peak.value
        rows.append([name, _cell(value, "+.4g"), _interval(peak, "+.4g"), unit])
    speed = ", ".join(f"{x:g}" for x in a.moving_water.water_velocity)
    title = f"\n  water: current ({speed}) m/s; estimated, not published"
    return [title, *table(rows, "<>><", 2)]


def _whole_arm(a: Analysis) -> list[str]:
    """Energy, load on the mount and path of the TCP."""
    used = energy(a)
    drawn = " .. ".join(_cell(x, ".4g") for x in used["drawn_interval_j"])
    force, moment = mount_peaks(a)
    first, last = _point(a.tcp[0]), _point(a.tcp[-1])
    lowest, highest = _point(a.tcp.min(axis=0)), _point(a.tcp.max(axis=0))
    return [
        "",
        f"  power: peak {used['electrical_peak_w']:.3g} W; "
        f"drawn {used['drawn_j']:.4g} J ({drawn}), "
        f"fed back {used['fed_back_j']:.3g} J, "
        f"mechanical work {used['mechanical_j']:.3g} J",
        f"  mount: force up to {force.value:.4g} N, "
        f"moment up to {moment.value:.4g} N m",
        f"  TCP: path {tcp_way(a):.4g} m, from {first} to {last} m,",
        f"       within {lowest} .. {highest} m",
    ]


def _point(position: Iterable[float]) -> str:
    """A point in base_link."""
    return f"({', '.join(f'{x:z.3f}' for x in position)})"


def _notes(a: Analysis) -> list[str]:
    """The assumptions behind the figures."""
    record = a.arm.parameters
    own = None if is_catalogue(record) else record.name
    ratios = ", ".join(f"{m.joint} {m.constants_ratio:.3f}" for m in a.actuators)
    whose = "the motors'" if own else "Table 4's"
    used = a.actuators[0].constants
    if used == "printed":
        unexplained = energy(a)["contradiction_j"]
        used += (
            f", which leaves {unexplained:+.3g} J of the electrical energy unexplained"
        )
    at_motors = (
        "friction, at the motor, is a cause of its own; "
        "it is in the current, not in the torque"
    )
    if a.rotor is not None:
        at_motors = (
            "rotor and friction, at the motor, are causes of their own; "
            "they are in the current, not in the torque"
        )
    notes = [
        f"below {REST_SHARE:.1%} of its rated speed a joint is at rest: "
        "friction holds it, its motor helps with the least current",
        at_motors,
        f"torque limits are those of {own}"
        if own
        else "no torque limit is published; torque_margin of --json is to the 9 N m "
        "(jaw rod 10 N) of most public models",
        f"{whose} constants "
        f"contradict each other (K_t/K_v: {ratios}); used here: {used}",
        "Table 4 does not say whose efficiency eta_max is; "
        f"taken here for that of the {a.actuators[0].efficiency}",
    ]
    supply = a.supply_voltage or record.motors.supply_voltage
    limits = a.current_limits or record.motors.current_limits
    known = supply if own else a.supply_voltage
    if known is None or (own and not any(limits)):
        where = f", here or in {own}'s file" if own else ""
        notes.append(
            f"current limits need --supply-voltage and --current-limit{where}; "
            "neither is published"
        )
    return ["", *(f"  note: {note}" for note in notes)]


def _table(title: str, joints: _Joints, columns: Sequence[_Column]) -> list[str]:
    """A table with one line for each joint, the jaw rod under its own units."""
    rows = [["", *(column.title for column in columns)]]
    for units in (TURNING, SLIDING):
        group = {name: joint for name, joint in joints.items() if joint.units == units}
        if group:
            rows.append(["", *(units.get(x.unit, x.unit) for x in columns)])
        for name, joint in group.items():
            rows.append([name, *(column.cell(joint) for column in columns)])
    return [f"\n  {title}", *table(rows, "<>", 2)]


def _cell(value: float | None, form: str) -> str:
    """A number, or a dash if it is not known."""
    return "-" if value is None else format(value, form)


def _size(peak: Peak, form: str) -> str:
    """The value of a peak, 0 for rounding."""
    return format(peak.value if abs(peak.value) > ROUNDING else 0.0, form)


def _interval(peak: Peak | None, form: str, missing: str = "-") -> str:
    """The interval of a peak."""
    if peak is None or peak.interval is None:
        return missing
    return " .. ".join(format(x, form) for x in peak.interval)
