"""The key figures of an analysed motion: peaks, margins, energies, warnings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.text import plain
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, is_catalogue
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.checks import LIMIT_SLACK
from alpha5_model.trajectory.smoothing import SmoothMotion

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Torques and speeds less than this are rounding, SI units.
ROUNDING = 1e-12
#: Units of a joint's figures.
TURNING = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
SLIDING = {"position": "m", "velocity": "m/s", "torque": "N"}


def summary(analysis: Analysis) -> dict[str, Any]:
    """Peaks, margins, energies and warnings, in types that JSON has.

    Units: s, A, V, W, J, N, m; a joint's position, velocity and torque are in its
    ``units``: rad, rad/s, N m, for the jaw rod ``axis_a`` m, m/s, N. A margin is what
    is left to a limit, negative beyond it. ``null`` if a motor cannot be computed, a
    limit is not given or no effort or current is recorded. Their differences are those
    of what was recorded less what was computed.
    """
    a = analysis
    time = a.smooth.time
    steps = np.diff(time)
    ranges = _ranges(a.arm)
    figures = {
        "source": a.motion.source,
        "samples": time.size,
        "start_s": time[0],
        "duration_s": time[-1] - time[0],
        "time_unit_of_file": a.motion.time_unit,
        "sample_time_s": {"median": np.median(steps), "longest": steps.max()},
        "model": _model(a),
        "smoothing": _smoothing(a.smooth),
        "motors": _motors(a),
        "joints": {joint.name: _joint(a, k, joint) for k, joint in enumerate(ranges)},
        "energy": _energy(a),
        "mount": _mount(a),
        "tcp": _tcp_path(a.tcp),
        "warnings": a.warnings,
        "ignored_columns": a.motion.ignored,
    }
    # JSON refuses NaN: what may be missing is None instead.
    record: dict[str, Any] = plain(figures, unknown=math.nan)
    return record


def _ranges(arm: Arm) -> list[JointRange]:
    """The limits of the arm's joints, which may differ from the catalogue's."""
    limits = arm.limits
    return [
        JointRange(
            name=name,
            lower=float(limits.lower[k]),
            upper=float(limits.upper[k]),
            velocity=float(limits.velocity[k]),
            effort=float(limits.effort[k]),
        )
        for k, name in enumerate(arm.joint_names)
    ]


def _model(a: Analysis) -> dict[str, Any]:
    """The arm and the water around it."""
    model: dict[str, Any] = {
        **_own_arm(a.arm.parameters),
        "gripper": "jaws" if "axis_a" in a.smooth.joints else "locked",
        "fluid_density": a.arm.fluid_density,
        "payload_kg": _payload(a.arm),
        "gravity": a.arm.model.gravity.linear,
    }
    if a.moving_water is not None:
        model["water_current"] = a.moving_water.current
    return model


def _payload(arm: Arm) -> float:
    """Mass of all bodies that the arm holds [kg]."""
    frames = arm.model.frames
    return float(sum(f.inertia.mass for f in frames if f.name.startswith("payload")))


def _own_arm(record: Alpha5Parameters) -> dict[str, Any]:
    """Name of an arm of one's own; nothing for the catalogue's."""
    return {} if is_catalogue(record) else {"arm": record.name}


def _smoothing(motion: SmoothMotion) -> dict[str, Any]:
    """How the derivatives were found."""
    return {
        "method": motion.method,
        "bandwidth_hz": motion.bandwidth,
        "derivatives_from": "velocities" if motion.from_velocity else "positions",
    }


def _motors(a: Analysis) -> dict[str, Any]:
    """The assumptions about the motors and their drive."""
    motors: dict[str, Any] = {
        "constants": a.actuators[0].constants,
        "constants_ratio": {m.joint: m.constants_ratio for m in a.actuators},
        "efficiency": a.actuators[0].efficiency,
        "supply_voltage": a.supply_voltage,
        "current_limit": a.current_limit,
    }
    if not is_catalogue(a.arm.parameters):
        # Limits that are not complete, and so have no margins, are named, too.
        own = a.arm.parameters.motors
        limits = a.current_limits or own.current_limits
        motors["supply_voltage"] = a.supply_voltage or own.supply_voltage
        motors["current_limits"] = dict(zip(a.smooth.joints, limits, strict=False))
        motors["rotor_inertias"] = {m.joint: m.rotor_inertia for m in a.actuators}
    return motors


def _energy(a: Analysis) -> dict[str, Any]:
    """Power and energy of all motors together."""
    time = a.smooth.time
    power = np.nansum(a.electrical_power, axis=1)
    return {
        "electrical_peak_w": power.max(),
        "drawn_j": _drawn(power, time),
        "drawn_interval_j": _drawn_interval(a),
        "fed_back_j": _drawn(-power, time),
        "mechanical_j": _integral(a.mechanical_power.sum(axis=1), time),
        "contradiction_j": _integral(_contradicting_power(a), time),
    }


def _known_motors(a: Analysis) -> list[int]:
    """The joints whose motors can be computed."""
    joints = range(len(a.actuators))
    return [k for k in joints if np.isfinite(a.current[:, k]).all()]


def _drawn_interval(a: Analysis) -> list[float | None]:
    """The energy drawn over the printed tolerance of friction: least and most [J]."""
    at_lower = _powers(a, a.current_lower)
    at_upper = _powers(a, a.current_upper)
    least = np.minimum(at_lower, at_upper).sum(axis=0)
    most = np.maximum(at_lower, at_upper).sum(axis=0)
    return [_drawn(least, a.smooth.time), _drawn(most, a.smooth.time)]


def _powers(a: Analysis, current: FloatArray) -> FloatArray:
    """The electrical power of each known motor for some currents, (motors, N) [W]."""
    velocity = a.smooth.signed_velocity
    powers = []
    for k in _known_motors(a):
        voltage = a.actuators[k].voltage(current[:, k], velocity[:, k])
        powers.append(voltage * current[:, k])
    return np.stack(powers)


def _contradicting_power(a: Analysis) -> FloatArray:
    """Electrical power that the contradicting motor constants leave unexplained [W]."""
    velocity = a.smooth.signed_velocity
    powers = []
    for k in _known_motors(a):
        motor = a.actuators[k]
        excess = (motor.back_emf_constant - motor.torque_constant) * motor.ratio
        powers.append(excess * a.current[:, k] * velocity[:, k])
    return np.asarray(sum(powers))


def _mount(a: Analysis) -> dict[str, Any]:
    """Peaks of the load on the mount, and of what moving water adds to it."""
    time = a.smooth.time
    force, moment = _force_and_moment(a.base_wrench)
    mount = {
        "force_peak_n": _peak(force, time),
        "moment_peak_nm": _peak(moment, time),
    }
    if a.moving_water is not None:
        water_force, water_moment = _force_and_moment(a.moving_water.wrench)
        mount["water_force_peak_n"] = _water_peak(water_force, time)
        mount["water_moment_peak_nm"] = _water_peak(water_moment, time)
    return mount


def _force_and_moment(wrenches: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The size of force and of moment of wrenches, (..., 6)."""
    force = np.linalg.norm(wrenches[..., :3], axis=-1)
    moment = np.linalg.norm(wrenches[..., 3:], axis=-1)
    return force, moment


