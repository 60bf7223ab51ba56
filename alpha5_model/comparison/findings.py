"""What a person should know about the other model, in words."""

from __future__ import annotations

import math
from pathlib import Path

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.alignment import body_transforms
from alpha5_model.comparison.arm import FourJointArm
from alpha5_model.comparison.axis_fit import Alignment
from alpha5_model.comparison.bodies import Cost, body_findings
from alpha5_model.comparison.geometry import geometry_findings
from alpha5_model.comparison.records import BodyDifference, Finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.parameters import Alpha5Parameters, parameters

#: Of Table 3's whole volume; its digits allow 5 * 0.5 mL of 573 mL.
VOLUME_TOLERANCE = 5e-3


def findings(
    other: UrdfRobot,
    ours: FourJointArm,
    theirs: FourJointArm,
    written: FourJointArm,
    alignment: Alignment,
    bodies: tuple[BodyDifference, ...],
    q: FloatArray,
    cost: Cost,
    folder: Path | None,
) -> tuple[Finding, ...]:
    """Everything that a person should know about the other model: what costs most first, then base to tip.

    Args:
        other: The other model as read.
        ours, theirs: Both arms, reduced to four joints; theirs as meant, with exact multiples of pi.
        written: Theirs as written.
        alignment: Base, signs and zeros.
        bodies: The bodies held against the tables.
        q: Our joint positions at which costs are taken, (N, 4) [rad].
        cost: What an error of a body is worth.
        folder: Where its meshes are; None leaves them out.
    """
    tables, transforms = parameters(), body_transforms(ours, theirs, alignment)
    found = (
        *geometry_findings(other, ours, theirs, written, alignment, q),
        *body_findings(other, ours, theirs, transforms, bodies, cost),
        *_volume(tables, ours, theirs),
        *_files(other, folder),
    )
    return tuple(sorted(found, key=lambda f: (-round(f.cost, 6), not f.serious)))


def collision_volume(arm: FourJointArm) -> float:
    """Of the collision primitives [m^3]; NaN if there are none."""
    return float(arm.volume.sum()) or math.nan


def _volume(tables: Alpha5Parameters, ours: FourJointArm, theirs: FourJointArm) -> list[Finding]:
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    printed, enclosing = sum(link.volume for link in tables.links), float(ours.volume.sum())
    volume = collision_volume(theirs)
    found = []
    if theirs.collision_meshes:
        count = len(theirs.collision_meshes)
        text = f"{count} collision meshes: their volume is not counted"
        found.append(Finding("volume", text, serious=False))
    known = any(abs(volume - v) <= VOLUME_TOLERANCE * printed for v in (printed, enclosing))
    if not math.isnan(volume) and not known:
        found.append(
            Finding(
                "volume",
                f"collision primitives sum to {volume * 1e3:.3f} L, the arm displaces "
                f"{printed * 1e3:.3f} L: wrong buoyancy in a tool that takes it from them",
                serious=False,
            )
        )
    return found


def _files(other: UrdfRobot, folder: Path | None) -> list[Finding]:
    if folder is None:
        return []
    names = sorted({file for link in other.links.values() for file in link.files})
    missing = [name for name in names if "://" not in name and not (folder / name).is_file()]
    return [Finding(name, "mesh is not there", serious=False) for name in missing]
