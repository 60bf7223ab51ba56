"""Values from the texts of options: numbers in SI units, names, and the arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from typer import BadParameter

from alpha5_model._support.checks import real
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.cli.syntax import split
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER, gravity_in_base

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.numbers.parameters import Alpha5Parameters


class _Unit(NamedTuple):
    """A unit that may follow a number.

    Attributes:
        si: The SI unit of the same quantity.
        size: Number of SI units in this unit.
    """

    si: str
    size: float


#: The units of `alpha5_model.cli.syntax`.
_UNITS = {
    "deg": _Unit(si="rad", size=math.pi / 180),
    "mm": _Unit(si="m", size=1e-3),
    "rad": _Unit(si="rad", size=1.0),
    "m": _Unit(si="m", size=1.0),
}
#: Unit -> the range in which a number without a unit is plausible.
_PLAUSIBLE = {
    "m": plausibility.POSITION,
    "rad": plausibility.ANGLE,
    "rad/s": plausibility.ANGLE,
    "rad/s^2": plausibility.ANGLE,
}
#: Option -> largest plausible number, in SI units; larger ones are typing errors.
_LARGEST = {"current": 100.0, "gravity": 1e4, "fluid": 1e5}
_FLUIDS = {"sea": SEA_WATER, "fresh": FRESH_WATER, "air": AIR}
_COUNT_WORDS = {2: "two", 3: "three", 4: "four", 5: "five"}

#: Hints about numbers of this run that seem to have another unit. The first hint is
#: printed with the error, or after the result.
hints: list[str] = []


def numbers(
    name: str, text: str, counts: Sequence[int] = (), unit: str = "", expected: str = ""
) -> list[float]:
    """Numbers in one text, separated by spaces or commas, in SI units.

    Args:
        counts: How many there may be; empty for any.
        unit: Their SI unit. If it is ``m`` or ``rad``, ``mm`` or ``deg`` may follow a
            number.
        expected: For the message; made from counts and unit if empty.

    Raises:
        InputError: Anything else.
    """
    expected = expected or _expected(counts, unit)
    units = _units_for(unit)
    try:
        values = [_number(part, units, unit) for part in split(text)]
    except ValueError:
        raise InputError(name, text, expected) from None

    if counts and len(values) not in counts:
        raise InputError(name, text, expected)
    largest = _LARGEST.get(name, math.inf)
    if any(abs(value) > largest for value in values):
        raise InputError(name, text, f"at most {largest:g} {unit}")
    return values


def _expected(counts: Sequence[int], unit: str) -> str:
    """How many numbers of which unit are expected, for the message."""
    words = [
        f"{_COUNT_WORDS.get(count, count)} numbers" if count > 1 else "one number"
        for count in counts
    ]
    return f"{' or '.join(words)} ({unit})"


def _units_for(unit: str) -> dict[str, _Unit]:
    """The units that may follow a number.

    Args:
        unit: SI unit of the number, or several: ``rad/s``, ``rad or m``, ``kg, m``.
    """
    kinds = ("rad", "m") if " m" in unit else (unit.partition("/")[0],)
    return {name: found for name, found in _UNITS.items() if found.si in kinds}


def _number(part: str, units: dict[str, _Unit], unit: str) -> float:
    """One number in SI units; adds a hint if it seems to lack its unit.

    Raises:
        ValueError: Not a number with one of the units.
    """
    own = next((name for name in units if part.endswith(name)), None)
    if own is not None:
        return float(part.removesuffix(own)) * units[own].size

    value = float(part)
    if unit in _PLAUSIBLE:
        hints.extend(plausibility.hints(part, value, _PLAUSIBLE[unit]))
    return value


def joint_numbers(
    name: str,
    text: str,
    unit: str,
    counts: Sequence[int],
    names: Sequence[str] = (),
) -> list[float]:
    """One number for each joint, base to tip.

    A unit alone at the end applies to the turning joints only.

    Args:
        names: What may be given in place of numbers, for the message.
    """
    words = " or ".join(_COUNT_WORDS[count] for count in sorted({*counts}))
    expected = f"{words} numbers ({unit}{', jaw rod m' if 5 in counts else ''})"
    expected = ", ".join([*names, f"or {expected}" if names else expected])
    parts = split(text)
    if len(parts) not in counts:
        raise InputError(name, text, expected)

    turning = " ".join(parts[:4])
    rod = " ".join(part.removesuffix("deg") for part in parts[4:])
    angles = numbers(name, turning, (4,), unit, expected)
    return angles + numbers(name, rod, (), unit.replace("rad", "m"), expected)


def joint_positions(
    name: str,
    text: str,
    counts: Sequence[int],
    record: Alpha5Parameters | None,
) -> list[float]:
    """Positions of the joints: numbers as `joint_numbers` takes them, or a named pose.

    Args:
        record: Of an arm of one's own, whose limits the pose keeps; None for the
            catalogue's.

    Raises:
        InputError: Neither.
    """
    from alpha5_model.description.srdf import NAMED_POSES, named_pose

    pose = text.strip()
    if pose in NAMED_POSES:
        return [float(angle) for angle in named_pose(pose, record)]
    return joint_numbers(name, text, "rad", counts, names=tuple(NAMED_POSES))


def current_vector(text: str | None) -> list[float] | None:
    """Velocity of a water current, (3,) [m/s]; None for no text."""
    return None if text is None else numbers("current", text, (3,), "m/s")


def metres(text: Any, unit: str = "m") -> float:
    """A length, for the parser of one argument."""
    try:
        (number,) = numbers("", str(text), (1,), unit)
    except InputError as error:
        raise BadParameter(f"expected {error.expected}, got {text!r}") from None
    return number


def radians(text: Any) -> float:
    """An angle, for the parser of one argument or option."""
    return metres(text, "rad")


def angular_speed(text: Any) -> float:
    """A speed [rad/s], for the parser of one option; ``deg`` may follow."""
    return metres(text, "rad/s")


def angular_acceleration(text: Any) -> float:
    """An acceleration [rad/s^2], for the parser of one option; ``deg`` may follow."""
    return metres(text, "rad/s^2")


def fluid_density(text: str) -> float:
    """``sea``, ``fresh``, ``air`` or a number [kg/m^3].

    Raises:
        InputError: Anything else.
    """
    if text in _FLUIDS:
        return _FLUIDS[text]
    expected = f"{', '.join(_FLUIDS)} or a density [kg/m^3]"
    (density,) = numbers("fluid", text, (1,), "kg/m^3", expected)
    return real("fluid", density, minimum=0.0)


def correction_names(text: str | None) -> tuple[str, ...]:
    """Names of corrections, unchecked; the default ones for None."""
    return DEFAULT_CORRECTIONS if text is None else names(text)


def names(text: str) -> tuple[str, ...]:
    """The parts between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def pairs(option: str, parts: list[str], sign: str) -> dict[str, str]:
    """Names and values, from texts with a sign between the two.

    Raises:
        InputError: A name without a value, or one that stands twice.
    """
    form = "axis_e=NAME,axis_d=NAME,..." if option == "map" else f"NAME{sign}VALUE"
    may_be_empty = option == "arg"

    pairs: dict[str, str] = {}
    for part in parts:
        if not part.strip():
            continue
        name, equals, value = part.strip().partition(sign)
        complete = name and equals and (value or may_be_empty)
        if not complete or name.strip() in pairs:
            raise InputError(option, ",".join(parts), f"{form} with each name once")
        pairs[name.strip()] = value.strip()
    return pairs


