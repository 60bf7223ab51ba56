"""Everything that is wrong or odd about another model, in the order of its parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from alpha5_model.proofs.comparison.axis_findings import axis_findings, rest_findings
from alpha5_model.proofs.comparison.base_findings import (
    mount_findings,
    shoulder_findings,
)
from alpha5_model.proofs.comparison.body_findings import all_body_findings
from alpha5_model.proofs.comparison.correction import JointCorrection
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.file_findings import file_findings
from alpha5_model.proofs.comparison.limit_findings import limit_findings, mimic_findings
from alpha5_model.proofs.comparison.records import Finding
from alpha5_model.proofs.comparison.tool_findings import tool_findings


def all_findings(evidence: Evidence) -> Iterator[Finding]:
    """Everything that is wrong or odd, from the base on."""
    axes = [
        *shoulder_findings(evidence),
        *axis_findings(evidence),
        *tool_findings(evidence),
    ]
    rest = _not_mended(evidence, axes)
    yield from mount_findings(evidence)
    yield from axes
    yield from rest_findings(evidence, rest)
    yield from limit_findings(evidence)
    yield from mimic_findings(evidence.other)
    yield from all_body_findings(evidence)
    yield from file_findings(evidence)


def _not_mended(evidence: Evidence, found: Sequence[Finding]) -> list[JointCorrection]:
    """The corrections that no finding tells to write."""
    corrections = [*evidence.corrections]
    if evidence.tool_correction is not None:
        corrections.append(evidence.tool_correction)

    texts = [finding.instead for finding in found]
    return [one for one in corrections if not any(one.text in text for text in texts)]
