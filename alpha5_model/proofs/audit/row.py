"""A row of the audit, and figures that follow from printed numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.quantity import Quantity

Relation = Literal["=", "<=", ">="]
Verdict = Literal["agrees", "differs", "impossible"]
Kind = Literal["claim", "observation", "outside"]
Category = Literal["error", "reading", "transcription"]

#: What double precision may leave of a figure that holds exactly, in the row's unit.
ARITHMETIC = 1e-9
_DECIMALS = 9
#: Unit in which a figure is shown -> how many of them an SI unit has; 1 if it is not
#: listed.
PER_SI = {
    "mm": 1e3,
    "kg mm^2": 1e6,
    "mA": 1e3,
    "L": 1e3,
    "kg/L": 1e-3,
    "%": 1e2,
    "deg": 180 / math.pi,
}


class Figure(NamedTuple):
    """A figure that follows from printed numbers, in SI units.

    Attributes:
        value: Number or array.
        bound: How far it may be off because the numbers are rounded, or because it was
            sampled; of the same shape, not negative.
    """

    value: Any
    bound: Any = 0.0


def si(printed: Sequence[Quantity]) -> FloatArray:
    """Printed numbers in SI units, (N,)."""
    return np.array([number.si for number in printed])


def figure(
    function: Callable[[FloatArray], Any], printed: Sequence[Quantity]
) -> Figure:
    """A figure, and how far it may be off because its printed inputs are rounded.

    The bound is the worst case, to first order: each input is moved by half a unit of
    its last printed digit, one at a time, and the changes of the result are added up.

    Args:
        function: From the inputs in SI units, (N,), to a result of any shape.
        printed: The N inputs.
    """
    inputs = si(printed)
    value = function(inputs)

    changes = []
    for step in np.diag([number.rounding for number in printed]):
        up = np.abs(function(inputs + step) - value)
        down = np.abs(function(inputs - step) - value)
        changes.append([up, down])
    return Figure(value=value, bound=np.max(changes, axis=1).sum(axis=0))


@dataclass(frozen=True)
class AuditRow:
    """One claim of the documents, or one observation about their numbers, measured.

    Attributes:
        claim: Identifier, ``topic.subject``.
        place: Section, table or equation.
        says: What the document says there, in short.
        measured: The figure that follows from the document's other numbers, in
            ``unit``.
        relation: Relation that must hold between ``measured`` and ``expected``.
        expected: The figure that the claim asks for, in ``unit``.
        bound: How far apart the two may be, in ``unit``: the rounding of printed
            digits, a printed tolerance, or three standard errors of a sampled figure.
        unit: Empty for a pure number.
        verdict: ``agrees``; ``differs``: the figure is beyond the bound;
            ``impossible``: it is, and no body or formula can be so.
        measures: What ``measured`` is.
        finding: What follows if it does not agree, in sentences. This and the next
            four are empty or None if it agrees.
        used: What this package takes instead.
        effect: What the difference costs, in ``effect_unit``; None if the audit cannot
            compute it.
        effect_unit: ``N m``, ``N m/A`` or ``mm``.
        cost: What ``effect`` is the size of.
        kind: ``claim``: the documents say so. ``observation``: they do not; their
            numbers are compared with something else, and a difference is not their
            error. ``outside``: somebody else says otherwise, and who is right is open.
        category: What a claim that does not agree is; else None. ``error``: wrong in
            every reading. ``reading``: wrong in the reading that was measured; the
            finding names one in which it is right. ``transcription``: it depends on a
            sign, an index or a letter of a formula. We have only a transcription of
            the document, so the original may be right.
    """

    claim: str
    place: str
    says: str
    measured: float
    relation: Relation
    expected: float
    bound: float
    unit: str
    verdict: Verdict
    measures: str
    finding: str
    used: str
    effect: float | None
    effect_unit: str
    cost: str
    kind: Kind
    category: Category | None

    @property
    def topic(self) -> str:
        """The claim's first word; rows of one topic ask the same of several links."""
        return self.claim.partition(".")[0]


def judged(
    claim: str,
    figure: Figure,
    expected: float = 0.0,
    *,
    place: str,
    says: str,
    measures: str,
    relation: Relation = "=",
    unit: str = "",
    law: bool = False,
    finding: str = "",
    used: str = "",
    cost: str = "",
    effect: float | None = None,
    effect_unit: str = "N m",
    kind: Kind = "claim",
    category: Category = "error",
) -> AuditRow:
    """The row of a figure; see `AuditRow` for the words.

    Args:
        figure, expected, effect: In SI units.
        law: Nature or mathematics demands it: a figure beyond the bound is then
            impossible, not only different.
        finding, used, cost, effect, category: For the case that it does not agree.
    """
    measured = _shown(figure.value, unit)
    bound = _shown(figure.bound, unit)
    asked = _shown(expected, unit)
    excess = {
        "=": abs(measured - asked),
        "<=": measured - asked,
        ">=": asked - measured,
    }[relation]

    agrees = excess <= bound + ARITHMETIC
    verdict: Verdict = "agrees" if agrees else "impossible" if law else "differs"
    costs = not agrees and effect is not None
    return AuditRow(
        claim=claim,
        place=place,
        says=says,
        measured=measured,
        relation=relation,
        expected=asked,
        bound=bound,
        unit=unit,
        verdict=verdict,
        measures=measures,
        finding="" if agrees else finding,
        used="" if agrees else used,
        effect=_shown(effect, effect_unit) if costs else None,
        effect_unit=effect_unit if costs else "",
        cost=cost if costs else "",
        kind=kind,
        category=None if agrees or kind != "claim" else category,
    )


def _shown(value: Any, unit: str) -> float:
    """A value in SI units, in the unit in which it is shown.

    It is rounded to `ARITHMETIC`: a decimal number comes back as it was printed, and no
    processor's last bits are shown or judged.
    """
    return round(float(value) * PER_SI.get(unit, 1.0), _DECIMALS) + 0.0
