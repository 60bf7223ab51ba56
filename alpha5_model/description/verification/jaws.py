"""Moving jaws: the closed assembly is link 4, and the fingers follow the rod."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.description.verification.own_arm import (
    INERTIA_BOUND,
    closed_links,
    inertia_error,
)
from alpha5_model.description.verification.subject import (
    JAW_LINKS,
    FileCheck,
    Subject,
)
from alpha5_model.description.verification.values import table_2
from alpha5_model.numbers.inertia import pseudo_inertia
from alpha5_model.numbers.parameters import is_catalogue


def check_closed_jaws(text: Subject) -> FileCheck:
    """Compare the assembly's pseudo-inertia about the origin of link 4 with Table 2's.

    For an arm of your own, it is compared with that of the arm's link 4.

    The 4x4 pseudo-inertia holds mass, first and second moments, and adds up over the
    bodies, so the sum needs no parallel-axis theorem. Each entry is compared with the
    size of its block.
    """
    total = _assembly(text)
    if total is None:
        finding = "wrist, rod and fingers are not all there, with their joints"
        return text.row("closed jaws", "failed", finding)

    error = inertia_error(total, _closed_link_4(text))
    return text.row(
        "closed jaws",
        verdict="passed" if error <= INERTIA_BOUND else "failed",
        finding="wrist, rod and fingers have link 4's mass, "
        "first and second moments (relative)",
        measured=error,
        bound=INERTIA_BOUND,
    )


def _closed_link_4(text: Subject) -> FloatArray:
    """Pseudo-inertia of link 4, of Table 2 or of the arm's record, (4, 4)."""
    if not is_catalogue(text.expected):
        return closed_links(text.expected)[4]
    link_4 = table_2()[4]
    return pseudo_inertia(link_4.mass, link_4.com, link_4.at_com)


def _assembly(text: Subject) -> FloatArray | None:
    """Pseudo-inertia in link_4 of wrist, rod and fingers, jaws closed, (4, 4).

    None if one of them, or its joint, is missing.
    """
    wrist = text.prefix + "link_4"
    total = np.zeros((4, 4))
    for name in (wrist, *(text.prefix + link for link in JAW_LINKS)):
        body = text.links.get(name)
        if body is None or body.mass is None:
            return None
        placed = np.eye(4)
        if name != wrist:
            joint = text.carriers.get(name)
            if joint is None or joint.parent != wrist:
                return None
            placed = _closed_pose(text, joint)
        total += placed @ pseudo_inertia(body.mass, body.com, body.inertia) @ placed.T
    return total


def _closed_pose(text: Subject, joint: UrdfJoint) -> FloatArray:
    """Pose of the joint's child in its parent, jaws closed, (4, 4)."""
    leader = text.joints.get(joint.source)
    closed = 0.0 if leader is None else leader.lower or 0.0
    return joint.transform @ joint.motion(joint.multiplier * closed + joint.offset)


def jaw_limit_differences(text: Subject) -> Iterator[str]:
    """Fingers whose range or speed does not follow from the rod's."""
    rod = text.joints.get(text.prefix + "axis_a")
    if rod is None or rod.lower is None or rod.upper is None or rod.velocity is None:
        yield "axis_a: no limits"
        return
    for child in (text.prefix + "finger_1", text.prefix + "finger_2"):
        finger = text.carriers.get(child)
        if finger is None or finger.mimic != rod.name:
            yield f"{child}: no joint that follows {rod.name}"
            continue

        turn = finger.multiplier
        nominal = text.expected.jaws.finger_turn
        if abs(turn) != nominal:
            yield f"{finger.name}: {turn:g} rad/m, expected {nominal:g} rad/m"
        ends = [turn * rod.lower + finger.offset, turn * rod.upper + finger.offset]
        implied = {
            "lower": min(ends),
            "upper": max(ends),
            "velocity": abs(turn) * rod.velocity,
        }
        for limit, value in implied.items():
            given = getattr(finger, limit)
            if given is None or not math.isclose(
                given, value, rel_tol=0, abs_tol=1e-12
            ):
                yield f"{finger.name}: {limit} {given}, the rod makes it {value:.12g}"
