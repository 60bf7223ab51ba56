"""The axes of a study: what it varies. Each has a parser in `PARSERS`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import (
    choice,
    count,
    flag,
    float_array,
    listed,
    named,
    real,
    shaped,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_file import arm_file
from alpha5_model.numbers.corrections import CORRECTIONS
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.water.carrier import Carrier

#: Joints of the arm, base to tip.
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
#: Axis of a state -> its SI unit.
STATE_AXES = {
    **{f"{joint}_pos": "rad" for joint in JOINTS},
    **{f"{joint}_vel": "rad/s" for joint in JOINTS},
    **{f"{joint}_acc": "rad/s^2" for joint in JOINTS},
}
#: Axis of a case that has numbers -> its SI unit, and the plausible range of the value
#: farthest from 0. The mount's attitude is roll, pitch and yaw of base_link in the
#: world. The payload is at the tcp.
CASE_NUMBERS: dict[str, tuple[str, plausibility.Plausible | None]] = {
    "mount_roll": ("rad", None),
    "mount_pitch": ("rad", None),
    "mount_yaw": ("rad", None),
    "payload_mass": ("kg", plausibility.MASS),
    "payload_x": ("m", plausibility.POSITION),
    "payload_y": ("m", plausibility.POSITION),
    "payload_z": ("m", plausibility.POSITION),
    "payload_volume": ("m^3", plausibility.VOLUME),
    "fluid_density": ("kg/m^3", plausibility.FLUID_DENSITY),
    "current_speed": ("m/s", plausibility.WATER_VELOCITY),
    "current_azimuth": ("rad", None),
    "current_elevation": ("rad", None),
}
#: SI unit -> the units that an axis may be given in, each with its size.
UNITS = {
    "rad": {"rad": 1.0, "deg": np.pi / 180},
    "rad/s": {"rad/s": 1.0, "deg/s": np.pi / 180},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": np.pi / 180},
    "m": {"m": 1.0, "mm": 1e-3},
    "m^3": {"m^3": 1.0, "L": 1e-3},
    "kg": {"kg": 1.0, "g": 1e-3},
    "m/s": {"m/s": 1.0},
    "kg/m^3": {"kg/m^3": 1.0},
}
#: SI units of axes that cannot be negative.
_NOT_NEGATIVE = ("kg", "m^3", "kg/m^3", "m/s")
#: Most values of an axis, and most groups or bins of an output.
MOST = 10_000_000
#: The value of the axis ``arm`` that is no file.
CATALOGUE = "catalogue"
#: Suffixes of recordings in a folder.
_RECORDINGS = (".csv", ".parquet", ".pq", ".bag", ".db3", ".mcap")
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


class Drawn(NamedTuple):
    """The range from which each state draws its own number."""

    low: float
    high: float


class Context(NamedTuple):
    """What some axes refer to.

    Attributes:
        folder: Where relative paths of recordings and arm files start.
        vehicles: The vehicles that the study describes, by name.
    """

    folder: Path
    vehicles: Mapping[str, Carrier]


def rising(place: str, ends: Any) -> tuple[float, float]:
    """Two numbers, the second above the first.

    Raises:
        InputError: Anything else.
    """
    low, high = shaped(place, ends, (2,)).tolist()
    if not low < high:
        raise InputError(place, ends, "two numbers, the second above the first")
    return low, high


def _numbers(
    place: str,
    given: Any,
    context: Context,
    unit: str,
    plausible: plausibility.Plausible | None = None,
) -> list[float] | Drawn:
    """Numbers in SI units: values, a grid, or of a state a range to draw from."""
    table = given if isinstance(given, dict) else {"values": given}
    sizes = UNITS[unit]
    scale = sizes[choice(f"unit of {place}", table.get("unit", unit), tuple(sizes))]
    keys = {*table} - {"unit"}
    if keys == {"random"} and place.removeprefix("axes.") in STATE_AXES:
        low, high = rising(place, table["random"])
        return Drawn(low=real(place, scale * low), high=real(place, scale * high))

    if keys == {"values"}:
        numbers = float_array(place, table["values"], ())
    elif keys == {"from", "to", "count"}:
        size = count(f"{place}.count", table["count"])
        low, high = rising(place, [table["from"], table["to"]])
        numbers = np.linspace(low, high, min(size, MOST + 1))
    else:
        expected = "values; from, to and count; or of a state, random"
        raise InputError(place, given, expected)
    if not 0 < numbers.size <= MOST:
        raise InputError(place, given, f"1 to {MOST} values")
    least = 0.0 if unit in _NOT_NEGATIVE else None
    values = [real(place, scale * number, least) for number in numbers.ravel().tolist()]
    if plausible is not None:
        plausibility.check(place, max(values, key=abs), plausible)
    return values


def _each_once(place: str, given: Any, checked: Callable[[Any], Any]) -> list[Any]:
    """The values of an axis, given as a list or as one of them; each once."""
    items = given if isinstance(given, list) else [given]
    values = [checked(item) for item in items]
    if not values or len({*values}) < len(values):
        raise InputError(place, given, "at least one value, each once")
    return values


def _recordings(place: str, given: Any, context: Context) -> list[str]:
    """Paths of recordings, in the order given; those of a folder by their names."""
    items = [given] if isinstance(given, str) else listed(place, given, "files")
    found = []
    for item in map(str, items):
        folder = context.folder / item
        if not folder.is_dir():
            found.append(item)
            continue
        names = sorted(file.name for file in folder.iterdir())
        found += [str(Path(item, x)) for x in names if Path(x).suffix in _RECORDINGS]
    if not found:
        expected = f"files, or folders with some of {', '.join(_RECORDINGS)}"
        raise InputError(place, given, expected)
    return found


def _corrections(place: str, given: Any, context: Context) -> list[str]:
    """Sets of corrections: ``"none"``, or names joined by ``+``."""

    def checked(joined: Any) -> str:
        names = str(joined).split("+")
        named(place, names, ("none", *CORRECTIONS))
        if len(names) > 1 and "none" in names:
            raise InputError(place, joined, "'none' alone, or names joined by +")
        return str(joined)

    return _each_once(place, given, checked)


def _levels(place: str, given: Any, context: Context) -> list[str]:
    return _each_once(place, given, lambda name: choice("level", name, LEVELS))


def _vehicles(place: str, given: Any, context: Context) -> list[str]:
    names = tuple(context.vehicles)
    if not names:
        raise InputError(place, given, "a table [vehicles.NAME] in the study")
    return _each_once(place, given, lambda name: choice("vehicle", name, names))


def _flags(place: str, given: Any, context: Context) -> list[bool]:
    return _each_once(place, given, lambda value: flag(place, value))


def _arms(place: str, given: Any, context: Context) -> dict[str, Alpha5Parameters]:
    """Name or file of each arm -> its record."""
    names = _each_once(place, given, str)
    return {
        name: chosen_arm(None) if name == CATALOGUE else arm_file(context.folder / name)
        for name in names
    }


def _sets(place: str, given: Any, context: Context) -> Sequence[int]:
    return range(count(place, given))


#: Axis -> its parser, a function of its place, what is given, and the `Context`.
PARSERS: dict[str, Callable[[str, Any, Context], Any]] = {
    **{name: partial(_numbers, unit=unit) for name, unit in STATE_AXES.items()},
    **{
        name: partial(_numbers, unit=unit, plausible=plausible)
        for name, (unit, plausible) in CASE_NUMBERS.items()
    },
    "level": _levels,
    "vehicle": _vehicles,
    "trim": _flags,
    "arm": _arms,
    "corrections": _corrections,
    "parameters": _sets,
    "recordings": _recordings,
    "in_collision": _flags,
}


class Axes(NamedTuple):
    """The axes of a study, in SI units.

    Attributes:
        cases: Axis of the arm and its surroundings -> values. If there is the axis
            ``recording``, it is the first.
        states: Axis of a state -> values.
        drawn: Axis of a state -> the range to draw from.
        in_collision: Which states are kept: those of which it is true, or false, that
            the arm touches itself. Empty without this axis.
        arms: Value of the axis ``arm`` -> its record.
    """

    cases: dict[str, Sequence[Any]]
    states: dict[str, list[float]]
    drawn: dict[str, Drawn]
    in_collision: list[bool]
    arms: dict[str, Alpha5Parameters]

    @property
    def grid(self) -> dict[str, Sequence[Any]]:
        """Axis by which rows can be told apart -> its values."""
        grid: dict[str, Sequence[Any]] = {**self.cases, **self.states}
        if self.in_collision:
            grid["in_collision"] = self.in_collision
        return grid

    @property
    def units(self) -> dict[str, str]:
        """Axis that has a unit -> its SI unit."""
        units = {name: unit for name, (unit, _) in CASE_NUMBERS.items()} | STATE_AXES
        names = [*self.cases, *self.states, *self.drawn]
        return {name: units[name] for name in names if name in units}


def read_axes(given: Mapping[str, Any], context: Context) -> Axes:
    """The axes of a study.

    Args:
        given: The table of a study file.
        context: What they refer to.

    Raises:
        InputError: An invalid axis, or axes that do not fit together.
        UnknownNameError: No such axis, unit, correction, level or vehicle.
        MissingFileError: No such arm file.
        FileFormatError: Not an arm file.
    """
    axes = Axes(cases={}, states={}, drawn={}, in_collision=[], arms={})
    for name, value in given.items():
        parse = PARSERS[choice("axis", name, tuple(PARSERS))]
        parsed = parse(f"axes.{name}", value, context)
        if isinstance(parsed, Drawn):
            axes.drawn[name] = parsed
        elif name in STATE_AXES:
            axes.states[name] = parsed
        elif name == "in_collision":
            axes.in_collision.extend(parsed)
        elif name == "recordings":
            axes.cases["recording"] = parsed
        elif name == "arm":
            axes.arms.update(parsed)
            axes.cases["arm"] = list(parsed)
        else:
            axes.cases[name] = parsed

    if "recording" in axes.cases:
        recordings = {"recording": axes.cases.pop("recording")}
        axes = axes._replace(cases={**recordings, **axes.cases})
    _check_together(axes)
    return axes


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
    positions = [f"{joint}_pos" for joint in JOINTS]
    if (recorded and states) or not (recorded or {*positions} <= states):
        expected = f"recordings alone, or all of {', '.join(positions)}"
        raise InputError("axes, states", sorted(states), expected)


def check_states(arm: Alpha5Parameters, axes: Axes) -> None:
    """Refuse states beyond the limits of an arm.

    Raises:
        InputError: States beyond its limits.
    """
    states: dict[str, Sequence[float]] = {**axes.states, **axes.drawn}
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
                expected = (
                    f"values within the limits of {arm.name}, "
                    f"{lower:.6g} to {upper:.6g} {unit}"
                )
                raise InputError(f"axes.{name}", f"{farthest:.6g} {unit}", expected)
