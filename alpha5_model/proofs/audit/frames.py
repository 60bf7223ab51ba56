"""Sections 1.1, 2 and 2.2: the frames, and where the document refers to them.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1, 2 and 2.2.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import excess_of_box
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.parameters import Alpha5Parameters, LinkParameters
from alpha5_model.numbers.tables import InertialRow, Published
from alpha5_model.proofs.audit.rounding import figure
from alpha5_model.proofs.audit.row import AuditRow, audited

#: Section -> the section that it names for the frames, and the one that places them.
REFERENCES = {"1.1": ("2", "2"), "2.2": ("2.1", "2")}


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the frames, in the order of the sections."""
    first_frame = float(printed.table_1.rows[0].link) - 1
    largest_angle = max(abs(row.alpha) for row in parameters.dh[:4])
    return [
        audited("frames.first", measured=first_frame),
        audited(
            "frames.aligned",
            measured=largest_angle,
            bound=None,
            angle=np.degrees(largest_angle),
        ),
        *(
            _cross_reference(section, named, right)
            for section, (named, right) in REFERENCES.items()
        ),
        _base_frame(printed.table_2.rows[0], parameters.links[0]),
    ]


def _cross_reference(section: str, named: str, right: str) -> AuditRow:
    return audited(
        f"cross_reference.section_{section}",
        measured=float(named),
        expected=float(right),
        section=section,
        named=named,
        right=right,
    )


def _base_frame(row: InertialRow, link: LinkParameters) -> AuditRow:
    """Distance of the COM of link 0 from its body, if {0} is as the text says."""

    def outside(com: FloatArray) -> float:
        return excess_of_box(com * [-1, -1, 1], link.bounds)

    distance = figure(outside, row.com)
    moved = 2 * float(np.hypot(*link.com[:2]))
    return audited(
        "base_frame",
        measured=distance.value,
        bound=distance.bound,
        of=row,
        effect=moved * link.mass * -GRAVITY[2],
        moved=1e3 * moved,
    )
