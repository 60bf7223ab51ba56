"""Shared by all tests."""

from __future__ import annotations

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


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """One browser for all tests: a launch costs seconds."""
    from browser import browser

    with browser() as running:
        yield running
