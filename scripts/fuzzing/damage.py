"""A valid text with a few things wrong."""

from __future__ import annotations

import re

import numpy as np
from fuzzing.values import Rng, pick

#: In place of a number in a text.
NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e400",
    "1e308",
    "1e-320",
    "-1",
    "0",
    "",
    "x",
    "1,5",
    "0x10",
    "1_0",
    "٣",
    "1e",
    "--1",
    "9" * 5000,
)
#: In place of a character.
CHARACTERS = "<>&\"'/=,;\t\n\r\0 \ufeff\u2028é9-eE.#${}[]"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def damage(rng: Rng, text: str) -> bytes:
    """The text with one to three things wrong, in some encoding."""
    for _ in range(int(rng.integers(1, 4))):
        text = _changed(rng, text)

    encoding = pick(rng, ("utf-8",) * 9 + ("utf-16", "latin-1", "utf-8-sig"))
    content = text.encode(encoding, "replace")
    if rng.integers(10) == 0:
        content = _with_other_bytes(rng, content)
    return content


def _changed(rng: Rng, text: str) -> str:
    """The text with one thing wrong, or as it is."""
    way = int(rng.integers(8))
    start = int(rng.integers(len(text) + 1))
    end = min(start + int(rng.integers(1, 60)), len(text))
    numbers = list(NUMBER.finditer(text)) if way < 3 else []
    if numbers:
        found = pick(rng, numbers)
        return text[: found.start()] + pick(rng, NUMBERS) + text[found.end() :]
    if way == 3:
        return text[:start] + text[end:]
    if way == 4:
        return text[:end] + text[start:]
    if way == 5:
        return text[:start] + pick(rng, CHARACTERS) + text[start + 1 :]
    if way == 6:
        return _with_a_line_moved(rng, text)
    if rng.integers(4) == 0:
        return text[:start]
    return text


def _with_a_line_moved(rng: Rng, text: str) -> str:
    """The text with two lines exchanged, or one moved over the other."""
    lines = text.split("\n")
    here = int(rng.integers(len(lines)))
    there = int(rng.integers(len(lines)))
    moved = lines[here] if rng.integers(2) else ""
    lines[here] = lines[there]
    lines[there] = moved
    return "\n".join(lines)


def _with_other_bytes(rng: Rng, content: bytes) -> bytes:
    """The content with one byte in up to three places."""
    raw = np.frombuffer(content, np.uint8).copy()
    value = rng.integers(256)
    places = rng.integers(len(raw) or 1, size=min(3, len(raw)))
    raw[places] = value
    return raw.tobytes()
