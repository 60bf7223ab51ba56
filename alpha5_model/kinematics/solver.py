"""The generated kernel of the inverse kinematics, on targets of any shape.

It is made from `alpha5_model.codegen.inverse_kinematics`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import LARGEST, BoolArray, FloatArray
from alpha5_model.errors import KernelError
from alpha5_model.kernels import choice as kernels
from alpha5_model.kinematics.geometry import Geometry

#: Targets in a block: the results of so many stay in the cache.
BLOCK = 8192


class Branches(NamedTuple):
    """All solutions of a set of targets.

    Attributes:
        q, exists, within_limits, singular, position: As for
            `alpha5_model.kinematics.ik.Solutions`.
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray


def solve(
    geometry: Geometry,
    position: FloatArray,
    wrist: FloatArray | float,
    angles: bool = True,
) -> Branches:
    """Solve finite targets of any shape.

    Args:
        geometry: Of the arm.
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
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
        solved = solve_rows(geometry, target[rows], np.ascontiguousarray(theta_3[rows]))
        if angles:
            q[rows] = solved[0]
        exists[rows], within_limits[rows], singular[rows] = solved[1:]

    return Branches(
        q=q.reshape(*lead, 4, 4) if angles else q,
        exists=exists.reshape(*lead, 4),
        within_limits=within_limits.reshape(*lead, 4),
        singular=singular.reshape(lead),
        position=position,
    )


def solve_rows(
    geometry: Geometry, target: FloatArray, theta_3: FloatArray
) -> tuple[FloatArray, ...]:
    """q, exists, within_limits and singular of N targets, as float64.

    Args:
        geometry: Of the arm.
        target: (N, 3) [m].
        theta_3: (N,) [rad].
    """
    parameters = geometry.ik_parameters
    try:
        return kernels.rows("inverse_kinematics", parameters, target, theta_3)
    except KernelError:
        # Numbers too large to compute with are clipped: still out of reach.
        near = (x.clip(-LARGEST, LARGEST) for x in (target, theta_3))
        return kernels.rows("inverse_kinematics", parameters, *near)
