"""Axes of a study whose values are no numbers: files, names, yes and no."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import choice, flag, listed, named
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_file import arm_file
from alpha5_model.numbers.corrections import CORRECTIONS
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

#: Suffixes of recordings in a folder.
_RECORDINGS = (".csv", ".parquet", ".pq", ".bag", ".db3", ".mcap")
#: The value of the axis ``arm`` that is no file.
CATALOGUE = "catalogue"


def recordings_of(given: Any, folder: Path) -> tuple[str, ...]:
    """Paths of recordings, in the order given; those of a folder by their names.

    Raises:
        InputError: None.
    """
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


def corrections_of(given: Any) -> list[str]:
    """Sets of corrections, each joined by ``+``.

    Raises:
        InputError: Not a list.
        UnknownNameError: A correction that is not recorded.
    """
    place = "axes.corrections"
    expected = "a list of names, such as ['none', 'base_frame+link3_cob']"
    sets = listed(place, given, expected)
    every_name = "+".join(map(str, sets)).split("+")
    named(place, every_name, ("none", *CORRECTIONS))
    return sets


def levels_of(given: Any) -> list[str]:
    """Levels of the estimated added mass and drag.

    Raises:
        InputError: None, or one of them twice.
        UnknownNameError: No such level.
    """
    return _values("axes.level", given, lambda name: choice("level", name, LEVELS))


def vehicles_of(given: Any, vehicles: Sequence[str]) -> list[str]:
    """Names of vehicles.

    Args:
        given: Of the axis.
        vehicles: Those that the study describes.

    Raises:
        InputError: None, or one of them twice.
        UnknownNameError: The study describes no such vehicle.
    """
    if not vehicles:
        raise InputError("axes.vehicle", given, "a table [vehicles.NAME] in the study")
    return _values(
        "axes.vehicle", given, lambda name: choice("vehicle", name, vehicles)
    )


def flags_of(place: str, given: Any) -> list[bool]:
    """True, False, or both.

    Raises:
        InputError: Anything else.
    """
    return _values(place, given, lambda value: flag(place, value))


def arms_of(given: Any, folder: Path) -> dict[str, Alpha5Parameters]:
    """Value of the axis ``arm`` -> its record.

    Args:
        given: Paths of arm files, or ``"catalogue"``.
        folder: Where relative paths start.

    Raises:
        InputError: None, or one of them twice.
        MissingFileError: No such file.
        FileFormatError: Not an arm file.
    """
    names = _values("axes.arm", given, str)
    return {
        name: chosen_arm(None) if name == CATALOGUE else arm_file(folder / name)
        for name in names
    }


def _values(place: str, given: Any, checked: Callable[[Any], Any]) -> list[Any]:
    """The values of an axis, given as a list or as one of them; each once."""
    several = isinstance(given, list)
    values = [checked(value) for value in (given if several else [given])]
    if not values or len({*values}) < len(values):
        raise InputError(place, given, "at least one value, each once")
    return values
