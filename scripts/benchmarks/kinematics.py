"""Kinematics against its peers."""

from __future__ import annotations

from benchmarks.timing import Row


def rows() -> list[Row]:
    """Measured rows of this section."""
    return []


def missing() -> list[str]:
    """Peers that are not installed."""
    return []
