"""Texts of the commands, from ``words.toml``."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

#: Command -> what it prints, for `str.format`; ``help`` -> helps of options.
WORDS: dict[str, Any] = tomllib.loads(
    Path(__file__).with_name("words.toml").read_text("utf-8")
)
