"""Which solutions drive the arm into itself, and what would free a target.

The jaws count as closed. If every solution of a target collides, three changes are
tried: another wrist angle, the target turned about the yaw axis, and a target nearby.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.errors import SelfCollisionError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.solutions import PoseSolutionArrays, SolutionArrays
from alpha5_model.kinematics.solver import solve_batch

#: Angles are tried in such steps [rad], and the nearest free one is narrowed down by
#: halving a step so many times.
ANGLE_STEP = math.radians(1.0)
_HALVINGS = 12
#: Directions in which a free target is looked for, and the distances [m].
DIRECTIONS = 256
DISTANCES = tuple(1e-3 * 1.3**k for k in range(24))

#: Whether each of N changes leads to a free solution: (N,) bool.
IsFree = Callable[[FloatArray], BoolArray]


def collides(
    solutions: SolutionArrays | PoseSolutionArrays, scene: SelfCollision
) -> BoolArray:
    """Which solutions within the limits touch the arm itself, (..., 4), read-only."""
    hits = scene.touches(
        solutions.q.reshape(-1, 4), asked=solutions.within_limits.reshape(-1)
    ).reshape(solutions.within_limits.shape)
    hits.flags.writeable = False
    return hits


def collision_error(
    target: FloatArray,
    q: FloatArray,
    shape: ArmShape,
    scene: SelfCollision,
    place: str = "",
) -> SelfCollisionError:
    """The error of a target whose solutions all collide.

    Args:
        target: (3,) [m].
        q: The solution that would have been chosen, (4,) [rad].
        shape: Of the arm.
        scene: Of the arm.
        place: Which of several targets it is, for the message.
    """
    links, depth = scene.overlap(q)
    wrist, yaw, nearest = _remedies(target, float(q[3]), shape, scene)
    return SelfCollisionError(
        target,
        links=links,
        depth=depth,
        wrist=wrist,
        yaw=yaw,
        nearest=nearest,
        place=place,
    )


def _remedies(
    target: FloatArray, wrist: float, shape: ArmShape, scene: SelfCollision
) -> tuple[float, float, FloatArray]:
    """What would free a target, each NaN if nothing was found.

    Returns:
        The nearest free wrist angle [rad], the least turn of the target about the yaw
        axis [rad], and a free target near it, (3,) [m].
    """

    def free_at_wrist(angles: FloatArray) -> BoolArray:
        return _is_free(np.broadcast_to(target, (len(angles), 3)), angles, shape, scene)

    def free_turned(angles: FloatArray) -> BoolArray:
        cos, sin = np.cos(angles), np.sin(angles)
        x, y, z = target
        turned = np.stack([cos * x - sin * y, sin * x + cos * y, z + 0.0 * cos], axis=1)
        return _is_free(turned, np.full(len(angles), wrist), shape, scene)

    lower, upper = shape.lower[3] - wrist, shape.upper[3] - wrist
    return (
        wrist + _least_change(free_at_wrist, lower, upper),
        _least_change(free_turned, -math.pi, math.pi) if target[:2].any() else math.nan,
        _free_target(target, wrist, shape, scene),
    )


def nearest_free_angle(
    scene: SelfCollision, q: FloatArray, joint: int, lower: float, upper: float
) -> float:
    """The angle of a joint nearest to that of q (4,) at which the arm is free [rad].

    NaN if there is none between ``lower`` and ``upper``.
    """

    def is_free(changes: FloatArray) -> BoolArray:
        rows = np.repeat(q[None], len(changes), axis=0)
        rows[:, joint] += changes
        return ~scene.touches(rows)

    return float(q[joint]) + _least_change(
        is_free, lower - float(q[joint]), upper - float(q[joint])
    )


def _is_free(
    targets: FloatArray, wrists: FloatArray, shape: ArmShape, scene: SelfCollision
) -> BoolArray:
    """Which targets (N, 3) have a free solution within the limits, (N,)."""
    solutions = solve_batch(targets, wrists, shape)
    return np.asarray(
        (solutions.within_limits & ~collides(solutions, scene)).any(axis=-1)
    )


def _least_change(is_free: IsFree, lower: float, upper: float) -> float:
    """The least change of an angle that frees the arm; NaN if none between bounds.

    A free range narrower than `ANGLE_STEP` can be missed.
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


def _free_target(
    target: FloatArray, wrist: float, shape: ArmShape, scene: SelfCollision
) -> FloatArray:
    """A free target near another, at the same wrist angle, (3,) [m]; NaN if none."""
    directions = _directions()
    wrists = np.full(DIRECTIONS, wrist)
    for distance in DISTANCES:
        points = target + distance * directions
        free = _is_free(points, wrists, shape, scene)
        if free.any():
            return np.asarray(points[free.argmax()])
    return np.full(3, math.nan)


def _directions() -> FloatArray:
    """Unit vectors, spread evenly along a spiral on the sphere, (`DIRECTIONS`, 3)."""
    k = np.arange(DIRECTIONS) + 0.5
    z = 1.0 - 2.0 * k / DIRECTIONS
    azimuth = math.pi * (1.0 + math.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1)
