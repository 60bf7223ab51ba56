"""README's tables are tables: a blank line or a missing cell turns the rest of one into plain text."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
DELIMITER = re.compile(r"\|(\s*:?-{3,}:?\s*\|)+")


def faults(text: str) -> list[str]:
    """Rows that no Markdown reader would show as part of a table, after GitHub's specification, 4.10."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    wrong = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        rows = block.splitlines()
        widths = [len(re.findall(r"(?<!\\)\|", row)) for row in rows]
        if len(rows) < 3 or not DELIMITER.fullmatch(rows[1].strip()):
            wrong.append(f"no head above {rows[0][:40]!r}")
        wrong += [row[:40] for row, n in zip(rows, widths, strict=True) if n != widths[0]]
    return wrong


def test_every_row_stands_in_a_table() -> None:
    text = (REPOSITORY / "README.md").read_text("utf-8")
    assert text.count("\n|") > 60
    assert faults(text) == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("| a | b |\n|---|---|\n| 1 | 2 |\n\n| 3 | 4 |\n", "no head"),
        ("| a | b |\n|---|---|\n| 1 | 2 | 3 |\n", "| 1 | 2 | 3 |"),
        ("| a | b |\n| 1 | 2 |\n| 3 | 4 |\n", "no head"),
    ],
)
def test_a_broken_table_is_seen(text: str, fault: str) -> None:
    assert fault in faults(text)[0]
