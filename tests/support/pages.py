"""The pages of the documentation, and what the build writes into them."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import NamedTuple

REPOSITORY = Path(__file__).resolve().parents[2]
DOCS = REPOSITORY / "docs"
PAGES = (REPOSITORY / "README.md", *sorted(DOCS.rglob("*.md")))

sys.path.insert(0, str(DOCS / "_extensions"))
import generated_text  # noqa: E402

__all__ = ["DOCS", "PAGES", "REPOSITORY", "Block", "blocks", "generated_text"]


class Block(NamedTuple):
    """A fenced block: its language, its text and its line in the page."""

    language: str
    text: str
    line: int


def blocks(text: str) -> list[Block]:
    """The fenced blocks of a page, in order."""
    fence = re.compile(
        r"^```+\{?([\w-]*)\}?[^\n]*\n(.*?)^```+$", re.DOTALL | re.MULTILINE
    )
    return [
        Block(m[1], m[2], text[: m.start()].count("\n") + 1)
        for m in fence.finditer(text)
    ]
