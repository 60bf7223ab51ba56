"""A number as printed: its digits, its unit, its value and rounding in SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal

#: Powers of ten from a printed unit to SI. Shifting the decimal point keeps every
#: printed digit: ``float("-7.120") * 1e-3`` is not the double nearest to -0.00712.
DECIMAL_SHIFT: dict[str, int] = {
    **dict.fromkeys(("", "kg", "m", "rad", "Nm", "N", "Ohm", "kg.m", "kg.m^2"), 0),
    **dict.fromkeys(("Nm/A", "V/rad/s", "kg/m^3", "rad/m"), 0),
    "%": -2,
    **dict.fromkeys(("mm", "mm/s", "Nmm", "L", "mA"), -3),
    **dict.fromkeys(("uH", "kg.mm^2"), -6),
}
#: Units that need more than a shift of the decimal point.
FACTOR: dict[str, float] = {"deg": math.pi / 180.0, "deg/s": math.pi / 180.0}


@dataclass(frozen=True, slots=True)
class Quantity:
    """One printed number.

    Attributes:
        text: The digits exactly as printed, for example ``"-7.120"``.
        unit: The unit printed with them, for example ``"mm"``; empty for a pure number.
    """

    text: str
    unit: str

    @property
    def value(self) -> Decimal:
        """The printed value, in the printed unit, exact."""
        return Decimal(self.text)

    @property
    def si(self) -> float:
        """The double nearest to the printed value in SI units."""
        return self._in_si(self.value)

    @property
    def rounding(self) -> float:
        """Half a unit of the last digit, in SI units: the largest rounding error."""
        exponent = self.value.as_tuple().exponent
        assert isinstance(exponent, int)  # digits
        return self._in_si(Decimal(5).scaleb(exponent - 1))

    def _in_si(self, printed: Decimal) -> float:
        if self.unit in FACTOR:
            return float(printed) * FACTOR[self.unit]
        return float(printed.scaleb(DECIMAL_SHIFT[self.unit]))

    def __str__(self) -> str:
        return f"{self.text} {self.unit}".rstrip()
