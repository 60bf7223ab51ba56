"""What every command does alike: pipes, full disks, absurd numbers, 80 columns."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main

ROOT = Path(__file__).resolve().parents[2]
TORQUE = ("torque", "--q", "3.1", "1.2", "1.8", "7")


def program(*arguments):
    return [sys.executable, "-m", "alpha5_model", *arguments]


def environment():
    return {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "80"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [("ik", "0.25", "0.1", "0.1"), ("workspace",), ("generate", "urdf"), TORQUE],
    ids=lambda arguments: arguments[0],
)
def test_a_reader_that_leaves_is_no_failed_check(arguments):
    """Status 1 means that a check failed; `alpha5 ... | head` is not that."""
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        program(*arguments),
        stdout=write,
        stderr=subprocess.PIPE,
        env=environment(),
        check=False,
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.skipif(
    not Path("/dev/full").exists(), reason="no /dev/full on this system"
)
def test_a_full_disk_is_one_line_and_status_2():
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            program("ik", "0.25", "0.1", "0.1", "--json"),
            stdout=full,
            stderr=subprocess.PIPE,
            env=environment(),
            check=False,
        )
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert b"No space left" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((*TORQUE, "--fluid", "1e308"), "fluid"),
        (("torque", "--q", "3", "1", "1", ""), "--q"),
        ((*TORQUE, "--gravity", "1e300 0 0"), "gravity"),
        ((*TORQUE, "--gravity", "nan 0 0"), "gravity[0]"),
        (("ik", "1e300", "0", "0"), "1e+303 mm away"),
        (("check", "."), "is a folder"),
        (("compare", "."), "is a folder"),
        (("dh", "--urdf", "."), "is a folder"),
        (("generate", "urdf", "--parent", "base_link"), "parent"),
        (("generate", "urdf", "--parent", "left_tcp", "--prefix", "left_"), "parent"),
    ],
)
def test_bad_input_is_one_line_and_status_2(capsys, arguments, words):
    assert main(arguments) == 2
    out = capsys.readouterr()
    assert out.out == ""
    assert len(out.err.splitlines()) == 1
    assert words in out.err


def test_no_arguments_print_the_help_and_no_complaint(capsys):
    assert main([]) == 2
    out = capsys.readouterr()
    assert "generate" in out.out
    assert out.err == ""


def test_very_far_points_project_like_far_ones():
    directions = np.random.default_rng(3).normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    far, very_far = (
        a5.distance_to_reach(scale * directions) for scale in (1e90, 1e200)
    )
    assert far == pytest.approx(1e90, rel=1e-12)
    assert very_far == pytest.approx(1e200, rel=1e-12)
