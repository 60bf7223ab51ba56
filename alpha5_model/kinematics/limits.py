"""The limits of joints, and which positions are beyond them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model.errors import JointLimitError
from alpha5_model.kinematics.tolerances import ON_LIMIT


class Limits(NamedTuple):
    """Limits of an arm's n joints, (n,) each.

    Attributes:
        lower, upper: Ends of the ranges [rad, and m for axis_a].
        velocity: Rated speeds [rad/s, m/s].
        effort: [N m, N]; what every public model copies, no rating is published.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    effort: FloatArray

    def beyond(self, q: ArrayLike) -> BoolArray:
        """Whether each joint is beyond its range by more than 1e-6.

        Args:
            q: (..., n) [rad, and m for axis_a].

        Raises:
            InputError: Not finite numbers of this shape.
        """
        position = float_array("q", q, self.lower.shape)
        return beyond(position, self.lower, self.upper)


def beyond(
    q: FloatArray, lower: FloatArray | float, upper: FloatArray | float
) -> BoolArray:
    """Whether each joint of q is beyond its range, by more than `ON_LIMIT`."""
    return np.asarray((q < lower - ON_LIMIT) | (q > upper + ON_LIMIT))


def within(
    joints: Sequence[str], q: FloatArray, lower: FloatArray, upper: FloatArray
) -> FloatArray:
    """q (n,), moved to a limit that it is beyond by at most `ON_LIMIT`.

    Raises:
        JointLimitError: A joint is farther beyond its limit.
    """
    inside = np.clip(q, lower, upper)
    is_beyond = beyond(q, lower, upper)
    if is_beyond.any():
        first = int(is_beyond.argmax())
        unit = "m" if joints[first] == "axis_a" else "rad"
        value, bound = float(q[first]), float(inside[first])
        raise JointLimitError(joints[first], value, bound, unit)
    return inside
