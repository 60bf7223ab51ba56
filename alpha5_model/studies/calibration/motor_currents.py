"""Friction, rotor inertia and torque per ampere of the motors, from recorded currents.

The tables, or the arm file, are the known load. The current of a joint's motor is

    i = (tau + F sign(v) + B v + J a) / K

with the load tau, Coulomb friction F of each direction, viscous friction B, the rotor's
inertia J, all at the joint, and the torque per ampere K, which is K_t times the gear
ratio. This is linear in 1/K, F/K, B/K and J/K. A friction that drifts has columns of
its own. All else is correlated noise, see `alpha5_model.studies.calibration.ar1`. A
steady zero of the current is part of the friction of both directions, and a loss in the
gears that grows with the load is part of K.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, flag, instance
from alpha5_model._support.files import PathLike
from alpha5_model._support.writing import atomic_write
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.load import loaded
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.fluids import AIR, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.ar1 import correlations, whitened
from alpha5_model.studies.calibration.motor_record import (
    WIDE,
    JointMotor,
    MotorProblem,
    with_motors,
)
from alpha5_model.trajectory import Motion, SmoothMotion, smooth

#: The arm's joints; the jaw rod is left out.
_JOINTS = 4
#: Public drivers suggest a static current of 43 mA, Table 4 implies 280 mA: the middle
#: and the standard deviation of the prior [A].
_FRICTION = (0.16, 0.12)
#: Standard deviations of the prior of B/K [A s/rad] and J/K [A s^2/rad]: at the rated
#: speed, and at its change within a second or two, as much as friction.
_VISCOUS = 0.3
_ARMATURE = 0.3
#: That of the torque per ampere, relative to Table 4's: its two constants of one motor
#: differ by 15 %, and a fluid may be wrong.
_BY_TABLE = 0.5
#: Below this speed friction is not Coulomb's, relative to the joint's rated speed.
_SLOW = 0.15
#: Friction drifts with periods of this many seconds or more, by this size [A].
_DRIFT = 20.0
_DRIFT_SIZE = 0.02
#: Fewer samples in each direction than this tell nothing.
_LEAST_SAMPLES = 50
#: A torque per ampere that is less certain than this stays as in the arm's record.
_UNKNOWN = 0.25
#: The same, if the currents alone are to tell it, and for the judgement of the fluid.
_ANY = 20.0
_TOLD = 0.5
_TABLE = 0.12
#: Fluids of nearly the same density cannot be told apart [kg/m^3].
_SAME_FLUID = 500.0
#: Another one is named if the squared misfit, in standard deviations, is larger than
#: this, and it leaves less than this share.
_MISFIT = 4.0
_FAR_BETTER = 0.5
#: Currents in other columns fit better if they leave less than this share of a joint's
#: residuals, as a geometric mean over the joints that change.
_BETTER = 0.7
#: Standard deviation of a payload before the data: the arm's own mass, or none [kg].
_PAYLOAD = 1.0
_NO_PAYLOAD = 1e-9
#: Three standard deviations must tell this payload from none [kg].
_USEFUL = 0.1
_CERTAIN = 3.0
#: A computed current has no noise [A].
_LEAST_NOISE = 1e-9
_FLUIDS = {"air": AIR, "water": SEA_WATER}


class Payload(NamedTuple):
    """A mass that the tool point carries.

    Attributes:
        mass: In the fluid: without what its displaced water weighs [kg].
        deviation: Standard deviation, the uncertain torque per ampere included [kg].
    """

    mass: float
    deviation: float


class MotorCalibration(NamedTuple):
    """What currents say of the motors. `print` shows the problems first.

    Attributes:
        joints: Of axis_e to axis_b.
        payload: What the tool point carries, if that was asked for.
        parameters: The arm's record with these motors; see `write`.
        gravity_deviation: Relative standard deviation to which the currents tell the
            torque of gravity, the smallest of all joints. The printed digits leave
            0.004 on axis_d, so currents cannot tell the masses of links.
        problems: What the currents contradict, and what they do not tell.
    """

    joints: tuple[JointMotor, ...]
    payload: Payload | None
    parameters: Alpha5Parameters
    gravity_deviation: float
    problems: tuple[MotorProblem, ...]

    @property
    def contradicted(self) -> bool:
        """Whether the currents contradict what was given with them."""
        return any(one.name != "uncertain" for one in self.problems)

    def text(self) -> str:
        """The arm file, with the problems in its head."""
        return arm_file_text(self.parameters, map(str, self.problems))

    def write(self, path: PathLike) -> Path:
        """Write the arm with these motors as an arm file, ``.toml``.

        Raises:
            OutputError: The file cannot be written.
        """
        return atomic_write(Path(path), self.text())

    def __str__(self) -> str:
        lines = [str(one) for one in self.problems]
        if self.problems:
            lines.append("")
        lines.extend(str(joint) for joint in self.joints)
        if self.payload is not None:
            mass = 1e3 * self.payload.mass
            lines.append(f"payload {mass:.0f} ± {_wide(self.payload.deviation)} g")
        lines.append(
            f"masses of links: not told, gravity is known to "
            f"± {100 * WIDE * self.gravity_deviation:.1f} %"
        )
        lines.append("each ± holds the truth in 95 % of recordings")
        return "\n".join(lines)


def motors(
    motion: Motion,
    arm: Alpha5Parameters | Arm | None = None,
    *,
    payload: bool = False,
    **smoothing: Any,
) -> MotorCalibration:
    """Estimate the motors from a motion with recorded currents.

    Sway all joints to both sides for a minute. Samples below 0.15 of the rated speed
    are left out.

    Args:
        motion: With currents, see `alpha5_model.trajectory`; the jaw rod is left out.
        arm: The known load, in its fluid, on a fixed base; a record, or None for the
            catalogue's, is the bare arm in air. A torque per ampere with a half width
            in its file is known to that.
        payload: Whether an unknown mass is at the tool point. Calibrate the motors
            without it first. It may also stand for another fluid, which is not judged
            then.
        smoothing: As of `alpha5_model.trajectory.smooth`.

    Raises:
        InputError: No currents, too few samples in a direction, a wrong sign, currents
            in the columns of other joints, or a payload that the currents cannot tell;
            the message says why.
    """
    arm = loaded(arm, fluid_density=AIR)
    flag("payload", payload)
    recorded = instance("motion", motion, Motion).current
    if recorded is None:
        raise InputError("motion", motion.source, "one with recorded currents")
    states = _states(smooth(motion, **smoothing), arm, recorded)
    _check_columns(states, arm)

    of_payload = np.zeros_like(states.torque)
    if payload:
        of_payload = states.loads(arm.with_payload(mass=1.0)) - states.torque
    record = arm.parameters
    mass = _PAYLOAD if payload else _NO_PAYLOAD
    fits = []
    for k in range(_JOINTS):
        prior = _prior(record, k, _own_share(record, k) or _BY_TABLE, mass)
        fits.append(_fit(states, k, of_payload[:, k], prior))
    joints = tuple(_motor(fit, k, record) for k, fit in enumerate(fits))
    problems = _uncertain(joints)
    if not payload:
        problems = [*_wrong_load(states, arm), *problems]
    return MotorCalibration(
        joints=joints,
        payload=_weighed(fits, joints) if payload else None,
        parameters=with_motors(record, joints, motion.source),
        gravity_deviation=min(joint.relative_deviation for joint in joints),
        problems=tuple(problems),
    )


class _States(NamedTuple):
    """A recording, and the torques of the arm that is known.

    Attributes:
        time: (N,).
        q, v, a: (N, 4).
        torque, current: (N, 4).
        used: Samples that are fast enough and have a current, (N, 4) bool.
    """

    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    torque: FloatArray
    current: FloatArray
    used: BoolArray

    def loads(self, arm: Arm) -> FloatArray:
        """Torques of an arm in this motion, (N, 4)."""
        return np.array(arm.inverse_dynamics_batch(self.q, self.v, self.a))

    def of_motor(self, k: int) -> FloatArray:
        """What the motor of a joint gives current to, (N, 5), as in `_Motor`."""
        v = self.v[:, k]
        forward = (v > 0).astype(float)
        backward = -(v < 0).astype(float)
        return np.column_stack([self.torque[:, k], forward, backward, v, self.a[:, k]])


class _Motor(NamedTuple):
    """Coefficients of a joint's current, in the order of their columns.

    Attributes:
        per_torque: 1/K [A/(N m)].
        forward, backward: F/K [A].
        viscous: B/K [A s/rad].
        armature: J/K [A s^2/rad].
        payload: Current per mass at the tool point [A/kg].
    """

    per_torque: float = 0.0
    forward: float = 0.0
    backward: float = 0.0
    viscous: float = 0.0
    armature: float = 0.0
    payload: float = 0.0


class _Prior(NamedTuple):
    """Coefficients before the data, and their standard deviations."""

    middle: _Motor
    deviation: _Motor


class _Fit(NamedTuple):
    """The coefficients of a joint's current.

    Attributes:
        values: The likeliest.
        deviation: Their standard deviations.
        covariance: (6, 6), in the order of `_Motor`.
        noise: Standard deviation of what is left [A].
    """

    values: _Motor
    deviation: _Motor
    covariance: FloatArray
    noise: float

    def variance(self, slope: _Motor) -> float:
        """Of a quantity with these derivatives by the coefficients."""
        return float(np.array(slope) @ self.covariance @ np.array(slope))


def _states(motion: SmoothMotion, arm: Arm, recorded: FloatArray) -> _States:
    """The recording of the joints that move fast enough.

    Raises:
        InputError: A joint without a rated speed, or too few samples.
    """
    joints = arm.parameters.joints[:_JOINTS]
    for joint in joints:
        if not joint.velocity > 0.0:
            raise InputError(
                f"{joint.name}.velocity", joint.velocity, "a speed above 0"
            )
    q = np.array(motion.position[:, :_JOINTS])
    v = np.array(motion.velocity[:, :_JOINTS])
    a = np.array(motion.acceleration[:, :_JOINTS])
    current = np.array(recorded[:, :_JOINTS])
    least = _SLOW * np.array([joint.velocity for joint in joints])
    used = (np.abs(v) > least) & np.isfinite(current)
    for sign, way in ((1.0, "forward"), (-1.0, "backward")):
        counts = (used & (sign * v > 0)).sum(axis=0)
        k = int(counts.argmin())
        if counts[k] < _LEAST_SAMPLES:
            name = JOINT_NAMES[k]
            given = f"{name} with {counts[k]} samples {way} that are fast enough"
            expected = f"{_LEAST_SAMPLES} above {least[k]:.3g} rad/s"
            raise InputError("motion", given, expected)
    torque = np.array(arm.inverse_dynamics_batch(q, v, a))
    return _States(
        time=motion.time, q=q, v=v, a=a, torque=torque, current=current, used=used
    )


def _check_columns(states: _States, arm: Arm) -> None:
    """Refuse currents that follow the motions of other joints.

    Raises:
        InputError: Currents in other columns fit the motion better.
    """
    from scipy.optimize import linear_sum_assignment

    left = np.empty((_JOINTS, _JOINTS))
    for motion in range(_JOINTS):
        columns = states.of_motor(motion)
        for current in range(_JOINTS):
            used = states.used[:, motion] & np.isfinite(states.current[:, current])
            if used.sum() < _LEAST_SAMPLES:
                # Joints that are read in turn share no sample: none can be exchanged.
                left[motion, current] = 0.0 if motion == current else np.inf
                continue
            measured = states.current[used, current]
            fitted = columns[used] @ np.linalg.lstsq(columns[used], measured)[0]
            size = np.sqrt(np.mean((measured - fitted) ** 2))
            left[motion, current] = np.log(max(float(size), _LEAST_NOISE))

    _, order = linear_sum_assignment(left)
    own = np.arange(_JOINTS)
    moved = order != own
    if not moved.any():
        return
    if np.mean((left[own, order] - left[own, own])[moved]) < np.log(_BETTER):
        names = JOINT_NAMES[:_JOINTS]
        found = f"those of {', '.join(names[k] for k in np.argsort(order))}"
        expected = f"currents of {', '.join(names)}, in the order of their joints"
        raise InputError("motion", found, expected)


def _fit(states: _States, k: int, of_payload: FloatArray, prior: _Prior) -> _Fit:
    """Fit a joint's current by least squares, over all likely correlations of noise."""
    drift = _drift(states.time) * np.sign(states.v[:, [k]])
    used = np.flatnonzero(states.used[:, k])
    columns = np.column_stack([states.of_motor(k), of_payload, drift])[used]
    measured = states.current[used, k]
    expected = np.append(prior.middle, np.zeros(drift.shape[1]))
    spread = np.append(prior.deviation, np.full(drift.shape[1], _DRIFT_SIZE))
    freedom = max(len(used) - columns.shape[1], 1)

    likely = correlations(measured, columns, used)
    estimates = []
    covariances = []
    for rho in likely.rho.tolist():
        white = whitened(columns, rho, used)
        target = whitened(measured, rho, used)
        rest = target - white @ np.linalg.lstsq(white, target)[0]
        chance = max(float(np.sqrt(rest @ rest / freedom)), _LEAST_NOISE)
        equations = np.vstack([white / chance, np.diag(1.0 / spread)])
        wanted = np.append(target / chance, expected / spread)
        estimates.append(np.linalg.lstsq(equations, wanted)[0])
        covariances.append(np.linalg.inv(equations.T @ equations))

    estimate = likely.probability @ np.array(estimates)
    apart = np.array(estimates) - estimate
    covariance = np.tensordot(likely.probability, covariances, 1)
    covariance += (apart.T * likely.probability) @ apart

    of_motor = len(_Motor._fields)
    residual = measured - columns @ estimate
    fit = _Fit(
        values=_Motor(*estimate[:of_motor].tolist()),
        deviation=_Motor(*np.sqrt(np.diag(covariance))[:of_motor].tolist()),
        covariance=covariance[:of_motor, :of_motor],
        noise=float(np.sqrt(np.mean(residual**2))),
    )
    _check_sign(fit, JOINT_NAMES[k])
    return fit


