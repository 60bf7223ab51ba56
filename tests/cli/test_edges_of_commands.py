"""Commands at the edges of what they take, and in the units that suit."""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model._support.text import plain
from alpha5_model.cli import (
    demo,
    main,
    sweep,
    values,
    view,
)
from alpha5_model.cli.commands import COMMANDS, application
from alpha5_model.cli.syntax import one_syntax
from alpha5_model.cli.torque_record import Motors, State, torque_record
from alpha5_model.cli.torque_text import torque_lines
from alpha5_model.errors import InputError
from alpha5_model.proofs.comparison import measure
from alpha5_model.studies.sweep.extent import Extent

Capture = pytest.CaptureFixture[str]
POSE = ["--q", "3.1", "1.2", "1.8", "0"]


def answer(capsys: Capture, *words: str) -> Any:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


# --- numbers of options ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "unit", "largest"),
    [("current", "m/s", 100.0), ("gravity", "m/s^2", 1e4), ("fluid", "kg/m^3", 1e5)],
)
def test_the_largest_number_of_an_option_is_taken(
    name: str, unit: str, largest: float
) -> None:
    for number in (largest, -largest):
        assert values.numbers(name, repr(number), (1,), unit) == [number]
    for number in (largest + 0.5, -largest - 0.5):
        with pytest.raises(InputError, match=re.escape(f"at most {largest:g} {unit}")):
            values.numbers(name, repr(number), (1,), unit)


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("1.5rad", "rad", 1.5),
        ("90deg", "rad", np.pi / 2),
        ("1.5m", "m", 1.5),
        ("30mm", "m", 0.03),
        ("90deg", "rad/s^2", np.pi / 2),
        ("30mm", "rad or m", 0.03),
        ("-2", "kg", -2.0),
    ],
)
def test_units_of_numbers(text: str, unit: str, number: float) -> None:
    assert values.numbers("x", text, (1,), unit) == [pytest.approx(number, rel=1e-15)]


@pytest.mark.parametrize(
    ("text", "unit"), [("1m", "rad"), ("1deg", "m"), ("1mm", "kg")]
)
def test_units_of_other_quantities_are_refused(text: str, unit: str) -> None:
    with pytest.raises(InputError, match="one number"):
        values.numbers("x", text, (1,), unit)


@pytest.mark.parametrize(
    ("text", "payload"),
    [
        ("0.5", (0.5, (0.0, 0.0, 0.0), 0.0)),
        ("0.5 1 2 3", (0.5, (1.0, 2.0, 3.0), 0.0)),
        ("0.5 1 2 3 4e-4", (0.5, (1.0, 2.0, 3.0), 4e-4)),
    ],
)
def test_a_payload_has_one_four_or_five_numbers(text: str, payload: Any) -> None:
    assert values.payload_numbers(text) == payload


@pytest.mark.parametrize("count", [2, 3, 6])
def test_a_payload_of_other_counts_is_refused(count: int) -> None:
    with pytest.raises(InputError, match="MASS X Y Z VOLUME"):
        values.payload_numbers(" ".join(["0.5"] * count))


@pytest.mark.parametrize("option", ["--positions", "--payload", "--mount"])
def test_a_vector_takes_nine_numbers_at_most(option: str) -> None:
    """Three points have nine; a tenth number is an argument."""
    points = "0.2 0 -0.03 -0.1 0.17 -0.03 -0.1 -0.17 -0.03"
    words = ["calibrate", option, *points.split(), "10", "plan.toml"]
    assert one_syntax(words) == ["calibrate", option, points, "10", "plan.toml"]


def test_a_vector_of_one_word_takes_no_other() -> None:
    words = ["dh", "--link", "0 1 2 3 0", "4", "5"]
    assert one_syntax(words) == words
    assert one_syntax(["move", "--mount", "90", "deg"]) == ["move", "--mount", "90deg"]


# --- compare --------------------------------------------------------------------------


@pytest.fixture
def other(tmp_path: Path) -> Path:
    file = tmp_path / "other.urdf"
    file.write_text(with_mass(OWN, "0.5"), "utf-8")
    return file


