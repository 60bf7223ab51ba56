"""A study, read from TOML; messages name the place of a mistake."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.checks import (
    choice,
    count,
    flag,
    generator,
    listed,
    named,
    real,
)
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.text import plain
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.kernels.choice import backend
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue
from alpha5_model.studies.sweep.axes import (
    CATALOGUE,
    JOINTS,
    MOST,
    Axes,
    Context,
    check_states,
    read_axes,
    rising,
)
from alpha5_model.water.carrier import read_carrier

_XYZ = ("x", "y", "z", "norm")
#: Quantity -> its unit and its columns.
QUANTITIES = {
    "torque": ("N m", JOINTS),
    "current": ("A", JOINTS),
    "power": ("W", JOINTS),
    "margin": ("N m", JOINTS),
    "mount_force": ("N", _XYZ),
    "mount_moment": ("N m", _XYZ),
    "reach": ("m", _XYZ),
    "trim": ("rad", ("roll", "pitch")),
}
#: Form of an output -> its own keys.
FORMS = {
    "peak": ("by",),
    "maximum": ("by",),
    "minimum": ("by",),
    "quantile": ("levels",),
    "histogram": ("range", "bins"),
    "table": (),
}
#: Tables and keys of a study.
_KEYS = (
    "seed",
    "samples",
    "leave_out_self_collision",
    "axes",
    "vehicles",
    "outputs",
)
#: Row numbers reserved for each recording, whose number of samples is not known before.
_ROWS_OF_RECORDING = 2**32


class Output(NamedTuple):
    """A figure of a quantity that is kept.

    Attributes:
        quantity: Its name.
        unit: Its unit.
        columns: Names of its columns.
        form: One of `FORMS`.
        by: Axes of a map of extremes.
        levels: Of quantiles.
        range: Ends of a histogram.
        bins: Of a histogram.
    """

    quantity: str
    unit: str
    columns: Sequence[str]
    form: str
    by: Sequence[str] = ()
    levels: Sequence[float] = ()
    range: tuple[float, float] = (0.0, 1.0)
    bins: int = 1


@dataclass(frozen=True, eq=False)
class Study:
    """A study, checked.

    Rows are numbered case by case, state by state, the last axis fastest.

    Attributes:
        folder: Where relative paths of recordings start.
        text: As read.
        settings: Its tables and keys, without comments.
        seed: Of all random numbers.
        samples: States drawn for each point of the grid, the same in every case.
        axes: What it varies.
        vehicles: Those that the study describes, by name.
        outputs: By name.
        leaves_out_collisions: Leave out the states at which the arm touches itself.
        arm: Record of an arm of your own; None for the catalogue's.
        made_by: See `made_by`.
    """

    folder: Path
    text: str
    settings: dict[str, Any]
    seed: int
    samples: int
    axes: Axes
    vehicles: dict[str, Any]
    outputs: dict[str, Output]
    leaves_out_collisions: bool
    arm: Alpha5Parameters | None
    made_by: str

    @property
    def recordings(self) -> Sequence[str]:
        """Paths of its recordings; none for a study of states."""
        return self.axes.cases.get("recording", ())

    @property
    def cases(self) -> int:
        """Number of cases."""
        return math.prod(map(len, self.axes.cases.values()))

    @property
    def states(self) -> int:
        """Row numbers of each case: states, or more than any recording has."""
        if self.recordings:
            return _ROWS_OF_RECORDING
        return self.samples * math.prod(map(len, self.axes.states.values()))

    def arm_of(self, case: Mapping[str, Any]) -> Alpha5Parameters | None:
        """The record of the arm of a case; None for the catalogue's.

        Args:
            case: Axis of the cases -> value.
        """
        return self.axes.arms[case["arm"]] if "arm" in case else self.arm

    @property
    def has_table(self) -> bool:
        """Whether it keeps rows."""
        return any(output.form == "table" for output in self.outputs.values())

    @cached_property
    def head(self) -> str:
        """All that the results depend on but the recordings' content, as JSON."""
        parts = {
            "made_by": self.made_by,
            "study": self.settings,
            "recordings": self.recordings,
            "arms": plain(self.axes.arms),
            "arm": plain(self.arm),
        }
        return json.dumps(parts, ensure_ascii=False, default=str)

    @cached_property
    def key(self) -> str:
        """A hash of `head`."""
        return hashlib.sha256(self.head.encode()).hexdigest()[:16]


def made_by() -> str:
    """Version and kernels, which the last digits of the results depend on."""
    from alpha5_model import __version__

    return f"alpha5-model {__version__}, {backend().partition(' ')[0]} kernels"