def _drift(time: FloatArray) -> FloatArray:
    """Half waves with periods that friction may drift with, (N, m)."""
    duration = float(np.ptp(time))
    half_turns = np.pi * (time - time[0]) / duration
    most = int(2 * duration / _DRIFT)
    return np.cos(np.outer(half_turns, np.arange(1, most + 1)))


def _prior(
    record: Alpha5Parameters, k: int, relative: float, mass: float = _NO_PAYLOAD
) -> _Prior:
    """What is known of a joint's motor before the data.

    Args:
        record: Of the arm.
        k: Index of the joint.
        relative: Standard deviation of the torque per ampere over it.
        mass: That of the payload [kg].
    """
    per_torque = 1.0 / _per_ampere(record, k)
    middle = _Motor(per_torque=per_torque, forward=_FRICTION[0], backward=_FRICTION[0])
    deviation = _Motor(
        per_torque=relative * per_torque,
        forward=_FRICTION[1],
        backward=_FRICTION[1],
        viscous=_VISCOUS,
        armature=_ARMATURE,
        payload=mass * per_torque,
    )
    return _Prior(middle=middle, deviation=deviation)


def _per_ampere(record: Alpha5Parameters, k: int) -> float:
    """Torque per ampere of a joint by the arm's record [N m/A]."""
    actuator = record.actuators[k]
    return float(actuator.torque_constant * actuator.gear_ratio)


