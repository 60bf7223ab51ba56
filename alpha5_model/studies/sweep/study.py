"""A study, read from TOML: what is varied and what is kept; every mistake is named with its place.

What there is to vary and to keep stands in ``study.toml`` beside this file.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import (
    choice,
    count,
    float_array,
    generator,
    listed,
    named,
    real,
    shaped,
)
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import CORRECTIONS

SCHEMA: Any = tomllib.loads(Path(__file__).with_name("study.toml").read_text("utf-8"))
_UNITS = SCHEMA["state"] | SCHEMA["case"]
#: Axis of a case -> what is plausible of the value farthest from 0.
_PLAUSIBLE = {
    "payload_mass": plausibility.MASS,
    "payload_x": plausibility.POSITION,
    "payload_y": plausibility.POSITION,
    "payload_z": plausibility.POSITION,
    "payload_volume": plausibility.VOLUME,
    "fluid_density": plausibility.FLUID_DENSITY,
    "current_speed": plausibility.CURRENT,
}
#: What a recording can be.
_RECORDED = (".csv", ".parquet", ".pq", ".bag", ".db3", ".mcap")
#: States computed at a time: what a kernel reads and writes of them stays in the cache.
BLOCK = 8192
#: A dotted key with more parts than any study has; ``tomllib`` takes minutes for a long one.
_LONG_KEY = re.compile(
    r"""(?<![\w.-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){20}"""
)
#: Most values of an axis, and most groups or bins of an output.
_MOST = 10_000_000


class Output(NamedTuple):
    """What is kept of a quantity, its unit and columns: its form, the axes of a map, levels, range and bins."""

    quantity: str
    unit: str
    columns: Sequence[str]
    form: str
    by: Sequence[str]
    levels: Sequence[float]
    range: tuple[float, float]
    bins: int


@dataclass(frozen=True, eq=False)
class Study:
    """A study, checked. Rows are numbered case by case, state by state, the last axis fastest.

    Attributes:
        text, source, folder: As read, the file's name, and where relative paths of recordings start.
        seed: Of all that is drawn.
        samples: States drawn for each point of the grid; every case has the same ones.
        cases, states: Axis -> values, in SI units; ``recording``, of cases, is the first.
        drawn: Axis -> the range that each state has its own number of.
        outputs: By name.
    """

    text: str
    source: str
    folder: Path
    seed: int
    samples: int
    cases: dict[str, Sequence[Any]]
    states: dict[str, Sequence[float]]
    drawn: dict[str, Sequence[float]]
    outputs: dict[str, Output]

    def sizes(self) -> tuple[int, int, int]:
        """Number of cases, of states and of blocks in each; of recordings that is not known, and 1."""
        cases, states = (
            math.prod(map(len, grid.values())) for grid in (self.cases, self.states)
        )
        return cases, states * self.samples, -(-states * self.samples // BLOCK)

    def __reduce__(self) -> tuple[Any, ...]:
        # A process makes the study of its many tasks once.
        return _study, (
            self.text,
            self.source,
            self.folder,
            self.cases.get("recording"),
        )


def read_study(study: PathLike) -> Study:
    """A study from a TOML file.

    Raises:
        MissingFileError: No such file.
        FileFormatError: Not TOML, or an axis, range, unit, name or output that cannot be; with its place.

    Warns:
        ImplausibleWarning: Values of an axis that seem to be in another unit.
    """
    text = read_named(study, "a study (TOML)").decode("utf-8-sig", "replace")
    folder = Path(study).resolve().parent
    found = _study(text.replace("\r\n", "\n"), str(study), folder)
    for name, limits in _PLAUSIBLE.items():
        farthest = max(found.cases.get(name, [0.0]), key=abs)
        plausibility.check(f"axes.{name}", farthest, limits)
    return found


@lru_cache(maxsize=2)
def _study(
    text: str, source: str, folder: Path, found: tuple[str, ...] | None = None
) -> Study:
    long_key = _LONG_KEY.search(text)
    if long_key:
        place = f"line {text.count(chr(10), 0, long_key.start()) + 1}"
        raise FileFormatError(source, "a key of more than 20 parts", place)
    try:
        given = tomllib.loads(text)
        named("key", given, ("seed", "samples", "axes", "outputs"))
        for key in ("axes", "outputs"):
            if not isinstance(given.get(key), dict) or not given[key]:
                raise InputError(key, given.get(key), "a table with at least one key")
        cases, states, drawn = _axes(given["axes"], folder, found)
        seed: Any = given.get("seed", 0)
        samples: Any = given.get("samples", None if drawn else 1)
        generator(seed)
        if count("samples", samples) > 1 and not drawn:
            raise InputError("samples", samples, "none where no axis is random")
        asked, grid = given["outputs"].items(), cases | states
        outputs = {name: _output(name, table, grid) for name, table in asked}
        return Study(text, source, folder, seed, samples, cases, states, drawn, outputs)
    except ValueError as error:  # of TOML, or this package's own
        raise FileFormatError(source, str(error)) from None
    except RecursionError:
        raise FileFormatError(
            source, "expected fewer brackets inside one another"
        ) from None


def _axes(
    given: dict[str, Any], folder: Path, found: Any
) -> Sequence[dict[str, Sequence[Any]]]:
    """Axes of cases, axes of states, and those of states that are drawn."""
    kinds: tuple[dict[str, Any], ...] = {}, {}, {}
    cases, states, drawn = kinds
    if "recordings" in given:
        cases["recording"] = found or _recordings(given["recordings"], folder)
    for name in [name for name in given if name != "recordings"]:
        random = isinstance(given[name], dict) and "random" in given[name]
        kind = cases if name in SCHEMA["case"] else drawn if random else states
        kind[name] = _axis(name, given[name])
    if {"parameters", "corrections"} <= {*cases}:
        raise InputError("axes", "parameters and corrections", "one of them")
    names, needed = (
        {*states, *drawn},
        {name for name in SCHEMA["state"] if "_pos" in name},
    )
    if names if "recording" in cases else not needed <= names:
        expected = f"recordings alone, or all of {', '.join(sorted(needed))}"
        raise InputError("axes, states", sorted(names), expected)
    return kinds


def _recordings(given: Any, folder: Path) -> tuple[str, ...]:
    """Files, in order; those of folders by their names."""
    found: list[str] = []
    for path in (
        [given] if isinstance(given, str) else listed("axes.recordings", given, "files")
    ):
        whole = folder / str(path)
        inside = sorted(p.name for p in whole.iterdir()) if whole.is_dir() else []
        found += [
            str(Path(path, name)) for name in inside if Path(name).suffix in _RECORDED
        ]
        found += [] if whole.is_dir() else [str(path)]
    if not found:
        expected = f"files, or folders with some of {', '.join(_RECORDED)}"
        raise InputError("axes.recordings", given, expected)
    return tuple(found)


def _axis(name: str, given: Any) -> Sequence[Any]:
    """Values of an axis, or the range to draw from."""
    place, unit = f"axes.{name}", _UNITS[choice("axis", name, (*_UNITS, "recordings"))]
    if name == "parameters":
        return range(count(place, given))
    if name == "corrections":
        names = listed(
            place, given, "a list of names, such as ['none', 'base_frame+link3_cob']"
        )
        named(place, "+".join(map(str, names)).split("+"), ("none", *CORRECTIONS))
        return names
    table = given if isinstance(given, dict) else {"values": given}
    units, keys = SCHEMA["units"][unit], {*table} - {"unit"}
    scale = units[choice(f"unit of {place}", table.get("unit", unit), tuple(units))]
    if keys == {"values"}:
        values = np.atleast_1d(float_array(place, table["values"], ()))
    elif keys == {"from", "to", "count"}:
        size = min(count(f"{place}.count", table["count"]), _MOST + 1)
        values = np.linspace(*_rising(place, [table["from"], table["to"]]), size)
    elif keys == {"random"} and name in SCHEMA["state"]:
        values = np.array(_rising(place, table["random"]))
    else:
        raise InputError(
            place, given, "values; from, to and count; or of a state, random"
        )
    if not 0 < values.size <= _MOST:
        raise InputError(place, given, f"1 to {_MOST} values")
    least = 0.0 if unit in ("kg", "m^3", "kg/m^3", "m/s") else None
    return [real(place, scale * x, least) for x in values.ravel().tolist()]


def _rising(place: str, ends: Any) -> tuple[float, float]:
    low, high = shaped(place, ends, (2,)).tolist()
    if not low < high:
        raise InputError(place, ends, "two numbers, the second above the first")
    return low, high


def _output(name: str, given: Any, grid: dict[str, Any]) -> Output:
    place, table = f"outputs.{name}", given if isinstance(given, dict) else {}
    if not re.fullmatch(r"[\w-]+", name):
        raise InputError("outputs", name, "names of letters, digits, _ and -")
    quantity = choice(
        f"{place}.quantity", table.get("quantity"), tuple(SCHEMA["quantities"])
    )
    form = choice(f"{place}.as", table.get("as"), tuple(SCHEMA["forms"]))
    named(f"key of {place}", table, ("quantity", "as", *SCHEMA["forms"][form]))
    by, levels = (
        listed(f"{place}.{k}", table.get(k, ()), "a list") for k in ("by", "levels")
    )
    for axis in by:
        choice(f"axis of {place}.by", axis, tuple(grid))
    if form == "quantile":
        levels = [real(f"{place}.levels", level) for level in levels]
        if not levels or not 0 < min(levels) <= max(levels) <= 1:
            raise InputError(f"{place}.levels", levels, "numbers above 0, up to 1")
    span, bins = (
        (table.get("range"), table.get("bins")) if form == "histogram" else ([0, 1], 1)
    )
    bins = count(f"{place}.bins", bins)
    if max(bins, math.prod(len(grid[axis]) for axis in by)) > _MOST:
        raise InputError(place, given, f"at most {_MOST} groups or bins")
    unit, *columns = SCHEMA["quantities"][quantity]
    ends = _rising(f"{place}.range", span)
    return Output(quantity, unit, columns, form, by, levels, ends, bins)
