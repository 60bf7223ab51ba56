"""Whether an arm has the catalogue's dimensions: what was made for those refuses other arms."""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model._support.spatial import pose
from alpha5_model.description.bodies import (
    base_placement,
    joint_placements,
    tcp_placement,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import parameters

#: How far a joint may be from its place [m], and turned from it [rad], where a closed form or a
#: kernel answers: what rounding does to the numbers of a file.
EXACT = 1e-9
#: The same where bodies answer. Primitives enclose the drawn bodies within 3 mm; sets of numbers
#: that round to the printed ones differ by 2 mm.
DRAWN = 3e-3
#: Turns of this arm move a point by at most its reach [m].
_REACH = 0.5


def has_dimensions(model: Any, tolerance: float = EXACT) -> bool:
    """Whether `check_dimensions` passes."""
    return _farthest(model)[1] <= tolerance


def check_dimensions(model: Any, needed_for: str, tolerance: float = EXACT) -> None:
    """Check that the joints and the tcp of a model are where the catalogue's are.

    Args:
        model: pin.Model of an arm, on any base and with any gripper.
        needed_for: What answers for the catalogue's dimensions only, for the message.
        tolerance: [m], and at the arm's reach.

    Raises:
        InputError: A joint or the tcp is elsewhere, or not there.
    """
    name, distance = _farthest(model)
    if distance <= tolerance:
        return
    found = (
        f"an arm without {name}"
        if np.isinf(distance)
        else f"{name} {distance * 1e3:.3g} mm off"
    )
    raise InputError(
        "arm", found, f"the dimensions of Table 1, for which {needed_for} was made"
    )


def check_limits(model: Any, needed_for: str) -> None:
    """Check that axis_e to axis_b have the catalogue's limits.

    Raises:
        InputError: One of them has others.
    """
    for joint in parameters().joints[:4]:
        at = model.joints[model.getJointId(joint.name)].idx_q
        found = model.lowerPositionLimit[at], model.upperPositionLimit[at]
        if np.abs(np.subtract(found, (joint.lower, joint.upper))).max() > EXACT:
            given = f"{joint.name} from {found[0]:.6g} to {found[1]:.6g} rad"
            raise InputError(
                "arm", given, f"the catalogue's limits, for which {needed_for} was made"
            )


def _farthest(model: Any) -> tuple[str, float]:
    """Name of the joint that is farthest from its place, or ``tcp``, and how far [m]."""
    p = parameters()
    names = [joint.name for joint in p.joints[:4]]
    for name in names:
        if not model.existJointName(name):
            return name, np.inf
    for name in ("base_link", "tcp"):
        if not model.existFrame(name):
            return name, np.inf

    base, first, *rest = (
        pose(at.xyz, at.rpy)
        for at in (base_placement(p), *joint_placements(p), tcp_placement(p))
    )
    ours = [base @ first, *rest]

    to_base = model.frames[model.getFrameId("base_link")].placement.inverse()
    at_joints = [model.jointPlacements[model.getJointId(name)] for name in names]
    at_joints[0] = to_base * at_joints[0]
    tip = model.frames[model.getFrameId("tcp")].placement
    theirs = [at.homogeneous for at in (*at_joints, tip)]

    off = [_distance(one, other) for one, other in zip(ours, theirs, strict=True)]
    worst = int(np.argmax(off))
    return [*names, "tcp"][worst], off[worst]


def _distance(one: Any, other: Any) -> float:
    """How far two poses (4, 4) are apart, at the arm's reach [m]."""
    difference = np.abs(one - other)
    return float(max(difference[:3, 3].max(), _REACH * difference[:3, :3].max()))
