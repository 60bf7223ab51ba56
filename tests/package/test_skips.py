"""In CI a test is skipped for a listed reason only."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import skips

TESTS = Path(__file__).resolve().parents[1]
LISTED = tomllib.loads(skips.LIST.read_text("utf-8"))["skip"]
SOURCE = """
import pytest

def test_runs(): pass

@pytest.mark.xfail(reason="expected")
def test_fails(): assert False

def test_listed():
    pytest.skip("no recordings: the folder shared/data beside the checkout is absent")

def test_unlisted(): pytest.skip("not today")
"""


def outcome(folder: Path, source: str, only_allowed: bool) -> tuple[int, str]:
    """Status and last line of pytest on a file, with the hooks of `conftest`."""
    (folder / "test_some.py").write_text(source, "utf-8")
    environment = {**os.environ, "PYTHONPATH": str(TESTS)}
    environment.pop("ALPHA5_ONLY_ALLOWED_SKIPS", None)
    if only_allowed:
        environment["ALPHA5_ONLY_ALLOWED_SKIPS"] = "1"
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "conftest",
            "-p",
            "no:cacheprovider",
            ".",
        ],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


@pytest.mark.slow
def test_an_unlisted_skip_fails_in_ci(tmp_path: Path) -> None:
    status, said = outcome(tmp_path, SOURCE, only_allowed=True)
    assert status == 1
    assert "not in allowed_skips.toml: not today" in said
    assert "1 failed, 1 passed, 1 skipped, 1 xfailed" in said


def test_elsewhere_any_skip_passes(tmp_path: Path) -> None:
    status, said = outcome(tmp_path, SOURCE, only_allowed=False)
    assert status == 0
    assert "1 passed, 2 skipped, 1 xfailed" in said


def test_a_file_that_is_left_out_fails_in_ci(tmp_path: Path) -> None:
    source = 'import pytest\npytest.importorskip("no_such_module")'
    status, said = outcome(tmp_path, source, only_allowed=True)
    assert status != 0
    assert "could not import 'no_such_module'" in said


@pytest.mark.parametrize("entry", LISTED, ids=lambda entry: entry["reason"])
def test_each_entry_says_why(entry: dict[str, str]) -> None:
    assert set(entry) == {"reason", "why"}
    assert len(entry["why"]) > 20