def _own_share(record: Alpha5Parameters, k: int) -> float | None:
    """Standard deviation of that over it, if the record has a half width."""
    key = f"motors.torque_constant.{JOINT_NAMES[k]}"
    for one in record.measurements:
        if one.key == key and one.half_width is not None:
            constant = record.actuators[k].torque_constant
            return max(one.half_width / constant / WIDE, 1e-6)
    return None


def _check_sign(fit: _Fit, name: str) -> None:
    """Refuse friction that drives a joint."""
    friction = fit.values.forward + fit.values.backward
    variance = fit.variance(_Motor(forward=1.0, backward=1.0))
    if friction < -4 * np.sqrt(variance):
        given = f"{name} with a friction of {1e3 * friction / 2:.0f} mA"
        raise InputError("motion", given, "currents with the sign of the motion")


def _motor(fit: _Fit, k: int, record: Alpha5Parameters) -> JointMotor:
    """A joint's motor from the coefficients of its current."""
    values, deviation = fit.values, fit.deviation
    relative = deviation.per_torque / abs(values.per_torque)
    known = relative < _UNKNOWN and values.per_torque > 0
    return JointMotor(
        name=JOINT_NAMES[k],
        friction_forward=values.forward,
        friction_backward=values.backward,
        friction_deviation=max(deviation.forward, deviation.backward),
        viscous=values.viscous,
        viscous_deviation=deviation.viscous,
        armature=values.armature,
        armature_deviation=deviation.armature,
        torque_per_ampere=1 / values.per_torque if known else _per_ampere(record, k),
        relative_deviation=relative,
        known=known,
        noise=fit.noise,
    )


