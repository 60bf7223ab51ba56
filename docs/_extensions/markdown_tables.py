"""Tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    cells = (
        [re.sub(r"\s+", " ", cell).replace("|", "\\|") for cell in line]
        for line in lines
    )
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def plain(text: str) -> str:
    """Words that Markdown would take for markup or mathematics."""
    return re.sub(r"([*<\[\]])", r"\\\1", text)
