"""The interval of each printed number, and parameter sets with other numbers.

A printed number stands for all numbers that round to it: 0.38 kg is 0.375 to 0.385 kg.
Friction has the tolerance that is printed with it. Zeros of Table 1 are exact, since
axes that intersect are not measured.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, named
from alpha5_model.numbers.corrections import (
    CORRECTIONS,
    DEFAULT_CORRECTIONS,
    check_corrections,
)
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters_from_tables
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import DECIMAL_SHIFT, Quantity
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.bodies import implied_mass

#: Other readings of numbers that contradict each other or have two meanings: name ->
#: what is believed instead of the plain reading.
ALTERNATIVES: dict[str, str] = {
    "link3_cob": CORRECTIONS["link3_cob"].statement,
    "implied_mass": "The masses that best carry Table 2's I_COM to its I_Link, "
    "not those printed.",
    "torque_constant": "Table 4's K_t for both constants of a motor, "
    "which should agree.",
    "voltage_constant": "Table 4's K_v for both; K_t if that is asked for, too.",
    "link2_mass": "Link 2's 0.38 kg is 0.380 kg, printed without its last zero.",
    "motor_efficiency": "Table 4's eta_max is the motor's: "
    "nothing is lost in the gearbox.",
}
#: Table -> kind of its rows, in the names of numbers.
_TABLES = {
    "table_1": "link",
    "table_2": "link",
    "table_3": "link",
    "table_4": "actuator",
}
Names = Iterable[str]
#: Function of a printed number's name and the number that returns another number.
_Change = Callable[[str, Quantity], Quantity]


@dataclass(frozen=True)
class PrintedNumber:
    """A number of Tables 1 to 4 and its interval, SI units.

    Attributes:
        name: As ``link_2.mass``, ``link_3.cob.z``, ``link_1.inertia_com.xy``,
            ``actuator_0.friction``.
        printed: Digits and unit as printed.
        value: Middle of the interval. With the alternatives ``implied_mass`` and
            ``motor_efficiency`` it is not the printed number.
        lower, upper: Ends of the interval.
    """

    name: str
    printed: Quantity
    value: float
    lower: float
    upper: float


def printed_numbers(alternatives: Names = ()) -> dict[str, PrintedNumber]:
    """Every number of Tables 1 to 4 by its name, with the interval of its digits.

    Args:
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        UnknownNameError: An alternative that is not recorded.
    """
    return dict(numbers(believed(alternatives)))


def believed(alternatives: Names) -> tuple[str, ...]:
    """Check names of `ALTERNATIVES`."""
    return named("alternative", alternatives, tuple(ALTERNATIVES))


@cache
def numbers(alternatives: tuple[str, ...]) -> dict[str, PrintedNumber]:
    """Every number by its name. The answer must not be changed.

    Args:
        alternatives: Checked names of `ALTERNATIVES`.
    """
    found: dict[str, Quantity] = {}

    def note(name: str, number: Quantity) -> Quantity:
        return found.setdefault(name, number)

    # Each number is noted; none is replaced.
    _with_replaced_numbers(note)
    out = {}
    for name, number in found.items():
        if name.endswith("tolerance"):
            continue
        tolerance = found.get(f"{name}_tolerance")
        value, half = _interval(name, number, tolerance, alternatives)
        out[name] = PrintedNumber(
            name=name,
            printed=number,
            value=value,
            lower=value - half,
            upper=value + half,
        )
    return out


def _interval(
    name: str,
    number: Quantity,
    tolerance: Quantity | None,
    alternatives: tuple[str, ...],
) -> tuple[float, float]:
    """Middle and half width of a number's interval."""
    value = number.si
    if name.endswith("efficiency") and "motor_efficiency" in alternatives:
        return 1.0, 0.0
    if name.endswith("mass") and "implied_mass" in alternatives:
        return implied_mass(published().table_2.rows[int(name[5])])
    if name == "link_2.mass" and "link2_mass" in alternatives:
        return value, _finest_mass().rounding
    if not number.value and name.endswith((".d", ".a")):
        # The distance of axes that intersect is not measured.
        return value, 0.0
    if tolerance is not None:
        return value, max(number.rounding, value * tolerance.si)
    return value, number.rounding


