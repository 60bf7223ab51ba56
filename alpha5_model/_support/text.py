"""Results to be read, columns side by side, long lines wrapped, units with their signs; and for JSON."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import asdict, is_dataclass
from typing import Any

import numpy as np

#: Control characters, which a terminal obeys, but for ends of lines, tabs and plain colours.
_OBEYED = re.compile(
    r"(\x1b\[(?:0|1|3[0-7]|9[0-7])m)"
    r"|[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]"
)


def printable(text: str) -> str:
    """A text that may hold names from a file, its control characters written out."""
    return _OBEYED.sub(lambda m: m[1] or m[0].encode("unicode_escape").decode(), text)


def readable(text: str) -> str:
    """Units as a reader writes them: ``N m`` and ``kg m^2`` as ``N·m`` and ``kg·m²``."""
    text = text.replace("^2", "²").replace("^3", "³")
    return re.sub(r"\b(N|kg) (mm?)(?![a-z])", r"\1·\2", text)


def plain(value: Any, unknown: float | None = None) -> Any:
    """Numbers, texts, arrays, records and collections of them in the types that JSON has.

    Args:
        unknown: In place of a number that is not finite.
    """
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    value = value._asdict() if hasattr(value, "_asdict") else value
    if isinstance(value, dict):
        return {key: plain(item, unknown) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item, unknown) for item in value]
    return unknown if isinstance(value, float) and not math.isfinite(value) else value


def wrapped(line: str, width: int, hang: int | None = None) -> list[str]:
    """A line as lines of at most so many characters; what does not fit hangs two deeper than it.

    Args:
        hang: Spaces before each line but the first.
    """
    spaces = len(line) - len(line.lstrip()) + 2 if hang is None else hang
    if len(line) <= width:
        return [line]
    whole: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}
    return textwrap.wrap(line, width, subsequent_indent=" " * spaces, **whole)


def table(
    rows: Iterable[Sequence[str]],
    align: str = "<>",
    indent: int = 0,
    width: int = 0,
    gap: int = 2,
) -> list[str]:
    """Rows of cells as lines; each column is as wide as its widest cell.

    Args:
        rows: Of equally many cells.
        align: ``<`` or ``>`` for each column; the last one holds for those that follow, too.
        indent: Spaces before each line.
        width: What is longer goes on under its last cell; 0 for lines as long as they are.
        gap: Spaces between columns.
    """
    cells = [[readable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    sides = align + align[-1] * (len(widths) - len(align))
    lines = []
    for row in cells:
        parts = [
            f"{c:{side}{n}}" for c, side, n in zip(row, sides, widths, strict=True)
        ]
        line = (" " * indent + (" " * gap).join(parts)).rstrip()
        hang = indent + sum(widths[:-1]) + gap * (len(widths) - 1)
        lines += wrapped(line, width, hang) if width else [line]
    return lines
