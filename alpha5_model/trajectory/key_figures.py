"""The key figures of an analysed motion: peaks, margins, energies, warnings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.text import plain
from alpha5_model.numbers.parameters import JointRange, is_catalogue
from alpha5_model.trajectory.analysis import AT_MOTORS, Analysis
from alpha5_model.trajectory.checks import LIMIT_SLACK

if TYPE_CHECKING:
    from alpha5_model.water.terms import WaterTerms

#: Torques and speeds less than this are rounding, SI units.
ROUNDING = 1e-12
#: Units of a joint's figures.
TURNING = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
SLIDING = {"position": "m", "velocity": "m/s", "torque": "N"}


@dataclass(frozen=True)
class Peak:
    """The value of largest size, its time [s], and its interval if it has one."""

    value: float
    time_s: float
    interval: tuple[float, float] | None = None


@dataclass(frozen=True)
class Comparison:
    """What was recorded against what was computed, over the samples with a record.

    Attributes:
        samples: Their number.
        peak, rms: Of what was recorded.
        difference_mean, difference_rms, difference_peak: Of what was recorded less what
            was computed.
        correlation: None if one of both does not vary.
        difference_rms_with_friction: Of efforts: with the motors' friction, and what
            turns their rotors, computed, too; None if friction is unknown.
    """

    samples: int
    peak: Peak
    rms: float | None
    difference_mean: float
    difference_rms: float | None
    difference_peak: Peak
    correlation: float | None
    difference_rms_with_friction: float | None = None


@dataclass(frozen=True, eq=False)
class JointFigures:
    """The figures of a joint, in its units and in A, V, W and J.

    A margin is what is left to a limit, negative beyond it. What belongs to a motor
    that cannot be computed, or to a limit that is not given, is None.
    """

    units: dict[str, str]
    position_range: tuple[float, float]
    position_margin: float
    velocity_limit: float
    velocity_margin: float
    beyond_rated_velocity: int
    velocity_peak: Peak
    acceleration_peak: Peak
    torque_peak: Peak
    smoothing_deviation: float
    torque_rms: float | None
    torque_margin: float
    causes_peak: dict[str, float | None]
    effort: Comparison | None
    recorded_current: Comparison | None
    current_peak: Peak | None
    current_rms: float | None
    voltage_peak: Peak | None
    power_peak: Peak | None
    energy_drawn_j: float | None
    current_margin: float | None
    voltage_margin: float | None
    drive_torque_margin: float | None
    beyond_drive_limits: int | None
    moving_water_peak: Peak | None


def summary(
    analysis: Analysis, torque_margin: FloatArray | None = None
) -> dict[str, Any]:
    """Peaks, margins, energies and warnings, in types that JSON has.

    Units: s, A, V, W, J, N, m; a joint's position, velocity and torque are in its
    ``units``: rad, rad/s, N m, for the jaw rod ``axis_a`` m, m/s, N. A margin is what
    is left to a limit, negative beyond it. ``null`` if a motor cannot be computed, a
    limit is not given or no effort or current is recorded. Their differences are those
    of what was recorded less what was computed.

    Args:
        analysis: What to summarise.
        torque_margin: Lower and upper distance of each joint's torque at its peak to
            the ends of its interval, (2, n), if they are known.
    """
    a = analysis
    time = a.smooth.time
    steps = np.diff(time)
    figures = {
        "source": a.motion.source,
        "samples": time.size,
        "start_s": time[0],
        "duration_s": time[-1] - time[0],
        "time_unit_of_file": a.motion.time_unit,
        "sample_time_s": {"median": np.median(steps), "longest": steps.max()},
        "model": _model(a),
        "smoothing": {
            "method": a.smooth.method,
            "bandwidth_hz": a.smooth.bandwidth,
            "derivatives_from": "velocities" if a.smooth.from_velocity else "positions",
        },
        "motors": _motors(a),
        "joints": joint_figures(a, torque_margin),
        "energy": energy(a),
        "mount": _mount(a),
        "tcp": {
            "first_m": a.tcp[0],
            "last_m": a.tcp[-1],
            "lowest_m": a.tcp.min(axis=0),
            "highest_m": a.tcp.max(axis=0),
            "path_length_m": tcp_way(a),
        },
        "warnings": a.warnings,
        "ignored_columns": a.motion.ignored,
    }
    # JSON refuses NaN: what may be missing is None instead.
    record: dict[str, Any] = plain(figures, unknown=math.nan)
    return record


def joint_figures(
    a: Analysis, torque_margin: FloatArray | None = None
) -> dict[str, JointFigures]:
    """The figures of each joint; the arguments are those of `summary`."""
    limits = a.arm.limits
    figures = {}
    for k, name in enumerate(a.arm.joint_names):
        joint = JointRange(
            name=name,
            lower=float(limits.lower[k]),
            upper=float(limits.upper[k]),
            velocity=float(limits.velocity[k]),
            effort=float(limits.effort[k]),
        )
        digits = None if torque_margin is None else torque_margin[:, k]
        figures[name] = _joint(a, k, joint, digits)
    return figures


def energy(a: Analysis) -> dict[str, Any]:
    """Power [W] and energy [J] of all motors together."""
    time = a.smooth.time
    velocity = a.smooth.signed_velocity
    power = np.nansum(a.electrical_power, axis=1)
    at_ends = []
    contradicting = np.zeros(time.size)
    for k in _known_motors(a):
        motor = a.actuators[k]
        for current in (a.current_lower[:, k], a.current_upper[:, k]):
            at_ends.append(motor.voltage(current, velocity[:, k]) * current)
        excess = (motor.back_emf_constant - motor.torque_constant) * motor.ratio
        contradicting += excess * a.current[:, k] * velocity[:, k]
    ends = np.reshape(at_ends, (-1, 2, time.size))
    least = ends.min(axis=1).sum(axis=0)
    most = ends.max(axis=1).sum(axis=0)
    return {
        "electrical_peak_w": power.max(),
        "drawn_j": _drawn(power, time),
        "drawn_interval_j": [_drawn(least, time), _drawn(most, time)],
        "fed_back_j": _drawn(-power, time),
        "mechanical_j": _integral(a.mechanical_power.sum(axis=1), time),
        "contradiction_j": _integral(contradicting, time),
    }


def mount_peaks(a: Analysis) -> tuple[Peak, Peak]:
    """Peaks of force [N] and moment [N m] on the mount."""
    time = a.smooth.time
    force, moment = _force_and_moment(a.base_wrench)
    return _known_peak(force, time), _known_peak(moment, time)


def water_mount_peaks(
    water: WaterTerms, time: FloatArray
) -> tuple[Peak | None, Peak | None]:
    """Peaks of what moving water adds to force [N] and moment [N m] on the mount."""
    force, moment = _force_and_moment(water.wrench)
    return _water_peak(force, time), _water_peak(moment, time)


def _mount(a: Analysis) -> dict[str, Peak | None]:
    """Peaks of the load on the mount [N, N m], and of what moving water adds to it."""
    force, moment = mount_peaks(a)
    peaks: dict[str, Peak | None] = {"force_peak_n": force, "moment_peak_nm": moment}
    if a.moving_water is not None:
        of_water = water_mount_peaks(a.moving_water, a.smooth.time)
        peaks["water_force_peak_n"], peaks["water_moment_peak_nm"] = of_water
    return peaks


def tcp_way(a: Analysis) -> float:
    """Length of the TCP's path [m]."""
    return float(np.linalg.norm(np.diff(a.tcp, axis=0), axis=1).sum())


