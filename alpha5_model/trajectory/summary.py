"""Key figures of an analysed motion, as a plain record and as text."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.parameters import JointParameters, parameters
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.motion import LIMIT_SLACK
from alpha5_model.trajectory.smoothing import REST_SHARE

CAUSES = ("inertia", "coriolis", "weight", "buoyancy", "friction")
#: Figures of a joint that are None without a motor's constants, or without limits of its drive.
_BY_MOTOR = ("current_peak", "current_rms", "voltage_peak", "power_peak", "energy_drawn_j")
_BY_DRIVE = ("current_margin", "voltage_margin", "drive_torque_margin", "beyond_drive_limits")


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
    power_ends = [  # over the printed tolerance of friction
        np.stack([m.voltage(i[:, k], velocity[:, k]) * i[:, k] for k, m in known])
        for i in (a.current_lower, a.current_upper)
    ]
    power_interval = [end(*power_ends).sum(axis=0) for end in (np.minimum, np.maximum)]
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
            "drawn_j": _integral(np.maximum(power, 0.0), s.time),
            "drawn_interval_j": [_integral(np.maximum(p, 0.0), s.time) for p in power_interval],
            "fed_back_j": _integral(np.maximum(-power, 0.0), s.time),
            "mechanical_j": _integral(a.mechanical_power.sum(axis=1), s.time),
            "contradiction_j": _integral(np.asarray(contradiction), s.time),
        },
        "mount": {
            "force_peak_n": _peak(np.linalg.norm(a.base_wrench[:, :3], axis=1), s.time),
            "moment_peak_nm": _peak(np.linalg.norm(a.base_wrench[:, 3:], axis=1), s.time),
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


def _joint(a: Analysis, k: int, joint: JointParameters) -> dict[str, Any]:
    s = a.smooth
    q = a.motion.position[:, k]
    margin = float(min(q.min() - joint.lower, joint.upper - q.max()))
    if -LIMIT_SLACK * (joint.upper - joint.lower) <= margin < 0:
        margin = 0.0  # at the limit, as the warnings have it
    speed = np.abs(s.velocity[:, k])
    out: dict[str, Any] = {
        "units": dict(zip(("position", "velocity", "torque"), _units(joint.name), strict=True)),
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
        "causes_peak": {
            cause: _finite(float(np.abs(getattr(a, cause)[:, k]).max())) for cause in CAUSES
        },
        **dict.fromkeys(_BY_MOTOR + _BY_DRIVE),
    }
    if not np.isfinite(a.current[:, k]).all():
        return out
    at = int(np.abs(a.current[:, k]).argmax())
    interval = [float(a.current_lower[at, k]), float(a.current_upper[at, k])]
    out["current_peak"] = {**_peak(a.current[:, k], s.time), "interval": interval}
    out["current_rms"] = _rms(a.current[:, k], s.time)
    out["voltage_peak"] = _peak(a.voltage[:, k], s.time)
    out["power_peak"] = _peak(a.electrical_power[:, k], s.time)
    out["energy_drawn_j"] = _integral(np.maximum(a.electrical_power[:, k], 0.0), s.time)
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


_FORCE = {"N m": "torque", "N": "force"}


def _units(joint: str) -> tuple[str, str, str]:
    """Of position, velocity and torque."""
    return ("m", "m/s", "N") if joint == "axis_a" else ("rad", "rad/s", "N m")


def text(record: dict[str, Any]) -> str:
    """The record of `summary` as lines for a terminal."""
    model, smoothing = record["model"], record["smoothing"]
    width = smoothing["bandwidth_hz"]
    gravity = ", ".join(f"{g:g}" for g in model["gravity"])
    unit = record["time_unit_of_file"]
    lines = [
        f"{record['source']}: {record['samples']} samples, {record['duration_s']:.2f} s"
        + ("" if unit == "s" else f" (time column in {unit})"),
        f"  model: {model['gripper']} gripper, fluid {model['fluid_density']:g} kg/m^3, "
        f"gravity ({gravity}) m/s^2",
        f"  smoothing: {smoothing['method']}"
        + (f", {width:.3g} Hz (-3 dB)" if width is not None else "")
        + f"; derivatives from {smoothing['derivatives_from']}",
    ]
    groups: dict[tuple[str, ...], dict[str, Any]] = {}
    for name, j in record["joints"].items():
        groups.setdefault(tuple(j["units"].values()), {})[name] = j
    for units, joints in groups.items():
        lines += _joint_lines(joints, *units)
    for units, joints in groups.items():
        title = f"  peak {_FORCE[units[2]]} by cause [{units[2]}]"
        lines += ["", f"{title:28}" + "".join(f"{c:>11}" for c in CAUSES)]
        for name, j in joints.items():
            lines.append(f"  {name:26}" + "".join(_cause(j["causes_peak"][c]) for c in CAUSES))
    energy, mount, tcp = record["energy"], record["mount"], record["tcp"]
    least, most = energy["drawn_interval_j"]
    lines += [
        "",
        f"  power: peak {energy['electrical_peak_w']:.3g} W; drawn {energy['drawn_j']:.4g} J "
        f"({least:.4g} .. {most:.4g}), fed back {energy['fed_back_j']:.3g} J, mechanical work {energy['mechanical_j']:.3g} J",
        f"  mount: force up to {mount['force_peak_n']['value']:.4g} N, moment up to "
        f"{mount['moment_peak_nm']['value']:.4g} N m",
        f"  TCP: path {tcp['path_length_m']:.4g} m, from {_point(tcp['first_m'])} to "
        f"{_point(tcp['last_m'])} m, within {_point(tcp['lowest_m'])} .. {_point(tcp['highest_m'])} m",
    ]
    for name, j in record["joints"].items():
        if j["beyond_rated_velocity"]:
            peak = abs(j["velocity_peak"]["value"])
            lines.append(
                f"  limit: {name} is beyond its rated speed of {peak + j['velocity_margin']:.4g} "
                f"{j['units']['velocity']} in {j['beyond_rated_velocity']} samples, up to {peak:.4g}"
            )
        if j["beyond_drive_limits"]:
            lines.append(
                f"  limit: {name} is beyond the speed-torque limit in {j['beyond_drive_limits']} samples"
            )
    for w in record["warnings"]:
        lines.append(f"  warning: {w['text']}: {w['count']} x, first: {w['first']}")
    lines += [f"  note: {note}" for note in _notes(record)]
    return "\n".join(lines)


def _joint_lines(joints: dict[str, Any], position: str, velocity: str, torque: str) -> list[str]:
    """Peaks and margins of joints that share their units."""
    head = f"{_FORCE[torque]} [{torque}]"
    lines = [
        "",
        f"  joint  {head:>15}  margin   current [A], interval     margin {f'speed [{velocity}]':>14}  "
        f"margin {f'range margin [{position}]':>20}",
    ]
    for name, j in joints.items():
        current = "       (needs --screw-lead)   "
        if j["current_peak"] is not None:
            low, high = j["current_peak"]["interval"]
            current = f"{j['current_peak']['value']:+8.3f}  {low:+.3f} .. {high:+.3f}"
        lines.append(
            f"  {name:7} {j['torque_peak']['value']:+14.4g} {j['torque_margin']:7.4g} "
            f"  {current:26} {_or_dash(j['current_margin'])} "
            f"{j['velocity_peak']['value']:+14.4g} {j['velocity_margin']:+7.3g} "
            f"{j['position_margin']:+20.4g}"
        )
    return lines


def _notes(record: dict[str, Any]) -> list[str]:
    motors = record["motors"]
    ratios = ", ".join(f"{name} {r:.3f}" for name, r in motors["constants_ratio"].items())
    notes = [
        f"a joint slower than {REST_SHARE:.1%} of its rated speed counts as at rest: friction holds it and "
        "its motor needs the least current that keeps it there",
        "torque is what the joint must carry; friction, at the motor, is a cause of its own and in the current",
        "torque margins are to an effort of 9 N m (jaw rod 10 N) that every public model copies; "
        "no rating is published",
        f"Table 4's K_t and K_v contradict each other (K_t/K_v: {ratios}); used here: "
        f"{motors['constants']}"
        + (
            f", which leaves {record['energy']['contradiction_j']:+.3g} J of the electrical energy "
            "unexplained"
            if motors["constants"] == "printed"
            else ""
        ),
    ]
    if motors["supply_voltage"] is None:
        notes.append(
            "current margins need --supply-voltage and --current-limit; neither is published"
        )
    return notes


def _cause(value: float | None) -> str:
    if value is None:
        return f"{'-':>11}"
    return f"{0.0 if value < 1e-12 else value:11.4g}"  # rounding is no torque


def _point(position: list[float]) -> str:
    # Adding zero turns the -0.0 of rounding into 0.0.
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in position) + ")"


def _or_dash(value: float | None) -> str:
    return "      -" if value is None else f"{value:+7.3f}"


def _peak(values: FloatArray, time: FloatArray) -> dict[str, Any]:
    at = int(np.abs(values).argmax())
    return {"value": float(values[at]), "time_s": float(time[at])}


def _integral(values: FloatArray, time: FloatArray) -> float:
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(time)))


def _rms(values: FloatArray, time: FloatArray) -> float:
    return float(np.sqrt(_integral(values**2, time) / (time[-1] - time[0])))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
