"""Rows of the audit as sentences, word for word."""

from __future__ import annotations

from dataclasses import replace

import pytest

from alpha5_model.cli.audit_text import alike, counts, grouped, heading, sentence
from alpha5_model.proofs.audit.row import EXACT, AuditRow

ROW = AuditRow(
    claim="mass.link_0",
    place="Section 2.1, Table 2, link 0",
    says="the mass is 1 kg",
    measured=1.23456789,
    relation="=",
    expected=1.0,
    bound=0.00512,
    unit="kg",
    verdict="differs",
    measures="mass of the CAD",
    finding="It is heavier.",
    used="the table's",
    effect=0.01234,
    effect_unit="N m",
    cost="torque at axis_d",
    kind="claim",
    standard_error=0.0321,
    category="error",
    source="The maker's page",
)
BARE = replace(
    ROW,
    bound=EXACT,
    finding="",
    used="",
    effect=None,
    cost="",
    standard_error=0.0,
    source="",
)
FIGURES = "mass of the CAD: 1.235 ± 0.032 kg, expected 1 ± 0.0051 kg"


def test_a_sentence_says_where_what_and_how_much() -> None:
    assert sentence([ROW]) == f"Section 2.1, Table 2, link 0: {FIGURES}"
    assert sentence([ROW], verbose=True) == (
        f'Section 2.1, Table 2, link 0, "the mass is 1 kg": {FIGURES}. '
        "It is heavier. We use the table's. "
        "It costs 0.0123 N m: torque at axis_d. Source: The maker's page."
    )


def test_what_is_not_known_is_left_out() -> None:
    figures = "mass of the CAD: 1.235 kg, expected 1 kg"
    assert sentence([BARE], verbose=True) == (
        f'Section 2.1, Table 2, link 0, "the mass is 1 kg": {figures}.'
    )
    words_only = replace(BARE, cost="one link")
    assert sentence([words_only], verbose=True).endswith(" It costs one link.")
    no_unit = replace(BARE, unit="", relation="<=")
    assert sentence([no_unit]).endswith(": 1.235, expected at most 1")
    assert sentence([replace(BARE, relation=">=")]).endswith("expected at least 1 kg")


@pytest.mark.parametrize(
    ("claims", "places", "said"),
    [
        (
            ["mass.link_0", "mass.link_1", "mass.link_4"],
            ["Section 2, Table 2, link 0", "Section 2, Table 2, link 1", "Section 2"],
            "Section 2, link 0, 1, 4",
        ),
        (
            ["mass.link_0", "mass.link_12"],
            ["Table 2, link 0", "Table 2, link 12"],
            "Table 2, link 0, 12",
        ),
        (["com.link_0", "com.base"], ["Table 2"] * 2, "Table 2, link 0, base"),
        (["com.link_0", "com.axis_0"], ["Table 2"] * 2, "Table 2, link 0, axis 0"),
        (["com.first", "com.second"], ["Table 2"] * 2, "Table 2, first, second"),
    ],
)
def test_rows_alike_are_one_sentence(
    claims: list[str], places: list[str], said: str
) -> None:
    rows = [
        replace(ROW, claim=claim, place=place, says=claim)
        for claim, place in zip(claims, places, strict=True)
    ]
    assert alike([rows[0], replace(ROW, measured=2.0), *rows[1:]])[0] == rows
    assert sentence(rows) == f"{said}: {FIGURES}"
    # Each of what they say, once; what they find is the same, the rest the first's.
    others = [replace(row, used="another", effect=2.0) for row in rows[1:]]
    words = sentence([rows[0], *others], verbose=True)
    assert "We use the table's. It costs 0.0123 N m: " in words
    assert words.startswith(f'{said}, "{"; ".join(claims)}": ')
    assert words.count("It is heavier.") == 1


def test_rows_are_counted_by_what_they_are() -> None:
    agrees = replace(ROW, verdict="agrees", category=None)
    observed = replace(agrees, kind="observation")
    outside = replace(ROW, kind="outside", category=None)
    rows = [ROW, ROW, agrees, agrees, observed, outside, outside]
    assert [heading(row) for row in (ROW, agrees, outside)] == [
        "error",
        "agrees",
        "outside",
    ]
    assert counts(rows) == (
        "documents: 2 claims agree, 2 errors, 0 readings, 0 matters of transcription; "
        "observations: 1 agree, 0 differ; outside evidence: 0 agree, 2 differ"
    )
    by_heading = grouped(rows, heading)
    assert [*by_heading] == ["error", "agrees", "observation", "outside"]
    assert by_heading["agrees"] == [agrees, agrees]
