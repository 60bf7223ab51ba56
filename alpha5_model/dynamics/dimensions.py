"""Checks that a model has the dimensions and limits of a record.

Computations that were made for the catalogue's arm, or from the record of an arm,
refuse other models with them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.spatial import pose
from alpha5_model.description.frames import (
    base_placement,
    joint_placements,
    tcp_placement,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

if TYPE_CHECKING:
    import pinocchio as pin

#: How far a joint may be from its place [m], and turned from it [rad], if an answer
#: needs the catalogue's dimensions exactly: a file may print few digits.
EXACT = 1e-9
#: The same for answers about drawn bodies. Primitives enclose these within 3 mm, and
#: sets of numbers that round to the printed ones differ by 2 mm.
DRAWN = 3e-3
#: Turns an angle into a distance: a turn moves a point of this arm by no more [m/rad].
_REACH = 0.5


def made_for() -> Alpha5Parameters:
    """The arm that the drawn bodies and the estimated water were made for.

    Those are files of the package, so this is the catalogue's arm.
    """
    return parameters()


def has_dimensions(
    model: pin.Model, tolerance: float = EXACT, arm: Alpha5Parameters | None = None
) -> bool:
    """Whether `check_dimensions` passes."""
    _, distance = _farthest(model, made_for() if arm is None else arm)
    return distance <= tolerance


def check_dimensions(
    model: pin.Model,
    needed_for: str,
    tolerance: float = EXACT,
    arm: Alpha5Parameters | None = None,
) -> None:
    """Check that the joints and the tcp of a model are where a record has them.

    Args:
        model: pin.Model of an arm, on any base and with any gripper.
        needed_for: The computation that needs these dimensions, for the message.
        tolerance: Largest error of a position, also by rotation at the reach [m].
        arm: The record; None for the catalogue's.

    Raises:
        InputError: A joint or the tcp is elsewhere, or not there.
    """
    known = made_for()
    record = known if arm is None else arm
    name, distance = _farthest(model, record)
    if distance <= tolerance:
        return

    missing = np.isinf(distance)
    off = f"{name} {distance * 1e3:.3g} mm off"
    source = "Table 1" if record is known else "its record"
    raise InputError(
        "arm",
        f"an arm without {name}" if missing else off,
        f"the dimensions of {source}, for which {needed_for} was made",
    )


def check_limits(model: pin.Model, needed_for: str, arm: Alpha5Parameters) -> None:
    """Check that axis_e to axis_b have the limits of a record.

    Raises:
        InputError: One of them has others.
    """
    for joint in arm.joints[:4]:
        at = model.joints[model.getJointId(joint.name)].idx_q
        lower = model.lowerPositionLimit[at]
        upper = model.upperPositionLimit[at]
        if max(abs(lower - joint.lower), abs(upper - joint.upper)) > EXACT:
            raise InputError(
                "arm",
                f"{joint.name} from {lower:.6g} to {upper:.6g} rad",
                f"the limits of its record, for which {needed_for} was made",
            )


def _farthest(model: pin.Model, parameters: Alpha5Parameters) -> tuple[str, float]:
    """The joint of a model that is farthest from its place in a record.

    Returns:
        Name of the joint, or ``tcp``, and how far off it is [m]; infinity if the model
        does not have it.
    """
    names = [joint.name for joint in parameters.joints[:4]]
    for name in names:
        if not model.existJointName(name):
            return name, np.inf
    for name in ("base_link", "tcp"):
        if not model.existFrame(name):
            return name, np.inf

    placements = [
        base_placement(parameters),
        *joint_placements(parameters),
        tcp_placement(parameters),
    ]
    base, first, *rest = (pose(at.xyz, at.rpy) for at in placements)
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
    """Distance of two poses (4, 4), with rotations taken at the arm's reach [m]."""
    difference = np.abs(one - other)
    return float(max(difference[:3, 3].max(), _REACH * difference[:3, :3].max()))
