"""The run of real tools: missing ones are not run, complaints and errors fail.

The tools themselves run in CI.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest
from conformance import linters, real_tools, ros_tools
from conformance.ros_tools import NotThereError, Result, Workspace
from PIL import Image

SCRIPTS = Path(__file__).parents[2] / "scripts"
CHECK = real_tools.Check(
    "odd tool", "", (), "something", lambda _: Result("0", 0.0), 1e-9
)


def verdict(result: Result | Exception, tmp_path: Path) -> tuple[str, ...]:
    def run(_: Workspace) -> Result:
        if isinstance(result, Exception):
            raise result
        return result

    return real_tools.row(replace(CHECK, run=run), Workspace(tmp_path))


@pytest.mark.parametrize(
    ("result", "expected", "words"),
    [
        (Result("1e-10", 1e-10), "agrees", "1e-10"),
        (
            Result("fine", warnings=("at zero it touches itself",)),
            "agrees",
            "touches itself",
        ),
        (Result("1e-8", 1e-8), "differs", "1e-8"),
        (Result("nan", float("nan")), "differs", "nan"),
        (
            Result("0", complaints=("WARN: a root with an inertia",)),
            "differs",
            "a root with",
        ),
        (RuntimeError("two\nlines"), "failed", "RuntimeError: two lines"),
        (NotThereError("no network"), "not run", "no network"),
    ],
)
def test_a_verdict_needs_agreement_and_silence(tmp_path, result, expected, words):
    *_, found, said = verdict(result, tmp_path)
    assert said == expected
    assert words in found


def test_what_is_not_there_is_not_run(tmp_path):
    check = replace(CHECK, needs=("/no/such/program", sys.executable))
    *_, found, said = real_tools.row(check, Workspace(tmp_path))
    assert (found, said) == ("/no/such/program not there", "not run")


def test_the_pixels_of_the_arm_are_counted_in_a_white_view_only():
    picture = Image.new("RGB", (1024, 768), "white")
    assert ros_tools.arm_pixels(picture) == 0
    picture.paste((20, 20, 20), (300, 300, 500, 360))
    picture.paste((20, 20, 20), (0, 0, 1024, 60))  # the window's own bar
    assert ros_tools.arm_pixels(picture) == 200 * 60
    assert ros_tools.arm_pixels(Image.new("RGB", (1024, 768), "black")) == 0


def test_a_complete_run_needs_every_tool(monkeypatch, capsys):
    ghost = replace(CHECK, needs=("/no/such/program",))
    monkeypatch.setattr(real_tools, "CHECKS", (ghost,))
    assert real_tools.main([]) == 0
    assert real_tools.main(["--complete"]) == 1
    assert "not run" in capsys.readouterr().out


def test_what_a_linter_reports_is_explained_or_fails():
    explained = {"tcp: no mass": "a frame"}
    assert linters.unexplained("urdf", ["tcp: no mass"], explained) == []
    assert linters.unexplained("urdf", ["tcp: no mass", "link_1: new"], explained) == [
        "urdf: link_1: new"
    ]
    assert linters.unexplained("urdf", [], explained) == [
        "urdf: no longer tcp: no mass"
    ]
