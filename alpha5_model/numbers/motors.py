"""What drives the arm and Table 4 does not print, and what it adds to the joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from alpha5_model._support.checks import choice, fill, listed, real
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import JOINT_NAMES

#: Which of the contradicting motor constants are believed.
CONSTANTS = ("printed", "torque", "voltage")
#: Field of `Motors` with a value for each joint -> its plausible values.
_LIMITS = {
    "current_limits": plausibility.CURRENT_LIMIT,
    "rotor_inertias": plausibility.ROTOR_INERTIA,
    "backward_frictions": plausibility.MOTOR_FRICTION,
    "viscous_frictions": plausibility.VISCOUS_FRICTION,
}
#: No value for any joint.
_UNKNOWN: tuple[None, ...] = (None,) * len(JOINT_NAMES)


@dataclass(frozen=True, eq=False)
class Motors:
    """Supply and drivers of the motors. None is a value that is not known.

    Attributes:
        supply_voltage: [V].
        current_limits: Of the drivers, ``axis_e`` to ``axis_a``, 5 values [A].
        rotor_inertias: Rotor and first gear stage at the motor shaft, 5 values
            [kg m^2].
        backward_frictions: Friction at the motor shaft while the joint turns backward,
            5 values [N m]; None for the friction of Table 4, which is then that of both
            directions.
        viscous_frictions: At the motor shaft, per motor speed, 5 values [N m s/rad].
        constants: Which of the contradicting motor constants of the actuators are
            believed: ``printed``, ``torque`` or ``voltage``, see
            `alpha5_model.actuators`.

    Raises:
        InputError: Not 5 values, a negative inertia, or another value not above 0.
        UnknownNameError: No such choice of constants.

    Warns:
        ImplausibleWarning: Values that seem to be in another unit.
    """

    supply_voltage: float | None = None
    current_limits: tuple[float | None, ...] = _UNKNOWN
    rotor_inertias: tuple[float | None, ...] = _UNKNOWN
    constants: str = "printed"
    backward_frictions: tuple[float | None, ...] = _UNKNOWN
    viscous_frictions: tuple[float | None, ...] = _UNKNOWN

    def __post_init__(self) -> None:
        choice("motors.constants", self.constants, CONSTANTS)
        if self.supply_voltage is not None:
            supply = real("supply_voltage", self.supply_voltage, 0.0, strict=True)
            plausibility.check("supply_voltage", supply, plausibility.SUPPLY_VOLTAGE)
            fill(self, supply_voltage=supply)
        for name, limits in _LIMITS.items():
            strict = name == "current_limits"  # a driver without current drives nothing
            values = _per_joint(name, getattr(self, name), strict)
            for i, value in enumerate(values):
                if value is not None:
                    plausibility.check(f"{name}[{i}]", value, limits)
            fill(self, **{name: values})


def _per_joint(
    name: str, given: tuple[float | None, ...], strict: bool
) -> tuple[float | None, ...]:
    """Five checked values; ``strict`` refuses 0."""
    expected = f"5 values, {JOINT_NAMES[0]} to {JOINT_NAMES[-1]}"
    values = listed(name, given, expected)
    if len(values) != len(JOINT_NAMES):
        raise InputError(name, len(values), expected)
    return tuple(
        None if value is None else real(f"{name}[{i}]", value, 0.0, strict=strict)
        for i, value in enumerate(values)
    )


class JointLosses(NamedTuple):
    """What a motor adds to a joint.

    Attributes:
        armature: Rotor inertia at the joint [kg m^2].
        friction: Coulomb friction at the joint, the mean of both directions [N m].
        damping: Viscous friction at the joint [N m s/rad].
    """

    armature: float
    friction: float
    damping: float


def joint_losses(arm: Any) -> dict[str, JointLosses]:
    """Joint -> what its motor adds, for the joints of which something was measured.

    Table 4's friction is left out: it is not measured, and a public driver contradicts
    it. The jaw rod is left out, whose screw lead is not known.

    Args:
        arm: An `Alpha5Parameters`.
    """
    found = {}
    printed = published().table_4.rows
    for k, joint in enumerate(arm.joints[:4]):
        actuator = arm.actuators[k]
        backward = arm.motors.backward_frictions[k]
        is_own = backward is not None or actuator.friction != printed[k].friction.si
        other = actuator.friction if backward is None else backward
        friction = (actuator.friction + other) / 2 if is_own else 0.0

        gear = actuator.gear_ratio
        losses = JointLosses(
            armature=(arm.motors.rotor_inertias[k] or 0.0) * gear**2,
            friction=friction * gear,
            damping=(arm.motors.viscous_frictions[k] or 0.0) * gear**2,
        )
        if any(losses):
            found[joint.name] = losses
    return found
