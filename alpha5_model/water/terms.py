"""What moving water adds to the torques of an arm in still water, with its interval."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.renaming import renamed
from alpha5_model.dynamics.torque_causes import check_fixed_base
from alpha5_model.numbers.hydrodynamics import LEVELS


@renamed("current", "water_velocity")
@dataclass(frozen=True, eq=False)
class WaterTerms:
    """What moving water adds to an arm in still water.

    This is added mass and drag, which are estimated, not published.

    Attributes:
        water_velocity: Velocity of the water, uniform, in base_link, (3,) [m/s].
        torque: Joint torque, (N, 3, nv) [N m, N]: with all numbers low, nominal, high.
        wrench: Load on the mount in base_link, (N, 3, 6) [N, N m], likewise.
    """

    water_velocity: FloatArray
    torque: FloatArray
    wrench: FloatArray


def water_terms(
    arm: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike, water_velocity: ArrayLike
) -> WaterTerms:
    """What moving water adds to inverse dynamics and base wrench of many states.

    Args:
        arm: On a fixed base, in still water.
        q: (N, nq).
        v: (N, nv).
        a: (N, nv).
        water_velocity: (3,) [m/s].

    Raises:
        InputError: An arm on a floating base, or arrays that do not fit.
    """
    check_fixed_base(arm)
    wet_arms = [arm.with_hydrodynamics(water_velocity, level) for level in LEVELS]
    of_trees = [wet._water_torques(q, v, a, None) for wet in wet_arms]

    # The first six of a tree's torques are the mount's: one pass gives both.
    tree_torques = np.stack(of_trees, axis=1)
    one, *_ = wet_arms
    return WaterTerms(
        water_velocity=one.water_velocity,
        torque=tree_torques @ one._tree.g,
        wrench=-tree_torques[..., :6],
    )
