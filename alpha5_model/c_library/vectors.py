"""Numbers that a C build is tested with: random states and edges, and what Pinocchio answers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.arm import Arm


def answer(arm: Arm, name: str, given: Mapping[str, FloatArray]) -> list[FloatArray]:
    """What Pinocchio says of one of `alpha5_model.symbolic.products`, output by output.

    Args:
        arm: Whose method of that name is asked.
        name: Of the function.
        given: Its inputs q, v, a, tau.
    """
    if name == "link_poses":
        links = (f"link_{i}" for i in range(1, 5))
        return [_array(arm.forward_kinematics(given["q"], frame=link)) for link in links]
    result = getattr(arm, name)(*given.values())
    return [_array(part) for part in (result if isinstance(result, tuple) else (result,))]


def _array(result: Any) -> FloatArray:
    """A pose as (4, 4), a force as (6,)."""
    for attribute in ("homogeneous", "vector"):
        result = getattr(result, attribute, result)
    return np.array(result)
