"""Texts that are committed as files, so that a change of them can be read."""

from __future__ import annotations

import os
from pathlib import Path


def check_committed(path: Path, text: str) -> None:
    """Fail unless the text equals the committed file.

    With ALPHA5_UPDATE_PRINTED set, write the text to the file instead.
    """
    if os.environ.get("ALPHA5_UPDATE_PRINTED"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, "utf-8")
    assert text == path.read_text("utf-8")
