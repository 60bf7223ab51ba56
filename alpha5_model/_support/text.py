"""Results as text: wrapped lines, tables, units with their signs; and for JSON."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields, is_dataclass
from typing import Any

import numpy as np

#: Control characters of a terminal, except ends of lines and tabs. Group 1 holds those
#: of plain colours, which are kept.
_CONTROL = re.compile(
    r"(\x1b\[(?:0|1|3[0-7]|9[0-7])m)"
    r"|[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]"
)


def printable(text: str) -> str:
    """A text with its control characters escaped; it may hold names from a file."""
    return _CONTROL.sub(lambda m: m[1] or m[0].encode("unicode_escape").decode(), text)


def readable(text: str) -> str:
    """A text with its units as people write them: ``N·m`` and ``kg·m²``."""
    text = text.replace("^2", "²").replace("^3", "³")
    return re.sub(r"\b(N|kg) (mm?)(?![a-z])", r"\1·\2", text)


def plain(value: Any, unknown: float | None = None) -> Any:
    """A result in the types of JSON: numbers, texts, arrays, records, collections.

    Args:
        unknown: Replaces numbers that are not finite.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value), unknown)
    if hasattr(value, "_asdict"):
        return plain(value._asdict(), unknown)
    if isinstance(value, dict):
        return {key: plain(item, unknown) for key, item in value.items()}

    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item, unknown) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return unknown
    return value


def wrapped(line: str, width: int, hang: int | None = None) -> list[str]:
    """A line, broken into lines of at most ``width`` characters; words stay whole.

    Args:
        hang: Spaces before each line but the first; two more than before the first if
            left out.
    """
    if len(line) <= width:
        return [line]
    indent = len(line) - len(line.lstrip())
    spaces = indent + 2 if hang is None else hang
    return textwrap.wrap(
        line,
        width,
        subsequent_indent=" " * spaces,
        break_long_words=False,
        break_on_hyphens=False,
    )


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
        align: ``<`` or ``>`` for each column; the last one also holds for those that
            follow.
        indent: Spaces before each line.
        width: Longer lines are continued under their last cell; 0 for no limit.
        gap: Spaces between columns.
    """
    cells = [[readable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    sides = align + align[-1] * (len(widths) - len(align))
    last_column = indent + sum(widths[:-1]) + gap * (len(widths) - 1)

    lines = []
    for row in cells:
        columns = zip(row, sides, widths, strict=True)
        aligned = [f"{cell:{side}{size}}" for cell, side, size in columns]
        line = " " * indent + (" " * gap).join(aligned)
        if width:
            lines += wrapped(line.rstrip(), width, hang=last_column)
        else:
            lines.append(line.rstrip())
    return lines


def short_repr(record: Any) -> str:
    """A record in a few lines: arrays by their shapes, records by their names.

    Args:
        record: A dataclass or a named tuple.
    """
    named = getattr(record, "_fields", None)
    names = [f.name for f in fields(record)] if named is None else named
    shown = [f"{name}={_short(getattr(record, name))}" for name in names]
    text = f"{type(record).__name__}({', '.join(shown)})"
    return "\n".join(wrapped(text, 88, hang=4))


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"array{value.shape}"
    if is_dataclass(value) and not isinstance(value, type):
        return f"{type(value).__name__}(...)"
    text = repr(value)
    if len(text) <= 60 and "\n" not in text:
        return text
    if isinstance(value, str):
        return f"{text[:57]}..."
    if hasattr(value, "__len__"):
        return f"{type(value).__name__} of {len(value)}"
    return f"{type(value).__name__}(...)"
