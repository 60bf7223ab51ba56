"""What a recording says: measured torques or loads, and their regressor."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, instance
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.errors import InputError
from alpha5_model.trajectory import Motion, smooth

#: Rows of `regressor_rows` that belong to torques, and to the load on the mount.
TORQUES = slice(0, 4)
LOADS = slice(4, 10)


class Recording(NamedTuple):
    """Measured torques or loads, and their regressor.

    Attributes:
        regressor: (N, n, 38).
        measured: Torques or loads, (N, n); NaN for what is missing.
        time: (N,) [s].
        position, velocity, acceleration: Of the joints, (N, 4) each.
        channels: `TORQUES` or `LOADS`.
    """

    regressor: FloatArray
    measured: FloatArray
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    channels: slice


def recording_of(
    motion: Motion, arm: Arm, wrench: ArrayLike | None, smoothing: dict[str, Any]
) -> Recording:
    """The load on the mount if it is given; otherwise the motion's efforts.

    Args:
        motion: With efforts, unless there is a wrench.
        arm: Its gravity and dimensions are those of the regressor.
        wrench: (N, 6) [N, N m], or None.
        smoothing: Arguments of `smooth`.

    Raises:
        InputError: Neither efforts nor a wrench, or a wrench of another length.
    """
    smoothed = smooth(instance("motion", motion, Motion), **smoothing)
    q = np.array(smoothed.position[:, :4])
    v = np.array(smoothed.velocity[:, :4])
    a = np.array(smoothed.acceleration[:, :4])
    if wrench is not None:
        measured = array("wrench", wrench, len(q), 6)
        channels = LOADS
    elif motion.effort is not None:
        measured = motion.effort[:, :4]
        channels = TORQUES
    else:
        expected = "one with recorded efforts, or a wrench"
        raise InputError("motion", motion.source, expected)

    gravity = arm_parameters(arm)[-3:]
    every_row = regressor_rows(q, v, a, gravity, arm_dimensions(arm))
    return Recording(
        regressor=every_row[:, channels],
        measured=measured,
        time=smoothed.time,
        position=q,
        velocity=v,
        acceleration=a,
        channels=channels,
    )
