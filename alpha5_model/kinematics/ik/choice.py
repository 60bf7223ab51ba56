"""Choosing one of the solutions, and saying why when there is none."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array
from alpha5_model.errors import InputError, JointLimitError, UnreachableError
from alpha5_model.kinematics.ik.one import LIMIT_TOLERANCE, on_axis
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.kinematics.reach import nearest_reachable, reachable
from alpha5_model.parameters import parameters


class HasBranches(Protocol):
    """Solutions by branch: q (..., 4, 4), within_limits (..., 4), position (..., 3)."""

    @property
    def q(self) -> FloatArray: ...
    @property
    def within_limits(self) -> BoolArray: ...
    @property
    def position(self) -> FloatArray: ...


def nearest_solution(solutions: HasBranches, q_reference: ArrayLike) -> FloatArray:
    """`alpha5_model.kinematics.ik.solutions.Solutions.best`."""
    require_solution(solutions)
    q, reference = candidates(solutions, q_reference)
    return pick(q, reference, solutions.within_limits)


def candidates(solutions: HasBranches, q_reference: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Solutions (..., 4, 4), theta_0 from the reference where it is free, and the reference (..., 4)."""
    reference = float_array("q_reference", q_reference, (4,))
    try:
        lead = np.broadcast_shapes(reference.shape[:-1], solutions.q.shape[:-2])
    except ValueError:
        lead = None
    if lead != solutions.q.shape[:-2]:
        shape = (*solutions.q.shape[:-2], 4)
        raise InputError("q_reference", reference.shape, f"shape (4,) or {shape}")
    q = solutions.q
    free = on_axis(solutions.position)
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


def require_solution(solutions: HasBranches) -> None:
    """Raise for the first target that has no solution within the limits.

    Raises:
        JointLimitError: It is within reach, and only its wrist angle is beyond the limits.
        UnreachableError: It is out of reach.
    """
    solved = solutions.within_limits.any(axis=-1)
    if solved.all():
        return
    index = tuple(int(i) for i in np.argwhere(~solved)[0])
    target = solutions.position[index]
    if bool(reachable(target)):
        joint = parameters().joints[3]
        angles = solutions.q[index][:, 3]
        angle = float(angles[~np.isnan(angles)][0])
        if not joint.lower - LIMIT_TOLERANCE <= angle <= joint.upper + LIMIT_TOLERANCE:
            bound = joint.lower if angle < joint.lower else joint.upper
            raise JointLimitError(joint.name, angle, bound)
    nearest = nearest_reachable(target)
    place = f" (row {', '.join(map(str, index))})" if index else ""
    raise UnreachableError(
        target, math.hypot(*(target - nearest)), nearest, f" within the joint limits{place}"
    )
