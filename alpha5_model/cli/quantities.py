"""Numbers of the command line: each has a quantity, and only units of that quantity."""

from __future__ import annotations

import math
import warnings
from argparse import ArgumentTypeError
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from alpha5_model.errors import ImplausibleWarning
from alpha5_model.numbers import arm_schema, plausibility


@dataclass(frozen=True)
class Quantity:
    """What a number is.

    Attributes:
        si: Its SI unit, for messages.
        units: Unit that may follow the number -> its size in SI units.
        plausible: A number without a unit that lies outside causes a warning.
        largest: A larger magnitude is a typing error.
    """

    si: str
    units: Mapping[str, float] = field(default_factory=dict)
    plausible: plausibility.Plausible | None = None
    largest: float = math.inf


_DEGREE = math.pi / 180
_ANGLES = {"rad": 1.0, "deg": _DEGREE}


def _sizes(unit: str) -> dict[str, float]:
    """An SI unit and those of an arm file in its place -> their sizes."""
    sizes = {name: float(size) for name, size in arm_schema.UNITS[unit].items()}
    return {unit: 1.0, **sizes}


_LENGTHS = _sizes("m")

ANGLE = Quantity("rad", _ANGLES, plausibility.ANGLE)
LENGTH = Quantity("m", _LENGTHS, plausibility.POSITION)
#: A length of any arm: 5 m are as plausible as 5 mm.
SIZE = Quantity("m", _LENGTHS)
ANGLE_OR_LENGTH = Quantity("rad or m", {**_ANGLES, **_LENGTHS})
ANGULAR_SPEED = Quantity(
    "rad/s", {"rad/s": 1.0, "deg/s": _DEGREE, **_ANGLES}, plausibility.ANGLE
)
ANGULAR_ACCELERATION = Quantity(
    "rad/s^2", {"rad/s^2": 1.0, "deg/s^2": _DEGREE, **_ANGLES}, plausibility.ANGLE
)
SPEED = Quantity("m/s", {"m/s": 1.0, "mm/s": 1e-3, **_LENGTHS}, largest=100.0)
ACCELERATION = Quantity("m/s^2", {"m/s^2": 1.0, "mm/s^2": 1e-3, **_LENGTHS})
GRAVITY = Quantity("m/s^2", {"m/s^2": 1.0}, largest=1e4)
MASS = Quantity("kg", _sizes("kg"))
VOLUME = Quantity("m^3", _sizes("m^3"))
DENSITY = Quantity("kg/m^3", {"kg/m^3": 1.0}, largest=1e5)
CURRENT = Quantity("A", _sizes("A"))
VOLTAGE = Quantity("V", _sizes("V"))
TIME = Quantity("s", {"s": 1.0, "ms": 1e-3})
FREQUENCY = Quantity("Hz", {"Hz": 1.0})
#: Of a controller. Hz would leave open whether a turn is meant.
ANGULAR_FREQUENCY = Quantity("rad/s", {"rad/s": 1.0})
NUMBER = Quantity("")

#: All units that may follow a number, or stand alone after several, for all of them
#: that it fits; the longest first.
UNITS = sorted(
    {
        unit
        for quantity in (
            *(ANGLE, ANGULAR_SPEED, ANGULAR_ACCELERATION),
            *(LENGTH, SPEED, ACCELERATION, MASS, VOLUME, DENSITY),
            *(CURRENT, VOLTAGE, TIME, FREQUENCY),
        )
        for unit in quantity.units
    },
    key=lambda unit: (-len(unit), unit),
)
_COUNTS = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five"}


