"""``alpha5 torque`` in this process."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from alpha5_model.cli import main


def words(values: Iterable[float]) -> list[str]:
    """Numbers as words of a command line."""
    return [repr(float(x)) for x in values]


def torque(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """What ``alpha5 torque`` prints, which ends without an error or a warning."""
    assert main(["torque", *arguments]) == 0
    out = capsys.readouterr()
    assert out.err == ""
    return out.out
