"""Units of an arm file, and the exact way from a written number to SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal

from alpha5_model.numbers import plausibility
from alpha5_model.numbers.plausibility import Plausible

#: Unit that is not a power of ten of the SI unit -> its size.
_FACTORS = {"deg": math.pi / 180, "deg/s": math.pi / 180}
#: Signs between the parts of a unit that make no difference: "Nm", "kg.m^2".
_BETWEEN = str.maketrans("", "", " .*·")


@dataclass(frozen=True)
class Dimension:
    """What kind of quantity a number is.

    Attributes:
        units: The units that it may be given in, the SI unit first -> power of ten of
            the SI unit; of no meaning for degrees.
        plausible: Its plausible values; None for any.
    """

    units: Mapping[str, int]
    plausible: Plausible | None = field(default=None, compare=False)

    @property
    def si(self) -> str:
        """The SI unit."""
        return next(iter(self.units))

    def unit(self, given: str) -> str | None:
        """The unit that is meant, however it is spelt; None for another one."""
        for unit in self.units:
            if unit.translate(_BETWEEN) == given.translate(_BETWEEN):
                return unit
        return None

    def in_si(self, number: Decimal, unit: str) -> float:
        """The double nearest to a written number in SI units.

        Args:
            number: As written, finite.
            unit: One of `units`.
        """
        if unit in _FACTORS:
            return float(number) * _FACTORS[unit]
        sign, digits, exponent = number.as_tuple()
        assert isinstance(exponent, int)  # finite, says the caller
        return float(Decimal((sign, digits, exponent + self.units[unit])))

    def likely_unit(self, magnitude: float) -> str | None:
        """The unit that an implausible number was probably written in.

        Args:
            magnitude: In SI units.
        """
        if self.plausible is None or self.plausible.holds(magnitude):
            return None
        for unit, power in self.units.items():
            if self.plausible.holds(magnitude * _FACTORS.get(unit, 10.0**power)):
                return unit
        return None


_LENGTHS = {"m": 0, "mm": -3, "cm": -2}
_TORQUES = {"N m": 0, "N mm": -3, "mN m": -3}
_INERTIAS = {"kg m^2": 0, "kg mm^2": -6, "g cm^2": -7, "g mm^2": -9}
#: A hundred times the jaw rod's 3 mm/s.
_ROD_SPEED = Plausible(unit="m/s", ranges=((0.0, 0.3),), expected="at most 0.3")
#: Ten times the 9 N m of the public models; the shoulder stalls at about 98 N m.
_JOINT_TORQUE = Plausible(unit="N m", ranges=((0.0, 98.0),), expected="at most 98")
#: A hundred times the 10 N of the public models.
_ROD_FORCE = Plausible(unit="N", ranges=((0.0, 1000.0),), expected="at most 1000")
#: At 100 rad/s of the motor, the largest plausible friction of a motor.
_VISCOUS_FRICTION = Plausible(
    unit="N m s/rad", ranges=((0.0, 0.01),), expected="at most 0.01"
)
#: A share of the power, so not above 1.
_SHARE = Plausible(unit="", ranges=((0.0, 1.0),), expected="at most 1")
#: Name -> dimension, for the schema.
DIMENSIONS = {
    "length": Dimension(_LENGTHS, plausibility.POSITION),
    "mount length": Dimension(_LENGTHS, plausibility.VEHICLE_POSITION),
    "jaw length": Dimension(_LENGTHS, plausibility.JAW_LENGTH),
    "angle": Dimension({"rad": 0, "deg": 0}, plausibility.ANGLE),
    "speed": Dimension({"rad/s": 0, "deg/s": 0}, plausibility.ANGULAR_SPEED),
    "rod speed": Dimension({"m/s": 0, "mm/s": -3}, _ROD_SPEED),
    "torque": Dimension(_TORQUES, _JOINT_TORQUE),
    "force": Dimension({"N": 0, "kN": 3, "mN": -3}, _ROD_FORCE),
    "mass": Dimension({"kg": 0, "g": -3}, plausibility.MASS),
    "volume": Dimension(
        {"m^3": 0, "L": -3, "mL": -6, "cm^3": -6, "mm^3": -9}, plausibility.VOLUME
    ),
    "inertia": Dimension(_INERTIAS),
    "rotor inertia": Dimension(_INERTIAS, plausibility.ROTOR_INERTIA),
    "voltage": Dimension({"V": 0, "mV": -3}, plausibility.SUPPLY_VOLTAGE),
    "current": Dimension({"A": 0, "mA": -3}, plausibility.CURRENT_LIMIT),
    "resistance": Dimension({"Ohm": 0, "mOhm": -3}, plausibility.RESISTANCE),
    "inductance": Dimension({"H": 0, "mH": -3, "uH": -6}, plausibility.INDUCTANCE),
    "friction": Dimension(_TORQUES, plausibility.MOTOR_FRICTION),
    "viscous friction": Dimension(
        {"N m s/rad": 0, "mN m s/rad": -3}, _VISCOUS_FRICTION
    ),
    "torque constant": Dimension(
        {"N m/A": 0, "mN m/A": -3}, plausibility.MOTOR_CONSTANT
    ),
    "voltage constant": Dimension(
        {"V s/rad": 0, "mV s/rad": -3}, plausibility.MOTOR_CONSTANT
    ),
    "share": Dimension({"1": 0, "%": -2}, _SHARE),
    "number": Dimension({"1": 0}),
}
