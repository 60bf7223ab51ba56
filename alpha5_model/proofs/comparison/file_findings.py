"""Remarks on collision shapes and on missing files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.records import Finding

#: Relative tolerance of the volume: Table 3's digits leave 5 * 0.5 mL of 573 mL open.
VOLUME_TOLERANCE = 5e-3


def findings_of_files(evidence: Evidence) -> Iterator[Finding]:
    """Remarks on collision meshes, the volume of collision primitives, and files."""
    yield from _meshes(evidence)
    yield from _volume(evidence)
    yield from _missing_files(evidence.other, evidence.folder)


def _meshes(evidence: Evidence) -> Iterator[Finding]:
    """Collision meshes, whose volume is not counted."""
    meshes = 0
    for names in evidence.theirs.links:
        for name in names:
            meshes += len(evidence.other.links[name].meshes)
    if meshes:
        yield finding("volume.meshes", meshes=meshes)


def _volume(evidence: Evidence) -> Iterator[Finding]:
    """Collision primitives with another volume than the arm."""
    volume = evidence.theirs.volume
    printed = sum(link.volume for link in evidence.parameters.links)
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    enclosing = evidence.ours.reduced.volume
    off = min(abs(volume - printed), abs(volume - enclosing))
    if volume and off > VOLUME_TOLERANCE * printed:
        yield finding("volume", theirs=volume * 1e3, ours=printed * 1e3)


def _missing_files(other: UrdfRobot, folder: Path | None) -> Iterator[Finding]:
    """Meshes that are not there."""
    if folder is None:
        return
    names: set[str] = set()
    for link in other.links.values():
        names.update(link.files)
    for name in sorted(names):
        if "://" not in name and not (folder / name).is_file():
            yield finding("file", where=name)
