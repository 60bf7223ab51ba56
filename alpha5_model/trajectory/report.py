"""An analysed motion as key figures, as text and as a table over time."""

from __future__ import annotations

import json
import math
import tomllib
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, atomic_write, output_format
from alpha5_model._support.text import plain, readable, table
from alpha5_model.numbers.parameters import JointRange
from alpha5_model.trajectory import file_table, smoothing
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.checks import LIMIT_SLACK
from alpha5_model.trajectory.motors import BY_MOTOR

#: Of the table: CSV, or JSON with the key figures on top.
FORMATS = (".csv", ".json")
#: Torques less than this are rounding.
_ROUNDING = 1e-12
#: Rows written between two reports of progress.
_CHUNK = 10_000
#: Figures of a joint that are None without limits of its drive.
_BY_DRIVE = (
    "current_margin",
    "voltage_margin",
    "drive_torque_margin",
    "beyond_drive_limits",
)
#: Figures of the load on the mount.
_MOUNT = ("force_peak_n", "moment_peak_nm")
#: Units of a joint's figures.
_TURNING = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
_SLIDING = {"position": "m", "velocity": "m/s", "torque": "N"}


def summary(analysis: Analysis) -> dict[str, Any]:
    """Peaks, margins, energies and warnings, in types that JSON has.

    Units: s, A, V, W, J, N, m; a joint's position, velocity and torque are in its ``units``: rad,
    rad/s, N m, for the jaw rod ``axis_a`` m, m/s, N. A margin is what is left to a limit, negative
    beyond it. ``null`` where a motor cannot be computed, a limit is not given or no effort is
    recorded; an effort's differences are those of what was recorded less the torque computed.
    """
    a, s = analysis, analysis.smooth
    time, v, water = s.time, s.signed_velocity, a.moving_water
    steps, path = np.diff(time), np.linalg.norm(np.diff(a.tcp, axis=0), axis=1)
    power = np.nansum(a.electrical_power, axis=1)
    known = [
        (k, m) for k, m in enumerate(a.actuators) if np.isfinite(a.current[:, k]).all()
    ]
    currents = (
        a.current_lower,
        a.current_upper,
    )  # over the printed tolerance of friction
    powers = [
        np.stack([m.voltage(i[:, k], v[:, k]) * i[:, k] for k, m in known])
        for i in currents
    ]
    drawn = [_drawn(end(*powers).sum(axis=0), time) for end in (np.minimum, np.maximum)]
    excess = (
        (k, (m.back_emf_constant - m.torque_constant) * m.ratio) for k, m in known
    )
    contradiction = sum(torque * a.current[:, k] * v[:, k] for k, torque in excess)
    model: dict[str, Any] = {"gripper": "jaws" if "axis_a" in s.joints else "locked"}
    model |= {
        "fluid_density": a.arm.fluid_density,
        "gravity": a.arm.model.gravity.linear,
    }
    sizes = np.linalg.norm(a.base_wrench.reshape(-1, 2, 3), axis=2)
    mount = {name: _peak(sizes[:, i], time) for i, name in enumerate(_MOUNT)}
    if water is not None:
        model["water_current"] = water.current
        sizes = np.linalg.norm(water.wrench.reshape(-1, 3, 2, 3), axis=3)
        mount |= {
            f"water_{x}": _water_peak(sizes[..., i], time) for i, x in enumerate(_MOUNT)
        }
    ends = {"first_m": a.tcp[0], "last_m": a.tcp[-1]}
    ends |= {"lowest_m": a.tcp.min(axis=0), "highest_m": a.tcp.max(axis=0)}
    derivatives = {"derivatives_from": "velocities" if s.from_velocity else "positions"}
    ratios = {m.joint: m.constants_ratio for m in a.actuators}
    drive = {"supply_voltage": a.supply_voltage, "current_limit": a.current_limit}
    energy = {"electrical_peak_w": power.max(), "drawn_j": _drawn(power, time)}
    energy |= {"drawn_interval_j": drawn, "fed_back_j": _drawn(-power, time)}
    energy["mechanical_j"] = _integral(a.mechanical_power.sum(axis=1), time)
    energy["contradiction_j"] = _integral(np.asarray(contradiction), time)
    out: dict[str, Any] = {
        "source": a.motion.source,
        "samples": time.size,
        "start_s": time[0],
    }
    out |= {"duration_s": time[-1] - time[0], "time_unit_of_file": a.motion.time_unit}
    out |= {
        "sample_time_s": {"median": np.median(steps), "longest": steps.max()},
        "model": model,
    }
    out["smoothing"] = {"method": s.method, "bandwidth_hz": s.bandwidth, **derivatives}
    out["motors"] = {
        "constants": a.actuators[0].constants,
        "constants_ratio": ratios,
        "efficiency": a.actuators[0].efficiency,
        **drive,
    }
    joints = {joint.name: _joint(a, k, joint) for k, joint in enumerate(_ranges(a))}
    out |= {"joints": joints, "energy": energy}
    out |= {"mount": mount, "tcp": ends | {"path_length_m": path.sum()}}
    out |= {"warnings": a.warnings, "ignored_columns": a.motion.ignored}
    record: dict[str, Any] = plain(
        out, math.nan
    )  # which JSON refuses: what may lack is None
    return record


