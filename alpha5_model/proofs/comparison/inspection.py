"""Everything that is wrong or odd about another model, in the order of its parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from alpha5_model.proofs.comparison.axis_findings import (
    findings_of_axes,
    findings_of_rest,
)
from alpha5_model.proofs.comparison.base_findings import (
    findings_of_mount,
    findings_of_shoulder,
)
from alpha5_model.proofs.comparison.body_findings import findings_of_bodies
from alpha5_model.proofs.comparison.correction import JointCorrection
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.file_findings import findings_of_files
from alpha5_model.proofs.comparison.limit_findings import (
    findings_of_limits,
    findings_of_mimics,
)
from alpha5_model.proofs.comparison.records import Finding
from alpha5_model.proofs.comparison.tool_findings import findings_of_tool


def all_findings(evidence: Evidence) -> Iterator[Finding]:
    """Everything that is wrong or odd, from the base on."""
    axes = [
        *findings_of_shoulder(evidence),
        *findings_of_axes(evidence),
        *findings_of_tool(evidence),
    ]
    rest = _not_mended(evidence, axes)
    yield from findings_of_mount(evidence)
    yield from axes
    yield from findings_of_rest(evidence, rest)
    yield from findings_of_limits(evidence)
    yield from findings_of_mimics(evidence.other)
    yield from findings_of_bodies(evidence)
    yield from findings_of_files(evidence)


def _not_mended(evidence: Evidence, found: Sequence[Finding]) -> list[JointCorrection]:
    """The corrections that are part of no finding yet."""
    corrections = [*evidence.corrections]
    if evidence.tool_correction is not None:
        corrections.append(evidence.tool_correction)

    texts = [finding.instead for finding in found]
    return [one for one in corrections if not any(one.text in text for text in texts)]
