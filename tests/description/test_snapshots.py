"""Two files of an arm of one's own that no committed file is like, to be read.

Other tests compare descriptions with the tables, and the committed ones are those of
the catalogue's arm. After a change that you meant, run ``ALPHA5_UPDATE_PRINTED=1 python
-m pytest tests/description/test_snapshots.py`` and read the difference.
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest
from committed_texts import check_committed

import alpha5_model as a5
from alpha5_model.description.sdf import SdfOptions, sdf
from alpha5_model.description.water_table import WaterOptions, water_table
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import Pose

FOLDER = Path(__file__).parent / "snapshots"
EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")


@pytest.fixture(scope="module")
def arm() -> Alpha5Parameters:
    """The example of an arm file."""
    return a5.arm_file(EXAMPLE)


def check(name: str, lines: Iterable[str]) -> None:
    """Fail unless the lines are those of the committed file, without their sources.

    Numbers have six digits; smaller ones than 1e-15 are rounding.
    """
    shown = [
        NUMBER.sub(lambda found: _number(float(found[0])), line)
        for line in lines
        if "alpha5_model" not in line
    ]
    check_committed(FOLDER / name, "\n".join(shown) + "\n")


def _number(value: float) -> str:
    return f"{0.0 if 0.0 < abs(value) < 1e-15 else value:.6g}"


def test_gazebos_model_on_the_world(arm: Alpha5Parameters) -> None:
    assert arm.mount is not None
    mount = Pose(arm.mount.position, arm.mount.rotation, "world")
    on_world = dataclasses.replace(arm, mount=mount, attached=())
    check("model.sdf", sdf(SdfOptions(arm=on_world, fluid_density=1000.0)).splitlines())


def test_the_table_of_the_water(arm: Alpha5Parameters) -> None:
    table = water_table(WaterOptions("jaws", arm=arm))
    del table["provenance"]
    check("water.json", _rows("", table))


def _rows(name: str, value: object) -> Iterator[str]:
    """One line for each value, or list of values, by its path."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _rows(f"{name} {key}", item)
    else:
        yield f"{name[1:]}: {json.dumps(value)}"
