"""The kernel of the inverse kinematics, on targets of any shape."""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import LARGEST, FloatArray, float_array, frozen
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.errors import InputError, KernelError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.kinematics.tolerances import DOUBLE

#: Targets in a block: the results of so many stay in the cache.
BLOCK = 8192

Kind = TypeVar("Kind", bound=SolutionArrays)


def solve(
    kind: type[Kind], position: ArrayLike, wrist: ArrayLike, shape: ArmShape
) -> Kind:
    """All solutions of targets of any shape, read-only.

    Args:
        kind: The class of the answer.
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3; it broadcasts against ``position``'s leading axes [rad].
        shape: Of the arm.

    Raises:
        InputError: Not real numbers, or shapes that do not fit; `NonFiniteError` names
            a bad row.
    """
    target = float_array("position", position, (3,))
    angle = float_array("wrist", wrist, ())
    if target.ndim == 1 and angle.ndim == 0:
        return _solve_one(kind, target, angle, shape)
    try:
        lead = np.broadcast_shapes(target.shape[:-1], angle.shape)
    except ValueError:
        expected = f"a shape that broadcasts with {target.shape[:-1]}"
        raise InputError("wrist", angle.shape, expected) from None
    target = np.broadcast_to(target, (*lead, 3))

    solutions = solve_batch(target, angle, shape)
    for array in solutions:
        array.flags.writeable = False
    return kind._make(solutions)


def _solve_one(
    kind: type[Kind], target: FloatArray, angle: FloatArray, shape: ArmShape
) -> Kind:
    """One target, without what many take."""
    q, *flags = _solve_block(shape, target[None], angle.reshape(1))
    exists, within_limits, singular = (flag[0] != 0.0 for flag in flags)
    solutions = (q[0], exists, within_limits, singular.reshape(()), target.copy())
    for array in solutions:
        array.flags.writeable = False
    return kind._make(solutions)


def solve_batch(
    position: FloatArray, wrist: FloatArray, shape: ArmShape, angles: bool = True
) -> SolutionArrays:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
        shape: Of the arm.
        angles: False if q is not needed: it is then empty.
    """
    lead = position.shape[:-1]
    target = np.ascontiguousarray(position.reshape(-1, 3))
    count = len(target)
    theta_3 = np.broadcast_to(wrist, lead).reshape(-1)

    q = np.empty((count if angles else 0, 4, 4))
    exists = np.empty((count, 4), np.bool_)
    within_limits = np.empty((count, 4), np.bool_)
    singular = np.empty((count, 1), np.bool_)
    for start in range(0, count, BLOCK):
        rows = slice(start, start + BLOCK)
        solved = _solve_block(shape, target[rows], theta_3[rows])
        if angles:
            q[rows] = solved[0]
        exists[rows], within_limits[rows], singular[rows] = solved[1:]

    return SolutionArrays(
        q=q.reshape(*lead, 4, 4) if angles else q,
        exists=exists.reshape(*lead, 4),
        within_limits=within_limits.reshape(*lead, 4),
        singular=singular.reshape(lead),
        position=position,
    )


def _solve_block(
    shape: ArmShape, target: FloatArray, theta_3: FloatArray
) -> tuple[FloatArray, ...]:
    """q, exists, within_limits and singular of a block of targets, as numbers."""
    numbers = _numbers(shape)
    theta_3 = np.ascontiguousarray(theta_3)
    try:
        return kernels.rows("inverse_kinematics", numbers, target, theta_3)
    except KernelError:
        # Numbers too large to compute with are clipped: still out of reach.
        near = (x.clip(-LARGEST, LARGEST) for x in (target, theta_3))
        return kernels.rows("inverse_kinematics", numbers, *near)


@lru_cache(maxsize=64)
def _numbers(shape: ArmShape) -> FloatArray:
    """The parameters of the kernel."""
    return frozen([*shape.numbers, *DOUBLE])
