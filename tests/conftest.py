"""Shared by all tests."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# What several tests use is in `support`; some use a second route of another test.
sys.path[:0] = [
    str(folder) for folder in Path(__file__).parent.iterdir() if folder.is_dir()
]
# On a busy machine any example may take long; what must be quick is timed by the benchmark.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")

#: Set in CI, where everything is installed: a test is left out for a listed reason only.
ONLY_ALLOWED_SKIPS = "ALPHA5_ONLY_ALLOWED_SKIPS" in os.environ


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """One browser for all tests: a launch costs seconds."""
    from browser import browser

    with browser() as running:
        yield running


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Iterator[Any]:
    report = yield
    return judged(report)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Iterator[Any]:
    report = yield
    return judged(report)


def judged(report: Any) -> Any:
    """The report of a test or a file; where only listed skips pass, failed for another."""
    from skips import fail_unless_allowed

    if ONLY_ALLOWED_SKIPS:
        fail_unless_allowed(report)
    return report
