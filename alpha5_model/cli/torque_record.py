"""The torques at one state as a record, in SI units and ready for JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.cli.options import beyond_limits
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.errors import MissingParameterError
from alpha5_model.numbers.hydrodynamics import LEVELS

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

Record: TypeAlias = dict[str, Any]

#: The causes of a torque in still water, as `torque_terms` of an arm names them.
TERMS = ("inertia", "coriolis", "weight", "buoyancy")
_NOMINAL = LEVELS.index("nominal")


class State(NamedTuple):
    """Position, velocity and acceleration of each joint, base to tip."""

    q: list[float]
    v: list[float]
    a: list[float]


class _MovingWater(NamedTuple):
    """What moving water adds, for each level of `LEVELS`.

    Attributes:
        torque: Of each joint, (3, n) [N m, N].
        wrench: Load on the mount, (3, 6) [N, N m].
    """

    torque: FloatArray
    wrench: FloatArray


class _MotorCurrent(NamedTuple):
    """Current of a motor and its interval [A]; None if they are unknown."""

    value: Any
    ends: list[Any] | None


def torque_record(
    arm: Arm,
    state: State,
    constants: str | None,
    efficiency: str,
    water_velocity: list[float] | None,
) -> Record:
    """Torques by cause, motor currents, and the load on the mount.

    Args:
        constants, efficiency: Of the motors, see
            `alpha5_model.dynamics.actuators.actuator`.
        water_velocity: In base_link [m/s]; None for still water.
    """
    from alpha5_model.studies.uncertainty.digit_bounds import torque_margin

    torque = arm.inverse_dynamics(*state)
    causes = _causes(arm, state)
    wrench = arm.base_wrench(*state).vector
    water = None
    if water_velocity is not None:
        water = _moving_water(arm, state, water_velocity)
    if water is not None:
        torque = torque + water.torque[_NOMINAL]
        wrench = wrench + water.wrench[_NOMINAL]

    actuators = [
        actuator(joint, constants, efficiency=efficiency, arm=arm.parameters)
        for joint in arm.joint_names
    ]
    currents = _motor_currents(actuators, torque, state)
    margin = torque_margin(arm, *state)
    columns: dict[str, Iterable[Any]] = {
        "joint": arm.joint_names,
        "position": state.q,
        "velocity": state.v,
        "acceleration": state.a,
        **causes,
        **_water_columns(water),
        "torque": torque,
        "torque_range": (torque + margin).T,
        "current": [current.value for current in currents],
        "current_range": [current.ends for current in currents],
        "within_limits": _within_limits(arm, state.q),
    }
    record = {
        "fluid_density": arm.fluid_density,
        "payload_kg": arm.payload_mass,
        "gravity": arm.model.gravity.linear,
        "water_current": water_velocity,
        "constants": actuators[0].constants,
        "efficiency": efficiency,
        "joints": _rows(columns),
        "self_collision": _self_collision(arm, state.q),
        "mount": _mount(wrench, water),
    }
    return {key: value for key, value in record.items() if value is not None}


def _self_collision(arm: Arm, q: list[float]) -> Record | None:
    """Where the arm touches itself, as far as it is compared; None if it does not."""
    if not arm.in_collision(q):
        return None
    links, distance = arm.closest_links(q)
    return {"links": links, "depth": max(0.0, -distance)}


def _causes(arm: Arm, state: State) -> dict[str, FloatArray]:
    """Torque of each joint by cause, in still water."""
    from alpha5_model.dynamics.torque_causes import torque_terms

    terms = torque_terms(arm, *state, threads=1)
    causes = {}
    for term in TERMS:
        (causes[term],) = getattr(terms, term)
    return causes


def _moving_water(arm: Arm, state: State, water_velocity: list[float]) -> _MovingWater:
    from alpha5_model.water.terms import water_terms

    q, v, a = (np.array([numbers]) for numbers in state)
    terms = water_terms(arm, q, v, a, water_velocity)
    (torque,) = terms.torque
    (wrench,) = terms.wrench
    return _MovingWater(torque=torque, wrench=wrench)


def _water_columns(water: _MovingWater | None) -> dict[str, FloatArray]:
    if water is None:
        return {}
    low = water.torque.min(axis=0)
    high = water.torque.max(axis=0)
    return {
        "moving_water": water.torque[_NOMINAL],
        "moving_water_range": np.stack([low, high], axis=1),
    }


def _motor_currents(
    actuators: Sequence[Actuator], torque: FloatArray, state: State
) -> list[_MotorCurrent]:
    loads = zip(actuators, torque, state.v, state.a, strict=True)
    return [_motor_current(*load) for load in loads]


def _motor_current(
    motor: Actuator, torque: float, speed: float, acceleration: float
) -> _MotorCurrent:
    turning = None if motor.rotor_inertia is None else acceleration
    try:
        if speed:
            interval = motor.current_interval(torque, speed, turning)
        else:
            interval = motor.holding_current(torque)
        current = motor.current(torque, speed, turning)
        return _MotorCurrent(value=current, ends=[*interval])
    except MissingParameterError:  # the jaw rod's screw lead is not published
        return _MotorCurrent(value=None, ends=None)


def _within_limits(arm: Arm, q: list[float]) -> list[bool]:
    beyond = beyond_limits(arm, q)
    return [name not in beyond for name in arm.joint_names]


def _rows(columns: dict[str, Iterable[Any]]) -> list[Record]:
    """One record per joint, from columns with one value per joint."""
    rows = zip(*columns.values(), strict=True)
    return [dict(zip(columns, row, strict=True)) for row in rows]


def _mount(wrench: FloatArray, water: _MovingWater | None) -> Record:
    load = _load(wrench)
    if water is not None:
        levels = zip(LEVELS, water.wrench, strict=True)
        load["moving_water"] = {level: _load(part) for level, part in levels}
    return load


def _load(wrench: FloatArray) -> Record:
    return {"force": wrench[:3], "moment": wrench[3:]}