def _ranges(a: Analysis) -> list[JointRange]:
    """What the joints of the arm may do, which need not be what the catalogue's may."""
    limits = a.arm.limits
    columns = zip(a.arm.joint_names, *(end.tolist() for end in limits), strict=True)
    return [
        JointRange(
            name=name, lower=lower, upper=upper, velocity=velocity, effort=effort
        )
        for name, lower, upper, velocity, effort in columns
    ]


def _joint(a: Analysis, k: int, joint: JointRange) -> dict[str, Any]:
    s, time = a.smooth, a.smooth.time
    states = a.motion.position, s.velocity, s.acceleration, a.torque
    q, velocity, acceleration, torque = (x[:, k] for x in states)
    motor = a.current, a.current_lower, a.current_upper, a.voltage, a.electrical_power
    current, least, most, voltage, power = (x[:, k] for x in motor)
    margin = min(q.min() - joint.lower, joint.upper - q.max())
    if -LIMIT_SLACK * (joint.upper - joint.lower) <= margin < 0:
        margin = 0.0  # at the limit, as the warnings have it
    units = _SLIDING if joint.name == "axis_a" else _TURNING
    out: dict[str, Any] = {"units": units, "position_range": [q.min(), q.max()]}
    out |= {
        "position_margin": margin,
        "velocity_margin": joint.velocity - np.abs(velocity).max(),
    }
    out["beyond_rated_velocity"] = np.count_nonzero(np.abs(velocity) > joint.velocity)
    out |= {
        "velocity_peak": _peak(velocity, time),
        "acceleration_peak": _peak(acceleration, time),
    }
    out |= {"torque_peak": _peak(torque, time), "smoothing_deviation": s.deviation[k]}
    # Against the effort that every public model copies; no rating is published.
    out |= {
        "torque_rms": _rms(torque, time),
        "torque_margin": joint.effort - np.abs(torque).max(),
    }
    out["causes_peak"] = {
        c: _finite(np.abs(x[:, k]).max()) for c, x in a.causes().items()
    }
    out |= {"effort": _effort(a, k), "current_peak": _peak(current, time, least, most)}
    out |= {"current_rms": _rms(current, time), "voltage_peak": _peak(voltage, time)}
    out |= {"power_peak": _peak(power, time), "energy_drawn_j": _drawn(power, time)}
    out |= dict.fromkeys(_BY_DRIVE)
    if a.moving_water is not None:
        out["moving_water_peak"] = _water_peak(a.moving_water.torque[:, :, k], time)
    if a.torque_limits and a.current_limit and a.supply_voltage and out["current_peak"]:
        out["current_margin"] = a.current_limit - np.abs([least, most]).max()
        out["voltage_margin"] = a.supply_voltage - np.abs(voltage).max()
        lower, upper = (end[:, k] for end in a.torque_limits)
        reserve = np.minimum(upper - torque, torque - lower)
        possible = reserve[np.isfinite(reserve)]
        out["drive_torque_margin"] = possible.min() if possible.size else None
        out["beyond_drive_limits"] = np.count_nonzero(~(reserve >= 0))
    return out


def _effort(a: Analysis, k: int) -> dict[str, Any] | None:
    """Recorded effort of a joint against the torque computed, over the samples that have one."""
    if (
        a.motion.effort is None
        or not (there := np.isfinite(a.motion.effort[:, k])).any()
    ):
        return None
    time, efforts = a.smooth.time[there], (a.motion.effort, a.torque, a.friction)
    effort, torque, friction = (x[there, k] for x in efforts)
    difference = effort - torque
    varied = min(np.ptp(effort), np.ptp(torque)) > _ROUNDING
    parts = effort, difference, difference - friction
    whole, rms, rest = (_finite(np.sqrt(np.mean(x**2))) for x in parts)
    out = {"samples": effort.size, "peak": _peak(effort, time), "rms": whole}
    out |= {"difference_mean": difference.mean(), "difference_rms": rms}
    out |= {
        "difference_peak": _peak(difference, time),
        "difference_rms_with_friction": rest,
    }
    return out | {"correlation": np.corrcoef(effort, torque)[0, 1] if varied else None}


