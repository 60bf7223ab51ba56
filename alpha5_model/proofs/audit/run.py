"""All rows of the audit."""

from __future__ import annotations

from functools import cache

from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.printed import published
from alpha5_model.proofs.audit import bodies, geometry, lecture, motors
from alpha5_model.proofs.audit.row import AuditRow


@cache
def audit() -> tuple[AuditRow, ...]:
    """Every consistency check of the documents, measured against its bound.

    There is one row for each claim of the manufacturer's document and of the lecture
    notes: the claim in short, the figure that follows from other numbers, what the
    rounding of printed digits allows, a verdict, and the effect of the difference. The
    rows judge the documents, not this package: a row that differs is a finding. Rows of
    the kind ``observation`` compare numbers with something that the document does not
    claim. Rows of the kind ``outside`` compare them with what somebody else says, and
    name that source.

    Returns:
        Frozen rows, in the order of the topics; computed once.
    """
    printed = published()
    record = parameters()
    return (
        *geometry.rows(printed, record),
        *bodies.rows(printed, record),
        *motors.rows(printed, record),
        *lecture.rows(record),
    )
