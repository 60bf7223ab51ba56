"""Shared by all tests."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

TESTS = Path(__file__).parent
# What several tests use is in `support`; some use a second route of another test.
# Scripts import each other from `scripts`, and so do their tests.
sys.path[:0] = [
    *(str(folder) for folder in TESTS.iterdir() if folder.is_dir()),
    str(TESTS.parent / "scripts"),
]
# On a busy machine any example may take long. The benchmarks time what must be quick.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")

#: Set in CI, which has everything installed: a test is skipped for listed reasons only.
ONLY_ALLOWED_SKIPS = "ALPHA5_ONLY_ALLOWED_SKIPS" in os.environ


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """One browser for all tests: a launch costs seconds."""
    from browser import MISSING, browser

    if MISSING:
        pytest.skip(f"there is no {' and no '.join(MISSING)}")
    with browser() as running:
        yield running


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A test that uses Chromium is one of the layer `browser`."""
    for item in items:
        if "chromium" in getattr(item, "fixturenames", ()):
            item.add_marker("browser")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Iterator[Any]:
    report = yield
    return judged(report)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Iterator[Any]:
    report = yield
    return judged(report)


def judged(report: Any) -> Any:
    """The report of a test or file; in CI it fails if its skip is not listed."""
    from skips import fail_unless_allowed

    if ONLY_ALLOWED_SKIPS:
        fail_unless_allowed(report)
    return report
