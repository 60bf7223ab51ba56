"""The tables of words: names of the functions, and their texts in each dialect."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name(name).read_text("utf-8"))


#: ``quantities``: what goes in and comes out; ``functions``: what is computed; by name.
WORDS = _table("words.toml")

_TABLES = _table("dialects.toml")
#: Dialect -> its words, by operation. Operations that a dialect lacks are as in C.
DIALECTS: dict[str, dict[str, str]] = {
    dialect: {**_TABLES["double"], **own} for dialect, own in _TABLES.items()
}