def _model(a: Analysis) -> dict[str, Any]:
    """The arm and the water around it."""
    own = {} if is_catalogue(a.arm.parameters) else {"arm": a.arm.parameters.name}
    model: dict[str, Any] = {
        **own,
        "gripper": "jaws" if "axis_a" in a.smooth.joints else "locked",
        "fluid_density": a.arm.fluid_density,
        "payload_kg": a.arm.payload_mass,
        "gravity": a.arm.model.gravity.linear,
    }
    if a.moving_water is not None:
        model["water_current"] = a.moving_water.water_velocity
    return model


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


def _known_motors(a: Analysis) -> list[int]:
    """The joints whose motors can be computed."""
    joints = range(len(a.actuators))
    return [k for k in joints if np.isfinite(a.current[:, k]).all()]


def _joint(
    a: Analysis, k: int, joint: JointRange, digits: FloatArray | None
) -> JointFigures:
    """The figures of joint k."""
    time = a.smooth.time
    position = a.motion.position[:, k]
    velocity = a.smooth.velocity[:, k]
    torque = a.torque[:, k]
    current = a.current[:, k]
    power = a.electrical_power[:, k]

    range_left = min(position.min() - joint.lower, joint.upper - position.max())
    slack = LIMIT_SLACK * (joint.upper - joint.lower)
    speed_left = joint.velocity - np.abs(velocity)
    speed_left[np.abs(speed_left) <= ROUNDING] = 0.0
    torque_peak = _known_peak(torque, time)
    if digits is not None:
        lower, upper = (torque_peak.value + digits).tolist()
        torque_peak = Peak(torque_peak.value, torque_peak.time_s, (lower, upper))
    water = None if a.moving_water is None else a.moving_water.torque[:, :, k]

    limit = a.current_limits[k] if a.current_limits else None
    reserve: FloatArray | None = None
    if a.torque_limits and limit and a.supply_voltage and k in _known_motors(a):
        to_upper = a.torque_limits.upper[:, k] - torque
        to_lower = torque - a.torque_limits.lower[:, k]
        reserve = np.minimum(to_upper, to_lower)
    has_drive = reserve is not None and limit and a.supply_voltage

    return JointFigures(
        units=SLIDING if joint.name == "axis_a" else TURNING,
        position_range=(position.min(), position.max()),
        position_margin=0.0 if -slack <= range_left < 0 else range_left,
        velocity_limit=joint.velocity,
        velocity_margin=speed_left.min(),
        beyond_rated_velocity=int(np.count_nonzero(speed_left < 0.0)),
        velocity_peak=_known_peak(velocity, time),
        acceleration_peak=_known_peak(a.smooth.acceleration[:, k], time),
        torque_peak=torque_peak,
        smoothing_deviation=a.smooth.deviation[k],
        torque_rms=_rms(torque, time),
        # The catalogue's effort is what public models copy; no rating is published.
        torque_margin=joint.effort - np.abs(torque).max(),
        causes_peak={
            name: _finite(np.abs(values[:, k]).max())
            for name, values in a.causes().items()
        },
        effort=_effort(a, k),
        recorded_current=_recorded_current(a, k),
        current_peak=_peak(current, time, a.current_lower[:, k], a.current_upper[:, k]),
        current_rms=_rms(current, time),
        voltage_peak=_peak(a.voltage[:, k], time),
        power_peak=_peak(power, time),
        energy_drawn_j=_drawn(power, time),
        current_margin=_left(limit, a.current_lower[:, k], a.current_upper[:, k])
        if has_drive
        else None,
        voltage_margin=_left(a.supply_voltage, a.voltage[:, k]) if has_drive else None,
        drive_torque_margin=None if reserve is None else _least(reserve),
        beyond_drive_limits=None
        if reserve is None
        else int(np.count_nonzero(~(reserve >= 0))),
        moving_water_peak=None if water is None else _water_peak(water, time),
    )