def test_compare_without_options_is_the_function_without(
    other: Path, capsys: Capture
) -> None:
    assert main(["compare", str(other), "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert record == plain(measure.compare(other).as_dict())


@pytest.mark.parametrize(
    ("samples", "taken"),
    [("0", False), ("1", True), ("100000", True), ("100001", False)],
)
def test_compare_takes_one_to_a_hundred_thousand_samples(
    samples: str,
    taken: bool,
    other: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    asked = []

    def compare_robots(model: Any, names: Any, count: int, *_: Any, **__: Any) -> None:
        asked.append(count)
        raise InputError("samples", count, "no work in this test")

    monkeypatch.setattr(measure, "compare_robots", compare_robots)
    assert main(["compare", str(other), "--samples", samples]) == 2
    assert asked == [int(samples)] * taken
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("kilograms", "grams"),
    [("9.9995", "9999.50"), ("10", "10000"), ("10.0005", "10000")],
)
def test_masses_of_a_table_have_decimals_below_ten_kilograms(
    kilograms: str, grams: str, tmp_path: Path, capsys: Capture
) -> None:
    file = tmp_path / "heavy.urdf"
    file.write_text(with_mass(OWN, kilograms), "utf-8")
    assert main(["compare", str(file), "--samples", "1"]) == 1
    row = re.search(r"link_2 +theirs +(\S+)", capsys.readouterr().out)
    assert row is not None
    assert row[1] == grams


@pytest.mark.parametrize(("mass", "colour"), [("0.38", "32"), ("0.5", "31")])
def test_the_verdict_is_green_or_red(
    mass: str, colour: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[str] = []
    monkeypatch.setattr("alpha5_model.cli.printing.say", lambda *x: shown.extend(x))
    file = tmp_path / "model.urdf"
    file.write_text(with_mass(OWN, mass), "utf-8")
    assert main(["compare", str(file), "--samples", "1"]) == (mass != "0.38")
    assert shown[1].startswith(f"\x1b[{colour}mThe model ")


# --- torque ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("torque", "written"),
    [(99999.5, "99999.5000"), (1e5, "1.000e+05"), (-100000.5, "-1.000e+05")],
)
def test_a_table_has_decimals_below_a_hundred_thousand(
    torque: float, written: str
) -> None:
    state = State(q=[3.1, 1.2, 1.8, 0.0], v=[0.0] * 4, a=[0.0] * 4)
    motors = Motors(constants=None, efficiency="gearbox")
    record = torque_record(a5.load(), state, motors, current=None)
    record["joints"][1]["torque"] = torque
    row = next(line for line in torque_lines(record) if line.startswith("axis_d"))
    assert row.split()[-2] == written
    decimals = {cell.partition(".")[2] for cell in row.split()[1:3]}
    assert decimals == ({"0000"} if torque < 1e5 and torque > 0 else {"000e+00"})


# --- sweep ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (None, ""),
        (2.0, ""),
        (2.4, "one part, about 2 s"),
        (119.4, "one part, about 119 s"),
        (120.0, "one part, about 2 min"),
        (7199.0, "one part, about 120 min"),
        (7200.0, "one part, about 2 h"),
        (172799.0, "one part, about 48 h"),
        (172800.0, "one part, about 2 days"),
        (86400.0 * 1234, "one part, about 1,234 days"),
    ],
)
def test_a_long_study_is_announced_in_a_unit_that_suits(
    seconds: float | None, said: str, capsys: Capture
) -> None:
    one = Extent(rows=None, parts=1, of_parts=1, table_bytes=0, seconds=seconds)
    sweep._announce(False, one)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.strip() == said


def test_the_size_of_a_study_names_rows_parts_and_tables(capsys: Capture) -> None:
    large = Extent(
        rows=12345678, parts=1200, of_parts=1200, table_bytes=14 * 10**9, seconds=2.4
    )
    words = "12,345,678 rows in 1,200 parts, about 14 GB of tables, about 2 s"
    sweep._announce(True, large)
    assert capsys.readouterr().err == f"{words}\n"
    with pytest.raises(InputError, match=re.escape(f"--yes: {words}")):
        sweep._announce(False, large)


