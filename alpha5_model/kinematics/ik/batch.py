"""Inverse kinematics of many targets: the kernel's answers, and the edges one by one."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.kernels import module
from alpha5_model.kinematics.ik.one import solve_one


def solve_batch(
    position: FloatArray, wrist: FloatArray, angles: bool = True
) -> tuple[FloatArray, BoolArray, BoolArray, BoolArray]:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
        angles: False leaves q empty, (0, 4, 4).

    Returns:
        q (..., 4, 4), exists (..., 4), within limits (..., 4) and singular (...), as in
        `alpha5_model.kinematics.ik.Solutions`.
    """
    lead = position.shape[:-1]
    target = np.ascontiguousarray(position.reshape(-1, 3))
    rows = len(target)
    theta_3 = np.ascontiguousarray(np.broadcast_to(wrist, lead if wrist.ndim else ()).reshape(-1))
    q = np.empty((rows if angles else 0, 4, 4))
    exists, within = np.empty((rows, 4), np.bool_), np.empty((rows, 4), np.bool_)
    singular = np.empty(rows, np.bool_)  # near an edge, until `solve_one` knows
    module().inverse_kinematics_rows(target, theta_3, q, exists, within, singular)
    for row in np.flatnonzero(singular).tolist():
        (x, y, z), wanted = target[row].tolist(), float(theta_3[row if wrist.ndim else 0])
        numbers, reached, fits, singular[row] = solve_one(x, y, z, wanted)
        exists[row] = [reached >> branch & 1 for branch in range(4)]
        within[row] = [fits >> branch & 1 for branch in range(4)]
        if angles:
            q[row].flat = numbers
    return (
        q.reshape(*lead, 4, 4) if angles else q,
        exists.reshape(*lead, 4),
        within.reshape(*lead, 4),
        singular.reshape(lead),
    )
