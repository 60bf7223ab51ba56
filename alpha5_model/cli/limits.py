"""The joints of a state on the command line, and their limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: The turning joints, for helps.
JOINTS = "axis_e, axis_d, axis_c, axis_b"


def beyond_limits(arm: Arm, q: Sequence[float]) -> list[str]:
    """Joints that a position puts beyond their limits."""
    limits = zip(arm.joint_names, q, arm.limits.lower, arm.limits.upper, strict=True)
    return [name for name, x, lower, upper in limits if not lower <= x <= upper]
