"""Choosing one of several solutions, and refusing targets that have none."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.errors import InputError, JointLimitError, UnreachableError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.colliding import (
    collides,
    collision_error,
    nearest_free_angle,
)
from alpha5_model.kinematics.nearest_points import nearest_reachable
from alpha5_model.kinematics.plane import ArmPlane, on_axis
from alpha5_model.kinematics.reachable_points import reachable
from alpha5_model.kinematics.solutions import PoseSolutionArrays, SolutionArrays
from alpha5_model.kinematics.tolerances import LIMIT_TOLERANCE
from alpha5_model.numbers.parameters import JointParameters

#: Rotation errors that differ by less count as equal; the joint travel decides [rad].
TIE = 1e-7


def best(
    solutions: SolutionArrays,
    q_reference: ArrayLike,
    shape: ArmShape,
    wrist: JointParameters,
    scene: SelfCollision | None,
) -> FloatArray:
    """The solutions within the limits that are nearest to a reference, (..., 4).

    Of those that are free of self-collision, if there is a scene.
    """
    require_solution(solutions, shape, wrist)
    free = on_axis(solutions.position)
    if free.any():
        yaw = _yaw_of_reference(solutions.q, q_reference, free, shape)
        solutions = solutions._replace(q=yaw)
    if scene is None:
        return _nearest(solutions.q, q_reference, solutions.within_limits)

    valid = solutions.within_limits & ~collides(solutions, scene)
    if free.any() and not valid.any(axis=-1).all():
        solutions, valid = _with_free_yaw(solutions, valid, free, shape, scene)
    _require_free(solutions, valid, q_reference, shape, scene)
    return _nearest(solutions.q, q_reference, valid)


def best_pose(
    solutions: PoseSolutionArrays,
    q_reference: ArrayLike,
    shape: ArmShape,
    wrist: JointParameters,
    scene: SelfCollision | None,
) -> FloatArray:
    """The solutions within the limits with the least rotation error, (..., 4).

    Of those that are free of self-collision, if there is a scene.
    """
    require_solution(solutions, shape, wrist)
    valid = solutions.within_limits
    if scene is not None:
        valid = valid & ~collides(solutions, scene)
        _require_free(solutions, valid, q_reference, shape, scene)
    error = np.where(valid, solutions.rotation_error, np.inf)
    least = error <= error.min(axis=-1, keepdims=True) + TIE
    return _nearest(solutions.q, q_reference, least & valid)


def _require_free(
    solutions: SolutionArrays | PoseSolutionArrays,
    valid: BoolArray,
    q_reference: ArrayLike,
    shape: ArmShape,
    scene: SelfCollision,
) -> None:
    """Raise for the first target that no valid solution reaches.

    Raises:
        SelfCollisionError: There is one.
    """
    solved = valid.any(axis=-1)
    if solved.all():
        return
    index, row = _first(np.logical_not(solved))
    chosen = _nearest(solutions.q, q_reference, solutions.within_limits)
    raise collision_error(solutions.position[index], chosen[index], shape, scene, row)


def _first(which: BoolArray) -> tuple[tuple[int, ...], str]:
    """The first place where an array is True, and its words in a message."""
    index = tuple(int(i) for i in np.argwhere(which)[0])
    return index, f" (row {', '.join(map(str, index))})" if index else ""


def require_solution(
    solutions: SolutionArrays | PoseSolutionArrays,
    shape: ArmShape,
    wrist: JointParameters,
) -> None:
    """Raise for the first target that has no solution within the limits.

    Raises:
        JointLimitError: It is within reach, and only its wrist angle is beyond the
            limits.
        UnreachableError: It is out of reach; without the nearest point if the tool is
            beside the wrist axis.
    """
    solved = solutions.within_limits.any(axis=-1)
    if solved.all():
        return

    index, row = _first(np.logical_not(solved))
    target = solutions.position[index]
    reason = f" within the joint limits{row}"
    if not shape.has_tool_on_axis:
        exists = solutions.exists[index]
        for angle in solutions.q[index][exists, 3]:
            _check_wrist(float(angle), wrist)
        raise UnreachableError(target, math.nan, np.full(3, math.nan), reason)

    plane = ArmPlane.from_shape(shape, "the nearest point")
    if bool(reachable(plane, target, limits=True, accept=None)):
        angle = float(np.nanmin(solutions.q[index][:, 3]))  # the same for all branches
        _check_wrist(angle, wrist)

    closest = nearest_reachable(plane, target, limits=True)
    off = math.hypot(*(target - closest))
    raise UnreachableError(target, off, closest, reason)


def _check_wrist(angle: float, wrist: JointParameters) -> None:
    """Raise if a wrist angle is beyond its limits."""
    least = wrist.lower - LIMIT_TOLERANCE
    greatest = wrist.upper + LIMIT_TOLERANCE
    if not least <= angle <= greatest:
        bound = wrist.lower if angle < wrist.lower else wrist.upper
        raise JointLimitError(wrist.name, angle, bound)


def _reference(q: FloatArray, q_reference: ArrayLike) -> FloatArray:
    """The reference of each target of q (..., 4, 4), (..., 4)."""
    reference = float_array("q_reference", q_reference, (4,))
    shape = (*q.shape[:-2], 4)
    try:
        return np.broadcast_to(reference, shape)
    except ValueError:
        expected = f"shape (4,) or {shape}"
        raise InputError("q_reference", reference.shape, expected) from None


def _yaw_of_reference(
    q: FloatArray, q_reference: ArrayLike, free: BoolArray, shape: ArmShape
) -> FloatArray:
    """Solutions whose free theta_0 is the reference's, clipped to its range."""
    reference = _reference(q, q_reference)
    yaw = np.clip(reference[..., 0], shape.lower[0], shape.upper[0])
    turned = q.copy()
    replaced = free[..., None] & ~np.isnan(q[..., 0])
    turned[..., 0] = np.where(replaced, yaw[..., None], q[..., 0])
    return turned


def _with_free_yaw(
    solutions: SolutionArrays,
    valid: BoolArray,
    on_yaw_axis: BoolArray,
    shape: ArmShape,
    scene: SelfCollision,
) -> tuple[SolutionArrays, BoolArray]:
    """Solutions on the yaw axis with the nearest theta_0 that is free of collision.

    Only those that collide are turned, of targets that all solutions collide at.

    Returns:
        The solutions, and which are valid, (..., 4).
    """
    q = solutions.q.copy()
    valid = valid.copy()
    stuck = on_yaw_axis & ~valid.any(axis=-1)
    for index in np.argwhere(stuck[..., None] & solutions.within_limits):
        place = tuple(index)
        lower, upper = shape.lower[0], shape.upper[0]
        yaw = nearest_free_angle(scene, q[place], 0, lower, upper)
        if not math.isnan(yaw):
            q[place][0] = yaw
            valid[place] = True
    return solutions._replace(q=q), valid


def _nearest(q: FloatArray, q_reference: ArrayLike, valid: BoolArray) -> FloatArray:
    """The valid solutions of q (..., 4, 4) nearest to a reference, (..., 4)."""
    reference = _reference(q, q_reference)
    with np.errstate(over="ignore"):
        travel = np.square(q - reference[..., None, :]).sum(axis=-1)
    # A reference so far off that the travel overflows still has a nearest solution.
    travel = np.minimum(travel, np.finfo(np.float64).max)
    index = np.where(valid, travel, np.inf).argmin(axis=-1)
    chosen = np.take_along_axis(q, index[..., None, None], axis=-2)
    return np.ascontiguousarray(chosen[..., 0, :])