def test_files_of_others_are_named_up_to_five() -> None:
    five = [f"file_{k}" for k in range(5)]
    first = "\nnot of this study: file_0, file_1, file_2, file_3, file_4"
    assert list(sweep._foreign([])) == []
    assert list(sweep._foreign(five)) == [first]
    assert list(sweep._foreign([*five, "file_5"])) == [f"{first} and 1 more"]


# --- view -----------------------------------------------------------------------------


@pytest.fixture
def motion(tmp_path: Path) -> Path:
    """A motion of 61 samples, in which axis_e turns by a radian."""
    rows = [f"{k / 10},{2 + k / 60},1.2,2.2,1.5" for k in range(61)]
    head = "time,axis_e,axis_d,axis_c,axis_b"
    file = tmp_path / "motion.csv"
    file.write_text("\n".join([head, *rows]), "utf-8")
    return file


def test_pictures_and_videos_have_the_size_and_rate_that_the_help_says(
    motion: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["view", "--help"]) == 0
    text = capsys.readouterr().out
    sizes = re.findall(r"(\d+)x(\d+)", text)
    pixels = [(int(width), int(height)) for width, height in sizes]
    rate = re.search(r"(\d+) frames/s", text)
    assert rate is not None

    seen: dict[str, Any] = {"framed": []}

    def framed(shown: Any, size: Any, also: Any) -> Any:
        seen["framed"].append((size, also))
        return shown

    @contextlib.contextmanager
    def film(path: Path, per_second: float) -> Iterator[Any]:
        seen["rate"] = per_second
        yield per_second, lambda frame: None

    def pictures(scenes: Any, size: Any) -> list[Any]:
        seen["video"] = size
        return [b"" for _ in scenes]

    def picture_png(shown: Any, size: Any) -> bytes:
        seen["image"] = size
        return b""

    for replaced in (framed, film, pictures, picture_png):
        monkeypatch.setattr(view, replaced.__name__, replaced)
    image = motion.with_name("arm.png")
    video = motion.with_name("arm.gif")
    words = ["view", "--motion", str(motion), "--gripper", "locked"]
    assert main([*words, "--image", str(image), "--video", str(video)]) == 0
    assert [seen["image"], seen["video"]] == pixels
    assert [size for size, _ in seen["framed"]] == pixels
    assert seen["rate"] == float(rate[1])
    # Both cameras see poses from all of the motion, here its ends among them.
    arm = a5.load()
    for _, also in seen["framed"]:
        assert 10 < len(also) <= 24
        for poses, turn in ((also[0], 2.0), (also[-1], 3.0)):
            tcp = arm.forward_kinematics([turn, 1.2, 2.2, 1.5]).homogeneous
            np.testing.assert_allclose(poses["tcp"], tcp, atol=1e-12)


# --- demo -----------------------------------------------------------------------------


@pytest.fixture
def quick_demo(monkeypatch: pytest.MonkeyPatch) -> None:
    """A demo that only describes the arm."""
    still: dict[str, Callable[..., Any]] = {
        "_audit": lambda: None,
        "_solve": lambda: None,
        "_compute": lambda q: None,
        "_draw": lambda output, q: ["alpha5.html"],
    }
    for name, function in still.items():
        monkeypatch.setattr(demo, name, function)


@pytest.mark.usefixtures("quick_demo")
def test_the_demo_fails_if_a_description_is_wrong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    right = demo.variants.urdf
    assert main(["demo", "--output", str(tmp_path)]) == 0
    assert "FAILED" not in capsys.readouterr().out
    monkeypatch.setattr(
        demo.variants, "urdf", lambda variant: with_mass(right(variant), "0.83")
    )
    assert main(["demo", "--output", str(tmp_path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert "   alpha5.urdf: checks against the tables: 7 passed, 1 FAILED" in lines
    assert any(line.startswith("     inertias: link_2: mass 0.83") for line in lines)


def test_the_help_lists_every_command_and_a_call_loads_one(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["--help"]) == 0
    listed = re.findall(r"^│ ([a-z]+) ", capsys.readouterr().out, re.MULTILINE)
    assert sorted(COMMANDS) == sorted(set(listed) & set(COMMANDS))
    called = application("fk").registered_commands
    assert [command.name for command in called] == ["fk"]
