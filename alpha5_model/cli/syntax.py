"""Vectors and units on the command line, in one form for the parser."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterable

#: Units that may follow a number.
UNITS = ("deg", "mm", "rad", "m")
_NUMBER = rf"[-+−]?(?:\d+\.?\d*|\.\d+|inf|nan)(?:e[-+]?\d+)?(?:{'|'.join(UNITS)})?"
_NUMBERS = re.compile(rf"\s*{_NUMBER}(?:[\s,]+{_NUMBER})*[\s,]*", re.IGNORECASE)
#: Options with a vector -> how many numbers it has at most.
_VECTORS = {
    "--link": 5,
    "--limits": 2,
    "-l": 2,
    **dict.fromkeys(
        ("--gravity", "--current", "--mount", "--payload", "--positions"), 9
    ),
}
#: Options with a vector whose commands have no arguments: all words up to the next
#: option belong to it.
_OPEN_VECTORS = ("--q", "--v", "--a", "--xyz", "--rpy", "--target", "--pose")


def one_syntax(words: Iterable[str]) -> list[str]:
    """The arguments for the parser: one word for each vector and each other number.

    ``--q 1 2 3 4``, ``--q 1,2,3,4`` and ``--q 57 115 172 229 deg`` are the same, as are
    ``1 2`` and ``1,2`` without an option.
    """
    left = deque(words)
    out: list[str] = []
    while left:
        if left[0] in _VECTORS or left[0] in _OPEN_VECTORS:
            option = left.popleft()
            vector = split(" ".join(_take_numbers(left, option)))
            out.append(option)
            out += [" ".join(vector)] if vector else []
            continue

        arguments = _take_numbers(left)
        out += split(" ".join(arguments)) if arguments else [left.popleft()]
    return out


def _take_numbers(left: deque[str], option: str | None = None) -> list[str]:
    """Take words with numbers from the start of the rest, and a unit after them.

    Args:
        left: The remaining words; the taken ones are removed.
        option: The option that they belong to; None for arguments.
    """
    most = _VECTORS.get(option or "")
    taken: list[str] = []
    while left and _belongs(left[0], option):
        taken.append(left.popleft())
        is_whole_vector = len(split(taken[0])) > 1
        if most is not None and (is_whole_vector or len(taken) == most):
            break

    if taken and left and left[0] in UNITS:
        taken.append(left.popleft())
    return taken


def _belongs(word: str, option: str | None) -> bool:
    """Whether a word is part of an option's vector, or of the numbers without one."""
    if _NUMBERS.fullmatch(word):
        return True
    return option in _OPEN_VECTORS and not word.startswith("-")


def split(text: str) -> list[str]:
    """The parts between commas and spaces.

    A unit that stands alone at the end applies to all parts without a unit.
    """
    parts = text.replace("−", "-").replace(",", " ").split()
    unit = parts.pop() if parts and parts[-1] in UNITS else ""
    return [part if part.endswith(UNITS) else part + unit for part in parts]
