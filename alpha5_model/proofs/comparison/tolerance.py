"""How closely the numbers of a body must agree: to the digits that the file writes.

A number agrees if it differs by no more than half a unit of its last digit. The rule is
the same for every link. A file tells its digits by its most precise numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from decimal import Decimal
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.description.urdf_robot import UrdfRobot

Quantity = Literal["mass", "com", "inertia"]

#: Closer numbers are the same, whatever their digits: rounding of conversions.
LEAST = {"mass": 1e-6, "com": 5e-7, "inertia": 5e-10}  # [kg], [m], [kg m^2]
#: Files with fewer digits are compared as closely as this: they would hide mistakes.
MOST = {"mass": 5e-4, "com": 5e-4, "inertia": 1e-6}
#: A lighter link only has an inertial because some program wants one [kg].
TOKEN = 1e-6


class Precision(NamedTuple):
    """How precisely the numbers of one kind are written in a file.

    Attributes:
        place: The finest decimal place that any of them has, such as 0.001.
        figures: The most significant figures that any of them has.
    """

    place: float = 0.0
    figures: int = 17

    def half_digit(self, numbers: ArrayLike) -> FloatArray:
        """Half a unit of the last digit of each number.

        A number may have lost its trailing zeros. So it is taken to be rounded like the
        others: to as many decimals, or to as many significant figures.
        """
        values = np.abs(np.asarray(numbers, np.float64))
        decades = np.floor(np.log10(np.where(values > 0, values, 1e-300)))
        return np.asarray(
            0.5 * np.maximum(self.place, 10.0 ** (decades + 1 - self.figures))
        )

    def rounded(self, numbers: ArrayLike, most: float) -> FloatArray:
        """The numbers with as many digits as the file has.

        More digits would make the file look more precise than its other numbers are.

        Args:
            numbers: Any shape.
            most: The largest error that rounding may make.
        """
        half = np.clip(self.half_digit(numbers), 1e-15, most)
        decimals = -np.floor(np.log10(2 * half) + 1e-9)
        scale = 10.0**decimals
        return np.asarray(np.rint(np.asarray(numbers) * scale) / scale + 0.0)


class Digits(NamedTuple):
    """The digits of a file's inertials, the same for every link.

    Attributes:
        mass, com, inertia: How precisely these are written.
        length: By how much rounded joint origins misplace a body [m].
        angle: By how much they turn it [rad].
    """

    mass: Precision = Precision()
    com: Precision = Precision()
    inertia: Precision = Precision()
    length: float = 0.0
    angle: float = 0.0


def digits_of(robot: UrdfRobot) -> Digits:
    """The digits that a file writes in its inertials."""
    links = [link for link in robot.links.values() if (link.mass or 0) > TOKEN]
    return Digits(
        mass=_precision(link.mass for link in links if link.mass),
        com=_precision(itertools.chain.from_iterable(link.com for link in links)),
        inertia=_precision(
            itertools.chain.from_iterable(link.inertia.flat for link in links)
        ),
    )


def _precision(numbers: Iterable[float]) -> Precision:
    """The finest place and the most figures of some numbers; zeros have none."""
    texts = [Decimal(repr(float(x))).normalize().as_tuple() for x in numbers if x]
    if not texts:
        return Precision()
    exponents = [int(text.exponent) for text in texts]
    figures = [len(text.digits) for text in texts]
    return Precision(place=10.0 ** min(exponents), figures=max(figures))


class Tolerance:
    """How closely numbers of one kind must agree in one link.

    Attributes:
        quantity: Which kind.
    """

    def __init__(
        self, quantity: Quantity, right: ArrayLike, digits: Digits, slack: float
    ) -> None:
        """How closely a link's number must agree.

        Args:
            quantity: Which kind.
            right: What the link should say, (), (3,) or (3, 3).
            digits: Of the file.
            slack: What rounding elsewhere adds.
        """
        self.quantity = quantity
        self._size = float(np.abs(right).max())
        self._precision: Precision = getattr(digits, quantity)
        self._slack = slack

    def holds(
        self, computed: ArrayLike, written: ArrayLike, *, any_digits: bool = False
    ) -> BoolArray:
        """Which computed numbers are the written one, to its digits.

        Args:
            computed: (...), (..., 3) or (..., 3, 3).
            written: As the file has it, (), (3,) or (3, 3).
            any_digits: Whether the digits may be too few to compare by, see `MOST`.

        Returns:
            (...).
        """
        numbers = np.asarray(computed, np.float64)
        typed = np.asarray(written, np.float64)
        entries = tuple(range(-typed.ndim, 0))
        # A number in another unit has its least difference in that unit.
        unit = np.ones_like(numbers.max(entries, keepdims=True))
        if self._size:
            unit = np.abs(numbers).max(entries, keepdims=True) / self._size
        half = self._precision.half_digit(typed)
        if not any_digits:
            half = np.minimum(half, MOST[self.quantity] * unit)
        # The slack follows from written numbers, so it is in their unit already.
        least = LEAST[self.quantity] * unit + self._slack
        return np.asarray((np.abs(numbers - typed) <= half + least).all(entries))
