"""An analysed motion as key figures and as a table over time."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.files import PathLike, atomic_write, output_format
from alpha5_model.parameters import JointParameters, parameters
from alpha5_model.trajectory.analysis import BY_MOTOR, Analysis
from alpha5_model.trajectory.motion import LIMIT_SLACK, Progress

#: Of the table: CSV, or JSON with the key figures on top.
FORMATS = (".csv", ".json")
#: Torques less than this are rounding.
ROUNDING = 1e-12
#: Rows written between two reports of progress.
_CHUNK = 10_000
#: Figures of a joint that are None without a motor's constants, or without limits of its drive.
_BY_MOTOR = ("current_peak", "current_rms", "voltage_peak", "power_peak", "energy_drawn_j")
_BY_DRIVE = ("current_margin", "voltage_margin", "drive_torque_margin", "beyond_drive_limits")
#: Units of a joint's figures.
TURNING = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
SLIDING = {"position": "m", "velocity": "m/s", "torque": "N"}


def summary(analysis: Analysis) -> dict[str, Any]:
    """Peaks, margins, energies and warnings, in types that JSON has.

    Units: s, A, V, W, J, N, m; a joint's position, velocity and torque are in its ``units``: rad,
    rad/s, N m, for the jaw rod ``axis_a`` m, m/s, N. A margin is what is left to a limit, negative
    beyond it. ``null`` where a motor cannot be computed, a limit is not given or no effort is
    recorded; an effort's differences are those of what was recorded less the torque computed.
    """
    a, s = analysis, analysis.smooth
    steps, velocity = np.diff(s.time), s.signed_velocity
    path = np.linalg.norm(np.diff(a.tcp, axis=0), axis=1)
    power = np.nansum(a.electrical_power, axis=1)
    known = [(k, m) for k, m in enumerate(a.actuators) if np.isfinite(a.current[:, k]).all()]
    powers = [  # over the printed tolerance of friction
        np.stack([m.voltage(i[:, k], velocity[:, k]) * i[:, k] for k, m in known])
        for i in (a.current_lower, a.current_upper)
    ]
    interval = [end(*powers).sum(axis=0) for end in (np.minimum, np.maximum)]
    contradiction = sum(
        (m.back_emf_constant - m.torque_constant) * m.ratio * a.current[:, k] * velocity[:, k]
        for k, m in known
    )
    time, arm = s.time, a.arm
    out: dict[str, Any] = {"source": a.motion.source, "samples": int(time.size)}
    out |= {"start_s": float(time[0]), "duration_s": float(time[-1] - time[0])}
    out["time_unit_of_file"] = a.motion.time_unit
    out["sample_time_s"] = {"median": float(np.median(steps)), "longest": float(steps.max())}
    model: dict[str, Any] = {"gripper": "jaws" if "axis_a" in s.joints else "locked"}
    model |= {"fluid_density": arm.fluid_density, "gravity": arm.model.gravity.linear.tolist()}
    if a.moving_water is not None:
        model["water_current"] = a.moving_water.current.tolist()
    out["model"] = model
    derivatives = {"derivatives_from": "velocities" if s.from_velocity else "positions"}
    out["smoothing"] = {"method": s.method, "bandwidth_hz": s.bandwidth, **derivatives}
    drive = {"supply_voltage": a.supply_voltage, "current_limit": a.current_limit}
    ratios = {m.joint: m.constants_ratio for m in a.actuators}
    out["motors"] = {"constants": a.actuators[0].constants, "constants_ratio": ratios, **drive}
    joints = parameters().joints[: len(s.joints)]
    out["joints"] = {joint.name: _joint(a, k, joint) for k, joint in enumerate(joints)}
    out["energy"] = {
        "electrical_peak_w": float(power.max()),
        "drawn_j": _drawn(power, time),
        "drawn_interval_j": [_drawn(end, time) for end in interval],
        "fed_back_j": _drawn(-power, time),
        "mechanical_j": _integral(a.mechanical_power.sum(axis=1), time),
        "contradiction_j": _integral(np.asarray(contradiction), time),
    }
    sizes = np.linalg.norm(a.base_wrench.reshape(-1, 2, 3), axis=2)
    out["mount"] = {"force_peak_n": _peak(sizes[:, 0], time)}
    out["mount"] |= {"moment_peak_nm": _peak(sizes[:, 1], time), **_water_on_mount(a)}
    ends = {"first_m": a.tcp[0], "last_m": a.tcp[-1]}
    ends |= {"lowest_m": a.tcp.min(axis=0), "highest_m": a.tcp.max(axis=0)}
    out["tcp"] = {name: point.tolist() for name, point in ends.items()}
    out["tcp"]["path_length_m"] = float(path.sum())
    out["warnings"] = [asdict(w) for w in a.warnings]
    return {**out, "ignored_columns": list(a.motion.ignored)}


def _water_on_mount(a: Analysis) -> dict[str, Any]:
    """Peaks of what moving water adds to the load on the mount."""
    if a.moving_water is None:
        return {}
    sizes = np.linalg.norm(a.moving_water.wrench.reshape(-1, 3, 2, 3), axis=3)
    force, moment = (_water_peak(sizes[..., i], a.smooth.time) for i in (0, 1))
    return {"water_force_peak_n": force, "water_moment_peak_nm": moment}


def _water_peak(levels: FloatArray, time: FloatArray) -> dict[str, Any]:
    """The largest nominal value, and its interval from all numbers low to all high; levels are (N, 3)."""
    nominal, at = levels[:, 1], int(np.abs(levels[:, 1]).argmax())
    interval = [float(levels[at].min()), float(levels[at].max())]
    return {**_peak(nominal, time), "interval": interval}


def _joint(a: Analysis, k: int, joint: JointParameters) -> dict[str, Any]:
    s = a.smooth
    q = a.motion.position[:, k]
    margin = float(min(q.min() - joint.lower, joint.upper - q.max()))
    if -LIMIT_SLACK * (joint.upper - joint.lower) <= margin < 0:
        margin = 0.0  # at the limit, as the warnings have it
    speed = np.abs(s.velocity[:, k])
    out: dict[str, Any] = {"units": dict(SLIDING if joint.name == "axis_a" else TURNING)}
    out |= {"position_range": [float(q.min()), float(q.max())], "position_margin": margin}
    out["velocity_margin"] = float(joint.velocity - speed.max())
    out["beyond_rated_velocity"] = int(np.count_nonzero(speed > joint.velocity))
    over_time = {"velocity": s.velocity, "acceleration": s.acceleration, "torque": a.torque}
    out |= {f"{name}_peak": _peak(table[:, k], s.time) for name, table in over_time.items()}
    out["smoothing_deviation"] = float(s.deviation[k])
    out["torque_rms"] = _rms(a.torque[:, k], s.time)
    # Against the effort that every public model copies; no rating is published.
    out["torque_margin"] = float(joint.effort - np.abs(a.torque[:, k]).max())
    out["causes_peak"] = {c: _finite(np.abs(x[:, k]).max()) for c, x in a.causes().items()}
    out |= {"effort": _effort(a, k), **dict.fromkeys(_BY_MOTOR + _BY_DRIVE)}
    if a.moving_water is not None:
        out["moving_water_peak"] = _water_peak(a.moving_water.torque[:, :, k], s.time)
    if not np.isfinite(a.current[:, k]).all():
        return out
    over_time = {"current": a.current, "voltage": a.voltage, "power": a.electrical_power}
    out |= {f"{name}_peak": _peak(table[:, k], s.time) for name, table in over_time.items()}
    at = int(np.abs(a.current[:, k]).argmax())
    out["current_peak"]["interval"] = [float(a.current_lower[at, k]), float(a.current_upper[at, k])]
    out["current_rms"] = _rms(a.current[:, k], s.time)
    out["energy_drawn_j"] = _drawn(a.electrical_power[:, k], s.time)
    if a.torque_limits and a.current_limit and a.supply_voltage:
        worst = np.maximum(np.abs(a.current_lower[:, k]), np.abs(a.current_upper[:, k])).max()
        out["current_margin"] = float(a.current_limit - worst)
        out["voltage_margin"] = float(a.supply_voltage - np.abs(a.voltage[:, k]).max())
        lower, upper = (end[:, k] for end in a.torque_limits)
        reserve = np.minimum(upper - a.torque[:, k], a.torque[:, k] - lower)
        possible = reserve[np.isfinite(reserve)]
        out["drive_torque_margin"] = float(possible.min()) if possible.size else None
        out["beyond_drive_limits"] = int(np.count_nonzero(~(reserve >= 0)))
    return out


def _effort(a: Analysis, k: int) -> dict[str, Any] | None:
    """Recorded effort of a joint against the torque computed, over the samples that have one."""
    if a.motion.effort is None or not (there := np.isfinite(a.motion.effort[:, k])).any():
        return None
    effort, time = a.motion.effort[there, k], a.smooth.time[there]
    torque, friction = a.torque[there, k], a.friction[there, k]
    difference = effort - torque
    varied = min(np.ptp(effort), np.ptp(torque)) > ROUNDING
    left = _finite(np.sqrt(np.mean((difference - friction) ** 2)))
    out = {"samples": int(effort.size), "peak": _peak(effort, time)}
    out |= {"rms": float(np.sqrt(np.mean(effort**2))), "difference_mean": float(difference.mean())}
    out["difference_rms"] = float(np.sqrt(np.mean(difference**2)))
    out |= {"difference_peak": _peak(difference, time), "difference_rms_with_friction": left}
    correlation = float(np.corrcoef(effort, torque)[0, 1]) if varied else None
    return {**out, "correlation": correlation}


def _peak(values: FloatArray, time: FloatArray) -> dict[str, Any]:
    at = int(np.abs(values).argmax())
    return {"value": float(values[at]), "time_s": float(time[at])}


def _integral(values: FloatArray, time: FloatArray) -> float:
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(time)))


def _drawn(power: FloatArray, time: FloatArray) -> float:
    """Energy of the positive part."""
    return _integral(np.maximum(power, 0.0), time)


def _rms(values: FloatArray, time: FloatArray) -> float:
    return float(np.sqrt(_integral(values**2, time) / (time[-1] - time[0])))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def columns(analysis: Analysis) -> dict[str, FloatArray]:
    """Every quantity over time by column name, SI units, without motors that cannot be computed.

    ``time_secs``; for each joint ``axis_e_pos, axis_e_vel, axis_e_acc`` (smoothed),
    ``axis_e_torque`` and its causes, ``axis_e_effort`` as recorded, currents, voltage, powers and, with limits,
    ``axis_e_torque_min``, ``_max``, in a current ``axis_e_torque_moving_water_low``, ``_high``;
    ``base_force_x .. base_moment_z`` on the mount; ``tcp_x .. tcp_z``. The file can be read again
    by `read_motion`.
    """
    a, s = analysis, analysis.smooth
    by_joint = {"pos": s.position, "vel": s.velocity, "acc": s.acceleration, "torque": a.torque}
    by_joint |= {f"torque_{cause}": torque for cause, torque in a.causes().items()}
    if a.motion.effort is not None:
        by_joint["effort"] = a.motion.effort
    if (water := a.moving_water) is not None:
        low, _, high = water.torque.swapaxes(0, 1)
        by_joint |= {"torque_moving_water_low": low, "torque_moving_water_high": high}
    by_joint |= {name: getattr(a, name) for name in (*BY_MOTOR[1:], "mechanical_power")}
    if a.torque_limits is not None:
        by_joint |= {"torque_min": a.torque_limits.lower, "torque_max": a.torque_limits.upper}
    out = {"time_secs": s.time}
    for k, joint in enumerate(s.joints):
        out |= {f"{joint}_{name}": table[:, k] for name, table in by_joint.items()}
    for k, axis in enumerate("xyz"):
        out[f"base_force_{axis}"] = a.base_wrench[:, k]
        out[f"base_moment_{axis}"] = a.base_wrench[:, 3 + k]
        out[f"tcp_{axis}"] = a.tcp[:, k]
    return {name: column for name, column in out.items() if not np.isnan(column).all()}


def write(analysis: Analysis, path: PathLike, progress: Progress | None = None) -> Path:
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
        record = {"summary": summary(analysis), "columns": {k: _json(v) for k, v in table.items()}}
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
