"""Tables of text."""

from __future__ import annotations

import pytest

from alpha5_model._support.text import table


@pytest.mark.parametrize("gap", [1, 2, 5])
@pytest.mark.parametrize("indent", [0, 3])
def test_a_long_last_cell_goes_on_under_its_beginning(gap, indent):
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
