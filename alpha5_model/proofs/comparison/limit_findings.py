"""What is wrong with the limits of joints, and of joints that mimic another."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import wrap
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import JointParameters
from alpha5_model.proofs.comparison.alignment import ANGLE_TOLERANCE
from alpha5_model.proofs.comparison.correction import (
    LIMIT_TOLERANCE,
    JointCorrection,
    seems_in_degrees,
)
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.records import Finding


def findings_of_limits(evidence: Evidence) -> Iterator[Finding]:
    """Limits of the four joints that are missing, in degrees, or not ours."""
    for joint, correction in enumerate(evidence.corrections):
        ours = correction.ours
        if ours is None:
            continue
        yield from _velocity(correction, ours)
        sign = evidence.alignment.sign[joint]
        zero = evidence.alignment.zero[joint]
        yield from _range(correction, ours, sign, zero)


def _velocity(correction: JointCorrection, ours: JointParameters) -> Iterator[Finding]:
    """A velocity in degrees per second."""
    velocity = correction.joint.velocity
    if seems_in_degrees(velocity, ours.velocity):
        yield finding(
            "limits.velocity_in_degrees",
            where=ours.name,
            theirs=velocity,
            ours=math.degrees(ours.velocity),
            line=correction.text,
        )


def _range(
    correction: JointCorrection, ours: JointParameters, sign: float, zero: float
) -> Iterator[Finding]:
    """A range that is missing, in degrees, or not ours.

    Args:
        correction: Of their joint.
        ours: Our joint.
        sign: +1 or -1: how their positions follow from ours.
        zero: Their position at our zero [rad].
    """
    lower = correction.joint.lower
    upper = correction.joint.upper
    printed = np.array([ours.lower, ours.upper])
    if lower is None or upper is None:
        yield finding("limits.none", where=ours.name, line=correction.text)
        return

    if seems_in_degrees(upper - lower, ours.upper - ours.lower):
        yield finding(
            "limits.in_degrees",
            where=ours.name,
            theirs=(lower, upper),
            ours=np.degrees(printed),
            line=correction.text,
        )
        return

    ends = np.sort(sign * (np.array([lower, upper]) - zero))
    # Shift their range by full turns to where ours is.
    middle = ends.mean()
    ends = ends + float(wrap(middle, printed.mean()) - middle)
    if np.abs(ends - printed).max() > LIMIT_TOLERANCE:
        yield finding(
            "limits",
            where=ours.name,
            theirs=np.degrees(ends),
            ours=np.degrees(printed),
            line=correction.text,
        )


def findings_of_mimics(other: UrdfRobot) -> Iterator[Finding]:
    """Joints that their leader drives beyond their own limits."""
    advised: dict[str, FloatArray] = {}  # joint -> the limits that it should have
    for joint in other.joints.values():
        leader = other.joints.get(joint.mimic or "")
        if leader is None:
            continue
        limits = _limits(joint)
        travel = _limits(leader)
        if limits is None or travel is None:
            continue

        travel = advised.get(leader.name, travel)
        low, high = np.sort(joint.multiplier * travel + joint.offset)
        beyond = max(limits[0] - low, high - limits[1])
        if beyond > ANGLE_TOLERANCE:
            advised[joint.name] = np.array([low, high])
            yield finding(
                "mimic",
                where=joint.name,
                leader=leader.name,
                joint=joint.name,
                low=low,
                high=high,
                beyond=beyond,
            )


def _limits(joint: UrdfJoint) -> FloatArray | None:
    """Lower and upper limit of a joint, (2,) [rad or m]; None if one is missing."""
    if joint.lower is None or joint.upper is None:
        return None
    return np.array([joint.lower, joint.upper], float)
