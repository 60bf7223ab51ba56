"""Which pairs of links are left out for an arm with other lengths."""

from __future__ import annotations

import dataclasses

import pytest

from alpha5_model.collision.link_pairs import NEVER_PAIRS, unchecked_pairs
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters


def longer(*changes: tuple[int, str, float]) -> Alpha5Parameters:
    """The catalogue's arm with other lengths in rows of Table 1 [m]."""
    arm = parameters()
    rows = list(arm.dh)
    for number, name, change in changes:
        length = getattr(rows[number], name) + change
        rows[number] = dataclasses.replace(rows[number], **{name: length})
    return dataclasses.replace(arm, dh=tuple(rows))


@pytest.mark.parametrize(
    ("row", "name", "sign"),
    [(0, "a", 1), (1, "a", -1), (2, "a", 1), (0, "d", -1), (1, "d", -1), (2, "d", 1)],
)
def test_a_length_that_changes_by_40_mm_lets_links_meet(
    row: int, name: str, sign: int
) -> None:
    """Links 1 and 3 are 40 mm farther apart than they need be."""
    kept = unchecked_pairs(longer((row, name, sign * 0.0399)))
    assert kept["Never"] == NEVER_PAIRS
    assert "Never" not in unchecked_pairs(longer((row, name, sign * 0.0401)))


def test_changes_add_up_whatever_their_signs() -> None:
    beyond = longer((0, "a", 0.015), (0, "d", -0.015), (2, "a", -0.015))
    assert "Never" not in unchecked_pairs(beyond)
    assert "Never" in unchecked_pairs(longer((0, "a", 0.015), (0, "d", -0.015)))


@pytest.mark.parametrize("name", ["a", "d"])
def test_what_is_beyond_link_3_does_not_count(name: str) -> None:
    assert unchecked_pairs(longer((3, name, 0.1)))["Never"] == NEVER_PAIRS
