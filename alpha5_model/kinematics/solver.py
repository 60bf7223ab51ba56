"""The kernels of the inverse kinematics: one target, or blocks of many.

The kernels are generated from `alpha5_model.codegen.closed_form_ik`. They hold the
lengths and limits of the catalogue's arm, so they solve no other.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    LARGEST,
    BoolArray,
    FloatArray,
    float_array,
)
from alpha5_model.codegen.kernels.choice import compute, module
from alpha5_model.errors import InputError, KernelError
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.numbers.parameters import parameters

#: Targets in a block: the results of so many stay in the cache.
BLOCK = 8192
#: The kernel has no parameters: its numbers are constants.
_NO_PARAMETERS = np.empty(0)

Kind = TypeVar("Kind", bound=SolutionArrays)


@cache
def plane_of_kernels() -> ArmPlane:
    """The plane from which the kernels are generated: the catalogue's."""
    return ArmPlane.from_parameters(parameters())


def check_plane(plane: ArmPlane) -> None:
    """Check that the kernels solve a plane.

    Raises:
        InputError: It has other lengths, offsets or limits than the catalogue's.
    """
    solved = plane_of_kernels()
    for name, value in plane._asdict().items():
        if value != getattr(solved, name):
            raise InputError(
                "parameters",
                f"{name} = {value}",
                f"{name} = {getattr(solved, name)}, with which the inverse kinematics "
                "were generated",
            )


def solve(kind: type[Kind], position: ArrayLike, wrist: ArrayLike) -> Kind:
    """All solutions of targets of any shape, read-only.

    Args:
        kind: The class of the answer.
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3; it broadcasts against ``position``'s leading axes [rad].

    Raises:
        InputError: Not real numbers, or shapes that do not fit; `NonFiniteError` names
            a bad row.
    """
    solved: Kind | None = module().inverse_kinematics(kind, position, wrist)
    if solved is not None:
        return solved

    # The kernel of one target declined: another type or shape, or a bad number.
    target = float_array("position", position, (3,))
    angle = float_array("wrist", wrist, ())
    try:
        lead = np.broadcast_shapes(target.shape[:-1], angle.shape)
    except ValueError:
        expected = f"a shape that broadcasts with {target.shape[:-1]}"
        raise InputError("wrist", angle.shape, expected) from None
    target = np.broadcast_to(target, (*lead, 3)) if lead else target.copy()

    solutions = solve_batch(target, angle)
    for array in solutions:
        array.flags.writeable = False
    return kind._make(solutions)


def solve_batch(
    position: FloatArray, wrist: FloatArray, angles: bool = True
) -> SolutionArrays:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
        angles: False if q is not needed: it then holds arbitrary numbers.
    """
    lead = position.shape[:-1]
    target = np.ascontiguousarray(position.reshape(-1, 3))
    count = len(target)
    theta_3 = np.broadcast_to(wrist, lead if wrist.ndim else count)
    if wrist.ndim:
        theta_3 = np.ascontiguousarray(theta_3).reshape(-1)

    block = min(count, BLOCK) or 1
    q = np.empty((count if angles else block, 4, 4))
    exists = np.empty((count, 4), np.bool_)
    within_limits = np.empty((count, 4), np.bool_)
    singular = np.empty((count, 1), np.bool_)
    for start in range(0, count, block):
        rows = slice(start, min(start + block, count))
        _solve_block(
            target[rows],
            np.ascontiguousarray(theta_3[rows]),
            q[rows] if angles else q[: rows.stop - rows.start],
            (exists[rows], within_limits[rows], singular[rows]),
        )

    return SolutionArrays(
        q=q.reshape(*lead, 4, 4) if angles else q,
        exists=exists.reshape(*lead, 4),
        within_limits=within_limits.reshape(*lead, 4),
        singular=singular.reshape(lead),
        position=position,
    )


def _solve_block(
    target: FloatArray, theta_3: FloatArray, q: FloatArray, flags: Sequence[BoolArray]
) -> None:
    """Write the angles and flags of a block of targets."""
    numbers = [np.empty(flag.shape) for flag in flags]
    try:
        compute("inverse_kinematics", _NO_PARAMETERS, target, theta_3, q, *numbers)
    except KernelError:
        # Numbers too large to compute with are clipped: still out of reach.
        near = [x.clip(-LARGEST, LARGEST) for x in (target, theta_3)]
        compute("inverse_kinematics", _NO_PARAMETERS, *near, q, *numbers)
    for flag, number in zip(flags, numbers, strict=True):
        np.not_equal(number, 0.0, out=flag)
