"""The size of every unit follows from its name: prefixes, bases and powers."""

from __future__ import annotations

import math
import re
from decimal import Decimal

import pytest

from alpha5_model.numbers import arm_units, plausibility
from alpha5_model.numbers.arm_units import DIMENSIONS
from alpha5_model.numbers.plausibility import Plausible
from alpha5_model.numbers.quantity import DECIMAL_SHIFT, FACTOR, Quantity

PREFIXES = {"": 1.0, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6}
#: In SI units: a gramme is 1e-3 kg, a litre 1e-3 m^3, and g alone is gravity.
BASES = {
    **dict.fromkeys(("m", "s", "rad", "N", "A", "V", "Ohm", "H"), 1.0),
    "g": 1e-3,
    "L": 1e-3,
    "deg": math.pi / 180,
    "%": 1e-2,
    "1": 1.0,
}


def size_of(unit: str) -> float:
    """The size of a unit such as ``mN m/A`` or ``kg.mm^2`` in SI units."""
    size = 1.0
    over = False
    for part in re.findall(r"/|[^ ./]+", unit):
        if part == "/":
            over = True
            continue
        name, _, power = part.partition("^")
        factor = size_of_name(name) ** int(power or 1)
        size = size / factor if over else size * factor
    return size


def size_of_name(name: str) -> float:
    if name in BASES:
        return BASES[name]
    for prefix, factor in PREFIXES.items():
        for base, size in BASES.items():
            if name == prefix + base:
                return factor * size
    if name.startswith("N"):  # Nm and Nmm are written without a space
        return size_of_name(name[1:])
    raise AssertionError(f"no such unit: {name}")


def test_the_sizes_are_those_of_the_names() -> None:
    assert size_of("kg mm^2") == pytest.approx(1e-6)
    assert size_of("mN m s/rad") == pytest.approx(1e-3)
    assert size_of("g/cm^3") == pytest.approx(1e3)
    assert size_of("deg/s") == pytest.approx(math.pi / 180)
    assert size_of("Nmm") == pytest.approx(1e-3)


def test_units_of_an_arm_file() -> None:
    for dimension in DIMENSIONS.values():
        for unit in dimension.units:
            found = dimension.in_si(Decimal("2.5"), unit)
            assert found == pytest.approx(2.5 * size_of(unit), rel=1e-15), unit
        assert size_of(dimension.si) == 1.0


def test_units_of_a_printed_number() -> None:
    for unit in (*DECIMAL_SHIFT, *FACTOR):
        found = Quantity.parse("2.5", unit, "here").si
        assert found == pytest.approx(2.5 * size_of(unit), rel=1e-15), unit


LIMITS = {
    name: limits
    for module in (plausibility, arm_units)
    for name, limits in vars(module).items()
    if isinstance(limits, Plausible)
}


def test_units_that_a_warning_proposes() -> None:
    for name, limits in LIMITS.items():
        for unit, size in limits.units.items():
            expected = 9.81 if unit == "g" and name == "GRAVITY" else size_of(unit)
            if name == "GYRATION":  # a radius whose square has the unit of an inertia
                expected = math.sqrt(expected)
            assert size == pytest.approx(expected, rel=1e-12), (name, unit)
