"""Kinematics, kernels and files need NumPy alone, of all that is installed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import alpha5_model as a5

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "checks" / "numpy_alone.py"
#: Lets nothing be imported but the standard library, NumPy and this package.
BLOCKING = """
import runpy, sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top in {"numpy", "alpha5_model"} or top in sys.stdlib_module_names:
            return None
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocked())
"""


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", BLOCKING + code],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )


def test_the_promised_part_needs_numpy_alone() -> None:
    if a5.backend() == "numpy":
        pytest.skip("the kernels are not compiled here")
    done = run(f"runpy.run_path({str(SCRIPT)!r}, run_name='__main__')")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("yes ") == 7
    assert "other packages: none" in done.stdout


def test_without_a_compiler_self_collision_needs_coal() -> None:
    code = "import alpha5_model as a5; a5.inverse_kinematics([0.25, 0.1, 0.1]).collides"
    done = run(f"import os; os.environ['ALPHA5_KERNELS'] = 'numpy'; {code}")
    *_, last = done.stderr.splitlines()
    assert "self-collision without a compiler, needs coal, which is not" in last


def test_what_needs_more_says_so() -> None:
    done = run("import alpha5_model as a5; a5.load()")
    assert done.returncode == 1
    *_, last = done.stderr.splitlines()
    assert "alpha5_model.load needs pinocchio, which is not installed" in last


def test_the_command_line_says_in_one_line_what_it_lacks() -> None:
    done = run("from alpha5_model.cli import main; sys.exit(main(['view']))")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("alpha5: the command line needs ")
    assert "which is not installed: python -m pip install alpha5-model" in done.stderr


def test_commands_that_need_numpy_alone_run() -> None:
    commands = [["--help"], ["arm", "new", "-"]]
    if a5.backend() == "compiled":
        commands.append(["ik", "0.25", "-0.1", "0.05"])
    for words in commands:
        done = run(f"from alpha5_model.cli import main; sys.exit(main({words}))")
        assert done.returncode == 0, (words, done.stderr)
