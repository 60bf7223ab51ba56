"""A row of the audit, how it is judged, and what the rounding of printed digits allows.

References:
    [Cochran1977] Sampling Techniques, section 3.2: standard error of a sampled share.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from string import Template
from typing import Any, Literal

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.fluids import GRAVITY as DOWN
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import ActuatorRow, BuoyancyRow, InertialRow

Relation = Literal["=", "<=", ">="]
Verdict = Literal["agrees", "differs", "impossible"]
Kind = Literal["claim", "observation"]

MM = 1e-3
GRAVITY = abs(DOWN[2])  # m/s^2
#: What double precision leaves of a formula that holds exactly, in the row's own unit.
ARITHMETIC = 1e-9
#: Unit in which a figure is shown -> how many of them an SI unit has; 1 where it is not listed.
PER_SI = {
    "mm": 1e3,
    "kg mm^2": 1e6,
    "L": 1e3,
    "kg/L": 1e-3,
    "%": 1e2,
    "deg": 180 / math.pi,
}


@dataclass(frozen=True)
class AuditRow:
    """One claim of the documents, or one observation about their numbers, measured.

    Attributes:
        claim: Identifier, ``topic.subject``.
        place: Section, table or equation.
        says: What the document says there, in short.
        measured: The figure that follows from the document's other numbers, in ``unit``.
        relation: How ``measured`` must stand to ``expected``.
        expected: The figure that the claim asks for, in ``unit``.
        bound: How far apart the two may be because printed digits are rounded, in ``unit``.
        unit: Empty for a pure number.
        verdict: ``agrees``; ``differs``: beyond the bound; ``impossible``: beyond it, and no body
            or formula can be so.
        finding: What was found, in one sentence.
        effect: What the difference is worth, in ``effect_unit``; None where that has no meaning.
        effect_unit: ``N m``, ``N m/A`` or ``mm``.
        kind: ``claim``: the documents say so. ``observation``: they do not; their numbers are held
            against something else, and a difference is no error of theirs.
        standard_error: Of ``measured`` where it was sampled, in ``unit``; 0 where it was computed.
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
    finding: str
    effect: float | None = None
    effect_unit: str = ""
    kind: Kind = "claim"
    standard_error: float = 0.0

    @property
    def topic(self) -> str:
        """The claim's first word: rows of one topic ask the same question of several links."""
        return self.claim.partition(".")[0]


@cache
def _words() -> dict[str, Any]:
    return tomllib.loads((Path(__file__).parent / "rows.toml").read_text("utf-8"))


def audited(
    claim: str,
    measured: float,
    expected: float = 0.0,
    bound: float = 0.0,
    *,
    of: InertialRow | BuoyancyRow | ActuatorRow | None = None,
    effect: float | None = None,
    standard_error: float = 0.0,
    **words: Any,
) -> AuditRow:
    """A row in the words of ``rows.toml``, its figures given in SI units, its verdict judged.

    Args:
        claim: ``topic.subject``; the words stand under both or under the topic alone.
        of: The printed row that it is about: ``.link_3`` is added to the claim, and its columns to
            the words.
        measured, expected, bound, effect, standard_error: See `AuditRow`, in SI units; a bound of
            `ARITHMETIC` is in the row's own unit.
        words: What the text leaves open.
    """
    if of is not None:
        columns = [column.name for column in fields(of)]
        words = {**{name: getattr(of, name) for name in columns}, **words}
        claim += f".{columns[0]}_{words[columns[0]]}"
    topic, _, subject = claim.partition(".")
    text: dict[str, Any] = {**_words()[topic], **_words()[topic].get(subject, {})}
    place, says, finding = (
        Template(text[key]).substitute(words) for key in ("place", "says", "finding")
    )
    unit, effect_unit = text.get("unit", ""), text.get("effect_unit", "")
    scale = PER_SI.get(unit, 1.0)
    return judged(
        claim,
        place,
        says,
        float(f"{measured * scale:.15g}"),  # a decimal number in SI units and back is the same one
        text.get("must", "="),
        float(f"{expected * scale:.15g}"),
        bound if bound == ARITHMETIC else bound * scale,
        unit,
        finding,
        law=text.get("law", False),
        effect=None if effect is None else float(effect * PER_SI.get(effect_unit, 1.0)),
        effect_unit="" if effect is None else effect_unit,
        kind=text.get("kind", "claim"),
        standard_error=float(standard_error * scale),
    )


def judged(
    claim: str,
    place: str,
    says: str,
    measured: float,
    relation: Relation,
    expected: float,
    bound: float,
    unit: str,
    finding: str,
    *,
    law: bool = False,
    **more: Any,
) -> AuditRow:
    """A row with its verdict.

    Args:
        law: The claim must hold in nature: if it does not, the verdict is ``impossible``.
        others: The attributes of `AuditRow`, those that have a default in ``more``.
    """
    excess = measured - expected
    holds = {"=": abs(excess) <= bound, "<=": excess <= bound, ">=": -excess <= bound}[relation]
    verdict: Verdict = "agrees" if holds else "impossible" if law else "differs"
    figures = float(measured), relation, float(expected), float(bound)
    return AuditRow(claim, place, says, *figures, unit, verdict, finding, **more)


def sampled_share(hits: BoolArray) -> tuple[float, float]:
    """Share of True among independent samples (N,) and its standard error, sqrt(p (1 - p) / N)."""
    p = float(hits.mean())
    return p, float(np.sqrt(p * (1 - p) / hits.size))


def si(printed: Sequence[Quantity]) -> FloatArray:
    """Printed numbers in SI units, (N,)."""
    return np.array([q.si for q in printed])


def figure(
    function: Callable[[FloatArray], float], printed: Sequence[Quantity]
) -> tuple[float, float]:
    """The function's value at the printed numbers and its `rounding_bound`."""
    return float(function(si(printed))), float(rounding_bound(function, printed))


def rounding_bound(
    function: Callable[[FloatArray], FloatArray | float], printed: Sequence[Quantity]
) -> FloatArray:
    """How far a result may be off because its printed inputs are rounded: worst case, first order.

    Each input is moved by half a unit of its last printed digit, one at a time, and the
    changes of the result are added up.

    Args:
        function: From the inputs in SI units, (N,), to a result of any shape.
        printed: The N inputs.

    Returns:
        Of the result's shape, not negative.
    """
    centre = si(printed)
    value = np.asarray(function(centre), dtype=np.float64)
    total = np.zeros_like(value)
    for k, quantity in enumerate(printed):
        step = np.zeros_like(centre)
        step[k] = quantity.rounding
        up, down = (np.abs(function(centre + s * step) - value) for s in (1.0, -1.0))
        total += np.maximum(up, down)
    return total


def excess_of_box(point: FloatArray, bounds: FloatArray) -> float:
    """Distance of a point (3,) from a box (3, 2); 0 inside."""
    outside = np.maximum(np.maximum(bounds[:, 0] - point, point - bounds[:, 1]), 0.0)
    return float(np.linalg.norm(outside))
