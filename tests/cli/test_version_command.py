"""`alpha5 --version` says which kernels run."""

from __future__ import annotations

import os
import subprocess
import sys

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
