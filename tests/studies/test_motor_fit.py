"""Fits of motors to currents of which the truth is known exactly.

`_fit` is no public name: `calibrate.motors` takes recordings, which no motor without
noise has made.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.studies.calibration.motor_currents import (
    _Fit,
    _fit,
    _motor,
)
from alpha5_model.studies.calibration.motor_record import JointMotor

ARM = a5.load()
RECORD = ARM.parameters
AXIS_D = RECORD.joints[1]
TIME = np.arange(0.0, 50.0, 0.05)
RATE = 2 * np.pi * 0.09
VELOCITY = 0.9 * AXIS_D.velocity * np.sin(RATE * TIME + 0.3)
ACCELERATION = np.gradient(VELOCITY, TIME)
TORQUE = 0.8 * np.cos(RATE * TIME) + 0.4 * np.cos(0.71 * TIME)
PER_AMPERE = 24.0


def motion(velocity: Any = VELOCITY) -> Any:
    """Motion of all joints alike."""
    columns = np.tile(velocity[:, None], 4)
    slopes = np.tile(ACCELERATION[:, None], 4)
    return SimpleNamespace(time=TIME, velocity=columns, acceleration=slopes)


def current(forward: float = 0.1, backward: float = 0.08) -> Any:
    """Of a motor without noise."""
    friction = np.where(VELOCITY > 0, forward, -backward)
    return TORQUE / PER_AMPERE + friction + 0.02 * VELOCITY + 0.003 * ACCELERATION


def fitted(given: Any, velocity: Any = VELOCITY, of_payload: Any = None) -> _Fit:
    load = np.zeros_like(TIME) if of_payload is None else of_payload
    return _fit(motion(velocity), 1, given, TORQUE, load, ARM)


def test_a_current_without_noise_is_fitted_exactly() -> None:
    found = fitted(current())
    expected = [1 / PER_AMPERE, 0.1, 0.08, 0.02, 0.003, 0.0]
    assert found.values == pytest.approx(expected, abs=1e-5)
    assert found.noise < 1e-6
    deviation = np.sqrt(np.diag(found.covariance))
    assert (np.delete(deviation, [1, 2]) < 1e-5).all()
    # The current's zero, known to 2 mA, adds to one friction and takes from the other.
    assert deviation[1:3] == pytest.approx([0.002, 0.002], rel=0.01)
    assert found.covariance[1, 2] == pytest.approx(-(0.002**2), rel=0.01)


@pytest.mark.parametrize("kept", [57, 62])
def test_one_way_may_have_currents_only_early_on(kept: int) -> None:
    """The columns of its drift are zero in most rows, to rounding errors."""
    noisy = current() + 1e-4 * np.random.default_rng(0).normal(size=TIME.size)
    backward = np.flatnonzero(VELOCITY < 0)
    noisy[backward[kept:]] = np.nan
    found = fitted(noisy)
    assert found.values[:2] == pytest.approx([1 / PER_AMPERE, 0.1], rel=1e-3)
    assert found.noise == pytest.approx(1e-4, rel=0.05)


def test_the_jaw_rod_is_left_out() -> None:
    """Of a recording that has its position and current, too."""
    time = TIME[:500]
    turns = np.outer(time, 2 * np.pi * np.array([0.11, 0.09, 0.13, 0.17]))
    size = np.minimum([0.6, 0.8, 0.6, 0.7], 0.45 / (turns[1] / time[1]))
    q = np.array([3.0, 1.7, 1.7, 3.0]) + size * np.sin(turns)
    given = 0.05 * np.sign(np.cos(turns))
    given += 0.002 * np.random.default_rng(5).normal(size=given.shape)
    rod = np.linspace(0.0, 0.01, time.size)
    found = []
    for extra in ([], [rod]):
        recorded = a5.trajectory.motion(
            time, np.column_stack([q, *extra]), current=np.column_stack([given, *extra])
        )
        found.append(a5.calibrate.motors(recorded, method="interpolate"))
    assert found[0].joints == found[1].joints
    assert found[1].joints[1].friction_forward == pytest.approx(0.05, abs=0.01)


# --- the judgement --------------------------------------------------------------------


def fit(values: Any, deviation: Any = 0.001, together: float = 0.0) -> _Fit:
    covariance = np.diag(np.broadcast_to(deviation, 6) ** 2).astype(float)
    covariance[1, 2] = covariance[2, 1] = together
    return _Fit(values=np.array(values, float), covariance=covariance, noise=0.004)


def motors(friction: float = 0.1) -> tuple[JointMotor, ...]:
    return tuple(
        _motor(fit([0.05, friction - 0.01 * k, 0.2, 0.02, 0.003, 0.0]), k, RECORD)
        for k in range(4)
    )
