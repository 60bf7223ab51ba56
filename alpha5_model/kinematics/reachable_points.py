"""Which points the tcp reaches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, flag, float_array
from alpha5_model.errors import InputError
from alpha5_model.kinematics.half_plane import branches_reaching
from alpha5_model.kinematics.plane import ArmPlane, on_axis
from alpha5_model.kinematics.solver import BLOCK, solve_batch

#: Joint positions (M, 4) -> whether each is accepted, (M,).
Accept = Callable[[FloatArray], BoolArray]
#: Values of theta_0 that are tried on the yaw axis, where it is free.
_YAWS = 36


def reachable(
    plane: ArmPlane, positions: ArrayLike, limits: bool, accept: Accept | None
) -> BoolArray:
    """Whether the tcp reaches points (..., 3), in an accepted joint position, (...)."""
    target = float_array("positions", positions, (3,))
    limits = flag("limits", limits)
    if accept is not None and not callable(accept):
        raise InputError("accept", accept, "a function of joint positions")

    if accept is None:
        branches = branches_reaching(plane, target, limits)
        # The four flags of a target, read as one number: faster than any().
        flags = branches.view(np.uint32)[..., 0]
        return np.asarray(flags != 0)

    blocks = np.split(target.reshape(-1, 3), range(BLOCK, target.size // 3, BLOCK))
    accepted = [_accepted(plane, rows, limits, accept) for rows in blocks]
    return np.concatenate(accepted).reshape(target.shape[:-1])


def _accepted(
    plane: ArmPlane, points: FloatArray, limits: bool, accept: Accept
) -> BoolArray:
    """Which points (N, 3) a branch reaches in an accepted joint position, (N,)."""
    solutions = solve_batch(points, np.asarray(plane.middle[3]), plane.shape)
    reached = solutions.within_limits if limits else solutions.exists
    free = on_axis(points)
    yaws = np.linspace(plane.lower[0], plane.upper[0], _YAWS)

    found = np.zeros(len(points), np.bool_)
    for branch in range(solutions.q.shape[1]):
        for yaw in (None, *yaws):
            tried = reached[:, branch] & ~found & (free | (yaw is None))
            rows = np.flatnonzero(tried)
            if not len(rows):
                continue
            q = solutions.q[rows, branch]
            if yaw is not None:
                q[:, 0] = yaw
            found[rows] = _answer(accept(q), len(rows))
    return found


def _answer(answer: Any, count: int) -> BoolArray:
    """The checked answer of a user's function for so many joint positions."""
    accepted = np.asarray(answer)
    if accepted.shape != (count,) or accepted.dtype != np.bool_:
        raise InputError("accept", accepted, f"{count} times True or False")
    return accepted
