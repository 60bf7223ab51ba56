"""How results and progress are printed; results on stdout stay clean."""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
import xml.etree.ElementTree as ET

import pytest

from alpha5_model import URDF_PATH
from alpha5_model.cli import main, program
from alpha5_model.cli.printing import (
    progress_bars,
    progress_over,
    show,
    spinner,
)

Capture = pytest.CaptureFixture[str]
#: Takes away the line above, as a bar that is not to stay ends.
ERASED = "\x1b[1A\x1b[2K"


@pytest.fixture
def on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    # Rich takes it for a terminal then.
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")


@pytest.mark.usefixtures("on_a_terminal")
def test_progress_is_drawn_on_stderr_and_taken_away(capsys: Capture) -> None:
    assert list(progress_over(["one", "two"], "Drawing", 2)) == ["one", "two"]
    written = capsys.readouterr()
    assert written.out == ""
    assert "Drawing" in written.err
    assert "100%" in written.err
    assert written.err.endswith(ERASED)

    with progress_bars() as progress:
        progress("Reading", 0.25)
        progress("Reading", 0.5)
        progress("Writing", 0.75)
    written = capsys.readouterr()
    assert written.out == ""
    lines = re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", written.err).splitlines()
    for stage, done in (("Reading", "50%"), ("Writing", "75%")):
        assert any(stage in line and done in line for line in lines)
    # Each stage has one bar.
    assert written.err.endswith(ERASED * 2)


def test_without_a_terminal_nothing_is_drawn(capsys: Capture) -> None:
    with spinner("fitting"), progress_bars() as progress:
        progress("Reading", 0.5)
    written = capsys.readouterr()
    assert (written.out, written.err) == ("", "")


def test_json_is_indented_by_two_and_has_no_infinity(capsys: Capture) -> None:
    record = {"joint": "axis_e", "range": [0.5, math.inf]}
    show(True, record, ["not printed"])
    text = capsys.readouterr().out
    assert json.loads(text) == {"joint": "axis_e", "range": [0.5, None]}
    assert text.splitlines()[1:3] == ['  "joint": "axis_e",', '  "range": [']


def test_one_hint_is_enough(capsys: Capture) -> None:
    """Each of several numbers may seem to have another unit; the first is told."""
    assert main(["ik", "250", "-100", "50"]) == 2
    assert capsys.readouterr().err.count("250mm") == 1
    assert main(["fk", "170", "60", "100", "20"]) == 0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "170deg" in said


def test_the_program_is_that_of_the_words_on_the_command_line(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(sys, "argv", ["alpha5", "fk", "stow", "--json"])
    with pytest.raises(SystemExit) as ended:
        program.run()
    assert ended.value.code == 0
    assert set(json.loads(capsys.readouterr().out)) == {"q", "beyond_limits", "frames"}


@pytest.mark.parametrize("form", ["json", "junit"])
def test_an_output_on_standard_output_has_it_alone(
    form: str, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["compare", URDF_PATH, "--samples", "1", "--format", form]
    assert main([*words, "--write-arm", "-"]) == 0
    written = capfd.readouterr()
    assert "format" in tomllib.loads(written.out)
    if form == "json":
        assert json.loads(written.err)["agrees"]
    else:
        (suite,) = ET.fromstring(written.err.encode())
        assert suite.get("failures") == "0"