class Vector:
    """The type of an option or argument that is several numbers, for argparse.

    The numbers are one word, with spaces or commas between them. A unit follows its
    number, or stands alone at the end: then it is that of all numbers without one whose
    quantity has it.

    Args:
        quantities: Of each number.
        counts: How many numbers there may be, if fewer are possible; None for any
            count of numbers of the one quantity.
        named: Words that may stand in place of the numbers.
        expected: In words, for the error; made from the others if empty.
    """

    def __init__(
        self,
        *quantities: Quantity,
        counts: Sequence[int] | None = (),
        named: Sequence[str] = (),
        expected: str = "",
    ) -> None:
        self.quantities = quantities
        self.counts = None if counts is None else tuple(counts) or (len(quantities),)
        self.named = tuple(named)
        self.expected = expected or self._in_words()

    def __call__(self, text: str) -> Any:
        """The numbers in SI units, or one of the words.

        Raises:
            ArgumentTypeError: Other words, units or counts.
        """
        if text.strip() in self.named:
            return text.strip()
        parts, unit = _parts(text)
        quantities = self.quantities
        if self.counts is None:
            quantities *= len(parts)
        fits = any(unit in quantity.units for quantity in quantities[: len(parts)])
        if len(parts) in (self.counts or [len(parts)]) and (fits or not unit):
            pairs = list(zip(parts, quantities, strict=False))
            with suppress(ValueError):
                values = [_number(part, quantity, unit) for part, quantity in pairs]
                _warn_of_unit(pairs, unit)
                return values
        raise ArgumentTypeError(f"expected {self.expected}, got {text.strip()!r}")

    @property
    def most(self) -> int | None:
        """The largest count; None if there is none."""
        return None if self.counts is None else max(self.counts)

    def _in_words(self) -> str:
        names = [_COUNTS.get(count, str(count)) for count in self.counts or ()]
        units = dict.fromkeys(quantity.si for quantity in self.quantities)
        unit = ", ".join(filter(None, units))
        numbers = "number" if self.counts == (1,) else "numbers"
        words = f"{' or '.join(names)} {numbers}".strip() + (
            f" ({unit})" if unit else ""
        )
        return ", ".join([*self.named, f"or {words}"]) if self.named else words


class Scalar:
    """The type of an option that is one number, for argparse."""

    def __init__(self, quantity: Quantity, expected: str = "") -> None:
        self._vector = Vector(quantity, expected=expected)

    def __call__(self, text: str) -> float:
        """The number in SI units."""
        (number,) = self._vector(text)
        return float(number)


def joints(quantity: Quantity, rod: Quantity, named: Sequence[str] = ()) -> Vector:
    """The type of an option with a number for each turning joint, and the jaw rod's.

    Args:
        quantity: Of the four turning joints.
        rod: Of axis_a, which may be left out.
        named: Words that may stand in place of the numbers.
    """
    return Vector(*[quantity] * 4, rod, counts=(4, 5), named=named)


def _parts(text: str) -> tuple[list[str], str]:
    """The numbers of a text, each with its own unit, and the unit alone at its end."""
    parts = text.replace("−", "-").replace(",", " ").split()
    alone = parts.pop() if parts and parts[-1] in UNITS else ""
    return parts, alone


def _warn_of_unit(pairs: Sequence[tuple[str, Quantity]], alone: str) -> None:
    """Warn of the first number that seems to lack its unit; one warning is enough."""
    for part, quantity in pairs:
        has_unit = alone in quantity.units or part.endswith(tuple(quantity.units))
        if quantity.plausible is None or has_unit:
            continue
        for hint in plausibility.hints(part, float(part), quantity.plausible):
            warnings.warn(hint, ImplausibleWarning, stacklevel=2)
            return


def _number(part: str, quantity: Quantity, alone: str) -> float:
    """One number in SI units.

    Raises:
        ValueError: No number, or a unit of another quantity.
    """
    # The longest unit first: 5mm is not 5m in units of m.
    for unit in sorted(quantity.units, key=len, reverse=True):
        if part.endswith(unit):
            return _checked(float(part.removesuffix(unit)), quantity, unit)
    if alone in quantity.units:
        return _checked(float(part), quantity, alone)
    return _checked(float(part), quantity, "")


def _checked(value: float, quantity: Quantity, unit: str) -> float:
    size = quantity.units.get(unit, 1.0)
    if abs(value * size) > quantity.largest:
        largest = f"at most {quantity.largest:g} {quantity.si}"
        raise ArgumentTypeError(f"expected {largest}, got {value:g}")
    return value * size
