"""Currents, voltages and powers of the motors in a motion, and limits of a drive."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple, Protocol

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, frozen
from alpha5_model.dynamics.actuators import Actuator, Interval
from alpha5_model.errors import MissingParameterError

#: Columns of `motor_columns`; NaN if a constant of the motor is missing.
BY_MOTOR = (
    "rotor",
    "friction",
    "current",
    "current_lower",
    "current_upper",
    "voltage",
    "electrical_power",
)


class JointRates(Protocol):
    """What the motors need of a motion, (N, n) each.

    Attributes:
        signed_velocity: Velocities with the sign of the direction [rad/s, m/s].
        acceleration: [rad/s^2, m/s^2].
        direction: -1, 0 at rest, or 1.
    """

    @property
    def signed_velocity(self) -> FloatArray: ...
    @property
    def acceleration(self) -> FloatArray: ...
    @property
    def direction(self) -> FloatArray: ...


class Drive(NamedTuple):
    """The limits of the drive of each motor.

    Attributes:
        supply_voltage: [V].
        current_limits: Of each motor, (n,) [A]; None for one that is not known.
    """

    supply_voltage: float
    current_limits: tuple[float | None, ...]


class _JointState(NamedTuple):
    """Torque and motion of one joint, (N,) each.

    Attributes:
        torque: [N m, N].
        velocity: Signed by the direction of motion [rad/s, m/s].
        acceleration: [rad/s^2, m/s^2].
        at_rest: Whether friction holds the joint.
    """

    torque: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    at_rest: BoolArray


def motor_columns(
    motors: Sequence[Actuator], motion: JointRates, torque: FloatArray
) -> dict[str, FloatArray]:
    """`BY_MOTOR` of each joint, (N, n) each.

    Args:
        motors: Of the n joints.
        motion: Of the same joints.
        torque: At the joints, (N, n) [N m, N].
    """
    columns = {name: np.full(torque.shape, np.nan) for name in BY_MOTOR}
    for k, motor in enumerate(motors):
        with suppress(MissingParameterError):  # the jaw rod without a screw lead
            for name, column in _columns(motor, _state(motion, torque, k)).items():
                columns[name][:, k] = column
    return columns


def drive_limits(
    motors: Sequence[Actuator],
    motion: JointRates,
    torque: FloatArray,
    drive: Drive | None,
) -> Interval | None:
    """Torques that a drive can give in motion and hold at rest, (N, n) each.

    They are NaN for a motor without a current limit.

    Args:
        motors: Of the n joints.
        motion: Of the same joints.
        torque: At the joints, (N, n) [N m, N].
        drive: The limits of each motor; None if they are not known.

    Returns:
        None without a drive.

    Raises:
        InputError: A supply voltage or current limit that is not positive.
    """
    if drive is None:
        return None
    lower = np.full(torque.shape, np.nan)
    upper = np.full(torque.shape, np.nan)
    for k, (motor, limit) in enumerate(zip(motors, drive.current_limits, strict=True)):
        if limit is None:
            continue
        with suppress(MissingParameterError):  # the jaw rod without a screw lead
            state = _state(motion, torque, k)
            limits = _limits(motor, state, drive.supply_voltage, limit)
            lower[:, k] = limits.lower
            upper[:, k] = limits.upper
    return Interval(frozen(lower), frozen(upper))


def _state(motion: JointRates, torque: FloatArray, k: int) -> _JointState:
    """The motion of joint k."""
    return _JointState(
        torque=torque[:, k],
        velocity=motion.signed_velocity[:, k],
        acceleration=motion.acceleration[:, k],
        at_rest=motion.direction[:, k] == 0,
    )


def _columns(motor: Actuator, state: _JointState) -> dict[str, FloatArray]:
    """`BY_MOTOR` of one joint, (N,) each."""
    current = _current(motor, state)
    low_friction, high_friction = motor.extremes()
    ends = [_current(low_friction, state), _current(high_friction, state)]
    voltage = motor.voltage(current, state.velocity)
    motor_torque = motor.torque_constant * motor.ratio * current
    rotor = _rotor_torque(motor, state)
    return {
        "rotor": rotor,
        "friction": motor_torque - state.torque - rotor,
        "current": current,
        "current_lower": np.minimum(*ends),
        "current_upper": np.maximum(*ends),
        "voltage": voltage,
        "electrical_power": voltage * current,
    }


def _current(motor: Actuator, state: _JointState) -> FloatArray:
    """The current of a motor [A]. At rest, it is the least that holds the joint."""
    acceleration = _of_rotor(motor, state)
    moving = motor.current(state.torque, state.velocity, acceleration)
    holding = motor.holding_current(state.torque)
    least = np.clip(0.0, holding.lower, holding.upper)
    return np.where(state.at_rest, least, moving)


def _limits(
    motor: Actuator, state: _JointState, supply_voltage: float, current_limit: float
) -> Interval:
    """Torques that the drive of a motor can give while it moves and hold at rest."""
    acceleration = _of_rotor(motor, state)
    moving = motor.torque_limits(
        state.velocity, supply_voltage, current_limit, acceleration
    )
    stalled = supply_voltage / motor.parameters.resistance
    most = min(current_limit, stalled)
    return Interval(
        lower=np.where(state.at_rest, motor.holding_torque(-most).lower, moving.lower),
        upper=np.where(state.at_rest, motor.holding_torque(most).upper, moving.upper),
    )


def _rotor_torque(motor: Actuator, state: _JointState) -> FloatArray:
    """What turns the rotor, at the joint [N m, N]; 0 at rest or if it is unknown."""
    armature = (motor.rotor_inertia or 0.0) * motor.ratio**2
    return np.where(state.at_rest, 0.0, armature * state.acceleration)


def _of_rotor(motor: Actuator, state: _JointState) -> FloatArray | None:
    """The acceleration that turns a rotor; None if its inertia is unknown."""
    return None if motor.rotor_inertia is None else state.acceleration
