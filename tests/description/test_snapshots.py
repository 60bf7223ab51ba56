"""What is written for Gazebo, MuJoCo, USD and xacro, as files that a person can read.

Other tests compare these files with the tables, and the committed descriptions are
those of the catalogue's arm. Here is an arm of a laboratory, with options that no
committed file has. After a change that you meant, run ``ALPHA5_UPDATE_PRINTED=1 python
-m pytest tests/description/test_snapshots.py`` and read the difference.
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from committed_texts import check_committed

import alpha5_model as a5
from alpha5_model.description.lighthill import LighthillOptions, lighthill_files
from alpha5_model.description.mjcf import MjcfOptions, mjcf
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_world
from alpha5_model.description.srdf import srdf
from alpha5_model.description.usd import UsdOptions, usd_files
from alpha5_model.description.water_table import WaterOptions, water_table
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.numbers.mount import Mount
from alpha5_model.numbers.parameters import Alpha5Parameters

FOLDER = Path(__file__).parent / "snapshots"
EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
#: Measured motors of one joint, at its motor.
MOTORS = """
friction = {axis_d = 0.002}
friction_backward = {axis_d = 0.001}
viscous_friction = {axis_d = 1e-6}
rotor_inertia = {axis_d = 1e-7}
"""
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")
#: Coefficients of Gazebo's drag are one to a line.
COEFFICIENT = re.compile(r"(?:\s*<(\w+abs\w)>[^<]*</\1>)+")
#: Longer lists of numbers are described by sums.
SHORT = 16
#: Smaller numbers are rounding of zero, which differs between machines.
ROUNDING = 1e-15


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Alpha5Parameters:
    """The example of an arm file, with measured motors."""
    file = tmp_path_factory.mktemp("arm") / EXAMPLE.name
    text = EXAMPLE.read_text("utf-8")
    file.write_text(text.replace("[motors]", f"[motors]{MOTORS}"), "utf-8")
    return a5.arm_file(file)


@pytest.fixture(scope="module")
def bare(arm: Alpha5Parameters) -> Alpha5Parameters:
    """The same arm with nothing attached: no proof is needed of which links meet."""
    return dataclasses.replace(arm, attached=())


@pytest.fixture(scope="module")
def on_world(bare: Alpha5Parameters) -> Alpha5Parameters:
    """The arm with nothing attached, and not under a vehicle."""
    assert bare.mount is not None
    mount = Mount("world", bare.mount.position, bare.mount.rotation)
    return dataclasses.replace(bare, mount=mount)


def rounded(line: str) -> str:
    """A line with six digits of each number; of many, how many and two sums."""
    written = NUMBER.findall(line)
    if len(written) <= SHORT:
        return NUMBER.sub(lambda found: _number(float(found[0])), line)
    values = np.array(written, float)
    # Weights that tell any two places apart.
    weighted = float(values @ np.cos(np.arange(len(values))))
    sums = f"{_number(float(values.sum()))} {_number(weighted)}"
    start = line[: line.index(written[0])]
    return f"{start}({len(values)} numbers with sums {sums})"


def _number(value: float) -> str:
    return f"{0.0 if 0.0 < abs(value) < ROUNDING else value:.6g}"


def check(name: str, lines: Iterable[str]) -> None:
    """Fail unless the lines are those of the committed file, without their sources."""
    shown = [rounded(line) for line in lines if "alpha5_model" not in line]
    check_committed(FOLDER / name, "\n".join(shown) + "\n")


def test_gazebos_world_with_controllers_and_moving_water(arm: Alpha5Parameters) -> None:
    options = SdfOptions("jaws", hydrodynamics=True, controllers=True, arm=arm)
    text = COEFFICIENT.sub(_in_one_line, sdf_world(options))
    check("world.sdf", text.splitlines())


def _in_one_line(found: re.Match[str]) -> str:
    lines = found[0].split()
    return f"\n<drag> {' '.join(re.sub('</?|>', ' ', line) for line in lines)}"


def test_gazebos_model_on_the_world(on_world: Alpha5Parameters) -> None:
    check("model.sdf", sdf(SdfOptions(arm=on_world, fluid_density=1000.0)).splitlines())


def test_mujocos_model_with_moving_water_and_motors(bare: Alpha5Parameters) -> None:
    options = MjcfOptions("jaws", actuators="velocity", hydrodynamics=True, arm=bare)
    check("moving_water.xml", mjcf(options, meshes=["link_1.obj"]).splitlines())


def test_mujocos_model_for_brax(on_world: Alpha5Parameters) -> None:
    options = MjcfOptions(
        actuators="motor", collision="none", buoyancy="none", arm=on_world
    )
    check("for_brax.xml", mjcf(options).splitlines())


def test_mujocos_model_with_its_own_drag() -> None:
    options = MjcfOptions(actuators="motor", drag=True, fluid_density=1000.0)
    check("own_drag.xml", mjcf(options).splitlines())


def test_usd(bare: Alpha5Parameters) -> None:
    pytest.importorskip("pxr", reason="usd-core is not installed")
    text = usd_files(UsdOptions("jaws", arm=bare))["alpha5.usda"].decode()
    check("alpha5.usda", text.splitlines())


def test_numbers_for_xacro(arm: Alpha5Parameters) -> None:
    numbers = yaml.safe_load(parameter_yaml(arm))
    del numbers["provenance"]
    check("parameters.yaml", _rows("", numbers))


def test_srdf(bare: Alpha5Parameters) -> None:
    check("alpha5.srdf", srdf("jaws", bare).splitlines())


def test_lighthills_water(arm: Alpha5Parameters) -> None:
    options = LighthillOptions("jaws", fluid_density=1000.0, arm=arm, level="high")
    content = yaml.safe_load(lighthill_files(options)["lighthill.yaml"])
    links = {link["name"]: link for link in content["links"]}
    check("lighthill.yaml", _rows("", {**content, "links": links}))


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
