"""The axes of a study: the numbers that it varies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import (
    FloatArray,
    choice,
    count,
    float_array,
    listed,
    named,
    real,
    shaped,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.corrections import CORRECTIONS
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.sweep.schema import CASE_AXES, STATE_AXES, UNITS

#: Most values of an axis, and most groups or bins of an output.
MOST = 10_000_000
#: Suffixes of recordings in a folder.
_RECORDINGS = (".csv", ".parquet", ".pq", ".bag", ".db3", ".mcap")
#: A state beyond a limit by less is at the limit: degrees are rounded [rad, rad/s].
_SLACK = 1e-9
#: SI units of axes that cannot be negative.
_NOT_NEGATIVE = ("kg", "m^3", "kg/m^3", "m/s")


class Axes(NamedTuple):
    """The axes of a study, in SI units.

    Attributes:
        cases: Axis of the arm and its surroundings -> values. If there is the axis
            ``recording``, it is the first.
        states: Axis of a state -> values.
        drawn: Axis of a state -> the range to draw from, lower and upper end.
    """

    cases: dict[str, Sequence[Any]]
    states: dict[str, Sequence[float]]
    drawn: dict[str, Sequence[float]]


def read_axes(
    given: dict[str, Any], folder: Path, recordings: Sequence[str] | None
) -> Axes:
    """The axes of a study.

    Args:
        given: The table of a study file.
        folder: Where relative paths of recordings start.
        recordings: The recordings, if they were found before.

    Raises:
        InputError: An invalid axis, or axes that do not fit together.
        UnknownNameError: No such axis, unit or correction.
    """
    axes = Axes(cases={}, states={}, drawn={})
    if "recordings" in given:
        found = recordings or _recordings(given["recordings"], folder)
        axes.cases["recording"] = found
    for name, values in given.items():
        if name == "recordings":
            continue
        random = isinstance(values, dict) and "random" in values
        if name in CASE_AXES:
            kind = axes.cases
        else:
            kind = axes.drawn if random else axes.states
        kind[name] = _axis(name, values)

    _check_together(axes)
    return axes


def _check_together(axes: Axes) -> None:
    """Refuse axes that contradict each other, and states without all positions."""
    if {"parameters", "corrections"} <= {*axes.cases}:
        raise InputError("axes", "parameters and corrections", "one of them")

    recorded = "recording" in axes.cases
    states = {*axes.states, *axes.drawn}
    positions = {name for name in STATE_AXES if "_pos" in name}
    if (recorded and states) or not (recorded or positions <= states):
        expected = f"recordings alone, or all of {', '.join(sorted(positions))}"
        raise InputError("axes, states", sorted(states), expected)


def check_arm(
    arm: Alpha5Parameters,
    cases: Mapping[str, Sequence[Any]],
    states: Mapping[str, Sequence[float]],
) -> None:
    """Refuse axes that contradict an arm of one's own.

    Args:
        arm: Its record.
        cases: Axis of the arm and its surroundings -> values.
        states: Axis of a state -> values, or the range to draw from.

    Raises:
        InputError: Corrections, which a record has already, or states beyond its
            limits.
    """
    if "corrections" in cases:
        expected = f"none beside {arm.name}, which has its own corrections"
        raise InputError("axes.corrections", list(cases["corrections"]), expected)
    for joint in arm.joints[:4]:
        limits = {
            "pos": (joint.lower, joint.upper, "rad"),
            "vel": (-joint.velocity, joint.velocity, "rad/s"),
        }
        for rate, (lower, upper, unit) in limits.items():
            name = f"{joint.name}_{rate}"
            given = states.get(name, [0.0] if rate == "vel" else [lower])
            farthest = max(given, key=lambda x: max(lower - x, x - upper))
            if max(lower - farthest, farthest - upper) > _SLACK:
                range_text = f"{lower:.6g} to {upper:.6g} {unit}"
                expected = f"values within the limits of {arm.name}, {range_text}"
                raise InputError(f"axes.{name}", f"{farthest:.6g} {unit}", expected)


def _recordings(given: Any, folder: Path) -> tuple[str, ...]:
    """Paths of recordings, in the order given; those of a folder by their names."""
    paths = [given]
    if not isinstance(given, str):
        paths = listed("axes.recordings", given, "files")

    found: list[str] = []
    for path in paths:
        whole = folder / str(path)
        if whole.is_dir():
            names = sorted(inside.name for inside in whole.iterdir())
            found += [
                str(Path(path, name))
                for name in names
                if Path(name).suffix in _RECORDINGS
            ]
        else:
            found.append(str(path))

    if not found:
        expected = f"files, or folders with some of {', '.join(_RECORDINGS)}"
        raise InputError("axes.recordings", given, expected)
    return tuple(found)


def _axis(name: str, given: Any) -> Sequence[Any]:
    """Values of an axis, or the range to draw from."""
    units = {**STATE_AXES, **CASE_AXES}
    choice("axis", name, (*units, "recordings"))
    place = f"axes.{name}"
    if name == "parameters":
        return range(count(place, given))
    if name == "corrections":
        return _corrections(place, given)

    unit = units[name]
    table = given if isinstance(given, dict) else {"values": given}
    scale = _scale(place, table, unit)
    numbers = _given_numbers(place, table, may_be_random=name in STATE_AXES)
    if numbers is None:
        expected = "values; from, to and count; or of a state, random"
        raise InputError(place, given, expected)
    if not 0 < numbers.size <= MOST:
        raise InputError(place, given, f"1 to {MOST} values")

    least = 0.0 if unit in _NOT_NEGATIVE else None
    return [real(place, scale * number, least) for number in numbers.ravel().tolist()]


def _corrections(place: str, given: Any) -> list[str]:
    """Sets of corrections, each joined by ``+``."""
    expected = "a list of names, such as ['none', 'base_frame+link3_cob']"
    sets = listed(place, given, expected)
    every_name = "+".join(map(str, sets)).split("+")
    named(place, every_name, ("none", *CORRECTIONS))
    return sets


def _scale(place: str, table: dict[str, Any], unit: str) -> float:
    """Factor from the unit of an axis in the file to its SI unit."""
    sizes = UNITS[unit]
    own_unit = choice(f"unit of {place}", table.get("unit", unit), tuple(sizes))
    return sizes[own_unit]


def _given_numbers(
    place: str, table: dict[str, Any], may_be_random: bool
) -> FloatArray | None:
    """The numbers of an axis in its own unit: values, a grid, or a range to draw from.

    None if the keys fit none of these.
    """
    keys = {*table} - {"unit"}
    if keys == {"values"}:
        values = float_array(place, table["values"], ())
        return np.atleast_1d(values)
    if keys == {"from", "to", "count"}:
        number = count(f"{place}.count", table["count"])
        low, high = rising(place, [table["from"], table["to"]])
        return np.linspace(low, high, min(number, MOST + 1))
    if keys == {"random"} and may_be_random:
        ends = rising(place, table["random"])
        return np.array(ends)
    return None


def rising(place: str, ends: Any) -> tuple[float, float]:
    """Two numbers, the second above the first.

    Raises:
        InputError: Anything else.
    """
    low, high = shaped(place, ends, (2,)).tolist()
    if not low < high:
        raise InputError(place, ends, "two numbers, the second above the first")
    return low, high
