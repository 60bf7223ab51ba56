"""The outputs of a study: which figures of its quantities it keeps."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from alpha5_model._support.checks import choice, count, listed, named, real
from alpha5_model.errors import InputError
from alpha5_model.studies.sweep.axes import MOST, rising
from alpha5_model.studies.sweep.schema import FORMS, QUANTITIES


class Output(NamedTuple):
    """A figure of a quantity that is kept.

    Attributes:
        quantity: Its name.
        unit: Its unit.
        columns: Names of its columns.
        form: ``"peak"``, ``"maximum"``, ``"minimum"``, ``"quantile"``, ``"histogram"``
            or ``"table"``.
        by: Axes of a map of extremes.
        levels: Of quantiles.
        range: Ends of a histogram.
        bins: Of a histogram.
    """

    quantity: str
    unit: str
    columns: Sequence[str]
    form: str
    by: Sequence[str]
    levels: Sequence[float]
    range: tuple[float, float]
    bins: int


def read_output(name: str, given: Any, grid: Mapping[str, Sequence[Any]]) -> Output:
    """An output of a study.

    Args:
        name: Its name.
        given: Its table in a study file.
        grid: Axes that have values.

    Raises:
        InputError: An invalid value, with its place.
        UnknownNameError: No such quantity, form, key or axis.
    """
    if not re.fullmatch(r"[\w-]+", name):
        raise InputError("outputs", name, "names of letters, digits, _ and -")

    place = f"outputs.{name}"
    table = given if isinstance(given, dict) else {}
    quantity = choice(f"{place}.quantity", table.get("quantity"), tuple(QUANTITIES))
    form = choice(f"{place}.as", table.get("as"), tuple(FORMS))
    named(f"key of {place}", table, ("quantity", "as", *FORMS[form]))

    if quantity == "trim" and "vehicle" not in grid:
        raise InputError(f"{place}.quantity", quantity, "an axis vehicle beside it")

    by = listed(f"{place}.by", table.get("by", ()), "a list")
    levels = listed(f"{place}.levels", table.get("levels", ()), "a list")
    for axis in by:
        choice(f"axis of {place}.by", axis, tuple(grid))
    if form == "quantile":
        levels = _levels(f"{place}.levels", levels)

    bins = 1
    ends: Any = (0, 1)
    if form == "histogram":
        bins = count(f"{place}.bins", table.get("bins"))
        ends = table.get("range")
    groups = math.prod(len(grid[axis]) for axis in by)
    if max(bins, groups) > MOST:
        raise InputError(place, given, f"at most {MOST} groups or bins")

    unit, *columns = QUANTITIES[quantity]
    return Output(
        quantity=quantity,
        unit=unit,
        columns=columns,
        form=form,
        by=by,
        levels=levels,
        range=rising(f"{place}.range", ends),
        bins=bins,
    )


def _levels(place: str, given: Sequence[Any]) -> list[float]:
    """The levels of quantiles."""
    levels = [real(place, level) for level in given]
    if not levels or not 0 < min(levels) <= max(levels) <= 1:
        raise InputError(place, levels, "numbers above 0, up to 1")
    return levels
