"""The keys of an arm file: of each its dimension, shape and least value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from alpha5_model.numbers.arm_units import DIMENSIONS, Dimension
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES


@dataclass(frozen=True)
class Key:
    """A key with a number, three numbers or a 3x3 tensor.

    Attributes:
        dimension_name: Of `DIMENSIONS`.
        about: What it is, for the comment in a file.
        shape: ``()``, ``(3,)`` or ``(3, 3)``.
        least: The number must be at least this; None for any.
        above: Whether it must be above ``least``.
    """

    dimension_name: str
    about: str
    shape: tuple[int, ...] = ()
    least: float | None = None
    above: bool = True

    @property
    def dimension(self) -> Dimension:
        """Its dimension."""
        return DIMENSIONS[self.dimension_name]

    def takes(self, number: float) -> bool:
        """Whether a file may say a number, in SI units: an arm of this size has it."""
        plausible = self.dimension.plausible
        return plausible is None or plausible.holds(abs(number))


def _positive(dimension: str, about: str) -> Key:
    return Key(dimension, about, least=0.0)


def _not_negative(dimension: str, about: str) -> Key:
    return Key(dimension, about, least=0.0, above=False)


def _vector(dimension: str, about: str) -> Key:
    return Key(dimension, about, shape=(3,))


_BODY = {
    "com": _vector("length", "centre of mass"),
    "inertia": Key("inertia", "at the COM, products as in URDF", shape=(3, 3)),
    "cob": _vector("length", "centre of buoyancy"),
}
_TURNING = {
    "min_position": Key("angle", "lower end of the range"),
    "max_position": Key("angle", "upper end of the range"),
    "max_velocity": _positive("speed", "largest speed"),
    "max_effort": _positive("torque", "largest torque"),
}
_SLIDING = {
    "min_position": Key("jaw length", "lower end of the range, jaws closed"),
    "max_position": Key("jaw length", "upper end of the range"),
    "max_velocity": _positive("rod speed", "largest speed"),
    "max_effort": _positive("force", "largest force"),
}
#: Key of a limit -> field of `JointParameters`.
LIMIT_FIELDS: Mapping[str, str] = {
    "min_position": "lower",
    "max_position": "upper",
    "max_velocity": "velocity",
    "max_effort": "effort",
}
#: Key of a drive -> field of `Motors`.
DRIVE_FIELDS: Mapping[str, str] = {
    "current_limit": "current_limits",
    "rotor_inertia": "rotor_inertias",
    "friction_backward": "backward_frictions",
    "viscous_friction": "viscous_frictions",
}
MOUNT: Mapping[str, Key] = {
    "xyz": _vector("mount length", "origin of base_link in the parent"),
    "rpy": _vector("angle", "roll, pitch, yaw of base_link in the parent"),
}
LENGTHS: Mapping[str, Key] = {
    name: Key("length", "of Table 1") for name in ("a_0", "d_0", "a_1", "a_2", "d_3")
}
ZEROS: Mapping[str, Key] = {
    name: Key("angle", "added to the joint's angle") for name in JOINT_NAMES[:4]
}
JOINT_LIMITS: Mapping[str, Mapping[str, Key]] = {
    name: _SLIDING if name == "axis_a" else _TURNING for name in JOINT_NAMES
}
LINKS: Mapping[str, Mapping[str, Key]] = {
    name: {
        "mass": _positive("mass", "mass"),
        "volume": _positive("volume", "displaced volume"),
        **_BODY,
    }
    for name in BODY_NAMES
}
ATTACHED: Mapping[str, Key] = {
    "at": _vector("length", "origin of the body's frame in the link"),
    "rpy": _vector("angle", "its roll, pitch, yaw in the link"),
    "spacer": _not_negative("jaw length", "moves jaws and tool along -z of link_4"),
    "mass": _not_negative("mass", "mass"),
    "volume": _not_negative("volume", "displaced volume"),
    **_BODY,
}
TOOL: Mapping[str, Key] = {
    "xyz": _vector("length", "tool point in link_4, jaws along -z"),
    "rpy": _vector("angle", "roll, pitch, yaw of the tcp in link_4"),
}
#: Fields of `ActuatorParameters`; as for the two after it, there is one for each joint.
ACTUATORS: Mapping[str, Key] = {
    "resistance": _positive("resistance", "of the winding"),
    "inductance": _not_negative("inductance", "of the winding"),
    "friction": _not_negative("friction", "at the motor shaft"),
    "friction_tolerance": _not_negative("share", "of the friction"),
    "efficiency": _positive("share", "highest one of the gearbox"),
    "torque_constant": _positive("torque constant", "torque per current"),
    "voltage_constant": _positive("voltage constant", "voltage per motor speed"),
    "gear_ratio": _positive("number", "motor turns per output turn"),
}
DRIVES: Mapping[str, Key] = {
    "current_limit": _positive("current", "of the driver"),
    "rotor_inertia": _not_negative("rotor inertia", "at the motor shaft"),
    "friction_backward": _not_negative("friction", "while the joint turns backward"),
    "viscous_friction": _not_negative("viscous friction", "per motor speed"),
}
SUPPLY_VOLTAGE = _positive("voltage", "of all motors")


def _components(key: Key) -> tuple[str, ...]:
    """Ends of the names of a key's numbers: none, or its components."""
    if not key.shape:
        return ("",)
    if len(key.shape) == 1:
        return (".x", ".y", ".z")
    return (".xx", ".xy", ".xz", ".yy", ".yz", ".zz")


def _numbers() -> tuple[str, ...]:
    """`NUMBERS`."""
    found = []
    for link, keys in LINKS.items():
        for name in ("mass", "com", "inertia", "volume", "cob"):
            stem = f"links.{link}.{name}"
            found += [f"{stem}{end}" for end in _components(keys[name])]
    found += [f"zeros.{name}" for name in ZEROS]
    found += [f"lengths.{name}" for name in LENGTHS]
    return tuple(found)


#: The numbers that a covariance may be of, one name for each component.
NUMBERS = _numbers()
#: The version of the keys.
FORMAT = 1
#: The tables and keys of a file.
TOP = (
    "format",
    "name",
    "corrections",
    "mount",
    "lengths",
    "zeros",
    "joint_limits",
    "links",
    "attached",
    "tool",
    "motors",
    "covariance",
)
#: The keys of ``[covariance]``, which a calibration writes.
COVARIANCE = ("names", "deviation", "factor")
#: What people write -> what to do instead.
HINTS = {
    "max_acceleration": "the record has no limit of acceleration: leave it out",
    "min_velocity": "the limit holds both ways: write max_velocity",
    "lower": "write min_position",
    "upper": "write max_position",
    "velocity": "write max_velocity",
    "effort": "write max_effort",
    "has_position_limits": "limits that are given hold: leave it out",
    "has_velocity_limits": "limits that are given hold: leave it out",
    "has_effort_limits": "limits that are given hold: leave it out",
    "has_acceleration_limits": "limits that are given hold: leave it out",
    "weight": "write mass",
    "position": "write xyz",
    "rotation": "write rpy (roll, pitch, yaw)",
    "orientation": "write rpy (roll, pitch, yaw)",
}
#: Keys that would turn or shift axes in ways that Table 1 has not.
TWISTS = ("alpha", "twist", "d_1", "d_2", "d_4", "a_3", "a_4")