def read_study(study: PathLike, arm: Alpha5Parameters | None = None) -> Study:
    """A study from a TOML file.

    Args:
        study: The file.
        arm: Record of an arm of your own; None for the catalogue's.

    Raises:
        MissingFileError: No such file, or no such arm file.
        FileFormatError: Not TOML, or an invalid axis, range, unit, name or output, with
            place; states beyond the limits of an arm of your own.

    Warns:
        ImplausibleWarning: Values of an axis that seem to be in another unit.
    """
    text = read_named(study, "a study (TOML)").decode("utf-8-sig", "replace")
    text = text.replace("\r\n", "\n")
    settings = toml_tables(text, str(study))
    if arm is not None:
        record = chosen_arm(arm)
        if is_catalogue(record) and record.corrections == DEFAULT_CORRECTIONS:
            arm = None
    try:
        return _checked(settings, text, Path(study), arm)
    except FileFormatError:  # of an arm file
        raise
    except ValueError as error:  # this package's own
        raise FileFormatError(str(study), str(error)) from None


def _checked(
    given: dict[str, Any], text: str, source: Path, arm: Alpha5Parameters | None
) -> Study:
    """The study in the tables of a file.

    Raises:
        InputError: An invalid value, with its place.
    """
    named("key", given, _KEYS)
    for key in ("axes", "outputs"):
        if not isinstance(given.get(key), dict) or not given[key]:
            raise InputError(key, given.get(key), "a table with at least one key")
    tables = given.get("vehicles", {})
    if not isinstance(tables, dict):
        raise InputError("vehicles", tables, "tables [vehicles.NAME]")
    vehicles = {
        name: read_carrier(f"vehicles.{name}", table) for name, table in tables.items()
    }
    folder = source.resolve().parent
    axes = read_axes(given["axes"], Context(folder=folder, vehicles=vehicles))
    _check_arms(axes, arm)

    place = "leave_out_self_collision"
    leaves_out = flag(place, given.get(place, False))
    if leaves_out and axes.in_collision:
        expected = f"no {place} beside it"
        raise InputError("axes.in_collision", axes.in_collision, expected)
    seed = given.get("seed", 0)
    generator(seed)
    samples = count("samples", given.get("samples", None if axes.drawn else 1))
    if samples > 1 and not axes.drawn:
        raise InputError("samples", samples, "none if no axis is random")

    outputs = {
        name: _output(name, table, axes.grid)
        for name, table in given["outputs"].items()
    }
    return Study(
        folder=folder,
        text=text,
        settings=given,
        seed=seed,
        samples=samples,
        axes=axes,
        vehicles=vehicles,
        outputs=outputs,
        leaves_out_collisions=leaves_out,
        arm=arm,
        made_by=made_by(),
    )


def _check_arms(axes: Axes, arm: Alpha5Parameters | None) -> None:
    """Refuse what an arm of one's own contradicts, and states beyond its limits."""
    own = [record for name, record in axes.arms.items() if name != CATALOGUE]
    if arm is not None:
        own.append(arm)
        reasons = {
            "arm": "is the arm of the whole study",
            "corrections": "has its own corrections",
        }
        for name, reason in reasons.items():
            if name in axes.cases:
                expected = f"none beside {arm.name}, which {reason}"
                raise InputError(f"axes.{name}", axes.cases[name], expected)
    for record in own:
        check_states(record, axes)


def _output(name: str, given: Any, grid: Mapping[str, Sequence[Any]]) -> Output:
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

    unit, columns = QUANTITIES[quantity]
    output = Output(quantity=quantity, unit=unit, columns=columns, form=form)
    if form == "quantile":
        place = f"{place}.levels"
        given_levels = listed(place, table.get("levels", ()), "a list")
        levels = [real(place, level) for level in given_levels]
        if not levels or not 0 < min(levels) <= max(levels) <= 1:
            raise InputError(place, levels, "numbers above 0, up to 1")
        return output._replace(levels=levels)

    if form == "histogram":
        bins = count(f"{place}.bins", table.get("bins"))
        ends = rising(f"{place}.range", table.get("range"))
        output = output._replace(bins=bins, range=ends)
    by = listed(f"{place}.by", table.get("by", ()), "a list")
    for axis in by:
        choice(f"axis of {place}.by", axis, tuple(grid))
    groups = math.prod(len(grid[axis]) for axis in by)
    if max(output.bins, groups) > MOST:
        raise InputError(place, given, f"at most {MOST} groups or bins")
    return output._replace(by=by)
