"""The tables of words: names of the functions, and how languages write them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name(name).read_text("utf-8"))


#: ``quantities``: what goes in and comes out; ``functions``: what is computed; by name.
WORDS = _table("words.toml")

_TABLES = _table("languages.toml")
#: Language -> its words, by operation. What a language leaves out it writes as C does.
LANGUAGES: dict[str, dict[str, str]] = {
    language: {**_TABLES["double"], **own} for language, own in _TABLES.items()
}
