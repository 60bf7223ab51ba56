"""Printed digits become the nearest double in SI, and half a unit as their interval."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from alpha5_model.numbers.quantity import Quantity

#: Unit -> size in SI, as an exact fraction, written down from the unit's definition.
SIZE = {
    "": Fraction(1),
    "kg": Fraction(1),
    "mm": Fraction(1, 1000),
    "mm/s": Fraction(1, 1000),
    "Nmm": Fraction(1, 1000),
    "L": Fraction(1, 1000),  # cubic decimetre
    "%": Fraction(1, 100),
    "uH": Fraction(1, 10**6),
    "kg.mm^2": Fraction(1, 10**6),
    "V/rad/s": Fraction(1),
}
printed_numbers = st.from_regex(r"-?[0-9]{1,6}(\.[0-9]{1,6})?", fullmatch=True)


@given(printed_numbers, st.sampled_from(sorted(SIZE)))
def test_si_is_the_nearest_double(text: str, unit: str) -> None:
    quantity = Quantity(text, unit)
    exact = Fraction(text) * SIZE[unit]
    assert quantity.si == float(exact)  # float(Fraction) rounds correctly
    assert quantity.text == text


@given(printed_numbers, st.sampled_from(sorted(SIZE)))
def test_rounding_is_half_a_unit_of_the_last_digit(text: str, unit: str) -> None:
    decimals = len(text.partition(".")[2])
    exact = Fraction(1, 2 * 10**decimals) * SIZE[unit]
    assert Quantity(text, unit).rounding == float(exact)


def test_the_decimal_point_is_shifted_not_multiplied() -> None:
    """Multiplying would lose the last bit of the very first COM of Table 2."""
    assert float("-7.120") * 1e-3 != -0.00712
    assert Quantity("-7.120", "mm").si == -0.00712


def test_trailing_zeros_carry_precision() -> None:
    assert Quantity("0.38", "kg").rounding == 0.005
    assert Quantity("0.380", "kg").rounding == 0.0005


def test_degrees() -> None:
    quantity = Quantity("30", "deg")
    assert quantity.si == pytest.approx(math.radians(30), rel=1e-15)


def test_degrees_per_second() -> None:
    quantity = Quantity("30", "deg/s")
    assert quantity.si == pytest.approx(math.radians(30), rel=1e-15)
    assert quantity.rounding == pytest.approx(math.radians(0.5), rel=1e-15)


def test_reads_as_printed() -> None:
    assert str(Quantity("-7.120", "mm")) == "-7.120 mm"
    assert str(Quantity("1754.4", "")) == "1754.4"
