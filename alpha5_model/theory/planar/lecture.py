"""The lecture notes' theorem on 3R planar arms, beside the exact condition."""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model._support.checks import real
from alpha5_model.theory.planar.arm import PlanarArm
from alpha5_model.theory.planar.turning import ROUNDING, turns_fully


@dataclass(frozen=True)
class TheoremRow:
    """A row of the notes' experiment.

    Attributes:
        l_4: Distance of the pinned tip from the base.
        pair: Sum of the two shortest of l_1, l_2, l_4: the smallest l_i + l_j of the
            theorem.
        half: Half the sum of all four lengths, L/2; the notes' column is headed l_4/2.
        theorem: Whether the theorem holds.
        exact: Whether the last link turns fully.
    """

    l_4: float
    pair: float
    half: float
    theorem: bool
    exact: bool


def lecture_theorem(l_1: float, l_2: float, l_3: float, l_4: float) -> bool:
    """The notes' theorem to the letter: ``l_i + l_j >= L/2`` for all i, j in {1, 2, 4}.

    It promises that l_3 can turn by 2 pi while the tip is pinned at distance l_4 from
    the base. The condition is sufficient, not necessary; see `turns_fully`. i and j are
    different: with i = j the notes' own rows from 9 to 2 would fail.

    Args:
        l_1, l_2, l_3: Link lengths, base to tip, positive.
        l_4: Distance of the tip from the base, not negative.
    """
    return theorem_row(l_1, l_2, l_3, l_4).theorem


def theorem_row(l_1: float, l_2: float, l_3: float, l_4: float) -> TheoremRow:
    """Both sides of the theorem, its verdict and the exact one.

    See `lecture_theorem`.
    """
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    fourth = real("l_4", l_4, 0.0)
    pair = sum(sorted((first, second, fourth))[:2])
    half = (first + second + third + fourth) / 2
    return TheoremRow(
        l_4=fourth,
        pair=pair,
        half=half,
        theorem=pair >= half * (1 - ROUNDING),
        exact=turns_fully(PlanarArm((first, second, third)), fourth),
    )


def theorem_radii(l_1: float, l_2: float, l_3: float) -> tuple[float, float] | None:
    """The range of l_4 for which the theorem holds.

    It is ``|l_1 - l_2| + l_3 <= l_4 <= l_1 + l_2 - l_3``.

    Returns:
        Least and greatest l_4, or None if there is none.
    """
    first, second, third = _lengths(l_1=l_1, l_2=l_2, l_3=l_3)
    low = abs(first - second) + third
    high = first + second - third
    return (low, max(low, high)) if low <= high + ROUNDING * low else None


def _lengths(**lengths: float) -> list[float]:
    """Link lengths, each positive."""
    return [real(name, length, 0.0, strict=True) for name, length in lengths.items()]
