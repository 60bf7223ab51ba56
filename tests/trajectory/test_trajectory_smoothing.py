"""Smoothing agrees with SciPy's spline, its stated response and exact derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.trajectory.smoothing import (
    LEAST_BANDWIDTH,
    METHODS,
    savitzky_golay,
    smoothing_spline,
)


def uneven(count: int, mean_step: float, seed: int) -> np.ndarray:
    """Sample times with jitter, of which some are nearly equal, as in recordings."""
    steps = np.random.default_rng(seed).uniform(0.2, 1.8, count)
    steps[::17] = 0.005
    return np.cumsum(steps) * mean_step


@pytest.mark.parametrize("bandwidth", [0.5, 2.0, 8.0])
def test_spline_is_the_one_scipy_finds(bandwidth: float) -> None:
    from scipy.interpolate import make_smoothing_spline

    time = uneven(400, 0.02, seed=3)
    y = np.random.default_rng(4).normal(size=(400, 2)) + np.sin(time)[:, None]
    value, slope, bend = smoothing_spline(time, y, bandwidth)
    weights = np.array([np.trapezoid(np.eye(400)[k], time) for k in range(400)])
    lam = (math.sqrt(2) - 1) / (2 * math.pi * bandwidth) ** 4
    for k in range(2):
        spline = make_smoothing_spline(time, y[:, k], weights, lam=lam)
        np.testing.assert_allclose(value[:, k], spline(time), atol=1e-6)
        np.testing.assert_allclose(
            slope[:, k], spline(time, 1), atol=1e-5 * np.abs(slope).max()
        )
        np.testing.assert_allclose(
            bend[:, k], spline(time, 2), atol=1e-4 * np.abs(bend).max()
        )


@pytest.mark.parametrize("ratio", [0.2, 0.5, 1.0, 2.0])
def test_spline_passes_sines_as_stated(ratio: float) -> None:
    """The amplitude is 1 / (1 + (sqrt(2) - 1) ratio^4), without a phase shift.

    `ratio` is the frequency divided by the bandwidth.
    """
    bandwidth = 2.0
    time = uneven(6000, 0.004, seed=5)
    w = 2 * math.pi * bandwidth * ratio
    gain = 1 / (1 + (math.sqrt(2) - 1) * ratio**4)
    value, slope, bend = (
        x[:, 0] for x in smoothing_spline(time, np.sin(w * time)[:, None], bandwidth)
    )
    middle = slice(1000, -1000)
    for got, expected in (
        (value, gain * np.sin(w * time)),
        (slope, gain * w * np.cos(w * time)),
        (bend, -gain * w**2 * np.sin(w * time)),
    ):
        scale = np.abs(expected).max()
        np.testing.assert_allclose(got[middle], expected[middle], atol=5e-3 * scale)


@pytest.mark.parametrize("bandwidth", [1.0, 2.0, 5.0])
def test_savitzky_golay_reaches_the_bandwidth_it_states(bandwidth: float) -> None:
    time = np.arange(4000) * 0.01
    _, _, _, reached = savitzky_golay(time, np.zeros((4000, 1)), bandwidth)
    assert reached == pytest.approx(bandwidth, rel=0.1)
    sine = np.sin(2 * math.pi * reached * time)[:, None]
    value, slope, _, _ = savitzky_golay(time, sine, bandwidth)
    middle = slice(1000, -1000)
    np.testing.assert_allclose(value[middle], math.sqrt(0.5) * sine[middle], atol=2e-3)
    rate = np.gradient(value[:, 0], time)
    # The filter differentiates the fitted cubic, not its own smoothed value.
    assert np.abs(slope[middle, 0] - rate[middle]).max() < 0.35 * np.abs(rate).max()


def cubic_motion(
    count: int = 60,
) -> tuple[a5.trajectory.Motion, np.ndarray, np.ndarray]:
    time = uneven(count, 0.05, seed=6)
    c = np.random.default_rng(7).uniform(-0.02, 0.02, (4, 4))
    x = time[:, None]
    q = 1.5 + c[0] * x + c[1] * x**2 + c[2] * x**3
    v = c[0] + 2 * c[1] * x + 3 * c[2] * x**2
    return a5.trajectory.motion(time, q, v), v, 2 * c[1] + 6 * c[2] * x


def test_interpolation_of_a_cubic_is_exact() -> None:
    motion, v, a = cubic_motion()
    s = a5.trajectory.smooth(motion, "interpolate", use_velocity=False)
    np.testing.assert_array_equal(s.position, motion.position)
    np.testing.assert_allclose(s.velocity, v, atol=1e-9)
    np.testing.assert_allclose(s.acceleration, a, atol=1e-7)
    assert s.bandwidth is None
    s = a5.trajectory.smooth(motion, "interpolate")
    assert s.from_velocity
    np.testing.assert_array_equal(s.velocity, v)
    np.testing.assert_allclose(s.acceleration, a, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_velocities_of_the_motion_are_used_when_asked(method: str) -> None:
    motion, _, _ = cubic_motion()
    still = a5.trajectory.motion(
        motion.time, motion.position, np.zeros_like(motion.position)
    )
    assert np.abs(a5.trajectory.smooth(still, method).velocity).max() == 0
    assert np.abs(a5.trajectory.smooth(still, method).acceleration).max() == 0
    slope = a5.trajectory.smooth(still, method, use_velocity=False)
    assert np.abs(slope.velocity).max() > 0.01
    assert not slope.from_velocity


@pytest.mark.parametrize("jitter", [0.0, 0.5])
def test_the_least_bandwidth_is_as_good_as_it_says(jitter: float) -> None:
    """A sine at the least bandwidth keeps 1/sqrt(2) of its amplitude, to 0.1 %."""
    steps = 1 + jitter * np.random.default_rng(1).uniform(-1, 1, 60_000)
    time = 0.02 * np.cumsum(steps)
    width = LEAST_BANDWIDTH / float(np.median(np.diff(time)))
    sine = np.sin(2 * math.pi * width * time)[:, None]
    value, _, _ = smoothing_spline(time, sine, width)
    middle = slice(15_000, -15_000)
    np.testing.assert_allclose(value[middle], math.sqrt(0.5) * sine[middle], atol=1e-3)
    q = 1.5 + 0.1 * sine * np.ones(4)
    motion = a5.trajectory.motion(time, q)
    assert a5.trajectory.smooth(motion, "spline", width).bandwidth == width
    with pytest.raises(InputError, match="at least"):
        a5.trajectory.smooth(motion, "spline", width * (1 - 1e-12))


def test_noise_is_taken_out() -> None:
    time = uneven(3000, 0.02, seed=8)
    truth = 1.5 + np.sin(0.5 * time)[:, None] * np.ones(4)
    noisy = truth + np.random.default_rng(9).normal(scale=0.01, size=truth.shape)
    for method in ("spline", "savgol"):
        s = a5.trajectory.smooth(a5.trajectory.motion(time, noisy), method, 1.0)
        assert np.std((s.position - truth)[200:-200]) < 0.35 * 0.01
        raw = a5.trajectory.smooth(a5.trajectory.motion(time, noisy), "interpolate")
        error = [
            np.std((x.acceleration + 0.25 * (truth - 1.5))[200:-200]) for x in (s, raw)
        ]
        assert error[0] < 1e-2 * error[1]


def test_what_cannot_be_smoothed_is_refused() -> None:
    motion, _, _ = cubic_motion()
    bare = a5.trajectory.motion(motion.time, motion.position)
    with pytest.raises(UnknownNameError, match="spline, savgol"):
        a5.trajectory.smooth(motion, "kalman")
    with pytest.raises(InputError, match="half the sample rate"):
        a5.trajectory.smooth(motion, "spline", 50.0)
    with pytest.raises(InputError, match="above 0"):
        a5.trajectory.smooth(motion, "spline", 0.0)
    for method in ("spline", "savgol"):
        for width in (1e-5, 1e-100, 1e-300):
            with pytest.raises(
                InputError, match=r"at least 0\.0001 of the sample rate, 0\.00"
            ):
                a5.trajectory.smooth(motion, method, width)
    with pytest.raises(InputError, match="window of at most"):
        a5.trajectory.smooth(motion, "savgol", 0.01)
    with pytest.raises(InputError, match="no velocities"):
        a5.trajectory.smooth(bare, use_velocity=True)