def _tcp_path(tcp: FloatArray) -> dict[str, Any]:
    """Ends, bounds and length of the TCP's path."""
    return {
        "first_m": tcp[0],
        "last_m": tcp[-1],
        "lowest_m": tcp.min(axis=0),
        "highest_m": tcp.max(axis=0),
        "path_length_m": np.linalg.norm(np.diff(tcp, axis=0), axis=1).sum(),
    }


def _joint(a: Analysis, k: int, joint: JointRange) -> dict[str, Any]:
    """The figures of joint k."""
    time = a.smooth.time
    velocity = a.smooth.velocity[:, k]
    torque = a.torque[:, k]
    left = joint.velocity - np.abs(velocity)
    left[np.abs(left) <= ROUNDING] = 0.0
    position = a.motion.position[:, k]
    figures = {
        "units": SLIDING if joint.name == "axis_a" else TURNING,
        "position_range": [position.min(), position.max()],
        "position_margin": _position_margin(position, joint),
        "velocity_margin": left.min(),
        "beyond_rated_velocity": np.count_nonzero(left < 0.0),
        "velocity_peak": _peak(velocity, time),
        "acceleration_peak": _peak(a.smooth.acceleration[:, k], time),
        "torque_peak": _peak(torque, time),
        "smoothing_deviation": a.smooth.deviation[k],
        "torque_rms": _rms(torque, time),
        # The catalogue's effort is what public models copy; no rating is published.
        "torque_margin": joint.effort - np.abs(torque).max(),
        "causes_peak": _causes_peak(a, k),
        "effort": _effort(a, k),
        "recorded_current": _recorded_current(a, k),
        **_motor(a, k),
        **_drive_margins(a, k),
    }
    if a.moving_water is not None:
        water = a.moving_water.torque[:, :, k]
        figures["moving_water_peak"] = _water_peak(water, time)
    return figures


def _position_margin(position: FloatArray, joint: JointRange) -> float:
    """The distance to the nearer end of a joint's range; 0 within a limit's slack."""
    margin = min(position.min() - joint.lower, joint.upper - position.max())
    slack = LIMIT_SLACK * (joint.upper - joint.lower)
    return 0.0 if -slack <= margin < 0 else margin


def _causes_peak(a: Analysis, k: int) -> dict[str, float | None]:
    """The largest torque of each cause at joint k."""
    causes = a.causes().items()
    return {name: _finite(np.abs(torque[:, k]).max()) for name, torque in causes}


