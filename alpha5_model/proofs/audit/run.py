"""All rows of the audit."""

from __future__ import annotations

from functools import cache

from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.printed import published
from alpha5_model.proofs.audit import bodies, geometry, joints, lecture
from alpha5_model.proofs.audit.row import AuditRow


@cache
def audit() -> tuple[AuditRow, ...]:
    """Every consistency check of the documents, measured against its bound.

    One row per claim of the manufacturer's document and of the lecture on planar arms: its words in
    short, the figure that follows from its other numbers, what the rounding of printed digits
    allows, a verdict, and what the difference is worth. The rows judge the documents, not this
    package: a row that differs is a finding. Rows of the kind ``observation`` hold their
    numbers, or numbers that circulate beside them, against something that they do not claim.

    Returns:
        Frozen rows, in the order of the topics; computed once.
    """
    printed, p = published(), parameters()
    rows = [
        row for topic in (geometry, bodies, joints) for row in topic.audit(printed, p)
    ]
    return (*rows, *lecture.audit(p))
