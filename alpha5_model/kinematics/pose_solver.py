"""Solving whole poses: the position exactly, the orientation as closely as possible."""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, float_array, is_rigid
from alpha5_model.errors import InputError
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.plane import on_axis
from alpha5_model.kinematics.pose_search import search_poses
from alpha5_model.kinematics.solutions import (
    PoseSolutionArrays,
    SolutionArrays,
    pose_answer,
)
from alpha5_model.kinematics.solver import solve


def solve_poses(hand: Hand, transform: Any) -> PoseSolutionArrays:
    """All solutions of poses (..., 4, 4), read-only.

    Raises:
        InputError: Not real numbers of that shape, or not a rigid transform.
    """
    target = _rigid(transform)
    position = np.ascontiguousarray(target[..., :3, 3])
    rotation = target[..., :3, :3]
    middle = hand.shape.middle

    if not hand.shape.has_tool_on_axis:
        return search_poses(hand, position, rotation)

    solutions = solve(SolutionArrays, position, middle[3], hand.shape)
    exists = solutions.exists
    q = np.where(exists[..., None], solutions.q, np.asarray(middle))
    q, error = hand.turn_wrist(q, rotation)
    free = on_axis(position)
    if free.any():
        q[free], error[free] = _with_best_yaw(
            hand, q[free], error[free], rotation[free]
        )
    q[~exists] = np.nan
    error[~exists] = np.nan
    return pose_answer(
        q=q,
        exists=exists,
        within_limits=solutions.within_limits,
        singular=solutions.singular,
        position=solutions.position,
        error=error,
    )


def _rigid(transform: Any) -> FloatArray:
    """Rigid transforms (..., 4, 4), or of a ``pinocchio.SE3``."""
    matrix = getattr(transform, "homogeneous", transform)
    target = float_array("transform", matrix, (4, 4))
    rigid = is_rigid(target)
    if not rigid.all():
        index = tuple(int(i) for i in np.argwhere(~rigid)[0])
        place = f"transform[{', '.join(map(str, index))}]" if index else "transform"
        expected = "a rigid transform (rotation, translation, 0 0 0 1)"
        raise InputError(place, target[index].tolist(), expected)
    return target


def _with_best_yaw(
    hand: Hand, q: FloatArray, error: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """q (N, 4, 4) with the theta_0 of the least rotation error, and that (N, 4)."""
    for theta_0 in hand.yaw_candidates(q, rotation):
        trial = q.copy()
        trial[..., 0] = theta_0
        trial, missed = hand.turn_wrist(trial, rotation)
        better = missed < error
        q = np.where(better[..., None], trial, q)
        error = np.where(better, missed, error)
    return q, error
