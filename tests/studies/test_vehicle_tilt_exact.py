"""The tilt of a stiff vehicle, which is fitted exactly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.studies.vehicle_tilt import averaged

STIFFNESS = np.array([6e5, 9e5])
TIME = np.arange(0.0, 16.0, 0.05)
RATES = np.array([[0.5, 0.61, 0.7, 0.83], [0.9, 0.4, 0.55, 0.3], [0.35, 0.8, 0.45, 1]])


def recording(
    number: int, yaw: float, late: float = 0.3, size: float = 0.6
) -> a5.TiltRecording:
    """A vehicle that hardly tilts, so that gravity is the same; it answers late."""
    q = a5.named_pose("home") + size * np.sin(np.outer(TIME, RATES[number]))
    still = np.zeros((1, 4))
    load = a5.load(a5.FRESH_WATER).base_wrench_batch(q, still, still)[:, 3:5]
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    moment = load @ turn.T
    before = np.maximum(np.arange(TIME.size) - round(late / 0.05), 0)
    roll, pitch = (moment[before] / STIFFNESS).T
    up = np.column_stack([-pitch, roll, np.ones(TIME.size)])
    up /= np.linalg.norm(up, axis=1)[:, None]
    grid = np.arange(1.0, 14.0, 0.05)
    return a5.TiltRecording(a5.trajectory.motion(TIME, q), TIME, up, grid)


@pytest.mark.parametrize("yaw", [-3.0, 0.2])
@pytest.mark.parametrize("size", [0.6, 0.01])
def test_a_stiff_vehicle_is_fitted_exactly(yaw: float, size: float) -> None:
    """However small its moments are."""
    found = a5.fit_tilt([recording(0, yaw, size=size)])
    assert found.delay == 0.3
    assert np.remainder(found.yaw - yaw + 1.0, 2 * np.pi) == pytest.approx(
        1.0, abs=1e-6
    )
    assert found.stiffness == pytest.approx(STIFFNESS, rel=1e-5)
    assert 1 - found.r2 == pytest.approx(np.zeros(2), abs=1e-9)


def test_errors_are_those_of_fits_without_each_recording() -> None:
    """The jackknife, with each fit made again."""
    given = [recording(k, yaw) for k, yaw in enumerate((0.1, 0.12, 0.15))]
    found = a5.fit_tilt(given, delays=[0.3])
    without = [
        a5.fit_tilt([*given[:k], *given[k + 1 :]], delays=[0.3]) for k in range(3)
    ]
    yaws = np.array([one.yaw for one in without])
    stiffness = np.array([one.stiffness for one in without])
    assert found.yaw_error == pytest.approx(2 / np.sqrt(3) * yaws.std(ddof=1), rel=1e-3)
    error = 2 / np.sqrt(3) * stiffness.std(axis=0, ddof=1)
    assert found.stiffness_error == pytest.approx(error, rel=1e-3)
    left = np.zeros(2)
    total = np.zeros(2)
    for one, others in zip(given, without, strict=True):
        of_others = others.score([one])
        tilt = found.predict(one)
        left += (1 - of_others) * (tilt**2).sum(axis=0)
        total += (tilt**2).sum(axis=0)
    assert 1 - found.held_out_r2 == pytest.approx(left / total, rel=0.05)


def mean(start: float, end: float, time: np.ndarray, values: np.ndarray) -> float:
    """Of straight lines, which stay as they are at both ends."""
    knots = np.unique([start, *time[(time > start) & (time < end)], end])
    return float(np.trapezoid(np.interp(knots, time, values), knots)) / (end - start)


def test_a_moving_average_is_the_mean_of_straight_lines() -> None:
    """Of windows that end at times of values, or where they are constant."""
    rng = np.random.default_rng(4)
    time = np.arange(40) / 16
    values = rng.normal(size=(40, 2)) + 5.0
    for at in (np.arange(-60, 100, 7) / 16, np.arange(12, 24) / 16):
        for length in (1 / 8, 1.5):
            found = averaged(at, time, values, length)
            expected = [
                [mean(t - length / 2, t + length / 2, time, v) for v in values.T]
                for t in at
            ]
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


# --- edges ----------------------------------------------------------------------------


def made(**changes: Any) -> a5.TiltRecording:
    """A recording of 8 s at rest with changes."""
    time = np.linspace(0.0, 8.0, 9)
    motion = a5.trajectory.motion(time, np.ones((9, 4)))
    up = np.tile([0.0, 0.0, 1.0], (9, 1))
    own: dict[str, Any] = {"motion": motion, "time": time, "up": up}
    return a5.TiltRecording(**(own | changes))
