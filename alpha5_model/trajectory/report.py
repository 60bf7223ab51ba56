"""An analysed motion as key figures, as text, and as a table over time."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.files import PathLike, atomic_write, output_format
from alpha5_model.parameters import JointParameters, parameters
from alpha5_model.trajectory.analysis import BY_MOTOR, Analysis
from alpha5_model.trajectory.motion import LIMIT_SLACK
from alpha5_model.trajectory.reading import Progress
from alpha5_model.trajectory.smoothing import REST_SHARE

#: Of the table: CSV, or JSON with the key figures on top.
FORMATS = (".csv", ".json")
#: Rows written between two reports of progress.
_CHUNK = 10_000
#: Figures of a joint that are None without a motor's constants, or without limits of its drive.
_BY_MOTOR = ("current_peak", "current_rms", "voltage_peak", "power_peak", "energy_drawn_j")
_BY_DRIVE = ("current_margin", "voltage_margin", "drive_torque_margin", "beyond_drive_limits")
_TURNING = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
_SLIDING = {"position": "m", "velocity": "m/s", "torque": "N"}


def summary(analysis: Analysis) -> dict[str, Any]:
    """Peaks, margins, energies and warnings, in types that JSON has.

    Units: s, A, V, W, J, N, m; a joint's position, velocity and torque are in its ``units``: rad,
    rad/s, N m, for the jaw rod ``axis_a`` m, m/s, N. A margin is what is left to a limit, negative
    beyond it. ``null`` where a motor cannot be computed or a limit is not given.
    """
    a, s = analysis, analysis.smooth
    steps, velocity = np.diff(s.time), s.signed_velocity
    path = np.linalg.norm(np.diff(a.tcp, axis=0), axis=1)
    power = np.nansum(a.electrical_power, axis=1)
    known = [(k, m) for k, m in enumerate(a.actuators) if np.isfinite(a.current[:, k]).all()]
    ends = [  # of the power, over the printed tolerance of friction
        np.stack([m.voltage(i[:, k], velocity[:, k]) * i[:, k] for k, m in known])
        for i in (a.current_lower, a.current_upper)
    ]
    interval = [end(*ends).sum(axis=0) for end in (np.minimum, np.maximum)]
    contradiction = sum(
        (m.back_emf_constant - m.torque_constant) * m.ratio * a.current[:, k] * velocity[:, k]
        for k, m in known
    )
    joints = parameters().joints[: len(s.joints)]
    return {
        "source": a.motion.source,
        "samples": int(s.time.size),
        "start_s": float(s.time[0]),
        "duration_s": float(s.time[-1] - s.time[0]),
        "time_unit_of_file": a.motion.time_unit,
        "sample_time_s": {"median": float(np.median(steps)), "longest": float(steps.max())},
        "model": {
            "gripper": "jaws" if "axis_a" in s.joints else "locked",
            "fluid_density": a.arm.fluid_density,
            "gravity": a.arm.model.gravity.linear.tolist(),
            **(
                {} if a.moving_water is None else {"water_current": a.moving_water.current.tolist()}
            ),
        },
        "smoothing": {
            "method": s.method,
            "bandwidth_hz": s.bandwidth,
            "derivatives_from": "velocities" if s.from_velocity else "positions",
        },
        "motors": {
            "constants": a.actuators[0].constants,
            "constants_ratio": {m.joint: m.constants_ratio for m in a.actuators},
            "supply_voltage": a.supply_voltage,
            "current_limit": a.current_limit,
        },
        "joints": {joint.name: _joint(a, k, joint) for k, joint in enumerate(joints)},
        "energy": {
            "electrical_peak_w": float(power.max()),
            "drawn_j": _drawn(power, s.time),
            "drawn_interval_j": [_drawn(end, s.time) for end in interval],
            "fed_back_j": _drawn(-power, s.time),
            "mechanical_j": _integral(a.mechanical_power.sum(axis=1), s.time),
            "contradiction_j": _integral(np.asarray(contradiction), s.time),
        },
        "mount": {
            "force_peak_n": _peak(np.linalg.norm(a.base_wrench[:, :3], axis=1), s.time),
            "moment_peak_nm": _peak(np.linalg.norm(a.base_wrench[:, 3:], axis=1), s.time),
            **_water_on_mount(a),
        },
        "tcp": {
            "first_m": a.tcp[0].tolist(),
            "last_m": a.tcp[-1].tolist(),
            "lowest_m": a.tcp.min(axis=0).tolist(),
            "highest_m": a.tcp.max(axis=0).tolist(),
            "path_length_m": float(path.sum()),
        },
        "warnings": [asdict(w) for w in a.warnings],
        "ignored_columns": list(a.motion.ignored),
    }


def _water_on_mount(a: Analysis) -> dict[str, Any]:
    """Peaks of what moving water adds to the load on the mount."""
    if a.moving_water is None:
        return {}
    sizes = np.linalg.norm(a.moving_water.wrench.reshape(-1, 3, 2, 3), axis=3)
    force, moment = (_water_peak(sizes[..., i], a.smooth.time) for i in (0, 1))
    return {"water_force_peak_n": force, "water_moment_peak_nm": moment}


def _water_peak(levels: FloatArray, time: FloatArray) -> dict[str, Any]:
    """The largest nominal value, and its interval from all numbers low to all high; levels are (N, 3)."""
    at = int(np.abs(levels[:, 1]).argmax())
    return {
        **_peak(levels[:, 1], time),
        "interval": [float(levels[at].min()), float(levels[at].max())],
    }


def _joint(a: Analysis, k: int, joint: JointParameters) -> dict[str, Any]:
    s = a.smooth
    q = a.motion.position[:, k]
    margin = float(min(q.min() - joint.lower, joint.upper - q.max()))
    if -LIMIT_SLACK * (joint.upper - joint.lower) <= margin < 0:
        margin = 0.0  # at the limit, as the warnings have it
    speed = np.abs(s.velocity[:, k])
    out: dict[str, Any] = {
        "units": dict(_SLIDING if joint.name == "axis_a" else _TURNING),
        "position_range": [float(q.min()), float(q.max())],
        "position_margin": margin,
        "velocity_peak": _peak(s.velocity[:, k], s.time),
        "velocity_margin": float(joint.velocity - speed.max()),
        "beyond_rated_velocity": int(np.count_nonzero(speed > joint.velocity)),
        "acceleration_peak": _peak(s.acceleration[:, k], s.time),
        "smoothing_deviation": float(s.deviation[k]),
        "torque_peak": _peak(a.torque[:, k], s.time),
        "torque_rms": _rms(a.torque[:, k], s.time),
        # Against the effort that every public model copies; no rating is published.
        "torque_margin": float(joint.effort - np.abs(a.torque[:, k]).max()),
        "causes_peak": {c: _finite(np.abs(x[:, k]).max()) for c, x in a.causes().items()},
        **dict.fromkeys(_BY_MOTOR + _BY_DRIVE),
    }
    if a.moving_water is not None:
        out["moving_water_peak"] = _water_peak(a.moving_water.torque[:, :, k], s.time)
    if not np.isfinite(a.current[:, k]).all():
        return out
    at = int(np.abs(a.current[:, k]).argmax())
    interval = [float(a.current_lower[at, k]), float(a.current_upper[at, k])]
    out["current_peak"] = {**_peak(a.current[:, k], s.time), "interval": interval}
    out["current_rms"] = _rms(a.current[:, k], s.time)
    out["voltage_peak"] = _peak(a.voltage[:, k], s.time)
    out["power_peak"] = _peak(a.electrical_power[:, k], s.time)
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


def text(record: dict[str, Any]) -> str:
    """The record of `summary` as lines for a terminal."""
    return "\n".join([*_lines(record), *(f"  note: {note}" for note in _notes(record))])


def _lines(record: dict[str, Any]) -> Iterator[str]:
    model, smoothing = record["model"], record["smoothing"]
    width, unit = smoothing["bandwidth_hz"], record["time_unit_of_file"]
    column = "" if unit == "s" else f" (time column in {unit})"
    yield f"{record['source']}: {record['samples']} samples, {record['duration_s']:.2f} s{column}"
    gravity = ", ".join(f"{g:g}" for g in model["gravity"])
    fluid = f"fluid {model['fluid_density']:g} kg/m^3"
    yield f"  model: {model['gripper']} gripper, {fluid}, gravity ({gravity}) m/s^2"
    method = smoothing["method"] + ("" if width is None else f", {width:.3g} Hz (-3 dB)")
    yield f"  smoothing: {method}; derivatives from {smoothing['derivatives_from']}"
    groups = [
        (kind, units, {name: j for name, j in record["joints"].items() if j["units"] == units})
        for kind, units in (("torque", _TURNING), ("force", _SLIDING))
    ]
    for kind, units, joints in groups:
        if joints:
            yield from _peaks(joints, kind, units)
    for kind, units, joints in groups:
        if joints:
            title = f"  peak {kind} by cause [{units['torque']}]"
            heads = (
                f"{cause.removeprefix('moving_'):>11}"
                for cause in next(iter(joints.values()))["causes_peak"]
            )
            yield f"\n{title:28}" + "".join(heads)
        for name, j in joints.items():
            yield f"  {name:26}" + "".join(map(_cell, j["causes_peak"].values()))
    if water := model.get("water_current"):
        yield from _water(record, water)
    energy, mount, tcp = record["energy"], record["mount"], record["tcp"]
    least, most = energy["drawn_interval_j"]
    drawn = f"drawn {energy['drawn_j']:.4g} J ({least:.4g} .. {most:.4g})"
    other = f"fed back {energy['fed_back_j']:.3g} J, mechanical work {energy['mechanical_j']:.3g} J"
    yield f"\n  power: peak {energy['electrical_peak_w']:.3g} W; {drawn}, {other}"
    force, moment = (mount[key]["value"] for key in ("force_peak_n", "moment_peak_nm"))
    yield f"  mount: force up to {force:.4g} N, moment up to {moment:.4g} N m"
    ends = ("first_m", "last_m", "lowest_m", "highest_m")
    first, last, least, most = (_point(tcp[end]) for end in ends)
    length = f"path {tcp['path_length_m']:.4g} m"
    yield f"  TCP: {length}, from {first} to {last} m, within {least} .. {most} m"
    for name, j in record["joints"].items():
        if fast := j["beyond_rated_velocity"]:
            peak, unit = abs(j["velocity_peak"]["value"]), j["units"]["velocity"]
            limit = f"its rated speed of {peak + j['velocity_margin']:.4g} {unit}"
            yield f"  limit: {name} is beyond {limit} in {fast} samples, up to {peak:.4g}"
        if weak := j["beyond_drive_limits"]:
            yield f"  limit: {name} is beyond the speed-torque limit in {weak} samples"
    for w in record["warnings"]:
        yield f"  warning: {w['text']}: {w['count']} x, first: {w['first']}"


def _water(record: dict[str, Any], current: list[float]) -> Iterator[str]:
    """Peaks of what moving water adds, with the interval of its numbers."""
    speed = ", ".join(f"{x:g}" for x in current)
    yield f"\n  water: current ({speed}) m/s; estimated, not published; peak, and with all numbers low .. high"
    found = {
        name: (j["moving_water_peak"], j["units"]["torque"]) for name, j in record["joints"].items()
    }
    mount = record["mount"]
    found["mount"] = mount["water_force_peak_n"], "N"
    found[""] = mount["water_moment_peak_nm"], "N m"
    for name, (peak, unit) in found.items():
        low, high = peak["interval"]
        yield f"  {name:7} {peak['value']:+14.4g} {low:+14.4g} .. {high:+.4g} {unit}"


def _peaks(joints: dict[str, Any], kind: str, units: dict[str, str]) -> Iterator[str]:
    """Peaks and margins of joints that share their units."""
    force, speed = f"{kind} [{units['torque']}]", f"speed [{units['velocity']}]"
    head = f"\n  joint  {force:>15}  margin   current [A], interval     margin {speed:>14}  margin "
    yield head + f"range margin [{units['position']}]".rjust(20)
    for name, j in joints.items():
        current = "       (needs --screw-lead)   "
        if peak := j["current_peak"]:
            low, high = peak["interval"]
            current = f"{peak['value']:+8.3f}  {low:+.3f} .. {high:+.3f}"
        left = "      -" if j["current_margin"] is None else f"{j['current_margin']:+7.3f}"
        yield (
            f"  {name:7} {j['torque_peak']['value']:+14.4g} {j['torque_margin']:7.4g} "
            f"  {current:26} {left} {j['velocity_peak']['value']:+14.4g} "
            f"{j['velocity_margin']:+7.3g} {j['position_margin']:+20.4g}"
        )


def _notes(record: dict[str, Any]) -> Iterator[str]:
    motors, left = record["motors"], record["energy"]["contradiction_j"]
    yield (
        f"a joint slower than {REST_SHARE:.1%} of its rated speed counts as at rest: friction holds it and "
        "its motor needs the least current that keeps it there"
    )
    yield "torque is what the joint must carry; friction, at the motor, is a cause of its own and in the current"
    yield "torque margins are to an effort of 9 N m (jaw rod 10 N) that every public model copies; no rating is published"
    ratios = ", ".join(f"{name} {r:.3f}" for name, r in motors["constants_ratio"].items())
    used = motors["constants"]
    if used == "printed":
        used += f", which leaves {left:+.3g} J of the electrical energy unexplained"
    yield f"Table 4's K_t and K_v contradict each other (K_t/K_v: {ratios}); used here: {used}"
    if motors["supply_voltage"] is None:
        yield "current margins need --supply-voltage and --current-limit; neither is published"


def _cell(value: float | None) -> str:
    # Less than 1e-12 is rounding, no torque.
    return f"{'-':>11}" if value is None else f"{0.0 if value < 1e-12 else value:11.4g}"


def _point(position: list[float]) -> str:
    # Adding zero turns the -0.0 of rounding into 0.0.
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in position) + ")"


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
    ``axis_e_torque`` and its causes, currents, voltage, powers and, with limits,
    ``axis_e_torque_min``, ``_max``, in a current ``axis_e_torque_moving_water_low``, ``_high``;
    ``base_force_x .. base_moment_z`` on the mount; ``tcp_x .. tcp_z``. The file can be read again
    by `read_motion`.
    """
    a, s = analysis, analysis.smooth
    by_joint = {"pos": s.position, "vel": s.velocity, "acc": s.acceleration, "torque": a.torque}
    by_joint |= {f"torque_{cause}": torque for cause, torque in a.causes().items()}
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
