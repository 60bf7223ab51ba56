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
    real,
    shaped,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.sweep.named_axes import (
    arms_of,
    corrections_of,
    flags_of,
    levels_of,
    recordings_of,
    vehicles_of,
)
from alpha5_model.studies.sweep.schema import CASE_AXES, STATE_AXES, UNITS

#: Most values of an axis, and most groups or bins of an output.
MOST = 10_000_000
#: Axes that contradict each other.
_EITHER_OR = (
    ("parameters", "corrections"),
    ("arm", "corrections"),
    ("vehicle", "mount_roll"),
    ("vehicle", "mount_pitch"),
    ("vehicle", "mount_yaw"),
)
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
        in_collision: Which states are kept: those of which it is true, or false, that
            the arm touches itself. Empty without this axis.
        files: What was read and found.
    """

    cases: dict[str, Sequence[Any]]
    states: dict[str, Sequence[float]]
    drawn: dict[str, Sequence[float]]
    in_collision: list[bool]
    files: StudyFiles


class StudyFiles(NamedTuple):
    """The files that the axes of a study name.

    Attributes:
        recordings: Paths as given, or found in folders.
        arms: Value of the axis ``arm`` -> its record.
    """

    recordings: tuple[str, ...]
    arms: dict[str, Alpha5Parameters]


def read_axes(
    given: dict[str, Any],
    folder: Path,
    vehicles: Sequence[str],
    files: StudyFiles | None,
) -> Axes:
    """The axes of a study.

    Args:
        given: The table of a study file.
        folder: Where relative paths of files start.
        vehicles: Names of the vehicles that the study describes.
        files: Its files, if they were read before.

    Raises:
        InputError: An invalid axis, or axes that do not fit together.
        UnknownNameError: No such axis, unit, correction, level or vehicle.
        MissingFileError: No such arm file.
        FileFormatError: Not an arm file.
    """
    present = files or _files(given, folder)
    axes = Axes(cases={}, states={}, drawn={}, in_collision=[], files=present)
    if "recordings" in given:
        axes.cases["recording"] = present.recordings
    for name, values in given.items():
        if name == "recordings":
            continue
        if name == "in_collision":
            axes.in_collision.extend(flags_of("axes.in_collision", values))
            continue
        if name == "vehicle":
            axes.cases[name] = vehicles_of(values, vehicles)
            continue
        if name == "arm":
            axes.cases[name] = list(present.arms)
            continue
        random = isinstance(values, dict) and "random" in values
        if name in CASE_AXES:
            kind = axes.cases
        else:
            kind = axes.drawn if random else axes.states
        kind[name] = _axis(name, values)

    _check_together(axes)
    return axes


def _files(given: Mapping[str, Any], folder: Path) -> StudyFiles:
    """The files that axes name."""
    recordings = given.get("recordings")
    arms = given.get("arm")
    return StudyFiles(
        recordings=() if recordings is None else recordings_of(recordings, folder),
        arms={} if arms is None else arms_of(arms, folder),
    )


def _check_together(axes: Axes) -> None:
    """Refuse axes that contradict each other, and states without all positions."""
    for one, other in _EITHER_OR:
        if {one, other} <= {*axes.cases}:
            raise InputError("axes", f"{one} and {other}", "one of them")
    if "trim" in axes.cases and "vehicle" not in axes.cases:
        raise InputError("axes.trim", axes.cases["trim"], "an axis vehicle beside it")
    tilts = "vehicle" in axes.cases and True in axes.cases.get("trim", [True])
    if tilts and max(axes.cases.get("current_speed", [0.0])) > 0.0:
        expected = "trim = false, as the trim is that of still water"
        raise InputError("axes", "a current and a vehicle in its trim", expected)

    recorded = "recording" in axes.cases
    states = {*axes.states, *axes.drawn}
    positions = {name for name in STATE_AXES if "_pos" in name}
    if (recorded and states) or not (recorded or positions <= states):
        expected = f"recordings alone, or all of {', '.join(sorted(positions))}"
        raise InputError("axes, states", sorted(states), expected)


def check_alone(arm: Alpha5Parameters, cases: Mapping[str, Sequence[Any]]) -> None:
    """Refuse axes beside the arm of a whole study.

    Args:
        arm: Its record.
        cases: Axis of the arm and its surroundings -> values.

    Raises:
        InputError: Other arms, or corrections, which a record has already.
    """
    if "arm" in cases:
        expected = f"none beside {arm.name}, which is the arm of the whole study"
        raise InputError("axes.arm", list(cases["arm"]), expected)
    if "corrections" in cases:
        expected = f"none beside {arm.name}, which has its own corrections"
        raise InputError("axes.corrections", list(cases["corrections"]), expected)


def check_arm(arm: Alpha5Parameters, states: Mapping[str, Sequence[float]]) -> None:
    """Refuse states beyond the limits of an arm.

    Args:
        arm: Its record.
        states: Axis of a state -> values, or the range to draw from.

    Raises:
        InputError: States beyond its limits.
    """
    for joint in arm.joints[:4]:
        limits = {
            "pos": (joint.lower, joint.upper, "rad"),
            "vel": (-joint.velocity, joint.velocity, "rad/s"),
        }
        for rate, (lower, upper, unit) in limits.items():
            name = f"{joint.name}_{rate}"
            if name not in states:
                continue
            farthest = max(states[name], key=lambda x: max(lower - x, x - upper))
            if max(lower - farthest, farthest - upper) > _SLACK:
                range_text = f"{lower:.6g} to {upper:.6g} {unit}"
                expected = f"values within the limits of {arm.name}, {range_text}"
                raise InputError(f"axes.{name}", f"{farthest:.6g} {unit}", expected)


def _axis(name: str, given: Any) -> Sequence[Any]:
    """Values of an axis, or the range to draw from."""
    units = {**STATE_AXES, **CASE_AXES}
    choice("axis", name, (*units, "recordings", "in_collision"))
    place = f"axes.{name}"
    if name == "parameters":
        return range(count(place, given))
    if name == "corrections":
        return corrections_of(given)
    if name == "level":
        return levels_of(given)
    if name == "trim":
        return flags_of(place, given)

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
