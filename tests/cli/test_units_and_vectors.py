"""Numbers of options: their units, how many there may be, and how large they may be."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import command_parsers
import numpy as np
import pytest
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import COMMANDS, main, options
from alpha5_model.cli.quantities import CURRENT, MASS, SIZE, VOLTAGE, VOLUME, Scalar
from alpha5_model.description import srdf
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_schema import UNITS
from alpha5_model.planning.parking import placements
from alpha5_model.studies.control import step

Capture = pytest.CaptureFixture[str]
POSE = ["--q", "3.1", "1.2", "1.8", "0"]


def answer(capsys: Capture, *words: str) -> Any:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def refused(capsys: Capture, name: str, *words: str) -> bool:
    """Whether a command ends with status 2 and one line that names an option."""
    status = main([*words])
    said = capsys.readouterr().err
    return status == 2 and said.count("\n") == 1 and name in said


def test_units_are_those_of_the_quantity(capsys: Capture) -> None:
    plain = answer(capsys, "fk", "1.5", "1.2", "1.8", "0")
    for first in ("1.5rad", f"{float(np.degrees(1.5))}deg"):
        with_unit = answer(capsys, "fk", first, "1.2", "1.8", "0")
        np.testing.assert_allclose(with_unit["q"], plain["q"], rtol=1e-14)
    place = answer(capsys, "ik", "0.25", "-0.1", "0.05")
    for words in (["250", "-100", "50", "mm"], ["250mm", "-0.1m", "50mm"]):
        assert answer(capsys, "ik", *words)["branches"] == place["branches"]
    slow = answer(capsys, "torque", *POSE, "--water-velocity", "300", "0", "0", "mm/s")
    again = answer(capsys, "torque", *POSE, "--current", "0.3 0 0")
    assert again["joints"] == slow["joints"]
    assert refused(capsys, "argument Q", "fk", "1.5m", "1.2", "1.8", "0")
    assert refused(capsys, "", "ik", "0.25deg", "-0.1", "0.05")


@pytest.mark.parametrize(
    ("option", "largest", "count"),
    [("--water-velocity", 100, 3), ("--fluid", 100_000, 1)],
)
def test_numbers_that_no_water_has_are_refused(
    option: str, largest: int, count: int, capsys: Capture
) -> None:
    others = ["0"] * (count - 1)
    answer(capsys, "torque", *POSE, option, str(largest), *others)
    words = ["torque", *POSE, option, f"{largest}.5", *others]
    assert refused(capsys, option.strip("-"), *words)


def test_a_payload_has_one_four_or_five_numbers(capsys: Capture) -> None:
    arm = a5.load()
    expected = arm.with_payload(0.5, (0.1, 0.2, 0.3), volume=4e-4)
    found = answer(capsys, "torque", *POSE, "--payload", "0.5 0.1 0.2 0.3 4e-4")
    q = [float(word) for word in POSE[1:]]
    torque = [joint["torque"] for joint in found["joints"][:4]]
    np.testing.assert_allclose(torque, expected.hydrostatic_torque(q), atol=1e-12)
    answer(capsys, "torque", *POSE, "--payload", "0.5")
    answer(capsys, "torque", *POSE, "--payload", "0.5 0.1 0.2 0.3")
    for count in (2, 3, 6):
        text = " ".join(["0.1"] * count)
        assert refused(capsys, "payload", "torque", *POSE, "--payload", text)


def test_units_of_another_quantity_and_unknown_options_are_named(
    capsys: Capture,
) -> None:
    """Faults of an earlier command line, which took these for something else."""
    for payload in ("500mm", "30deg", "1 0 0 0 0.1mm"):
        assert refused(capsys, "--payload", "torque", *POSE, "--payload", payload)
    rod = ("180deg", "70deg", "100deg", "0deg", "0.005deg")
    assert refused(capsys, "argument Q", "fk", *rod)
    assert refused(capsys, "--radius", "planar", "5", "4", "1", "--radius", "-3")
    for command in (["fk", *POSE[1:]], ["ik", "0.2", "0.1", "0.1"], ["dh"]):
        assert refused(capsys, "--colour", *command, "--colour", "red")
    assert refused(capsys, "--obstacle", "move", "home", "reach", "--obstacle", "x")


@pytest.fixture
def other(tmp_path: Path) -> Path:
    file = tmp_path / "other.urdf"
    file.write_text(with_mass(OWN, "0.5"), "utf-8")
    return file


def test_compare_is_the_function(other: Path, capsys: Capture) -> None:
    assert main(["compare", str(other), "--samples", "20", "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    ours = a5.compare(other, samples=20).as_dict()
    assert record["verdict"] == ours["verdict"]
    assert [x["text"] for x in record["findings"]] == [
        x["text"] for x in ours["findings"]
    ]
    for samples in ("0", "100001"):
        assert refused(capsys, "samples", "compare", str(other), "--samples", samples)


@pytest.mark.parametrize(
    ("command", "option", "with_unit", "bare"),
    [
        ("jaws", "--at", "1cm", "0.01"),
        ("jaws --screw-lead 1mm", "--motor-current", "50mA", "0.05"),
        ("torque --q 3.1,1.2,1.8,0", "--payload", "0.5 0 0 0 500mL", "0.5 0 0 0 5e-4"),
        ("torque --q 3.1,1.2,1.8,0", "--payload", "0 1cm 0 0 9cm^3", "0 0.01 0 0 9e-6"),
        ("move home reach", "--acceleration", "0.4rad/s^2", "0.4"),
        ("move home reach --supply-voltage 24", "--current-limit", "600mA", "0.6"),
        ("move home reach --current-limit 0.6", "--supply-voltage", "24V", "24"),
        ("move home reach", "--rate", "40Hz", "40"),
        (
            "gains --bandwidth 8 --rate 200 --rotor-inertia 5e-8",
            "--delay",
            "10ms",
            ".01",
        ),
        (
            "gains --bandwidth 8 --delay 0 --rotor-inertia 5e-8",
            "--rate",
            "200Hz",
            "200",
        ),
        (
            "gains --rate 200 --delay 0 --rotor-inertia 5e-8",
            "--bandwidth",
            "8rad/s",
            "8",
        ),
        (
            "gains --rate 200 --delay 0 --rotor-inertia 5e-8",
            "--settling-time",
            "2s",
            "2",
        ),
    ],
)
def test_a_unit_is_a_factor(
    command: str, option: str, with_unit: str, bare: str, capsys: Capture
) -> None:
    words = command.split()
    found = answer(capsys, *words, option, with_unit)
    assert found == answer(capsys, *words, option, bare)


def test_hertz_are_refused_where_rad_per_second_are_meant(capsys: Capture) -> None:
    words = ("gains", "--rate", "200", "--delay", "0", "--rotor-inertia", "5e-8")
    assert refused(capsys, "--bandwidth", *words, "--bandwidth", "2Hz")


def test_units_of_an_arm_file_are_those_of_the_command_line() -> None:
    sizes = {"m": SIZE, "kg": MASS, "m^3": VOLUME, "A": CURRENT, "V": VOLTAGE}
    for unit, quantity in sizes.items():
        for name, size in UNITS[unit].items():
            assert Scalar(quantity)(f"3{name}") == pytest.approx(3 * float(size))


@pytest.mark.parametrize(
    ("command", "option", "function"),
    [
        ("park", "clearance", placements),
        ("park", "spacing", placements),
        ("park", "yaws", placements),
        ("move", "margin", a5.plan),
        ("gains", "tolerance", step),
        ("trajectory", "bandwidth", a5.trajectory.analyse),
    ],
)
def test_a_help_says_the_default_of_the_function(
    command: str, option: str, function: Callable[..., Any]
) -> None:
    (leaf,) = command_parsers.leaves(command).values()
    (found,) = (x for x in command_parsers.options(leaf) if x.dest == option)
    said = re.search(r"Default: ([\d.]*\d)", found.help or "")
    assert said is not None
    default = inspect.signature(function).parameters[option].default
    assert float(said[1]) == default
    assert found.default in (None, default)


def test_named_poses_are_those_of_the_descriptions() -> None:
    assert tuple(srdf.NAMED_POSES) == options.NAMED_POSES


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("verbose", ["check", a5.URDF_PATH, "--verbose"]),
        ("samples", ["workspace", "--samples", "5"]),
    ],
)
def test_an_option_without_use_is_refused(
    name: str, words: list[str], capsys: Capture
) -> None:
    assert refused(capsys, f"{name}: ", *map(str, words))


def test_pairs_of_names_are_complete_and_stand_once() -> None:
    given = ["a:=1", " ", "b := 2"]
    assert options.pairs("arg", given, ":=") == {"a": "1", "b": "2"}
    assert options.pairs("arg", ["a:="], ":=", may_be_empty=True) == {"a": ""}
    for parts in (["a:="], ["a"], [":=1"], ["a:=1", "a:=2"]):
        with pytest.raises(InputError) as refusal:
            options.pairs("arg", parts, ":=")
        assert refusal.value.name == "arg"


def test_the_help_lists_every_command(capsys: Capture) -> None:
    assert main(["--help"]) == 0
    listed = re.findall(r"^  ([a-z]+) ", capsys.readouterr().out, re.MULTILINE)
    assert set(COMMANDS) <= set(listed)