def _motor(a: Analysis, k: int) -> dict[str, Any]:
    """Current, voltage and power of the motor of joint k."""
    time = a.smooth.time
    current = a.current[:, k]
    lower = a.current_lower[:, k]
    upper = a.current_upper[:, k]
    power = a.electrical_power[:, k]
    return {
        "current_peak": _peak(current, time, lower, upper),
        "current_rms": _rms(current, time),
        "voltage_peak": _peak(a.voltage[:, k], time),
        "power_peak": _peak(power, time),
        "energy_drawn_j": _drawn(power, time),
    }


def _drive_margins(a: Analysis, k: int) -> dict[str, Any]:
    """Margins to the drive's limits at joint k; None without limits or motor."""
    known = k in _known_motors(a)
    limit = a.current_limits[k] if a.current_limits else None
    if not (a.torque_limits and limit and a.supply_voltage and known):
        return {
            "current_margin": None,
            "voltage_margin": None,
            "drive_torque_margin": None,
            "beyond_drive_limits": None,
        }

    ends = [a.current_lower[:, k], a.current_upper[:, k]]
    torque = a.torque[:, k]
    to_upper = a.torque_limits.upper[:, k] - torque
    to_lower = torque - a.torque_limits.lower[:, k]
    reserve = np.minimum(to_upper, to_lower)
    possible = reserve[np.isfinite(reserve)]
    return {
        "current_margin": limit - np.abs(ends).max(),
        "voltage_margin": a.supply_voltage - np.abs(a.voltage[:, k]).max(),
        "drive_torque_margin": possible.min() if possible.size else None,
        "beyond_drive_limits": np.count_nonzero(~(reserve >= 0)),
    }


def _effort(a: Analysis, k: int) -> dict[str, Any] | None:
    """The recorded effort of joint k against the torque computed."""
    if a.effort is None:
        return None
    figures = _comparison(a.effort[:, k], a.torque[:, k], a.smooth.time)
    if figures is None:
        return None
    with_friction = a.torque[:, k] + a.friction[:, k]
    left = a.effort[:, k] - with_friction
    recorded = np.isfinite(a.effort[:, k])
    return {
        **figures,
        "difference_rms_with_friction": _plain_rms(left[recorded]),
    }


def _recorded_current(a: Analysis, k: int) -> dict[str, Any] | None:
    """The recorded current of the motor of joint k against the current computed."""
    if a.recorded_current is None or k not in _known_motors(a):
        return None
    return _comparison(a.recorded_current[:, k], a.current[:, k], a.smooth.time)


def _comparison(
    recorded: FloatArray, computed: FloatArray, time: FloatArray
) -> dict[str, Any] | None:
    """What was recorded against what was computed, (N,) each.

    Samples without a record are left out; None if there is no record at all.
    """
    known = np.isfinite(recorded)
    if not known.any():
        return None

    values = recorded[known]
    expected = computed[known]
    difference = values - expected
    varied = min(np.ptp(values), np.ptp(expected)) > ROUNDING
    return {
        "samples": values.size,
        "peak": _peak(values, time[known]),
        "rms": _plain_rms(values),
        "difference_mean": difference.mean(),
        "difference_rms": _plain_rms(difference),
        "difference_peak": _peak(difference, time[known]),
        "correlation": np.corrcoef(values, expected)[0, 1] if varied else None,
    }


def _peak(
    values: FloatArray, time: FloatArray, *ends: FloatArray
) -> dict[str, Any] | None:
    """The value of largest size, its time, and the interval between the ends there.

    None if the value is not finite: its motor cannot be computed.
    """
    at = int(np.abs(values).argmax())
    if not np.isfinite(values[at]):
        return None
    peak: dict[str, Any] = {"value": values[at], "time_s": time[at]}
    if ends:
        peak["interval"] = [end[at] for end in ends]
    return peak


def _water_peak(levels: FloatArray, time: FloatArray) -> dict[str, Any] | None:
    """The largest nominal value, and its interval from all numbers low to all high.

    Args:
        levels: With all numbers low, nominal and high, (N, 3).
        time: (N,) [s].
    """
    return _peak(levels[:, 1], time, levels.min(axis=1), levels.max(axis=1))


def _integral(values: FloatArray, time: FloatArray) -> float:
    """The integral over time, by the trapezoidal rule."""
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(time)))


def _drawn(power: FloatArray, time: FloatArray) -> float | None:
    """The energy of the positive part of a power; None if that is not finite [J]."""
    return _finite(_integral(np.maximum(power, 0.0), time))


def _rms(values: FloatArray, time: FloatArray) -> float | None:
    """The root mean square over time; None if it is not finite."""
    return _finite(np.sqrt(_integral(values**2, time) / (time[-1] - time[0])))


def _plain_rms(values: FloatArray) -> float | None:
    """The root mean square over samples; None if it is not finite."""
    return _finite(np.sqrt(np.mean(values**2)))


def _finite(value: float) -> float | None:
    """A number, or None if it is not finite."""
    return value if np.isfinite(value) else None
