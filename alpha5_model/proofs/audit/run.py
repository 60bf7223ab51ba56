"""All rows of the audit."""

from __future__ import annotations

from functools import cache

from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import Published
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
    record = parameters()
    return (*audit_of_document(published(), record), *lecture.rows(record))


def audit_of_document(
    printed: Published, parameters: Alpha5Parameters
) -> list[AuditRow]:
    """The rows of the manufacturer's document.

    Args:
        printed: Its tables.
        parameters: The same in SI units.
    """
    return [
        *geometry.rows(printed, parameters),
        *bodies.rows(printed, parameters),
        *motors.rows(printed, parameters),
    ]
