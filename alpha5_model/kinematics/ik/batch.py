"""Inverse kinematics of many targets, block by block."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import LARGEST, BoolArray, FloatArray
from alpha5_model.kernels import module

#: Targets in a block: what the kernel writes of them stays in the cache.
BLOCK = 8192


def solve_batch(
    position: FloatArray, wrist: FloatArray, angles: bool = True
) -> tuple[FloatArray, BoolArray, BoolArray, BoolArray]:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
        angles: False leaves q to scratch, not to be relied on.

    Returns:
        q (..., 4, 4), exists (..., 4), within limits (..., 4) and singular (...), as in
        `alpha5_model.kinematics.ik.Solutions`.
    """
    lead, run = position.shape[:-1], module().batch
    target = np.ascontiguousarray(position.reshape(-1, 3))
    theta_3 = np.broadcast_to(wrist, lead if wrist.ndim else len(target))
    if wrist.ndim:
        theta_3 = np.ascontiguousarray(theta_3).reshape(-1)
    n, block = len(target), min(len(target), BLOCK) or 1
    q = np.empty((n if angles else block, 4, 4))
    flags = [np.empty((n, size), np.bool_) for size in (4, 4, 1)]
    for start in range(0, n, block):
        rows = target[start : start + block]
        given = rows, theta_3[start : start + block]
        numbers = [np.empty((len(rows), flag.shape[1])) for flag in flags]
        out = q[start : start + block] if angles else q[: len(rows)], *numbers
        if not run("inverse_kinematics", np.empty(0), *given, *out):
            near = (x.clip(-LARGEST, LARGEST) for x in given)  # as far out of reach
            run("inverse_kinematics", np.empty(0), *near, *out)
        for flag, number in zip(flags, numbers, strict=True):
            np.not_equal(number, 0.0, out=flag[start : start + block])
    exists, within, singular = flags
    return (
        q.reshape(*lead, 4, 4) if angles else q,
        exists.reshape(*lead, 4),
        within.reshape(*lead, 4),
        singular.reshape(lead),
    )
