"""In CI a test is skipped for a reason that `allowed_skips.toml` lists, or it fails."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
SOURCE = """
import pytest

def test_runs(): pass

@pytest.mark.xfail(reason="expected")
def test_fails(): assert False

def test_listed():
    pytest.skip("no recordings: the folder shared/data beside the checkout is absent")

def test_unlisted(): pytest.skip("not today")
"""


def outcome(folder: Path, source: str, **environment: str) -> tuple[int, str]:
    """Status and output of pytest on a file, with the hooks of `conftest`."""
    (folder / "test_some.py").write_text(source, "utf-8")
    inherited = {**os.environ, "PYTHONPATH": str(TESTS)}
    inherited.pop("ALPHA5_ONLY_ALLOWED_SKIPS", None)
    command = [sys.executable, "-m", "pytest", "-p", "conftest", "-p"]
    done = subprocess.run(
        [*command, "no:cacheprovider", "."],
        cwd=folder,
        env=inherited | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


@pytest.mark.slow
def test_an_unlisted_skip_fails_in_ci_only(tmp_path: Path) -> None:
    status, said = outcome(tmp_path, SOURCE, ALPHA5_ONLY_ALLOWED_SKIPS="1")
    assert status == 1
    assert "not in allowed_skips.toml: not today" in said
    assert "1 failed, 1 passed, 1 skipped, 1 xfailed" in said

    status, said = outcome(tmp_path, SOURCE)
    assert status == 0
    assert "1 passed, 2 skipped, 1 xfailed" in said

    file = 'import pytest\npytest.importorskip("no_such_module")'
    status, said = outcome(tmp_path, file, ALPHA5_ONLY_ALLOWED_SKIPS="1")
    assert status != 0
    assert "could not import 'no_such_module'" in said
