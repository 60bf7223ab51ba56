"""The keys of an arm file, of each its unit and shape, and the units of values."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from types import MappingProxyType

from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

#: The version of the keys.
FORMAT = 1

_MILLI = Decimal("1e-3")
_DEGREE = math.pi / 180
#: SI unit -> the units that a value may have instead, and their sizes. A decimal size
#: makes of written digits the nearest double.
UNITS: Mapping[str, Mapping[str, Decimal | float]] = {
    "m": {"mm": _MILLI, "cm": Decimal("1e-2")},
    "m/s": {"mm/s": _MILLI},
    "m/s^2": {"mm/s^2": _MILLI},
    "m/s^3": {"mm/s^3": _MILLI},
    "rad": {"deg": _DEGREE},
    "rad/s": {"deg/s": _DEGREE},
    "rad/s^2": {"deg/s^2": _DEGREE},
    "rad/s^3": {"deg/s^3": _DEGREE},
    "N": {"kN": Decimal(1000), "mN": _MILLI},
    "N m": {"N mm": _MILLI, "mN m": _MILLI},
    "kg": {"g": _MILLI},
    "m^3": {
        "L": _MILLI,
        "mL": Decimal("1e-6"),
        "cm^3": Decimal("1e-6"),
        "mm^3": Decimal("1e-9"),
    },
    "kg m^2": {
        "kg mm^2": Decimal("1e-6"),
        "g cm^2": Decimal("1e-7"),
        "g mm^2": Decimal("1e-9"),
    },
    "V": {"mV": _MILLI},
    "A": {"mA": _MILLI},
    "Ohm": {"mOhm": _MILLI},
    "H": {"mH": _MILLI, "uH": Decimal("1e-6")},
    "N m/A": {"mN m/A": _MILLI},
    "V s/rad": {"mV s/rad": _MILLI},
    "N m s/rad": {"mN m s/rad": _MILLI},
    "1": {"%": Decimal("1e-2")},
}
#: Signs between the parts of a unit: "N m", "N.m", "N*m" and "N·m" are the same.
_BETWEEN = re.compile(r"\s*[.*·]\s*|\s+")


@dataclass(frozen=True)
class Key:
    """A key with a number, three numbers or a 3x3 tensor.

    Attributes:
        unit: Its SI unit, one of `UNITS`.
        about: What it is, for the comment in a file.
        shape: ``()``, ``(3,)`` or ``(3, 3)``.
        positive: Whether the number is never below 0, so that its half width is at most
            the number itself.
    """

    unit: str
    about: str
    shape: tuple[int, ...] = ()
    positive: bool = False

    @property
    def units(self) -> Mapping[str, Decimal | float]:
        """The units that the value may have, the SI unit first, and their sizes."""
        return {self.unit: Decimal(1), **UNITS[self.unit]}

    def unit_of(self, text: str) -> str | None:
        """The unit that a text means; None if the value cannot have it."""
        spelt = _BETWEEN.sub(" ", text.strip())
        for unit in self.units:
            if spelt in (unit, unit.replace(" ", "")):
                return unit
        return None


def _size(unit: str, about: str) -> Key:
    """A key with a number that is never below 0."""
    return Key(unit, about, positive=True)


def _vector(unit: str, about: str) -> Key:
    return Key(unit, about, shape=(3,))


def _limits(length: str, effort: str, of_effort: str) -> Mapping[str, Key]:
    """Of a joint whose positions have the unit ``length``."""
    return MappingProxyType(
        {
            "min_position": Key(length, "lower end of the range"),
            "max_position": Key(length, "upper end of the range"),
            "max_velocity": _size(f"{length}/s", "largest speed"),
            "max_acceleration": _size(f"{length}/s^2", "largest acceleration"),
            "max_jerk": _size(f"{length}/s^3", "largest jerk"),
            "max_effort": _size(effort, of_effort),
        }
    )


_BODY = {
    "mass": _size("kg", "mass"),
    "com": _vector("m", "centre of mass"),
    "inertia": Key("kg m^2", "at the COM, products as in URDF", shape=(3, 3)),
    "volume": _size("m^3", "displaced volume"),
    "cob": _vector("m", "centre of buoyancy"),
}
MOUNT: Mapping[str, Key] = {
    "xyz": _vector("m", "origin of base_link in the parent"),
    "rpy": _vector("rad", "roll, pitch, yaw of base_link in the parent"),
}
LENGTHS: Mapping[str, Key] = {
    name: Key("m", "of Table 1") for name in ("a_0", "d_0", "a_1", "a_2", "d_3")
}
ZEROS: Mapping[str, Key] = {
    name: Key("rad", "added to the joint's angle") for name in JOINT_NAMES[:4]
}
JOINT_LIMITS: Mapping[str, Mapping[str, Key]] = {
    **dict.fromkeys(JOINT_NAMES[:4], _limits("rad", "N m", "largest torque")),
    JOINT_NAMES[4]: _limits("m", "N", "largest force"),
}
LINKS: Mapping[str, Mapping[str, Key]] = dict.fromkeys(BODY_NAMES, _BODY)
ATTACHED: Mapping[str, Key] = {
    "at": _vector("m", "origin of the body's frame in the link"),
    "rpy": _vector("rad", "its roll, pitch, yaw in the link"),
    "spacer": _size("m", "moves jaws and tool along -z of link_4"),
    **_BODY,
}
TOOL: Mapping[str, Key] = {
    "xyz": _vector("m", "tool point in link_4, jaws along -z"),
    "rpy": _vector("rad", "roll, pitch, yaw of the tcp in link_4"),
}
SUPPLY_VOLTAGE = _size("V", "of all motors")
#: What Table 4 does not print, one value for each joint.
DRIVES: Mapping[str, Key] = {
    "current_limit": _size("A", "of the driver"),
    "rotor_inertia": _size("kg m^2", "at the motor shaft"),
    "friction_backward": _size("N m", "while the joint turns backward"),
    "viscous_friction": _size("N m s/rad", "per motor speed"),
}
#: The columns of Table 4, fields of `ActuatorParameters`.
ACTUATORS: Mapping[str, Key] = {
    "resistance": _size("Ohm", "of the winding"),
    "inductance": _size("H", "of the winding"),
    "friction": _size("N m", "at the motor shaft"),
    "friction_tolerance": _size("1", "of the friction"),
    "efficiency": _size("1", "highest one of the gearbox"),
    "torque_constant": _size("N m/A", "torque per current"),
    "voltage_constant": _size("V s/rad", "voltage per motor speed"),
    "gear_ratio": _size("1", "motor turns per output turn"),
}
#: The tables and keys of a file.
TOP = (
    "format",
    "name",
    "corrections",
    "mount",
    "lengths",
    "zeros",
    "signs",
    "joint_limits",
    "links",
    "attached",
    "tool",
    "motors",
    "covariance",
)
#: The keys of ``[covariance]``, which a calibration writes.
COVARIANCE = ("names", "deviation", "factor")
#: Key of a limit -> field of `JointParameters`.
LIMIT_FIELDS: Mapping[str, str] = {
    "min_position": "lower",
    "max_position": "upper",
    "max_velocity": "velocity",
    "max_acceleration": "acceleration",
    "max_jerk": "jerk",
    "max_effort": "effort",
}
#: Key of a drive -> field of `Motors`.
DRIVE_FIELDS: Mapping[str, str] = {
    "current_limit": "current_limits",
    "rotor_inertia": "rotor_inertias",
    "friction_backward": "backward_frictions",
    "viscous_friction": "viscous_frictions",
}


def _numbers() -> tuple[str, ...]:
    """`NUMBERS`."""
    components = {
        (): ("",),
        (3,): (".x", ".y", ".z"),
        (3, 3): (".xx", ".xy", ".xz", ".yy", ".yz", ".zz"),
    }
    found = []
    for link in BODY_NAMES:
        for name in ("mass", "com", "inertia", "volume", "cob"):
            ends = components[_BODY[name].shape]
            found += [f"links.{link}.{name}{end}" for end in ends]
    found += [f"zeros.{name}" for name in ZEROS]
    found += [f"lengths.{name}" for name in LENGTHS]
    return tuple(found)


#: The numbers that a covariance may be of, one name for each component.
NUMBERS = _numbers()
