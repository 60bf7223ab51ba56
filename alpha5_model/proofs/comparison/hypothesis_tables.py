"""Tables of wrong numbers: right ones with one mistake or two at once."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray

#: Most mistakes at once; with three, some combination would match any number.
MOST_MISTAKES = 2


class Hypothesis(NamedTuple):
    """A number with mistakes.

    Attributes:
        words: The mistakes in words.
        value: The mass (), COM (3,) or tensor (3, 3) with these mistakes, SI.
        mistakes: Their number.
    """

    words: str
    value: FloatArray
    mistakes: int


class HypothesisTable(NamedTuple):
    """Several hypotheses side by side, those with the fewest mistakes first.

    Attributes:
        words: (N,).
        values: (N,), (N, 3) or (N, 3, 3).
        mistakes: (N,).
    """

    words: tuple[str, ...]
    values: FloatArray
    mistakes: NDArray[np.int_]


class Step(NamedTuple):
    """A mistake in words, and the function that makes it."""

    words: str
    change: Callable[[FloatArray], FloatArray]


def mass_hypothesis(words: str, value: float) -> Hypothesis:
    """A mass with one mistake."""
    return Hypothesis(words=words, value=np.asarray(value), mistakes=1)


def products_step(words: str, *, xy: float, xz: float, yz: float) -> Step:
    """The mistake that multiplies the products of inertia by these factors."""
    factors = np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])
    return Step(words=words, change=partial(np.multiply, factors))


def with_mistakes(
    sources: Iterable[Hypothesis], *stages: Sequence[Step]
) -> HypothesisTable:
    """All sources, each also with at most one step of each stage."""
    found = []
    for source in sources:
        made = [source]
        for stage in stages:
            made += _one_more_mistake(made, stage)
        found += made
    return table_of(found)


def _one_more_mistake(
    made: Sequence[Hypothesis], stage: Sequence[Step]
) -> list[Hypothesis]:
    """Each hypothesis with each further mistake, up to `MOST_MISTAKES`."""
    open_ones = [one for one in made if one.mistakes < MOST_MISTAKES]
    return [
        Hypothesis(
            words=f"{old.words}, {step.words}",
            value=step.change(old.value),
            mistakes=old.mistakes + 1,
        )
        for old, step in itertools.product(open_ones, stage)
    ]


def table_of(found: Iterable[Hypothesis]) -> HypothesisTable:
    """Hypotheses side by side, those with the fewest mistakes first."""
    ordered = sorted(found, key=lambda one: one.mistakes)
    return HypothesisTable(
        words=tuple(one.words for one in ordered),
        values=np.array([one.value for one in ordered]),
        mistakes=np.array([one.mistakes for one in ordered]),
    )


def signed_axes() -> Iterator[tuple[str, FloatArray]]:
    """The 47 ways to exchange and reverse axes, in words and as matrices (3, 3).

    One reversed axis comes before two that contain it.
    """
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            words = _axes_in_words(order, signs)
            if words:
                yield words, np.diag(signs) @ np.eye(3)[list(order)]


def _axes_in_words(order: Sequence[int], signs: Sequence[int]) -> str:
    """How axes are exchanged and reversed; empty if they are not."""
    names = ["xyz"[k] for k in order]
    if names != ["x", "y", "z"]:
        signed = [
            f"-{name}" if sign < 0 else name
            for name, sign in zip(names, signs, strict=True)
        ]
        return f"in the wrong axes ({', '.join(signed)})"

    wrong = "".join(name for name, sign in zip(names, signs, strict=True) if sign < 0)
    right = "".join(name for name, sign in zip(names, signs, strict=True) if sign > 0)
    return (
        "",
        f"the sign of {wrong} is wrong (mirrored)",
        f"turned by pi about {right}",
        "mirrored through the origin",
    )[len(wrong)]
