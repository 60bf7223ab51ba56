"""Why a body differs: hypotheses from the tables, tested with the other's numbers.

The diagnosis is the fewest mistakes that give the number to its printed digits. If no
hypothesis explains a difference, it has no diagnosis. Names play no part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.comparison.added_inertia import added_water, wrong_point
from alpha5_model.proofs.comparison.hypotheses import BodyHypotheses
from alpha5_model.proofs.comparison.hypothesis_tables import (
    MOST_MISTAKES,
    HypothesisTable,
)
from alpha5_model.proofs.comparison.inertials import (
    COM_DIGITS,
    Inertial,
    solid_links,
    subjects,
)

#: Powers of ten by which a wrong unit changes a tensor.
WRONG_UNITS = (9, 6, 3, -3, -6, -9)

#: Why a number is not that of the tables; None if no hypothesis gives it.
Explain = Callable[[BodyHypotheses, Inertial], str | None]


class View(NamedTuple):
    """A way to read a number, such as "in grams", that the hypotheses are tested with.

    Attributes:
        words: The mistake in it; empty if there is none.
        number: The number, (), (3,) or (3, 3).
        mistakes: 1 if reading it so is a mistake, else 0.
        scale: Factor on the values of the hypotheses.
    """

    words: str
    number: FloatArray
    mistakes: int = 0
    scale: float = 1.0


def reason(known: BodyHypotheses, written: Sequence[Inertial], explain: Explain) -> str:
    """Why a number of a body is wrong, in words; empty if nothing explains it.

    The first subject that has an explanation counts; other links of the body are named.
    """
    for subject in subjects(written):
        words = explain(known, subject)
        if words is None:
            continue
        beside = [link for link in solid_links(written) if link.link != subject.link]
        if not subject.link or not beside:
            return f": {words}"
        names = ", ".join(link.link for link in beside)
        grams = sum(link.mass for link in beside) * 1e3
        return f": {subject.link} has {words}; beside it {names} with {grams:.0f} g"
    return ""


def explain_mass(known: BodyHypotheses, subject: Inertial) -> str | None:
    """Why a mass is not Table 2's; None if no hypothesis gives it."""
    water = added_water(known, subject)
    if water is not None:
        return water.mass
    mass = np.array(subject.mass)
    views = [
        View(words="", number=mass),
        View(words="in grams", number=mass, mistakes=1, scale=1e3),
    ]
    digits = subject.mass_digits
    return _fewest_mistakes(known.masses, views, alone=digits, together=digits)


def explain_com(known: BodyHypotheses, subject: Inertial) -> str | None:
    """Why a COM is not Table 2's; None if no hypothesis gives it."""
    com = subject.com
    if subject.link and not com.any():
        return "missing or zero: at the origin of the other model's link frame"

    frame = f"in a frame that is not inertial frame {{{known.body}}}"
    views = [View(words="", number=subject.in_our_frame().com)]
    if subject.link:
        views += [
            _own_view(subject, com, frame),
            View(words="written in millimetres", number=com, mistakes=1, scale=1e3),
            View(words="written in kilometres", number=com, mistakes=1, scale=1e-3),
        ]
    digits = subject.com_digits
    return _fewest_mistakes(known.coms, views, alone=digits, together=COM_DIGITS[0])


def explain_inertia(known: BodyHypotheses, subject: Inertial) -> str | None:
    """Why a tensor is not Table 2's; None if no hypothesis gives it."""
    seen = subject.in_our_frame().inertia
    if not seen.any():
        return "missing or zero"

    axes = f"in axes that are not those of inertial frame {{{known.body}}}"
    views = [View(words="", number=seen)]
    if subject.link:
        views.append(_own_view(subject, subject.inertia, axes))
    views += _scaled_views(seen, subject.mass / known.link.mass)

    digits = subject.inertia_digits
    words = _fewest_mistakes(known.tensors, views, alone=digits, together=digits)
    if words is not None:
        return words
    water = added_water(known, subject)
    return water.inertia if water is not None else wrong_point(known, subject)


def _own_view(subject: Inertial, number: FloatArray, elsewhere: str) -> View:
    """The number as the link writes it, in its own frame.

    Args:
        subject: The link.
        number: Its number.
        elsewhere: The mistake in words if its frame was not meant to be ours.
    """
    if subject.meant_in_our_frame:
        return View(words="", number=number)
    return View(words=elsewhere, number=number, mistakes=1)


def _scaled_views(tensor: FloatArray, mass_ratio: float) -> list[View]:
    """A tensor that was scaled: with the mass, or by a wrong unit."""
    words = "scaled with the wrong mass"
    views = [View(words=words, number=tensor, mistakes=1, scale=mass_ratio)]
    for power in WRONG_UNITS:
        words = f"wrong unit, a factor of 1e{power}"
        views.append(View(words=words, number=tensor, mistakes=1, scale=10.0**power))
    return views


def _fewest_mistakes(
    table: HypothesisTable, views: Sequence[View], *, alone: float, together: float
) -> str | None:
    """The fewest mistakes that give a number, in words; None if none do.

    Args:
        table: The hypotheses.
        views: Ways to read the number.
        alone: How closely one mistake must match it.
        together: How closely several mistakes must.
    """
    errors = np.array([_errors(table, view) for view in views])
    mistakes = np.array([table.mistakes + view.mistakes for view in views])
    within = np.where(mistakes > 1, together, alone)
    hits = (mistakes <= MOST_MISTAKES) & (errors <= within)
    if not hits.any():
        return None

    counted = np.where(hits, mistakes, MOST_MISTAKES + 1)
    best = int(counted.argmin())
    view, hypothesis = divmod(best, len(table.words))
    words = [table.words[hypothesis], views[view].words]
    return ", ".join(filter(None, words))


def _errors(table: HypothesisTable, view: View) -> FloatArray:
    """How far the hypotheses are from a number, by its worst entry, (N,)."""
    entries = tuple(range(1, table.values.ndim))
    off = np.abs(table.values * view.scale - view.number)
    return np.asarray(off.max(entries, initial=0.0))
