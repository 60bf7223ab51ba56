"""The lengths that Table 1 prints as numbers."""

from __future__ import annotations

from typing import NamedTuple

from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import DHRow, Published


class Lengths(NamedTuple):
    """Lengths of Table 1, as printed; its a_1 is an expression."""

    a_0: Quantity
    d_0: Quantity
    a_2: Quantity
    d_3: Quantity


def lengths(printed: Published) -> Lengths:
    """The lengths of Table 1."""
    row_0, _, row_2, row_3, _ = printed.table_1.rows
    return Lengths(a_0=_a(row_0), d_0=row_0.d, a_2=_a(row_2), d_3=row_3.d)


def _a(row: DHRow) -> Quantity:
    """The a of a row that prints it as a number."""
    assert isinstance(row.a, Quantity)
    return row.a