def _finest_mass() -> Quantity:
    """The mass of Table 2 with the most decimals."""
    masses = [row.mass for row in published().table_2.rows]
    return min(masses, key=lambda mass: mass.rounding)


def intervals(alternatives: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Middles and half widths of the intervals of all printed numbers, (K,) each."""
    limits = [(x.lower, x.upper) for x in numbers(alternatives).values()]
    lower, upper = np.array(limits).T
    return (lower + upper) / 2, (upper - lower) / 2


def parameter_set(
    values: Mapping[str, float],
    alternatives: tuple[str, ...],
    corrections: tuple[str, ...] = DEFAULT_CORRECTIONS,
) -> Alpha5Parameters:
    """The arm's parameters with other values of printed numbers.

    Args:
        values, alternatives: As of `tables_with`.
        corrections: Of the arm; those among the alternatives are added.
    """
    tables = tables_with(values, alternatives)
    return parameters_from_tables(tables, with_alternatives(corrections, alternatives))


def with_alternatives(
    corrections: tuple[str, ...], alternatives: tuple[str, ...]
) -> tuple[str, ...]:
    """The corrections of an arm and those among the alternatives, each once."""
    believed = tuple(name for name in alternatives if name in CORRECTIONS)
    return check_corrections(corrections + believed)


def tables_with(
    values: Mapping[str, float], alternatives: tuple[str, ...]
) -> Published:
    """Tables 1 to 4 with other values of printed numbers.

    Args:
        values: By name, SI units; numbers without one stay as printed.
        alternatives: Checked names of `ALTERNATIVES`.
    """
    known = numbers(alternatives)
    same_constant = [name for name in alternatives if name.endswith("_constant")]

    def change(name: str, number: Quantity) -> Quantity:
        if same_constant and name.endswith("_constant"):
            actuator = name.partition(".")[0]
            name = f"{actuator}.{same_constant[0]}"
        if name.endswith("efficiency") and "motor_efficiency" in alternatives:
            return Quantity("100", "%")
        if name in values:
            return _quantity(values[name], number.unit)
        return known[name].printed if name in known else number

    return _with_replaced_numbers(change)


def _quantity(value: float, unit: str) -> Quantity:
    """A value in SI units as a table would print it in its unit."""
    digits = Decimal(repr(float(value))).scaleb(-DECIMAL_SHIFT[unit])
    return Quantity(str(digits), unit)


def _with_replaced_numbers(change: _Change) -> Published:
    """Tables 1 to 4 with every number replaced by a function's answer.

    The two halves of a tensor have the same names.
    """
    tables: dict[str, Any] = {"elbow": _replaced(published().elbow, "elbow", change)}
    for key, kind in _TABLES.items():
        table = getattr(published(), key)
        rows = [
            _replaced(row, f"{kind}_{i}", change) for i, row in enumerate(table.rows)
        ]
        tables[key] = replace(table, rows=tuple(rows))
    return replace(published(), **tables)


def _replaced(value: Any, name: str, change: _Change, axes: str = "") -> Any:
    """A part of a table with its numbers replaced.

    Args:
        value: A number, a tuple of parts along x, y, z, a text or a record.
        name: Of the quantity that the value belongs to, such as ``link_1.com``.
        change: Function that replaces a number.
        axes: Component of that quantity, such as ``x`` or ``xy``.
    """
    if isinstance(value, Quantity):
        in_order = "".join(sorted(axes))
        return change(f"{name}.{in_order}".rstrip("."), value)
    if isinstance(value, tuple):
        return tuple(
            _replaced(item, name, change, axes + axis)
            for axis, item in zip("xyz", value, strict=False)
        )
    if isinstance(value, str):
        return value
    parts = {}
    for field in fields(value):
        part = getattr(value, field.name)
        parts[field.name] = _replaced(part, f"{name}.{field.name}", change)
    return replace(value, **parts)
