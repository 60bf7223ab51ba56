"""The table ``[covariance]`` of an arm file: read, checked and written.

::

    [covariance]
    names = ["links.link_1.mass", "zeros.axis_d"]
    deviation = [0.0161, 0.01745]      # before the calibration, SI units
    factor = [[0.91, 0.02], [0.1, 0.99]]
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers.arm_values import ArmFileError, one_of, shown, table
from alpha5_model.numbers.covariance import Covariance, key_of

_LARGEST = Decimal(10**6)


def read_covariance(given: Any, measured: set[str]) -> Covariance:
    """The covariance of the numbers of a file.

    Args:
        given: The table.
        measured: Keys of values that have a half width.

    Raises:
        ArmFileError: Unknown names, names of values without a half width, or numbers
            that are no covariance.
    """
    key = "covariance"
    found = table(key, given, schema.COVARIANCE)
    for part in schema.COVARIANCE:
        if part not in found:
            raise ArmFileError(f"{key}.{part}", "missing")
    names = _names(f"{key}.names", found["names"], measured)
    deviation = _numbers(f"{key}.deviation", found["deviation"], len(names))
    factor = _rows(f"{key}.factor", found["factor"], len(names))
    try:
        return Covariance(names=names, deviation=deviation, factor=factor)
    except InputError as error:
        problem = f"{shown(error.value)}; expected {error.expected}"
        raise ArmFileError(error.name, problem) from None


def covariance_lines(covariance: Covariance | None) -> list[str]:
    """The lines of the table; none without a covariance."""
    if covariance is None:
        return []
    lines = [
        "",
        "# Covariance D (1 - F F^T) D of these numbers, SI units: D, the deviation,",
        "# was known before the calibration; F, the factor, is what it has told.",
        "[covariance]",
        "names = [",
        *(f'  "{name}",' for name in covariance.names),
        "]",
        "deviation = [",
        *(f"  {number!r}," for number in covariance.deviation.tolist()),
        "]",
        "factor = [",
    ]
    for row in covariance.factor:
        lines.append(f"  [{', '.join(f'{x:.13g}' for x in row)}],")
    return [*lines, "]"]


def _names(key: str, given: Any, measured: set[str]) -> tuple[str, ...]:
    """Known names of numbers with a half width."""
    if not isinstance(given, list) or len(given) > len(schema.NUMBERS):
        expected = "a list of names such as links.link_2.com.x"
        raise ArmFileError(key, f"{shown(given)}; expected {expected}")
    names = tuple(one_of(key, name, schema.NUMBERS) for name in given)
    for name in names:
        if key_of(name) not in measured:
            problem = f"{name}, but {key_of(name)} has no half_width"
            raise ArmFileError(key, problem)
    return names


def _rows(key: str, given: Any, count: int) -> FloatArray:
    """As many rows as there are names, all of one length."""
    if not isinstance(given, list) or len(given) != count:
        raise ArmFileError(key, f"{shown(given)}; expected {count} rows of numbers")
    width = len(given[0]) if given and isinstance(given[0], list) else 0
    if width > len(schema.NUMBERS):
        expected = f"at most {len(schema.NUMBERS)} numbers in a row"
        raise ArmFileError(key, f"{width} numbers; expected {expected}")
    rows = [_numbers(f"{key}[{i}]", row, width) for i, row in enumerate(given)]
    return np.array(rows).reshape(count, width)


def _numbers(key: str, given: Any, count: int) -> FloatArray:
    """A list of so many numbers."""
    if not isinstance(given, list):
        raise ArmFileError(key, f"{shown(given)}; expected {count} numbers")
    if len(given) != count:
        raise ArmFileError(key, f"{len(given)} numbers; expected {count}")
    for i, number in enumerate(given):
        if not _is_number(number):
            raise ArmFileError(f"{key}[{i}]", f"{shown(number)}; expected a number")
    return np.array([float(number) for number in given])


def _is_number(given: Any) -> bool:
    """Whether it is a finite number of a usual size."""
    if isinstance(given, bool) or not isinstance(given, int | Decimal):
        return False
    number = Decimal(given)
    return number.is_finite() and number.copy_abs() < _LARGEST
