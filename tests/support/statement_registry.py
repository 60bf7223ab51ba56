"""Numbers in the documentation, each beside the function that computes it again.

A statement has a page, its words with ``{}`` for each number, and a function that gives
a figure for each. The page must agree with the figures to the digits that it prints.
`test_statements_complete.py` looks for numbers that have no statement.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
#: A number as the pages print it: 20 000, −3, 2e-15, 9.8.
NUMBER = r"([-−]?\d+(?: \d{3})*(?:\.\d+)?(?:e-?\d+)?)"


@dataclass(frozen=True)
class Near:
    """The printed number is the figure, rounded.

    Attributes:
        value: The figure, in the unit that is printed.
        within: How far off it may be beyond the rounding, because it was sampled.
    """

    value: float
    within: float = 0.0

    def holds(self, text: str) -> bool:
        return abs(number(text) - self.value) <= half_unit(text) * 1.0001 + self.within


@dataclass(frozen=True)
class AtMost:
    """The printed number bounds the figure."""

    value: float

    def holds(self, text: str) -> bool:
        return self.value <= number(text)


Figure = Near | AtMost


@dataclass(frozen=True)
class Statement:
    """Words with numbers, and what computes these.

    Attributes:
        page: From the repository's root.
        words: As they stand in the page, with ``{}`` in place of each computed number.
        figures: Returns one figure for each number, in their order.
        marks: Of pytest.
    """

    page: str
    words: str
    figures: Callable[[], Sequence[Figure]]
    marks: tuple[Any, ...] = ()

    def found(self) -> re.Match[str] | None:
        """The words in the page, with the numbers as groups."""
        pieces = [re.escape(one_line(piece)) for piece in self.words.split("{}")]
        pattern = NUMBER.join(pieces).replace(r"\ ", r"\s+")
        return re.search(pattern, text_of(self.page))

    def check(self) -> None:
        """Fail where the page says something else."""
        found = self.found()
        assert found, f"{self.page} does not say {self.words!r}"
        printed = found.groups()
        figures = self.figures()
        assert len(printed) == len(figures), "one figure for each {}"
        for text, figure in zip(printed, figures, strict=True):
            assert figure.holds(text), f"{self.page}: {found[0]!r}: {text} for {figure}"


STATEMENTS: list[Statement] = []


def statement(page: str, words: str, *marks: Any) -> Callable[[Any], Any]:
    """Register the decorated function as what computes the numbers of a statement."""

    def register(
        figures: Callable[[], Sequence[Figure]],
    ) -> Callable[[], Sequence[Figure]]:
        STATEMENTS.append(Statement(page, words, figures, marks))
        return figures

    return register


def parameters_of(module: str) -> list[Any]:
    """The statements of a test module, for pytest."""
    mine = [item for item in STATEMENTS if item.figures.__module__ == module]
    return [
        pytest.param(item, marks=item.marks, id=f"{item.page}: {item.words[:40]}")
        for item in mine
    ]


@cache
def text_of(page: str) -> str:
    """The text of a page, white space and line breaks as they are."""
    return (REPOSITORY / page).read_text("utf-8")


def one_line(text: str) -> str:
    """White space as single spaces."""
    return re.sub(r"\s+", " ", text)


def number(text: str) -> float:
    """A printed number."""
    return float(text.replace("−", "-").replace(" ", ""))


def half_unit(text: str) -> float:
    """Half a unit of the last printed digit; half of a whole number's last digit that
    is not 0.
    """
    mantissa, _, exponent = text.replace(" ", "").partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - decimals)