def _peak(
    values: FloatArray, time: FloatArray, *ends: FloatArray
) -> dict[str, Any] | None:
    """The largest value, and there its interval; None of a motor that cannot be computed."""
    at = int(np.abs(values).argmax())
    out: dict[str, Any] = {"value": values[at], "time_s": time[at]}
    if ends:
        out["interval"] = [end[at] for end in ends]
    return out if np.isfinite(values[at]) else None


def _water_peak(levels: FloatArray, time: FloatArray) -> dict[str, Any] | None:
    """The largest nominal value, its interval from all numbers low to all high; levels are (N, 3)."""
    return _peak(levels[:, 1], time, levels.min(axis=1), levels.max(axis=1))


def _integral(values: FloatArray, time: FloatArray) -> float:
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(time)))


def _drawn(power: FloatArray, time: FloatArray) -> float | None:
    """Energy of the positive part."""
    return _finite(_integral(np.maximum(power, 0.0), time))


def _rms(values: FloatArray, time: FloatArray) -> float | None:
    return _finite(np.sqrt(_integral(values**2, time) / (time[-1] - time[0])))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def text(record: dict[str, Any]) -> str:
    """The record of `summary` as lines for a terminal; tables fit 80 columns."""
    words: Any = tomllib.loads(
        Path(__file__).with_name("report.toml").read_text("utf-8")
    )
    joints, motors, mount, energy = (
        record[k] for k in ("joints", "motors", "mount", "energy")
    )
    unit, width = record["time_unit_of_file"], record["smoothing"]["bandwidth_hz"]
    left = f", which leaves {energy['contradiction_j']:+.3g} J of the electrical energy unexplained"
    parts = {
        **record,
        "column": "" if unit == "s" else f" (time column in {unit})",
        "gravity": ", ".join(
            f"{round(g, 9) + 0.0:g}" for g in record["model"]["gravity"]
        ),
        "width": "" if width is None else f", {width:.3g} Hz (-3 dB)",
        "drawn": _cell(energy, "drawn_interval_j", ".4g"),
        "rest": smoothing.REST_SHARE,
        "ratios": ", ".join(
            f"{name} {r:.3f}" for name, r in motors["constants_ratio"].items()
        ),
        "left": left if motors["constants"] == "printed" else "",
    }
    for end in ("first_m", "last_m", "lowest_m", "highest_m"):
        parts[end] = f"({', '.join(f'{x:z.3f}' for x in record['tcp'][end])})"
    lines = [words["head"].format(**parts), *_by_joint("peaks", joints, words["peaks"])]
    digits = [j["torque_peak"].get("interval") for j in [*joints.values()][:4]]
    if all(digits):
        halves = ", ".join(f"{(high - low) / 2:.1g}" for low, high in digits)
        lines.append(f"  digits of Tables 2, 3: torque peaks ±({halves}) N m")
    lines += _by_joint(
        "left to the limits, negative beyond them", joints, words["left"]
    )
    names = next(iter(joints.values()))["causes_peak"]
    how = ".4g", "-", _ROUNDING
    causes = {
        x.removeprefix("moving_"): ["torque", f"causes_peak.{x}", *how] for x in names
    }
    lines += _by_joint("largest torque by cause", joints, causes)
    if recorded := {name: j for name, j in joints.items() if j.get("effort")}:
        title = "recorded effort, and what it has more than the torque"
        lines += _by_joint(title, recorded, words["effort"])
    if water := record["model"].get("water_current"):
        speed = ", ".join(f"{x:g}" for x in water)
        lines.append(f"\n  water: current ({speed}) m/s; estimated, not published")
        peaks = [
            (k, j["moving_water_peak"], j["units"]["torque"]) for k, j in joints.items()
        ]
        loads = (mount[f"water_{name}"] for name in _MOUNT)
        peaks += zip(("mount", ""), loads, ("N", "N m"), strict=True)
        rows = [["", "peak", "all numbers low .. high", ""]]
        for name, peak, unit in peaks:
            rows.append(
                [name, *(_cell(peak, k, "+.4g") for k in ("value", "interval")), unit]
            )
        lines += table(rows, "<>><", 2)
    lines.append(words["whole_arm"].format(**parts))
    for name, j in joints.items():
        peak = abs(j["velocity_peak"]["value"])
        said = {**j, "name": name, "peak": peak, "rated": peak + j["velocity_margin"]}
        lines += (
            form.format(**said) for key, form in words["beyond"].items() if j[key]
        )
    lines += (words["warning"].format(**w) for w in record["warnings"])
    notes = words["notes"] + words["without_drive"] * (motors["supply_voltage"] is None)
    return readable(
        "\n".join([*lines, *(f"  note: {note.format(**parts)}" for note in notes)])
    )


