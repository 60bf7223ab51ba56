"""Choosing one of the solutions, and saying why when there is none."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array
from alpha5_model.errors import InputError, JointLimitError, UnreachableError
from alpha5_model.kinematics.ik.one import LIMIT_TOLERANCE, on_axis
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.kinematics.reach import nearest_reachable, reachable
from alpha5_model.parameters import parameters


def candidates(
    q: FloatArray, position: FloatArray, q_reference: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Solutions (..., 4, 4), theta_0 from the reference where it is free, and the reference (..., 4)."""
    reference = float_array("q_reference", q_reference, (4,))
    try:
        lead = np.broadcast_shapes(reference.shape[:-1], q.shape[:-2])
    except ValueError:
        lead = None
    if lead != q.shape[:-2]:
        shape = (*q.shape[:-2], 4)
        raise InputError("q_reference", reference.shape, f"shape (4,) or {shape}")
    free = on_axis(position)
    if free.any():
        g = arm_plane()
        kept = np.clip(reference[..., 0], g.lower[0], g.upper[0])
        q = q.copy()
        q[..., 0] = np.where(free[..., None] & ~np.isnan(q[..., 0]), kept[..., None], q[..., 0])
    return q, reference


def pick(q: FloatArray, reference: FloatArray, allowed: BoolArray) -> FloatArray:
    """The allowed solution nearest to the reference, (..., 4)."""
    with np.errstate(over="ignore"):
        travel = np.square(q - reference[..., None, :]).sum(axis=-1)
    travel = np.minimum(travel, np.finfo(np.float64).max)  # however far the reference
    index = np.where(allowed, travel, np.inf).argmin(axis=-1)
    return np.ascontiguousarray(np.take_along_axis(q, index[..., None, None], axis=-2)[..., 0, :])


def require_solution(q: FloatArray, within_limits: BoolArray, position: FloatArray) -> None:
    """Raise for the first target that has no solution within the limits.

    Raises:
        JointLimitError: It is within reach, and only its wrist angle is beyond the limits.
        UnreachableError: It is out of reach.
    """
    solved = within_limits.any(axis=-1)
    if solved.all():
        return
    index = tuple(int(i) for i in np.argwhere(~solved)[0])
    target = position[index]
    if bool(reachable(target)):
        joint = parameters().joints[3]
        angles = q[index][:, 3]
        angle = float(angles[~np.isnan(angles)][0])
        if not joint.lower - LIMIT_TOLERANCE <= angle <= joint.upper + LIMIT_TOLERANCE:
            bound = joint.lower if angle < joint.lower else joint.upper
            raise JointLimitError(joint.name, angle, bound)
    nearest = nearest_reachable(target)
    place = f" (row {', '.join(map(str, index))})" if index else ""
    raise UnreachableError(
        target, math.hypot(*(target - nearest)), nearest, f" within the joint limits{place}"
    )
