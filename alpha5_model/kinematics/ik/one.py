"""Inverse kinematics of one target with all its edges, in plain floats: the reference of the kernels.

The formula is generated; `alpha5_model.symbolic.solutions` has it to be read.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from alpha5_model.kernels.numbers import NUMBERS
from alpha5_model.kinematics.edges import DOUBLE


def solve_one(x: float, y: float, z: float, wrist: float) -> tuple[list[float], int, int, bool]:
    """Solve a finite target.

    Args:
        x, y, z: tcp in ``base_link`` [m].
        wrist: theta_3, any turn of it [rad].

    Returns:
        q of the four branches (16 numbers), ``exists`` and ``within_limits`` with branch i as
        bit i, singular.
    """
    q, exists, within, (singular,) = _formula()((x, y, z), (wrist,), DOUBLE, NUMBERS)
    reached, fits = (sum(flag << i for i, flag in enumerate(f)) for f in (exists, within))
    return [*q], reached, fits, singular


@cache
def _formula() -> Any:
    # Late: the first target need not wait for it.
    from alpha5_model.kernels.generated import products

    return products.KERNELS["inverse_kinematics"][0]
