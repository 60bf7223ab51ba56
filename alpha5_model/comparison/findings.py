"""What a person should know about the other model, in words."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.alignment import Alignment, axis_lines
from alpha5_model.comparison.bodies import Cost, body_findings
from alpha5_model.comparison.mapping import AXES, FourJointArm
from alpha5_model.comparison.records import BodyDifference, Finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.parameters import Alpha5Parameters, parameters

#: What still counts as the same geometry.
LENGTH_TOLERANCE = 1e-5  # [m]
ANGLE_TOLERANCE = 1e-4  # [rad]
#: Of Table 3's whole volume; its digits allow 5 * 0.5 mL of 573 mL.
VOLUME_TOLERANCE = 5e-3


def findings(
    other: UrdfRobot,
    ours: FourJointArm,
    theirs: FourJointArm,
    alignment: Alignment,
    transforms: FloatArray,
    bodies: tuple[BodyDifference, ...],
    tip_error: float,
    cost: Cost,
    folder: Path | None,
) -> tuple[Finding, ...]:
    """Everything that a person should know about the other model: what costs most first, then base to tip.

    Args:
        other: The other model as read.
        ours, theirs: Both arms, reduced to four joints.
        alignment: Base, signs and zeros.
        transforms: transform_theirs_to_ours of the body frames, (5, 4, 4).
        bodies: The bodies held against the tables.
        tip_error: Largest distance of the tips [m].
        cost: What an error of a body is worth.
        folder: Where its meshes are; None leaves them out.
    """
    tables = parameters()
    found = (
        *_geometry(ours, theirs, alignment, tip_error),
        *_limits(tables, theirs, alignment),
        *_mimics(other),
        *body_findings(other, ours, theirs, transforms, bodies, cost),
        *_volume(tables, ours, theirs),
        *_files(other, folder),
    )
    return tuple(sorted(found, key=lambda f: (-round(f.cost, 6), not f.serious)))


def collision_volume(arm: FourJointArm) -> float:
    """Of the collision primitives [m^3]; NaN if there are none."""
    return float(arm.volume.sum()) or math.nan


def _geometry(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, tip_error: float
) -> list[Finding]:
    found = []
    shift, rotation = alignment.base[:3, 3], alignment.base[:3, :3]
    angle = math.acos(float(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
    if np.linalg.norm(shift) > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE:
        x, y, z = shift * 1e3
        found.append(
            Finding(
                "base",
                f"its root stands at ({x:.2f}, {y:.2f}, {z:.2f}) mm in our base_link, turned by "
                f"{math.degrees(angle):.2f} deg: another mount, or for a yaw a shifted zero of axis_e",
                serious=False,
            )
        )
    for axis, sign, zero in zip(AXES, alignment.sign, alignment.zero, strict=True):
        if sign < 0:
            found.append(Finding(axis, "turns the other way"))
        if abs(zero) > ANGLE_TOLERANCE:
            found.append(Finding(axis, f"its zero is shifted by {math.degrees(zero):.2f} deg"))
    if tip_error > LENGTH_TOLERANCE:
        first = _first_axis_off(ours, theirs, alignment)
        found.append(Finding(first, f"from here on the tip is up to {tip_error * 1e3:.2f} mm off"))
    return found


def _first_axis_off(ours: FourJointArm, theirs: FourJointArm, alignment: Alignment) -> str:
    points, directions = axis_lines(ours, np.zeros(4))
    there, _ = axis_lines(theirs, alignment.zero)
    there = there @ alignment.base[:3, :3].T + alignment.base[:3, 3]
    off = np.linalg.norm(np.cross(there - points, directions), axis=1) > LENGTH_TOLERANCE
    return AXES[int(off.argmax())] if off.any() else AXES[-1]


def _mimics(other: UrdfRobot) -> list[Finding]:
    """Joints that their leader drives beyond their own limits."""
    found = []
    for joint in other.joints.values():
        leader = other.joints.get(joint.mimic or "")
        if leader is None or None in (leader.lower, leader.upper, joint.lower, joint.upper):
            continue
        ends = [
            joint.multiplier * (end or 0.0) + joint.offset for end in (leader.lower, leader.upper)
        ]
        beyond = max((joint.lower or 0.0) - min(ends), max(ends) - (joint.upper or 0.0))
        if beyond > ANGLE_TOLERANCE:
            text = f"mimics {leader.name} {beyond:.4g} beyond its own limit"
            found.append(Finding(joint.name, text))
    return found


def _limits(tables: Alpha5Parameters, theirs: FourJointArm, alignment: Alignment) -> list[Finding]:
    found = []
    rows = zip(tables.joints[:4], theirs.joints, alignment.sign, alignment.zero, strict=True)
    for ours, joint, sign, zero in rows:
        if joint.lower is None or joint.upper is None:
            found.append(Finding(ours.name, "has no limits", serious=False))
            continue
        ends = sorted(float(sign * (end - zero)) for end in (joint.lower, joint.upper))
        if max(abs(ends[0] - ours.lower), abs(ends[1] - ours.upper)) > ANGLE_TOLERANCE:
            low, high = (math.degrees(end) for end in ends)
            found.append(
                Finding(
                    ours.name,
                    f"range {low:.1f} to {high:.1f} deg in place of "
                    f"{math.degrees(ours.lower):.1f} to {math.degrees(ours.upper):.1f} deg",
                    serious=False,
                )
            )
    return found


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
