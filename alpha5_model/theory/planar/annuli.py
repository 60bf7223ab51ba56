"""The annulus that a chain of freely turning links reaches."""

from __future__ import annotations

import math
from collections.abc import Iterable

from alpha5_model._support.checks import bounded, float_array, listed
from alpha5_model.errors import ShapeError


def annulus(length_ranges: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Radii between which a chain of freely turning links reaches.

    The outer radius is the sum of the lengths. The inner radius is the longest length
    minus all others, or 0 if that is negative. If lengths vary, the longest link counts
    with its least length and the others with their greatest: only one link can be
    longer than all others together, so these lengths reach the least radius.

    Args:
        length_ranges: (least, greatest) length of each link [m].

    Returns:
        Inner and outer radius [m].
    """
    pairs = "(least, greatest) length of each link"
    table = float_array(
        "length_ranges", listed("length_ranges", length_ranges, pairs), (2,)
    )
    if table.ndim != 2 or not len(table):
        raise ShapeError("length_ranges", table.shape, pairs)
    ranges = bounded("length_ranges", table).tolist()
    outer = math.fsum(high for _, high in ranges)
    inner = max(math.fsum([low, high, *-table[:, 1]]) for low, high in ranges)
    return max(0.0, inner), outer
