"""Which tests may be left out, and why: `tests/allowed_skips.toml`."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

LIST = Path(__file__).resolve().parents[1] / "allowed_skips.toml"


def allowed(reason: str) -> bool:
    """Whether the list has an entry for a reason, as pytest prints it."""
    entries = tomllib.loads(LIST.read_text("utf-8"))["skip"]
    return any(re.fullmatch(entry["reason"], reason) for entry in entries)


def fail_unless_allowed(report: Any) -> None:
    """Turn the report of a skipped test, or of a skipped file, into a failure.

    Args:
        report: pytest's report; one of a test that ran, or that is expected to fail,
            stays as it is.
    """
    if not report.skipped or hasattr(report, "wasxfail"):
        return
    path, line, text = report.longrepr
    reason = text.removeprefix("Skipped: ")
    if not allowed(reason):
        report.outcome = "failed"
        report.longrepr = f"{path}:{line}: skipped, and not in {LIST.name}: {reason}"
