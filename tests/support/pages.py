"""The pages of the documentation, and what the build writes into them."""

from __future__ import annotations

import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
DOCS = REPOSITORY / "docs"
PAGES = (REPOSITORY / "README.md", *sorted(DOCS.rglob("*.md")))

sys.path.insert(0, str(DOCS / "_extensions"))
import generated_text  # noqa: E402

__all__ = ["DOCS", "PAGES", "REPOSITORY", "generated_text"]
