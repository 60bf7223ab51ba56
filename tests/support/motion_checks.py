"""A planned motion between its samples, and its limits by finite differences."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

import alpha5_model as a5
from alpha5_model.planning import PlannedMotion


def check_limits(motion: PlannedMotion, acceleration: float) -> None:
    """By finite differences: none is larger than the quantity at some time between."""
    step = np.diff(motion.time)[:, None]
    rated = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
    speed = np.diff(motion.position, axis=0) / step
    of_speed = np.diff(motion.velocity, axis=0) / step
    second = np.diff(speed, axis=0) / step[1:]
    assert (np.abs(speed) <= rated * (1 + 1e-9)).all()
    assert (np.abs(of_speed) <= acceleration * (1 + 1e-9)).all()
    assert (np.abs(second) <= acceleration * (1 + 1e-6)).all()


def at(motion: PlannedMotion, time: float | np.ndarray) -> np.ndarray:
    """Position at any time, by the cubics between the samples."""
    return CubicHermiteSpline(motion.time, motion.position, motion.velocity)(time)