def _left(limit: float | None, *values: FloatArray) -> float | None:
    """What is left to a limit of magnitudes."""
    return None if limit is None else float(limit - np.abs(values).max())


def _least(reserve: FloatArray) -> float | None:
    """The least reserve of torque where the drive has any."""
    possible = reserve[np.isfinite(reserve)]
    return float(possible.min()) if possible.size else None


def _effort(a: Analysis, k: int) -> Comparison | None:
    """The recorded effort of joint k against the torque computed."""
    if a.effort is None:
        return None
    torque = a.torque[:, k]
    causes = a.causes()
    with_friction = torque.copy()
    for cause in AT_MOTORS:
        if cause in causes:
            with_friction += causes[cause][:, k]
    return _comparison(a.effort[:, k], torque, a.smooth.time, with_friction)


def _recorded_current(a: Analysis, k: int) -> Comparison | None:
    """The recorded current of the motor of joint k against the current computed."""
    if a.recorded_current is None or k not in _known_motors(a):
        return None
    return _comparison(a.recorded_current[:, k], a.current[:, k], a.smooth.time)


def _comparison(
    recorded: FloatArray,
    computed: FloatArray,
    time: FloatArray,
    with_friction: FloatArray | None = None,
) -> Comparison | None:
    """What was recorded against what was computed, (N,) each; None without records."""
    known = np.isfinite(recorded)
    if not known.any():
        return None
    values = recorded[known]
    expected = computed[known]
    difference = values - expected
    varied = min(np.ptp(values), np.ptp(expected)) > ROUNDING
    rest = None if with_friction is None else _plain_rms(values - with_friction[known])
    return Comparison(
        samples=values.size,
        peak=_known_peak(values, time[known]),
        rms=_plain_rms(values),
        difference_mean=difference.mean(),
        difference_rms=_plain_rms(difference),
        difference_peak=_known_peak(difference, time[known]),
        correlation=np.corrcoef(values, expected)[0, 1] if varied else None,
        difference_rms_with_friction=rest,
    )


def _force_and_moment(wrenches: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The size of force and of moment of wrenches, (..., 6)."""
    force = np.linalg.norm(wrenches[..., :3], axis=-1)
    moment = np.linalg.norm(wrenches[..., 3:], axis=-1)
    return force, moment


def _known_peak(values: FloatArray, time: FloatArray) -> Peak:
    """The value of largest size, and its time."""
    at = int(np.abs(values).argmax())
    return Peak(float(values[at]), float(time[at]))


def _peak(values: FloatArray, time: FloatArray, *ends: FloatArray) -> Peak | None:
    """The value of largest size, its time, and the interval between the ends there.

    None if the value is not finite: its motor cannot be computed.
    """
    at = int(np.abs(values).argmax())
    if not np.isfinite(values[at]):
        return None
    interval: tuple[float, float] | None = None
    if ends:
        lower, upper = ends
        interval = float(lower[at]), float(upper[at])
    return Peak(float(values[at]), float(time[at]), interval)


def _water_peak(levels: FloatArray, time: FloatArray) -> Peak | None:
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
