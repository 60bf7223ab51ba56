"""The kernels of the inverse kinematics: one target, or blocks of many.

Three kernels are generated. That of `alpha5_model.codegen.closed_form_ik` holds the
lengths and limits of the catalogue's arm. Those of `alpha5_model.codegen.own_arm_ik`
receive an arm's, for a tool on the wrist axis or beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    LARGEST,
    BoolArray,
    FloatArray,
    float_array,
    frozen,
)
from alpha5_model.codegen.kernels.choice import compute, module
from alpha5_model.errors import InputError, KernelError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.numbers.parameters import parameters

#: Targets in a block: the results of so many stay in the cache.
BLOCK = 8192
#: Kernels of any arm, with its tool on the wrist axis, or beside it.
ON_AXIS = "inverse_kinematics_of_lengths"
OFF_AXIS = "inverse_kinematics_of_tool"
#: The kernel of the catalogue's arm: its numbers are constants.
_NO_PARAMETERS = np.empty(0)

Kind = TypeVar("Kind", bound=SolutionArrays)


class Kernel(NamedTuple):
    """What solves an arm.

    Attributes:
        name: Of a generated kernel.
        numbers: Its parameters; none if it is the catalogue's, which contains them.
    """

    name: str
    numbers: FloatArray


@cache
def shape_of_kernels() -> ArmShape:
    """The shape whose numbers a kernel contains: the catalogue's."""
    return ArmShape.from_parameters(parameters())


@lru_cache(maxsize=64)
def kernel_of(shape: ArmShape) -> Kernel:
    """The kernel that solves an arm."""
    if shape == shape_of_kernels():
        return Kernel(name="inverse_kinematics", numbers=_NO_PARAMETERS)
    name = ON_AXIS if shape.has_tool_on_axis else OFF_AXIS
    return Kernel(name=name, numbers=frozen(shape.numbers))


@lru_cache(maxsize=64)
def _bound(kernels: Any, shape: ArmShape) -> tuple[Any, ...]:
    """The kernel of an arm with its numbers; nothing for the catalogue's."""
    kernel = kernel_of(shape)
    if not kernel.numbers.size:
        return ()
    return (kernels.bind(kernel.name, kernel.numbers),)


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
    kernels = module()
    solved: Kind | None = kernels.inverse_kinematics(
        kind, position, wrist, *_bound(kernels, shape)
    )
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

    solutions = solve_batch(target, angle, shape)
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
        angles: False if q is not needed: it then holds arbitrary numbers.
    """
    lead = position.shape[:-1]
    target = np.ascontiguousarray(position.reshape(-1, 3))
    count = len(target)
    theta_3 = np.broadcast_to(wrist, lead if wrist.ndim else count)
    if wrist.ndim:
        theta_3 = np.ascontiguousarray(theta_3).reshape(-1)

    kernel = kernel_of(shape)
    block = min(count, BLOCK) or 1
    q = np.empty((count if angles else block, 4, 4))
    exists = np.empty((count, 4), np.bool_)
    within_limits = np.empty((count, 4), np.bool_)
    singular = np.empty((count, 1), np.bool_)
    for start in range(0, count, block):
        rows = slice(start, min(start + block, count))
        _solve_block(
            kernel,
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
    kernel: Kernel,
    target: FloatArray,
    theta_3: FloatArray,
    q: FloatArray,
    flags: Sequence[BoolArray],
) -> None:
    """Write the angles and flags of a block of targets."""
    numbers = [np.empty(flag.shape) for flag in flags]
    try:
        compute(*kernel, target, theta_3, q, *numbers)
    except KernelError:
        # Numbers too large to compute with are clipped: still out of reach.
        near = [x.clip(-LARGEST, LARGEST) for x in (target, theta_3)]
        compute(*kernel, *near, q, *numbers)
    for flag, number in zip(flags, numbers, strict=True):
        np.not_equal(number, 0.0, out=flag)
