"""Friction, rotor inertia and torque per ampere of the motors, from recorded currents.

The tables, or the arm file, are the known load. The current of a joint's motor is

    i = (tau + F sign(v) + B v + J a) / K

with the load tau, Coulomb friction F of each direction, viscous friction B, the rotor's
inertia J, all at the joint, and the torque per ampere K, which is K_t times the gear
ratio. This is linear in 1/K, F/K, B/K and J/K. More friction at low speed, a friction
that drifts, and a drifting zero of the current have columns of their own; noise is
autoregressive, by `alpha5_model.studies.uncertainty.noise`. A loss in the gears that
grows with the load is not told apart from K.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, flag, instance
from alpha5_model._support.files import PathLike
from alpha5_model._support.writing import atomic_write
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.load import load
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.motor_record import (
    JointMotor,
    with_motors,
)
from alpha5_model.studies.uncertainty.noise import noise_of_channel, whitened
from alpha5_model.trajectory import Motion, SmoothMotion, smooth

#: Public drivers suggest a static current of 43 mA, Table 4 implies 280 mA: the middle
#: and the standard deviation of the prior [A].
_FRICTION = (0.16, 0.12)
#: Standard deviation of the torque per ampere before the data, relative to Table 4's:
#: its two constants of one motor differ by as much.
_BY_TABLE = 0.5
#: Below this speed friction is not Coulomb's, relative to the joint's rated speed.
_SLOW = 0.15
#: Speed within which low speed adds friction, relative to the rated one.
_STRIBECK = 0.1
#: Drifts have periods of this many seconds or more.
_DRIFT = 20.0
#: Standard deviations of what drifts, and of the current's zero [A].
_DRIFT_SIZE = 0.02
_ZERO = 0.002
#: Fewer samples in each direction than this tell nothing.
_LEAST_SAMPLES = 50
#: A torque per ampere that is less certain than this stays as in the arm's record.
_UNKNOWN = 0.25
#: Three standard deviations must tell this payload from none [kg].
_USEFUL = 0.1
_CERTAIN = 3.0
#: Half width of a 95 % interval in standard deviations.
_WIDE = 1.96
#: A computed current has no noise [A].
_LEAST_NOISE = 1e-9
#: The five numbers of a joint, first in all arrays.
_SCALE, _FORWARD, _BACKWARD, _VISCOUS, _ARMATURE, _PAYLOAD = range(6)


class Payload(NamedTuple):
    """A mass that the tool point carries.

    Attributes:
        mass: In the fluid: without what its displaced water weighs [kg].
        deviation: Standard deviation, the uncertain torque per ampere included [kg].
    """

    mass: float
    deviation: float


class MotorCalibration(NamedTuple):
    """What currents say of the motors.

    Attributes:
        joints: Of axis_e to axis_b.
        payload: What the tool point carries, if that was asked for.
        parameters: The arm's record with these motors; see `write`.
        gravity_deviation: Relative standard deviation to which the currents tell the
            torque of gravity, the smallest of all joints. The printed digits leave
            0.004 on axis_d, so currents cannot tell the masses of links.
    """

    joints: tuple[JointMotor, ...]
    payload: Payload | None
    parameters: Alpha5Parameters
    gravity_deviation: float

    def write(self, path: PathLike) -> Path:
        """Write the arm with these motors as an arm file, ``.toml``.

        Raises:
            OutputError: The file cannot be written.
        """
        return atomic_write(Path(path), arm_file_text(self.parameters))

    def __str__(self) -> str:
        lines = [str(joint) for joint in self.joints]
        if self.payload is not None:
            mass, deviation = self.payload
            lines.append(f"payload {1e3 * mass:.0f} ± {1e3 * deviation:.0f} g")
        lines.append(
            f"masses of links: not told, gravity is known to "
            f"{100 * self.gravity_deviation:.1f} %"
        )
        return "\n".join(lines)


def motors(
    motion: Motion,
    arm: Arm | None = None,
    *,
    payload: bool = False,
    **smoothing: Any,
) -> MotorCalibration:
    """Estimate the motors from a motion with recorded currents.

    Sway all joints to both sides for a minute. Samples below 0.15 of the rated speed
    are left out.

    Args:
        motion: With currents, see `alpha5_model.trajectory`; the jaw rod is left out.
        arm: The known load, in its fluid, on a fixed base; None for the bare arm in sea
            water. A torque per ampere with a half width in its file is known to that.
        payload: Whether an unknown mass is at the tool point. Calibrate the motors
            without it first.
        smoothing: As of `alpha5_model.trajectory.smooth`.

    Raises:
        InputError: No currents, too few samples in a direction, a wrong sign, or a
            payload that the currents cannot tell; the message says why.
    """
    arm = load() if arm is None else instance("arm", arm, Arm)
    flag("payload", payload)
    recorded = instance("motion", motion, Motion).current
    if recorded is None:
        raise InputError("motion", motion.source, "one with recorded currents")
    smoothed = smooth(motion, **smoothing)
    q = np.array(smoothed.position[:, :4])
    v = np.array(smoothed.velocity[:, :4])
    a = np.array(smoothed.acceleration[:, :4])
    torque = np.array(arm.inverse_dynamics_batch(q, v, a))
    of_payload = np.zeros_like(torque)
    if payload:
        heavy = arm.with_payload(mass=1.0)
        of_payload = np.array(heavy.inverse_dynamics_batch(q, v, a)) - torque

    fits = [
        _fit(smoothed, k, recorded[:, k], torque[:, k], of_payload[:, k], arm)
        for k in range(4)
    ]
    joints = tuple(_motor(fit, k, arm.parameters) for k, fit in enumerate(fits))
    weighed = _weighed(fits, joints) if payload else None
    relative = [joint.relative_deviation for joint in joints]
    return MotorCalibration(
        joints=joints,
        payload=weighed,
        parameters=with_motors(arm.parameters, joints, motion.source),
        gravity_deviation=min(relative),
    )


class _Fit(NamedTuple):
    """Coefficients of a joint's current.

    Attributes:
        values: 1/K, forward and backward F/K, B/K, J/K, payload over K, (6,).
        covariance: (6, 6).
        noise: Standard deviation of what is left [A].
    """

    values: FloatArray
    covariance: FloatArray
    noise: float


def _fit(
    motion: SmoothMotion,
    k: int,
    current: FloatArray,
    torque: FloatArray,
    of_payload: FloatArray,
    arm: Arm,
) -> _Fit:
    """Fit a joint's current by weighted least squares with the prior."""
    joint = arm.parameters.joints[k]
    if not joint.velocity > 0.0:
        raise InputError(f"{joint.name}.velocity", joint.velocity, "a speed above 0")
    velocity = motion.velocity[:, k]
    used = (np.abs(velocity) > _SLOW * joint.velocity) & np.isfinite(current)
    for sign, way in ((1.0, "forward"), (-1.0, "backward")):
        count = int((used & (sign * velocity > 0)).sum())
        if count < _LEAST_SAMPLES:
            given = f"{joint.name} with {count} samples {way} that are fast enough"
            least = _SLOW * joint.velocity
            expected = f"{_LEAST_SAMPLES} above {least:.3g} rad/s"
            raise InputError("motion", given, expected)

    of_motor = [
        torque,
        velocity > 0,
        -(velocity < 0).astype(float),
        velocity,
        motion.acceleration[:, k],
        of_payload,
    ]
    nuisances = _nuisances(motion.time, velocity, joint)
    rows = np.column_stack([*of_motor, nuisances])
    prior = _prior(arm.parameters, k, rows.shape[1], bool(of_payload.any()))
    fit = _averaged(rows, np.where(used, current, np.nan), *prior)
    _check_sign(fit, joint.name)
    return fit


