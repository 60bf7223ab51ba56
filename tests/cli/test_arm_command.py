"""``alpha5 arm``: a file of your own arm is written, checked and shown."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.dynamics.arm_changes import arm_changes
from alpha5_model.numbers.arm_writing import arm_file_text

NEW = arm_file_text(a5.parameters(), every_key=True)
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "my_arm.toml"


def test_new_writes_a_file_that_changes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["arm", "new"]) == 0
    assert "wrote my_arm.toml" in capsys.readouterr().out
    assert (tmp_path / "my_arm.toml").read_text("utf-8") == NEW
    assert main(["arm", "check", "my_arm.toml"]) == 0
    assert "alpha5 is the catalogue's arm" in capsys.readouterr().out


def test_new_writes_over_no_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("format = 1")
    assert main(["arm", "new", str(path)]) == 2
    assert f"cannot write {path}: it exists; name another" in capsys.readouterr().err
    assert path.read_text() == "format = 1"


def test_new_writes_to_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["arm", "new", "-"]) == 0
    assert capfd.readouterr().out == NEW


@pytest.mark.slow
def test_check_says_what_each_change_costs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["arm", "check", str(EXAMPLE), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["name"] == "alpha5_lab_2"
    own = a5.arm_file(EXAMPLE)
    expected = {change.key: change for change in arm_changes(own, a5.parameters())}
    assert [change["key"] for change in record["changes"]] == [*expected]
    for change in record["changes"]:
        assert change["torque"] == expected[change["key"]].torque
        assert change["tcp"] == expected[change["key"]].tcp
    (mass,) = next(
        change["differences"]
        for change in record["changes"]
        if change["key"] == "links.link_2"
    )
    printed = a5.parameters().links[2].mass
    assert mass == {"name": "mass", "printed": printed, "own": 0.341}


def test_show_prints_the_record(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["arm", "show", str(EXAMPLE), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    own = a5.arm_file(EXAMPLE)
    assert own.mount is not None
    assert record["mount"]["rotation"] == own.mount.rotation.tolist()
    assert record["tool"]["position"] == pytest.approx([0, 0, -0.202], abs=1e-15)
    assert [link["mass"] for link in record["links"]] == [x.mass for x in own.links]
    assert record["attached"][0]["name"] == "force_sensor"
    assert np.isclose(record["measurements"][0]["half_width"], 1e-3)


def test_show_prints_half_widths_where_there_are_some(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        "format = 1\n[links.link_2]\n"
        'mass = {value = 341, unit = "g", source = "weighed", half_width = 2}\n'
        'volume = {value = 0.2, unit = "L", source = "dipped"}\n',
        encoding="utf-8",
    )
    assert main(["arm", "show", str(file)]) == 0
    lines = capsys.readouterr().out.splitlines()
    (mass,) = [line for line in lines if "weighed" in line]
    (volume,) = [line for line in lines if "dipped" in line]
    assert mass.split() == ["links.link_2.mass", "±0.002", "weighed"]
    assert volume.split() == ["links.link_2.volume", "dipped"]


def test_show_and_check_say_signs_and_accelerations(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        "format = 1\n[signs]\naxis_b = -1\n"
        "[joint_limits.axis_c]\nmax_acceleration = 0.5\nmax_jerk = 4.25\n",
        encoding="utf-8",
    )
    assert main(["arm", "show", str(file)]) == 0
    lines = capsys.readouterr().out.splitlines()
    cells = [line.split() for line in lines]
    assert ["axis_c", "0.5", "4.25", "1"] in cells
    assert ["axis_b", "unknown", "unknown", "-1"] in cells
    assert main(["arm", "check", str(file)]) == 0
    out = capsys.readouterr().out
    assert "joint_limits.axis_c: acceleration none -> 0.5" in out
    assert "joint_limits.axis_b: sign 1 -> -1" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("chek", "a.toml"), "argument {new,check,show}: invalid choice: 'chek'"),
        (("check",), "the following arguments are required: FILE"),
        (("show", "none.toml"), "none.toml: no such file; expected an arm file (TOML)"),
        (("show", "a.toml"), "a.toml, lengths.a_1: expected at most 2 m; if it is in"),
    ],
)
def test_mistakes_are_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text("format = 1\n[lengths]\na_1 = 150.9")
    assert main(["arm", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(f"alpha5: {message}")
    assert captured.err.count("\n") == 1


def test_odd_values_are_warned_of_on_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.toml"
    path.write_text("format = 1\n[lengths]\na_1 = 0.18")
    assert main(["arm", "show", str(path)]) == 0
    line = f"alpha5: warning: {path}: lengths.a_1: 0.18 m is 29 mm off the printed one"
    assert capsys.readouterr().err == f"{line}\n"
