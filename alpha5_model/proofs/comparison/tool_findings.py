"""Findings about another model's tool frame."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import is_catalogue
from alpha5_model.proofs.comparison.correction import angle_between, tool_pose
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.poses import origin_of
from alpha5_model.proofs.comparison.records import Finding

#: Distance of the jaws' collar from axis_c, by the manufacturer's CAD [m].
JAWS_FROM = 0.13275
#: A tool frame between collar and finger tips is a choice, no error, if it is this
#: close to the wrist axis [m] and its axes are turned by no more than this [rad].
BESIDE = 0.002
TURNED = math.radians(0.5)


def findings_of_tool(evidence: Evidence) -> Iterator[Finding]:
    """A tool frame that is not where ours is in link_4."""
    correction = evidence.tool_correction
    if correction is None:
        return
    ours = evidence.ours.tool_pose
    theirs = tool_pose(evidence.ours, evidence.theirs, evidence.alignment)
    relative = np.linalg.inv(ours) @ theirs
    off = float(np.linalg.norm(origin_of(relative)))
    turned = angle_between(ours, theirs)
    length, angle = evidence.tolerance
    if off <= length and turned <= angle:
        return

    # Another point of the gripper, or axes with other names, are a choice.
    same_point = off <= length or _on_gripper(evidence, origin_of(theirs))
    is_choice = same_point and _axes_are_a_choice(theirs, TURNED + angle)
    x, y, z = origin_of(theirs) * 1e3
    is_printed = is_catalogue(evidence.parameters)
    yield finding(
        "tool.choice" if is_choice else "tool",
        frame=evidence.theirs.tool,
        x=x,
        y=y,
        z=z,
        off=off * 1e3,
        turned=math.degrees(turned),
        ours="Table 1's frame {5}" if is_printed else "its tcp",
        line=correction.text,
    )


def _on_gripper(evidence: Evidence, point: FloatArray) -> bool:
    """Whether a point (3,) of link_4 lies on the wrist axis, in the jaws."""
    tips = evidence.parameters.links[4].bounds[2, 0]
    beside = math.hypot(*point[:2])
    in_jaws = tips <= point[2] <= -JAWS_FROM
    return bool(beside < BESIDE + evidence.tolerance.length and in_jaws)


def _axes_are_a_choice(tool: FloatArray, within: float) -> bool:
    """Whether one axis of a frame lies along the wrist, at a roll of n * 30 deg.

    Args:
        tool: Pose of the frame in link_4, (4, 4).
        within: How closely [rad].
    """
    along = np.abs(tool[2, :3])
    axis = int(along.argmax())
    tilt = math.atan2(np.linalg.norm(np.delete(along, axis)), along[axis])

    across = tool[:3, (axis + 1) % 3]
    roll = math.atan2(across[1], across[0])
    step = math.radians(30)
    off_roll = abs(roll - step * round(roll / step))
    return tilt < within and off_roll < within