def _averaged(
    rows: FloatArray, measured: FloatArray, middle: FloatArray, deviation: FloatArray
) -> _Fit:
    """The mean fit over all noise that is likely.

    Args:
        rows: Columns of the current, (N, k), the motor's first.
        measured: (N,) [A]; NaN where it is not used.
        middle, deviation: Of the prior, (k,) each.
    """
    noise = noise_of_channel(rows, np.zeros((len(rows), 1)), measured)
    every = np.column_stack([rows, measured])
    estimates = []
    covariances = []
    for *coefficients, size in noise.likely:
        white = whitened(every, np.array(coefficients)) / max(size, _LEAST_NOISE)
        complete = white[np.isfinite(white).all(axis=1)]
        equations = np.vstack([complete[:, :-1], np.diag(1 / deviation)])
        target = np.append(complete[:, -1], middle / deviation)
        estimates.append(np.linalg.lstsq(equations, target)[0])
        covariances.append(np.linalg.inv(equations.T @ equations))

    covariance = np.mean(covariances, axis=0)
    covariance = covariance + np.cov(np.transpose(estimates), bias=True)
    of_motor = slice(0, _PAYLOAD + 1)
    return _Fit(
        values=np.mean(estimates, axis=0)[of_motor],
        covariance=covariance[of_motor, of_motor],
        noise=noise.deviation,
    )


