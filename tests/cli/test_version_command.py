"""`alpha5 --version` says which kernels run, and C has no moving jaws."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import alpha5_model as a5
from alpha5_model.cli import main


def test_the_version_names_the_kernels(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"{a5.__version__}, kernels: {a5.backend()}\n"


def test_kernels_that_were_not_compiled_are_visible():
    done = subprocess.run(
        [sys.executable, "-m", "alpha5_model", "--version"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "ALPHA5_KERNELS": "numpy"},
    )
    assert done.stdout == f"{a5.__version__}, kernels: numpy\n"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["c", "--gripper", "jaws"], "four joints, the jaws locked in link_4"),
        (["urdf", "--hydrodynamics"], "URDF has no element for drag or added mass"),
    ],
)
def test_an_option_that_a_format_cannot_have_is_explained(arguments, reason, capsys):
    assert main(["generate", "--format", *arguments]) == 2
    printed = capsys.readouterr().err
    assert reason in printed
    assert printed.count("\n") == 1
