"""A row of the audit: its words from ``rows.toml``, its figures and its verdict."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, Literal

from alpha5_model.numbers.tables import ActuatorRow, BuoyancyRow, InertialRow

Relation = Literal["=", "<=", ">="]
Verdict = Literal["agrees", "differs", "impossible"]
Kind = Literal["claim", "observation", "outside"]
Category = Literal["error", "reading", "transcription"]

#: Bound of a figure that follows from no printed digits, in the unit of its row: what
#: double precision leaves of a formula that holds exactly.
EXACT = 1e-9
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
        bound: How far apart the two may be because printed digits are rounded, in
            ``unit``.
        unit: Empty for a pure number.
        verdict: ``agrees``; ``differs``: the figure is beyond the bound;
            ``impossible``: it is, and no body or formula can be so.
        measures: What ``measured`` is.
        finding: What follows from it, in sentences; empty if the figure says it all.
        used: What this package takes instead; empty if the verdict is ``agrees``.
        effect: What the difference costs, in ``effect_unit``; None if it costs nothing
            that the audit can compute.
        effect_unit: ``N m``, ``N m/A`` or ``mm``.
        cost: What ``effect`` is the size of. If it is None, what the difference costs
            in other words; empty if the verdict is ``agrees``.
        kind: ``claim``: the documents say so. ``observation``: they do not; their
            numbers are compared with something else, and a difference is not their
            error. ``outside``: somebody else says otherwise, and who is right is open.
        standard_error: Of ``measured`` if it was sampled, in ``unit``; 0 if it was
            computed.
        category: What a difference means, None unless the row is a claim. ``error``: it
            is wrong in every reading. ``reading``: it is wrong in the reading that was
            measured; the finding names one in which it is right. ``transcription``: it
            depends on a sign, an index or a letter of a formula. We have only a
            transcription of the document, so the original may be right.
        source: Of ``expected`` if the kind is ``outside``; else empty.
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
    finding: str = ""
    used: str = ""
    effect: float | None = None
    effect_unit: str = ""
    cost: str = ""
    kind: Kind = "claim"
    standard_error: float = 0.0
    category: Category | None = "error"
    source: str = ""

    @property
    def topic(self) -> str:
        """The claim's first word; rows of one topic ask the same of several links."""
        return self.claim.partition(".")[0]


@cache
def texts() -> dict[str, Any]:
    """The words of the rows, topic by topic."""
    return tomllib.loads((Path(__file__).parent / "rows.toml").read_text("utf-8"))


def audited(
    claim: str,
    measured: float,
    bound: float | None = 0.0,
    expected: float = 0.0,
    *,
    of: InertialRow | BuoyancyRow | ActuatorRow | None = None,
    effect: float | None = None,
    standard_error: float = 0.0,
    more: bool = False,
    **words: Any,
) -> AuditRow:
    """A row in the words of ``rows.toml``, from figures in SI units.

    Args:
        claim: ``topic.subject``; the words are in the table of both or of the topic.
        measured, bound, expected, effect, standard_error: See `AuditRow`, in SI units.
            The bound is None if no printed digits are rounded: then it is `EXACT`.
        of: The printed row that the claim is about. Its link or actuator is added to
            the claim (``.link_3``), and its columns to the words.
        more: Whether to append the sentence ``more`` to the finding.
        words: Values of the {names} in the text.
    """
    if of is not None:
        columns = {column.name: getattr(of, column.name) for column in fields(of)}
        title, number = next(iter(columns.items()))
        claim = f"{claim}.{title}_{number}"
        words = columns | words

    text = _text_of(claim, more, words)
    unit = text.get("unit", "")
    per_si = PER_SI.get(unit, 1.0)
    relation: Relation = text.get("must", "=")
    kind: Kind = text.get("kind", "claim")
    category: Category = text.get("category", "error")
    shown_measured = _shown(measured, unit)
    shown_expected = _shown(expected, unit)
    shown_bound = EXACT if bound is None else float(bound * per_si)

    effect_unit = "" if effect is None else text["effect_unit"]
    per_si_of_effect = PER_SI.get(effect_unit, 1.0)

    found = verdict(
        measured=shown_measured,
        relation=relation,
        expected=shown_expected,
        bound=shown_bound,
        law=text.get("law", False),
    )
    return AuditRow(
        claim=claim,
        place=text["place"],
        says=text["says"],
        measured=shown_measured,
        relation=relation,
        expected=shown_expected,
        bound=shown_bound,
        unit=unit,
        verdict=found,
        measures=text["measures"],
        finding=text.get("finding", ""),
        used="" if found == "agrees" else text.get("used", ""),
        effect=None if effect is None else float(effect * per_si_of_effect),
        effect_unit=effect_unit,
        cost=text.get("cost", "") if effect is not None or found != "agrees" else "",
        kind=kind,
        standard_error=float(standard_error * per_si),
        category=category if kind == "claim" else None,
        source=text.get("source", ""),
    )


def _text_of(claim: str, more: bool, words: dict[str, Any]) -> dict[str, Any]:
    """The words of a claim: those of its subject before those of its topic.

    Args:
        more: Whether the finding ends with the sentence ``more``.
        words: Values of the {names}.
    """
    topic, _, subject = claim.partition(".")
    shared = texts()[topic]
    text = {**shared, **shared.get(subject, {})}
    last = text.pop("more", "")
    if more:
        text["finding"] = f"{text.get('finding', '')} {last}".lstrip()
    return {
        key: value.format_map(words) if isinstance(value, str) else value
        for key, value in text.items()
    }


def _shown(value: float, unit: str) -> float:
    """A value in SI units, in the unit in which it is shown.

    A decimal number that was converted to SI units comes back as the same number.
    """
    return float(f"{value * PER_SI.get(unit, 1.0):.15g}")


def verdict(
    measured: float,
    relation: Relation,
    expected: float,
    bound: float,
    law: bool = False,
) -> Verdict:
    """Verdict on a measured figure and the expected one.

    Args:
        measured, relation, expected, bound: See `AuditRow`.
        law: Nature or mathematics demands it: a figure beyond the bound is then
            impossible, not only different.
    """
    excess = measured - expected
    holds = {
        "=": abs(excess) <= bound,
        "<=": excess <= bound,
        ">=": -excess <= bound,
    }
    if holds[relation]:
        return "agrees"
    return "impossible" if law else "differs"
