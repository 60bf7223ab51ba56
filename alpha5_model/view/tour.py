"""A short motion through given poses, within the joints' speeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.errors import InputError
from alpha5_model.parameters import parameters
from alpha5_model.trajectory.motion import Motion, motion

#: Samples per second.
_RATE = 25.0


def tour(waypoints: ArrayLike, joints: Sequence[str] | None = None, pause: float = 0.6) -> Motion:
    """Move from pose to pose, resting at each.

    Each leg follows ``s = (1 - cos(pi t / T)) / 2`` and takes the time at which the fastest joint just
    reaches its speed.

    Args:
        waypoints: (N, n), at least two [rad; jaw rod m].
        joints: Names of the n joints; base to tip if None.
        pause: Rest at each pose [s].

    Returns:
        The motion, sampled at 25 Hz.

    Raises:
        InputError: Fewer than two poses, or names that do not fit.
    """
    known = {joint.name: joint for joint in parameters().joints}
    names = list(known)[: np.shape(waypoints)[-1]] if joints is None else list(joints)
    poses = float_array("waypoints", waypoints, (len(names),))
    if poses.ndim != 2 or len(poses) < 2:
        raise InputError("waypoints", poses.shape, "at least two poses in rows")
    speed = np.array([known[name].velocity for name in names])
    pieces: list[FloatArray] = [np.repeat(poses[:1], round(pause * _RATE), axis=0)]
    for start, end in pairwise(poses):
        duration = float(np.max(np.pi / 2 * np.abs(end - start) / speed))
        phase = np.linspace(0.0, np.pi, max(2, round(duration * _RATE) + 2))[1:]
        pieces.append(start + (end - start) * ((1.0 - np.cos(phase)) / 2)[:, None])
        pieces.append(np.repeat(end[None], round(pause * _RATE), axis=0))
    q = np.concatenate(pieces)
    return replace(motion(np.arange(len(q)) / _RATE, q, joints=names), source="a short motion")