def _nuisances(time: FloatArray, velocity: FloatArray, joint: Any) -> FloatArray:
    """Columns of friction at low speed, drifting friction, and a drifting zero."""
    half_turns = np.pi * (time - time[0]) / np.ptp(time)
    waves = np.cos(np.outer(half_turns, np.arange(_most_waves(time) + 1)))
    direction = np.sign(velocity)[:, None]
    slow = np.exp(-np.abs(velocity) / (_STRIBECK * joint.velocity))
    return np.column_stack([waves, direction * waves[:, 1:], direction * slow[:, None]])


def _most_waves(time: FloatArray) -> int:
    """Half waves of the slow drifts in a recording."""
    return int(2 * np.ptp(time) / _DRIFT)


def _prior(
    record: Alpha5Parameters, k: int, count: int, with_payload: bool
) -> tuple[FloatArray, FloatArray]:
    """Middles and standard deviations of the coefficients before the data."""
    actuator = record.actuators[k]
    per_ampere = actuator.torque_constant * actuator.gear_ratio
    half_widths = {one.key: one.half_width for one in record.measurements}
    key = f"motors.torque_constant.{JOINT_NAMES[k]}"
    half_width = half_widths.get(key)
    relative = _BY_TABLE
    if half_width is not None:
        relative = max(half_width / actuator.torque_constant / _WIDE, 1e-6)
    middle = np.zeros(count)
    # Friction drifts by a part of itself, a zero by little.
    deviation = np.full(count, _DRIFT_SIZE)
    deviation[_PAYLOAD + 1] = _ZERO
    middle[_SCALE] = 1 / per_ampere
    deviation[_SCALE] = relative / per_ampere
    middle[[_FORWARD, _BACKWARD]] = _FRICTION[0]
    deviation[[_FORWARD, _BACKWARD]] = _FRICTION[1]
    # A payload of the arm's own mass is likely; none if it is not asked for.
    deviation[_PAYLOAD] = (1.0 if with_payload else 1e-9) / per_ampere
    return middle, deviation


def _check_sign(fit: _Fit, name: str) -> None:
    """Refuse friction that drives a joint."""
    friction = fit.values[_FORWARD] + fit.values[_BACKWARD]
    pair = fit.covariance[_FORWARD : _BACKWARD + 1, _FORWARD : _BACKWARD + 1]
    if friction < -4 * np.sqrt(pair.sum()):
        given = f"{name} with a friction of {1e3 * friction / 2:.0f} mA"
        raise InputError("motion", given, "currents with the sign of the motion")


def _motor(fit: _Fit, k: int, record: Alpha5Parameters) -> JointMotor:
    """A joint's motor from the coefficients of its current."""
    deviation = np.sqrt(np.diag(fit.covariance))
    actuator = record.actuators[k]
    table = actuator.torque_constant * actuator.gear_ratio
    relative = float(deviation[_SCALE] / abs(fit.values[_SCALE]))
    known = relative < _UNKNOWN and fit.values[_SCALE] > 0
    return JointMotor(
        name=JOINT_NAMES[k],
        friction_forward=float(fit.values[_FORWARD]),
        friction_backward=float(fit.values[_BACKWARD]),
        friction_deviation=float(deviation[_FORWARD : _BACKWARD + 1].max()),
        viscous=max(float(fit.values[_VISCOUS]), 0.0),
        viscous_deviation=float(deviation[_VISCOUS]),
        armature=max(float(fit.values[_ARMATURE]), 0.0),
        armature_deviation=float(deviation[_ARMATURE]),
        torque_per_ampere=float(1 / fit.values[_SCALE]) if known else table,
        relative_deviation=relative,
        known=bool(known),
        noise=fit.noise,
    )


def _weighed(fits: list[_Fit], joints: tuple[JointMotor, ...]) -> Payload:
    """The payload's mass, from all joints by their certainty.

    Raises:
        InputError: The mass is too uncertain to be of use.
    """
    masses = []
    variances = []
    for fit in fits:
        scale = fit.values[_SCALE]
        mass = fit.values[_PAYLOAD] / scale
        slope = np.zeros(len(fit.values))
        slope[_PAYLOAD] = 1 / scale
        slope[_SCALE] = -mass / scale
        masses.append(mass)
        variances.append(slope @ fit.covariance @ slope)
    weights = 1 / np.array(variances)
    mass = float(weights @ masses / weights.sum())
    deviation = float(1 / np.sqrt(weights.sum()))

    friction = max(joint.friction_forward for joint in joints)
    if _CERTAIN * deviation > _USEFUL:
        given = (
            f"± {1e3 * deviation:.0f} g: friction takes {1e3 * friction:.0f} mA "
            "of the current and varies"
        )
        least = 1e3 * _USEFUL / _CERTAIN
        expected = f"currents that tell it to ± {least:.0f} g or less"
        raise InputError("payload", given, expected)
    return Payload(mass=mass, deviation=deviation)
