"""A calibrated motor, and the arm's record with it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.numbers.tables import JOINT_NAMES

#: Half width of a 95 % interval in standard deviations.
WIDE = 1.96
#: Keys of an arm file that a calibration replaces.
_KEYS = (
    "torque_constant",
    "friction",
    "friction_tolerance",
    "efficiency",
    "friction_backward",
    "viscous_friction",
    "rotor_inertia",
)


class MotorProblem(NamedTuple):
    """Something that the currents contradict, or do not tell.

    Attributes:
        name: ``fluid`` or ``gravity``, the wrong one; ``uncertain`` for estimates whose
            half widths exceed them.
        message: What it is, in words.
    """

    name: str
    message: str

    def __str__(self) -> str:
        return f"{self.name}: {self.message}"


class JointMotor(NamedTuple):
    """What the currents say of a joint's motor, at the joint.

    Attributes:
        name: Of the joint.
        friction_forward, friction_backward: Current that Coulomb friction takes, with
            a zero of the current in it [A]; like viscous and armature, below 0 if noise
            makes it so.
        friction_deviation: Standard deviation of both [A].
        viscous: Current per joint speed [A s/rad].
        viscous_deviation: Of that.
        armature: Current per joint acceleration, for the rotor [A s^2/rad].
        armature_deviation: Of that.
        torque_per_ampere: K_t times the gear ratio [N m/A].
        relative_deviation: Standard deviation of that over it, by the data.
        known: Whether the data tell torque_per_ampere; else it is the arm's own.
        noise: Standard deviation of the current that is not explained [A].
    """

    name: str
    friction_forward: float
    friction_backward: float
    friction_deviation: float
    viscous: float
    viscous_deviation: float
    armature: float
    armature_deviation: float
    torque_per_ampere: float
    relative_deviation: float
    known: bool
    noise: float

    def __str__(self) -> str:
        relative = 100 * WIDE * self.relative_deviation
        by = f"± {relative:.0f} %" if self.known else "by the arm's record"
        return (
            f"{self.name}: friction {1e3 * self.friction_forward:.1f} and "
            f"{1e3 * self.friction_backward:.1f} "
            f"± {1e3 * WIDE * self.friction_deviation:.1f} mA, "
            f"viscous {1e3 * self.viscous:.1f} "
            f"± {1e3 * WIDE * self.viscous_deviation:.1f} mA s/rad, "
            f"rotor {1e3 * self.armature:.1f} "
            f"± {1e3 * WIDE * self.armature_deviation:.1f} mA s^2/rad, "
            f"K_t gear {self.torque_per_ampere:.2f} N m/A {by}"
        )


def with_motors(
    arm: Alpha5Parameters, joints: Iterable[JointMotor], source: str
) -> Alpha5Parameters:
    """The arm's record with calibrated motors of axis_e to axis_b.

    Their gears have no loss that grows with the load: it is part of the torque
    constant. If the record believes K_v for torque, K_t is measured now.

    Args:
        arm: The record.
        joints: Calibrated.
        source: Of the recording.
    """
    actuators = list(arm.actuators)
    drives: dict[str, list[Any]] = {
        "rotor_inertias": list(arm.motors.rotor_inertias),
        "backward_frictions": list(arm.motors.backward_frictions),
        "viscous_frictions": list(arm.motors.viscous_frictions),
    }
    measurements: list[Measurement] = []
    replaced: set[str] = set()
    for joint in joints:
        k = JOINT_NAMES.index(joint.name)
        gear = actuators[k].gear_ratio
        constant = joint.torque_per_ampere / gear
        # Friction that drives the joint is none, nor is an inertia below 0.
        forward = max(joint.friction_forward, 0.0)
        tolerance = WIDE * joint.friction_deviation / max(forward, 1e-12)
        actuators[k] = replace(
            actuators[k],
            torque_constant=constant,
            friction=constant * forward,
            friction_tolerance=min(tolerance, 1.0),
            efficiency=1.0,
        )
        drives["backward_frictions"][k] = constant * max(joint.friction_backward, 0.0)
        drives["viscous_frictions"][k] = constant * max(joint.viscous, 0.0) / gear
        drives["rotor_inertias"][k] = constant * max(joint.armature, 0.0) / gear
        # Whose loss is in the torque constant.
        measurements.append(
            Measurement(key=f"motors.efficiency.{joint.name}", half_width=0.0)
        )
        replaced |= {f"motors.{key}.{joint.name}" for key in _KEYS}
        if joint.known:
            measurement = Measurement(
                key=f"motors.torque_constant.{joint.name}",
                source=f"currents of {source}",
                half_width=min(WIDE * joint.relative_deviation, 1.0) * constant,
            )
            measurements.append(measurement)

    own: dict[str, Any] = {name: tuple(values) for name, values in drives.items()}
    constants = "printed" if arm.motors.constants == "voltage" else arm.motors.constants
    kept = [one for one in arm.measurements if one.key not in replaced]
    return replace(
        arm,
        actuators=tuple(actuators),
        motors=replace(arm.motors, constants=constants, **own),
        measurements=(*kept, *measurements),
    )