def _uncertain(joints: tuple[JointMotor, ...]) -> list[MotorProblem]:
    """Estimates whose half widths exceed them, in one line."""
    unsure: dict[str, list[str]] = {}
    for joint in joints:
        friction = joint.friction_deviation
        quantities = (
            ("friction forward", joint.friction_forward, friction),
            ("friction backward", joint.friction_backward, friction),
            ("viscous friction", joint.viscous, joint.viscous_deviation),
            ("rotor inertia", joint.armature, joint.armature_deviation),
        )
        for name, value, deviation in quantities:
            if WIDE * deviation > abs(value):
                unsure.setdefault(name, []).append(joint.name)
    if not unsure:
        return []
    listed = [f"{name} of {', '.join(of)}" for name, of in unsure.items()]
    message = f"the ± exceeds the {'; the '.join(listed)}"
    return [MotorProblem(name="uncertain", message=message)]


def _wrong_load(states: _States, arm: Arm) -> list[MotorProblem]:
    """Gravity of the wrong direction, or another fluid, by the torque per ampere.

    The load of another fluid has nearly the same shape over a motion. Only its size
    tells it, which is that of the torque per ampere: the arm's record has another one.
    """
    record = arm.parameters
    found = np.empty(_JOINTS)  # 1/K over that of the record, by the currents alone
    deviation = np.empty(_JOINTS)
    for k in range(_JOINTS):
        prior = _prior(record, k, relative=_ANY)
        fit = _fit(states, k, np.zeros_like(states.time), prior)
        found[k] = fit.values.per_torque / prior.middle.per_torque
        deviation[k] = fit.deviation.per_torque / prior.middle.per_torque

    told = deviation < _TOLD
    inverse = told & (found < -_CERTAIN * deviation)
    if inverse.any():
        names = ", ".join(JOINT_NAMES[k] for k in np.flatnonzero(inverse))
        message = (
            f"the current of {names} falls if the load grows: is gravity, or the "
            "mount, upside down?"
        )
        return [MotorProblem(name="gravity", message=message)]

    own = np.array([_own_share(record, k) or _TABLE for k in range(_JOINTS)])

    def misfit(expected: FloatArray) -> float:
        spread = np.hypot(deviation, own * expected)
        return float((((found - expected) / spread)[told] ** 2).sum())

    given = misfit(np.ones(_JOINTS))
    centred = states.torque - states.torque.mean(axis=0)
    squares = (centred**2).sum(axis=0)
    for name, density in _FLUIDS.items():
        if abs(density - arm.fluid_density) < _SAME_FLUID:
            continue
        other = states.loads(
            Arm(arm.model, arm.displacements, density, parameters=arm.parameters)
        )
        other_misfit = misfit((other * centred).sum(axis=0) / squares)
        if given > _MISFIT and other_misfit < _FAR_BETTER * given:
            message = (
                f"the torque per ampere is the arm's own if the recording was made in "
                f"{name}, not in a fluid of {arm.fluid_density:g} kg/m^3"
            )
            return [MotorProblem(name="fluid", message=message)]
    return []


def _weighed(fits: list[_Fit], joints: tuple[JointMotor, ...]) -> Payload:
    """The payload's mass, from all joints by their certainty.

    Raises:
        InputError: The mass is too uncertain to be of use.
    """
    masses = []
    variances = []
    for fit in fits:
        per_torque = fit.values.per_torque
        mass = fit.values.payload / per_torque
        slope = _Motor(per_torque=-mass / per_torque, payload=1.0 / per_torque)
        masses.append(mass)
        variances.append(fit.variance(slope))
    weights = 1.0 / np.array(variances)
    mass = float(weights @ masses / weights.sum())
    deviation = float(1.0 / np.sqrt(weights.sum()))

    if _CERTAIN * deviation > _USEFUL:
        friction = max(joint.friction_forward for joint in joints)
        given = (
            f"± {_wide(deviation)} g: friction takes {1e3 * friction:.0f} mA of the "
            "current and varies"
        )
        expected = f"currents that tell it to ± {_wide(_USEFUL / _CERTAIN)} g or less"
        raise InputError("payload", given, expected)
    return Payload(mass=mass, deviation=deviation)


def _wide(deviation: float) -> str:
    """Half width of a 95 % interval in thousandths."""
    return f"{1e3 * WIDE * deviation:.0f}"
