"""Choosing one of several solutions, and refusing targets that have none.

The jaws count as closed. If every solution of a target collides, the error names the
nearest wrist angle, or the least turn of the target about the yaw axis, that frees it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, flag, float_array
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.errors import (
    InputError,
    JointLimitError,
    SelfCollisionError,
    UnreachableError,
)
from alpha5_model.kinematics.geometry import Geometry, on_axis
from alpha5_model.kinematics.reach import nearest_reachable, reachable
from alpha5_model.kinematics.solver import Branches, solve
from alpha5_model.kinematics.tolerances import LIMIT_TOLERANCE
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters

#: Rotation errors that differ by less count as equal; the joint travel decides [rad].
TIE = 1e-7
#: Angles are tried in such steps [rad], and the nearest free one is narrowed down by
#: halving a step so many times.
ANGLE_STEP = math.radians(1.0)
_HALVINGS = 12


def best(
    solutions: Branches,
    arm: Alpha5Parameters,
    q_reference: ArrayLike,
    allow_collision: bool,
) -> FloatArray:
    """`alpha5_model.kinematics.ik.Solutions.best` for the record of an arm."""
    allow_collision = flag("allow_collision", allow_collision)
    require_solution(solutions, arm)
    reference = _reference(solutions.q, q_reference)
    geometry = Geometry.of(arm)

    free = on_axis(solutions.position)
    if free.any():
        yaw = np.clip(reference[..., 0], geometry.lower[0], geometry.upper[0])
        turned = solutions.q.copy()
        replaced = free[..., None] & solutions.exists
        turned[..., 0] = np.where(replaced, yaw[..., None], turned[..., 0])
        solutions = solutions._replace(q=turned)
    if allow_collision:
        return _nearest(solutions.q, reference, solutions.within_limits)

    valid = solutions.within_limits & ~collides(solutions, arm)
    stuck = free & ~valid.any(axis=-1)
    if stuck.any():
        # Another theta_0 may be free.
        scene = self_collision(arm)
        yaw_range = (geometry.lower[0], geometry.upper[0])
        q = solutions.q.copy()
        for index in np.argwhere(stuck[..., None] & solutions.within_limits):
            place = tuple(index)
            free_yaw = nearest_free_yaw(scene, q[place], *yaw_range)
            if not math.isnan(free_yaw):
                q[place][0] = free_yaw
                valid[place] = True
        solutions = solutions._replace(q=q)
    _require_free(solutions, arm, valid, reference)
    return _nearest(solutions.q, reference, valid)


def best_pose(
    solutions: Branches,
    rotation_error: FloatArray,
    arm: Alpha5Parameters,
    q_reference: ArrayLike,
    allow_collision: bool,
) -> FloatArray:
    """`alpha5_model.kinematics.pose.PoseSolutions.best` for the record of an arm."""
    allow_collision = flag("allow_collision", allow_collision)
    require_solution(solutions, arm)
    reference = _reference(solutions.q, q_reference)
    valid = solutions.within_limits
    if not allow_collision:
        valid = valid & ~collides(solutions, arm)
        _require_free(solutions, arm, valid, reference)
    error = np.where(valid, rotation_error, np.inf)
    least = error <= error.min(axis=-1, keepdims=True) + TIE
    return _nearest(solutions.q, reference, least & valid)


def collides(solutions: Branches, arm: Alpha5Parameters) -> BoolArray:
    """Which solutions within the limits touch the arm itself, (..., 4), read-only."""
    asked = solutions.within_limits
    angles = solutions.q.reshape(-1, 4)
    hits = self_collision(arm).touches(angles, asked=asked.reshape(-1))
    hits = hits.reshape(asked.shape)
    hits.flags.writeable = False
    return hits


def require_solution(solutions: Branches, arm: Alpha5Parameters) -> None:
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
    if not Geometry.of(arm).tool_on_axis:
        exists = solutions.exists[index]
        for angle in solutions.q[index][exists, 3]:
            _check_wrist(float(angle), arm)
        raise UnreachableError(target, math.nan, np.full(3, math.nan), reason)

    if bool(reachable(target, arm=arm)):
        angle = float(np.nanmin(solutions.q[index][:, 3]))  # the same for all branches
        _check_wrist(angle, arm)
    closest = nearest_reachable(target, arm=arm)
    off = math.hypot(*(target - closest))
    raise UnreachableError(target, off, closest, reason)


def collision_error(
    target: FloatArray, q: FloatArray, arm: Alpha5Parameters, place: str = ""
) -> SelfCollisionError:
    """The error of a target whose solutions all collide.

    Args:
        target: (3,) [m].
        q: The solution that would have been chosen, (4,) [rad].
        arm: Record of the arm.
        place: Which of several targets it is, for the message.
    """
    geometry = Geometry.of(arm)
    wrist = float(q[3])

    def free_at_wrist(changes: FloatArray) -> BoolArray:
        targets = np.broadcast_to(target, (len(changes), 3))
        return _is_free(targets, wrist + changes, arm)

    def free_turned(angles: FloatArray) -> BoolArray:
        cos, sin = np.cos(angles), np.sin(angles)
        x, y, z = target
        turned = [cos * x - sin * y, sin * x + cos * y, np.full_like(cos, z)]
        return _is_free(np.stack(turned, axis=1), np.full_like(cos, wrist), arm)

    least = geometry.lower[3] - wrist
    most = geometry.upper[3] - wrist
    yaw = math.nan
    if target[:2].any():
        yaw = _least_change(free_turned, -math.pi, math.pi)
    links, depth = self_collision(arm).overlap(q)
    return SelfCollisionError(
        target,
        links=links,
        depth=depth,
        wrist=wrist + _least_change(free_at_wrist, least, most),
        yaw=yaw,
        place=place,
    )


def _require_free(
    solutions: Branches,
    arm: Alpha5Parameters,
    valid: BoolArray,
    reference: FloatArray,
) -> None:
    """Raise for the first target that no valid solution reaches.

    Raises:
        SelfCollisionError: There is one.
    """
    solved = valid.any(axis=-1)
    if not solved.all():
        index, row = _first(np.logical_not(solved))
        chosen = _nearest(solutions.q, reference, solutions.within_limits)
        raise collision_error(solutions.position[index], chosen[index], arm, row)


def _first(which: BoolArray) -> tuple[tuple[int, ...], str]:
    """The first place where an array is True, and its words in a message."""
    index = tuple(int(i) for i in np.argwhere(which)[0])
    return index, f" (row {', '.join(map(str, index))})" if index else ""


def _check_wrist(angle: float, arm: Alpha5Parameters) -> None:
    """Raise if a wrist angle is beyond its limits."""
    wrist = arm.joints[3]
    least = wrist.lower - LIMIT_TOLERANCE
    greatest = wrist.upper + LIMIT_TOLERANCE
    if not least <= angle <= greatest:
        bound = wrist.lower if angle < wrist.lower else wrist.upper
        raise JointLimitError(wrist.name, angle, bound)


def _reference(q: FloatArray, q_reference: ArrayLike) -> FloatArray:
    """The reference of each target of q (..., 4, 4), (..., 4)."""
    reference = float_array("q_reference", q_reference, (4,))
    plausibility.check_largest("q_reference", reference, plausibility.ANGLE)
    shape = (*q.shape[:-2], 4)
    try:
        return np.broadcast_to(reference, shape)
    except ValueError:
        expected = f"shape (4,) or {shape}"
        raise InputError("q_reference", reference.shape, expected) from None


def _nearest(q: FloatArray, reference: FloatArray, valid: BoolArray) -> FloatArray:
    """The valid solutions of q (..., 4, 4) nearest to references (..., 4), (..., 4)."""
    with np.errstate(over="ignore"):
        travel = np.square(q - reference[..., None, :]).sum(axis=-1)
    # A reference so far off that the travel overflows still has a nearest solution.
    travel = np.minimum(travel, np.finfo(np.float64).max)
    index = np.where(valid, travel, np.inf).argmin(axis=-1)
    chosen = np.take_along_axis(q, index[..., None, None], axis=-2)
    return np.ascontiguousarray(chosen[..., 0, :])


def nearest_free_yaw(
    scene: SelfCollision, q: FloatArray, lower: float, upper: float
) -> float:
    """The theta_0 nearest to that of q (4,) at which the arm is free [rad].

    NaN if there is none between ``lower`` and ``upper``.
    """

    def is_free(changes: FloatArray) -> BoolArray:
        rows = np.repeat(q[None], len(changes), axis=0)
        rows[:, 0] += changes
        return ~scene.touches(rows)

    yaw = float(q[0])
    return yaw + _least_change(is_free, lower - yaw, upper - yaw)


def _is_free(
    targets: FloatArray, wrists: FloatArray, arm: Alpha5Parameters
) -> BoolArray:
    """Which targets (N, 3) have a free solution within the limits, (N,)."""
    solved = solve(Geometry.of(arm), targets, wrists)
    valid = solved.within_limits & ~collides(solved, arm)
    return np.asarray(valid.any(axis=-1))


def _least_change(
    is_free: Callable[[FloatArray], BoolArray], lower: float, upper: float
) -> float:
    """The least change of an angle that frees the arm; NaN if none between bounds.

    A free range narrower than `ANGLE_STEP` can be missed.

    Args:
        is_free: Whether each of N changes leads to a free solution: (N,) bool.
        lower, upper: Of the change [rad].
    """
    steps = np.arange(ANGLE_STEP, max(-lower, upper) + ANGLE_STEP, ANGLE_STEP)
    changes = np.clip(np.ravel(np.stack([steps, -steps], axis=1)), lower, upper)
    free = is_free(changes)
    if not free.any():
        return math.nan

    change = float(changes[free.argmax()])
    blocked = change - math.copysign(ANGLE_STEP, change)
    for _ in range(_HALVINGS):
        middle = (change + blocked) / 2
        if is_free(np.array([middle]))[0]:
            change = middle
        else:
            blocked = middle
    return change