def arm_record(file: Path | None) -> Alpha5Parameters | None:
    """The record of an arm file; None for no file.

    Raises:
        Alpha5Error: A file that `arm_file` refuses.
    """
    if file is None:
        return None
    from alpha5_model.numbers.arm_file import arm_file

    return arm_file(file)


def arm_in(
    fluid: str,
    gravity: str,
    gripper: str,
    mount: str | None,
    payload: str | None,
    record: Alpha5Parameters | None = None,
) -> Arm:
    """The arm that the texts of these options describe.

    Args:
        fluid, gravity, gripper, payload: As on the command line.
        mount: Replaces the mount of the record; None keeps it.
        record: Of an arm of one's own; None for the catalogue's.
    """
    from alpha5_model.dynamics.load import load

    g: Any = numbers("gravity", gravity, (3,), "m/s^2")
    if mount is not None:
        rotation = rotation_from_rpy(numbers("mount", mount, (3,), "rad"))
        if not np.array_equal(rotation, np.eye(3)):
            g = gravity_in_base(rotation, g)
        if record is not None:
            record = replace(record, mount=None)
    arm = load(fluid_density(fluid), gripper, gravity=g, arm=record)
    return arm if payload is None else _with_payload(arm, payload)


def _with_payload(arm: Arm, text: str) -> Arm:
    mass, com, volume = payload_numbers(text)
    return arm.with_payload(mass, com, volume=volume, cob=com)


def payload_numbers(text: str) -> tuple[float, tuple[float, float, float], float]:
    """Mass [kg], centre of mass in tcp (3,) [m] and volume [m^3] of a payload."""
    expected = "MASS, MASS X Y Z or MASS X Y Z VOLUME (kg, m, m^3)"
    mass, *more = numbers("payload", text, (1, 4, 5), "kg, m", expected)
    x, y, z = more[:3] or [0.0, 0.0, 0.0]
    volume = more[3] if len(more) > 3 else 0.0
    return mass, (x, y, z), volume
