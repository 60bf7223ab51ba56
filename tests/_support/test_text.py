"""Tables of text, wrapped lines, and results as JSON has them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest

from alpha5_model._support.text import plain, table, wrapped


@pytest.mark.parametrize("gap", [1, 2, 5])
@pytest.mark.parametrize("indent", [0, 3])
def test_a_long_last_cell_goes_on_under_its_beginning(gap: int, indent: int) -> None:
    rows = [("a", "bcd", "one two three four five six"), ("ef", "g", "seven")]
    first, *rest = table(rows, "<", indent, 24, gap)
    start = first.index("one")
    assert start == indent + 2 + gap + 3 + gap
    *further, last = rest
    assert further
    for line in further:
        assert len(line) - len(line.lstrip()) == start
        assert len(line) <= 24
    assert last.endswith("seven")


def test_a_line_that_fits_is_left_and_a_longer_one_hangs() -> None:
    line = "  four well-known words"
    assert wrapped(line, len(line)) == [line]
    *start, end = wrapped(line, len(line) - 1)
    assert start == ["  four well-known"]
    assert end == "    words"
    assert wrapped(line, 12, hang=1) == ["  four", " well-known", " words"]
    # Words stay whole, however narrow.
    assert wrapped("internationally known", 5) == ["internationally", "  known"]


def test_columns_are_apart_and_the_last_side_goes_on() -> None:
    rows = [("name", "kg m^2", "x"), ("a", "1", "22")]
    assert table(rows) == ["name  kg·m²   x", "a         1  22"]
    assert table(rows, "<", gap=1) == ["name kg·m² x", "a    1     22"]
    assert table(rows, indent=2)[0].startswith("  name")


class Row(NamedTuple):
    """A record of another kind."""

    value: float


@dataclass(frozen=True)
class Record:
    """A record with others in it."""

    rows: tuple[Row, ...]
    array: np.ndarray
    number: np.generic


def test_records_become_what_json_has() -> None:
    record = Record((Row(math.nan), Row(1.5)), np.array([1.0, np.inf]), np.int64(3))
    expected = {"rows": [{"value": None}, {"value": 1.5}], "array": [1.0, None]}
    assert plain(record) == {**expected, "number": 3}
    assert type(plain(record)["number"]) is int
    assert plain({"x": (math.inf, 2)}, unknown=-1.0) == {"x": [-1.0, 2]}
    # A class is no record.
    assert plain(Record) is Record