def _by_joint(
    title: str, joints: dict[str, Any], columns: dict[str, list[Any]]
) -> list[str]:
    """A table of joints, the jaw rod under its units."""
    rows = [["", *columns]]
    for units in (_TURNING, _SLIDING):
        group = {name: j for name, j in joints.items() if j["units"] == units}
        rows += (
            [["", *(units.get(unit, unit) for unit, *_ in columns.values())]]
            if group
            else []
        )
        for name, j in group.items():
            rows.append([name, *(_cell(j, *how) for _, *how in columns.values())])
    return [f"\n  {title}", *table(rows, "<>", 2)]


def _cell(
    record: Any, place: str, form: str, missing: str = "-", least: float = 0.0
) -> str:
    """What stands at a place of the record; numbers less than ``least`` are rounding."""
    value = reduce(lambda found, key: found and found[key], place.split("."), record)
    if value is None:
        return missing
    values = value if isinstance(value, list) else [value]
    return " .. ".join(format(x if abs(x) >= least else 0.0, form) for x in values)


def columns(analysis: Analysis) -> dict[str, FloatArray]:
    """Every quantity over time by column name, SI units, without motors that cannot be computed.

    ``time_secs``; for each joint ``axis_e_pos, axis_e_vel, axis_e_acc`` (smoothed),
    ``axis_e_torque`` and its causes, ``axis_e_effort`` as recorded, currents, voltage, powers and, with limits,
    ``axis_e_torque_min``, ``_max``, in a current ``axis_e_torque_moving_water_low``, ``_high``;
    ``base_force_x .. base_moment_z`` on the mount; ``tcp_x .. tcp_z``. The file can be read again
    by `read_motion`.
    """
    a, s = analysis, analysis.smooth
    by_joint = {
        "pos": s.position,
        "vel": s.velocity,
        "acc": s.acceleration,
        "torque": a.torque,
    }
    by_joint |= {f"torque_{cause}": torque for cause, torque in a.causes().items()}
    if a.motion.effort is not None:
        by_joint["effort"] = a.motion.effort
    if (water := a.moving_water) is not None:
        low, _, high = water.torque.swapaxes(0, 1)
        by_joint |= {"torque_moving_water_low": low, "torque_moving_water_high": high}
    by_joint |= {name: getattr(a, name) for name in (*BY_MOTOR[1:], "mechanical_power")}
    if a.torque_limits is not None:
        by_joint |= {
            "torque_min": a.torque_limits.lower,
            "torque_max": a.torque_limits.upper,
        }
    out = {"time_secs": s.time}
    for k, joint in enumerate(s.joints):
        out |= {f"{joint}_{name}": table[:, k] for name, table in by_joint.items()}
    for k, axis in enumerate("xyz"):
        out[f"base_force_{axis}"] = a.base_wrench[:, k]
        out[f"base_moment_{axis}"] = a.base_wrench[:, 3 + k]
        out[f"tcp_{axis}"] = a.tcp[:, k]
    return {name: column for name, column in out.items() if not np.isnan(column).all()}


def write(
    analysis: Analysis, path: PathLike, progress: file_table.Progress | None = None
) -> Path:
    """Write the table; the suffix says how, ``.csv`` (also ``-``, devices and pipes) or ``.json``.

    Args:
        analysis: What to write.
        path: Target.
        progress: Called with a stage's name and the part done, 0 to 1.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    target = Path(path)
    kind = output_format("table format", target, FORMATS)
    table = columns(analysis)
    if kind == ".json":
        record = {
            "summary": summary(analysis),
            "columns": {k: _json(v) for k, v in table.items()},
        }
        return atomic_write(target, json.dumps(record, allow_nan=False) + "\n")
    rows = np.stack(list(table.values()), axis=1)
    line = ",".join(["%.16g", *["%.9g"] * (len(table) - 1)])
    parts = [",".join(table)]
    for start in range(0, len(rows), _CHUNK):
        parts += [line % tuple(row) for row in rows[start : start + _CHUNK].tolist()]
        if progress:
            progress("write", min(start + _CHUNK, len(rows)) / len(rows))
    return atomic_write(target, "\n".join(parts) + "\n")


def _json(column: FloatArray) -> list[float | None]:
    numbers = column.astype(object)
    numbers[~np.isfinite(column)] = None
    return list(numbers)
