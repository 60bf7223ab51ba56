"""A study, read from TOML; messages name the place of a mistake."""

from __future__ import annotations

import math
import pickle
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.checks import count, flag, generator, named
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue
from alpha5_model.studies.sweep.axes import (
    StudyFiles,
    check_alone,
    check_arm,
    read_axes,
)
from alpha5_model.studies.sweep.named_axes import CATALOGUE
from alpha5_model.studies.sweep.outputs import Output, read_output
from alpha5_model.studies.sweep.vehicles import read_vehicles
from alpha5_model.water.carrier import Carrier

#: Axis of a case -> plausible range of the value farthest from 0.
_PLAUSIBLE = {
    "payload_mass": plausibility.MASS,
    "payload_x": plausibility.POSITION,
    "payload_y": plausibility.POSITION,
    "payload_z": plausibility.POSITION,
    "payload_volume": plausibility.VOLUME,
    "fluid_density": plausibility.FLUID_DENSITY,
    "current_speed": plausibility.CURRENT,
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
#: States computed at a time: the numbers of so many stay in the cache.
BLOCK = 8192


class Sizes(NamedTuple):
    """The size of a study.

    Attributes:
        cases: Number of cases.
        states: States per case; 1 for a recording, whose size is not known.
        blocks: Blocks per case.
    """

    cases: int
    states: int
    blocks: int


@dataclass(frozen=True, eq=False)
class Study:
    """A study, checked.

    Rows are numbered case by case, state by state, the last axis fastest.

    Attributes:
        text: As read.
        settings: Its tables and keys, without comments.
        source: The file's name.
        folder: Where relative paths of recordings and arm files start.
        seed: Of all random numbers.
        samples: States drawn for each point of the grid, the same in every case.
        cases, states: Axis -> values, in SI units. The axis ``recording`` of the cases
            is the first.
        drawn: Axis -> the range from which each state draws its own value.
        outputs: By name.
        leaves_out_collisions: Leave out the states of the grid, and random ones, at
            which the arm touches itself.
        in_collision: Which states are kept, and told apart: those of which it is true,
            or false, that the arm touches itself. Empty for all, not told apart.
        vehicles: Those that the study describes, by name.
        files: Its recordings, and the records of the axis ``arm``.
        arm: Record of an arm of your own; None for the catalogue's.
    """

    text: str
    settings: dict[str, Any]
    source: str
    folder: Path
    seed: int
    samples: int
    cases: dict[str, Sequence[Any]]
    states: dict[str, Sequence[float]]
    drawn: dict[str, Sequence[float]]
    outputs: dict[str, Output]
    leaves_out_collisions: bool
    in_collision: Sequence[bool]
    vehicles: dict[str, Carrier]
    files: StudyFiles
    arm: Alpha5Parameters | None = None

    @property
    def axes(self) -> dict[str, Sequence[Any]]:
        """Axis that has values, by which rows can be told apart -> its values."""
        axes: dict[str, Sequence[Any]] = {**self.cases, **self.states}
        return {**axes, **_collision_axis(self.in_collision)}

    def arm_of(self, case_index: Mapping[str, int]) -> Alpha5Parameters | None:
        """The record of the arm of a case; None for the catalogue's.

        Args:
            case_index: Axis of the cases -> index of its value.
        """
        if "arm" not in self.cases:
            return self.arm
        return self.files.arms[self.cases["arm"][case_index["arm"]]]

    def sizes(self) -> Sizes:
        """Number of cases, and of states and blocks in each."""
        states = self.samples * _points(self.states)
        return Sizes(
            cases=_points(self.cases), states=states, blocks=-(-states // BLOCK)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickled as its text: a worker then reads it once for all its chunks.
        read = (pickle.dumps(self.files), _packed(self.arm))
        return _kept_study, (self.text, self.source, self.folder, *read)


def read_study(study: PathLike, arm: Alpha5Parameters | None = None) -> Study:
    """A study from a TOML file.

    Args:
        study: The file.
        arm: Record of an arm of your own; None for the catalogue's.

    Raises:
        MissingFileError: No such file.
        FileFormatError: Not TOML, or an invalid axis, range, unit, name or output, with
            place. With an arm, also states beyond its limits.

    Warns:
        ImplausibleWarning: Values of an axis that seem to be in another unit.
    """
    text = read_named(study, "a study (TOML)").decode("utf-8-sig", "replace")
    folder = Path(study).resolve().parent
    own = None if arm is None or _is_default(arm) else _packed(arm)
    found = _study(text.replace("\r\n", "\n"), str(study), folder, None, own)
    for name, limits in _PLAUSIBLE.items():
        if name in found.cases:
            farthest = max(found.cases[name], key=abs)
            plausibility.check(f"axes.{name}", farthest, limits)
    return found


def _points(grid: dict[str, Sequence[Any]]) -> int:
    """Number of points of a grid."""
    return math.prod(len(values) for values in grid.values())


def _collision_axis(values: Sequence[bool]) -> dict[str, Sequence[bool]]:
    """The axis ``in_collision``, if a study has it."""
    return {"in_collision": values} if values else {}


def _is_default(arm: Alpha5Parameters) -> bool:
    """Whether a record is the catalogue's, as it is without an arm."""
    record = chosen_arm(arm)
    return is_catalogue(record) and record.corrections == DEFAULT_CORRECTIONS


def _packed(arm: Alpha5Parameters | None) -> bytes | None:
    """A record as bytes, by which a worker knows it again."""
    return None if arm is None else pickle.dumps(arm)


@lru_cache(maxsize=2)
def _kept_study(
    text: str, source: str, folder: Path, files: bytes, arm: bytes | None
) -> Study:
    """The study that was sent to a worker, kept for its next chunk."""
    return _study(text, source, folder, files, arm)


def _study(
    text: str, source: str, folder: Path, files: bytes | None, arm: bytes | None
) -> Study:
    """The study in a text.

    Args:
        text: TOML.
        source: Name of its file, for messages.
        folder: Where relative paths of files start.
        files: Its `StudyFiles` as bytes, if they were read before.
        arm: Its `_packed` arm.

    Raises:
        FileFormatError: Not TOML, or not a study.
    """
    tables = toml_tables(text, source)
    own = None if arm is None else pickle.loads(arm)
    present = None if files is None else pickle.loads(files)
    try:
        study = _checked(tables, text, source, folder, present)
        by_name = study.files.arms
        arms = [by_name[name] for name in by_name if name != CATALOGUE]
        if own is not None:
            check_alone(own, study.cases)
            arms.append(own)
        for record in arms:
            check_arm(record, {**study.states, **study.drawn})
        return replace(study, arm=own)
    except FileFormatError:  # of an arm file
        raise
    except ValueError as error:  # this package's own
        raise FileFormatError(source, str(error)) from None


def _checked(
    given: dict[str, Any],
    text: str,
    source: str,
    folder: Path,
    files: StudyFiles | None,
) -> Study:
    """The study in the tables of a file.

    Raises:
        InputError: An invalid value, with its place.
    """
    named("key", given, _KEYS)
    for key in ("axes", "outputs"):
        if not isinstance(given.get(key), dict) or not given[key]:
            raise InputError(key, given.get(key), "a table with at least one key")

    vehicles = read_vehicles(given.get("vehicles", {}))
    axes = read_axes(given["axes"], folder, tuple(vehicles), files)
    leaves_out = flag(
        "leave_out_self_collision", given.get("leave_out_self_collision", False)
    )
    if leaves_out and axes.in_collision:
        expected = "no leave_out_self_collision beside it"
        raise InputError("axes.in_collision", list(axes.in_collision), expected)
    seed = given.get("seed", 0)
    generator(seed)
    samples = count("samples", given.get("samples", None if axes.drawn else 1))
    if samples > 1 and not axes.drawn:
        raise InputError("samples", samples, "none where no axis is random")

    grid = {**axes.cases, **axes.states, **_collision_axis(axes.in_collision)}
    return Study(
        text=text,
        settings=given,
        source=source,
        folder=folder,
        seed=seed,
        samples=samples,
        cases=axes.cases,
        states=axes.states,
        drawn=axes.drawn,
        outputs={
            name: read_output(name, table, grid)
            for name, table in given["outputs"].items()
        },
        leaves_out_collisions=leaves_out,
        in_collision=axes.in_collision,
        vehicles=vehicles,
        files=axes.files,
    )
