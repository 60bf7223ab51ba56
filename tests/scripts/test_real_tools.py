"""The run of real tools: missing ones are not run, complaints and errors fail.

The tools themselves run in CI.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conformance import gazebo_tools, linters, real_tools, ros_tools
from conformance.ros_tools import NotThereError, Result, Workspace
from PIL import Image

import alpha5_model as a5

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


@pytest.mark.parametrize(("difference", "status"), [(0.0, 0), (1.0, 1)])
def test_one_that_is_off_is_exit_status_1(
    monkeypatch, tmp_path, capsys, difference, status
):
    page = tmp_path / "page.md"
    page.write_text("a\n{}\nold\n{}\nb\n".format(*real_tools.MARKS), "utf-8")
    check = replace(CHECK, run=lambda _: Result("figure", difference))
    monkeypatch.setattr(real_tools, "CHECKS", (check,))
    assert real_tools.main(["--page", str(page)]) == status
    printed = capsys.readouterr().out
    assert "| odd tool | – | something | figure |" in printed
    assert (
        page.read_text("utf-8")
        == f"a\n{real_tools.MARKS[0]}\n{printed}{real_tools.MARKS[1]}\nb\n"
    )


def test_every_package_is_installed_by_the_script():
    script = (SCRIPTS / "conformance" / "real_tools.sh").read_text("utf-8")
    named = re.search(r'packages="(.*?)"', script, re.DOTALL)[1].split()
    # a library comes with its headers
    bring = {"libsdformat12-12": "libsdformat-dev"}
    packages = {check.package for check in real_tools.CHECKS} - {""}
    assert {bring.get(package, package) for package in packages} <= set(named)
    assert len(set(named)) == len(named)


def test_the_pixels_of_the_arm_are_counted_in_a_white_view_only():
    picture = Image.new("RGB", (1024, 768), "white")
    assert ros_tools.arm_pixels(picture) == 0
    picture.paste((20, 20, 20), (300, 300, 500, 360))
    picture.paste((20, 20, 20), (0, 0, 1024, 60))  # the window's own bar
    assert ros_tools.arm_pixels(picture) == 200 * 60
    assert ros_tools.arm_pixels(Image.new("RGB", (1024, 768), "black")) == 0


def test_the_world_for_dart_is_our_model_fixed_in_air(tmp_path):
    text = gazebo_tools._world()
    assert text.count('<joint name="mount" type="fixed">') == 1
    assert "<child>link_0</child>" in text
    assert "buoyancy" not in text
    for name, value in (
        ("mass", a5.parameters().links[2].mass),
        ("max_step_size", 1e-4),
    ):
        assert value in np.array(
            re.findall(rf"<{name}>(.*?)</{name}>", text), dtype=float
        )


def test_a_complete_run_needs_every_tool(monkeypatch, capsys):
    ghost = replace(CHECK, needs=("/no/such/program",))
    monkeypatch.setattr(real_tools, "CHECKS", (ghost,))
    assert real_tools.main([]) == 0
    assert real_tools.main(["--complete"]) == 1
    assert "not run" in capsys.readouterr().out


def test_a_command_is_tried_three_times(tmp_path):
    """The third try passes; one that always fails gives its status."""
    script = SCRIPTS / "checks" / "retry.sh"
    pauses = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    (tmp_path / "sleep").write_text("#!/bin/sh\n")  # no waiting here
    (tmp_path / "sleep").chmod(0o755)
    count = tmp_path / "count"
    third = f'echo x >> {count}; test "$(wc -l < {count})" = 3'
    command = ["bash", str(script), "sh", "-c"]
    assert subprocess.run([*command, third], env=pauses, check=False).returncode == 0
    assert count.read_text() == "x\n" * 3
    done = subprocess.run(
        [*command, "exit 7"], env=pauses, capture_output=True, text=True, check=False
    )
    assert done.returncode == 7
    assert done.stderr.count("failed with status 7") == 3


def test_what_a_linter_reports_is_explained_or_fails():
    explained = {"tcp: no mass": "a frame"}
    assert linters.unexplained("urdf", ["tcp: no mass"], explained) == []
    assert linters.unexplained("urdf", ["tcp: no mass", "link_1: new"], explained) == [
        "urdf: link_1: new"
    ]
    assert linters.unexplained("urdf", [], explained) == [
        "urdf: no longer tcp: no mass"
    ]
