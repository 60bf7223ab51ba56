"""Modules that are imported when a test first uses them, not when it is collected."""

from __future__ import annotations

from typing import Any

import pytest


class Lazy:
    """A module; the test that uses it is skipped if it is not installed."""

    def __init__(self, name: str, **options: Any) -> None:
        self._name = name
        self._options = options

    def __getattr__(self, attribute: str) -> Any:
        module = pytest.importorskip(self._name, **self._options)
        return getattr(module, attribute)
