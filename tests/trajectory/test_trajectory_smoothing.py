"""Smoothing has its stated response, exact derivatives, and the spline's definition."""

from __future__ import annotations

import math

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError, UnknownNameError

METHODS = ("spline", "interpolate")


def uneven(count: int, mean_step: float, seed: int) -> np.ndarray:
    """Sample times with jitter, of which some are nearly equal, as in recordings."""
    steps = np.random.default_rng(seed).uniform(0.2, 1.8, count)
    steps[::17] = 0.005
    return np.cumsum(steps) * mean_step


def smoothed(time: np.ndarray, angle: np.ndarray, bandwidth: float) -> list[np.ndarray]:
    """Position, velocity and acceleration of a joint near 1.5 rad, less that."""
    motion = a5.trajectory.motion(time, 1.5 + np.outer(angle, np.ones(4)))
    s = a5.trajectory.smooth(motion, "spline", bandwidth)
    return [s.position[:, 1] - 1.5, s.velocity[:, 1], s.acceleration[:, 1]]


@pytest.mark.parametrize("bandwidth", [0.5, 2.0, 8.0])
def test_the_spline_is_the_one_of_reinschs_equations(bandwidth: float) -> None:
    """Its second derivatives at the samples, from the dense equations of 1967."""
    time = 1.7e9 + uneven(200, 0.02, seed=3)
    y = 0.01 * np.random.default_rng(4).normal(size=200) + 0.2 * np.sin(time)
    h = np.diff(time)
    weights = np.array([np.trapezoid(row, time) for row in np.eye(200)])
    lam = (math.sqrt(2) - 1) / (2 * math.pi * bandwidth) ** 4
    second = np.zeros((198, 200))
    r = np.zeros((198, 198))
    for k in range(198):
        second[k, k : k + 3] = 1 / h[k], -1 / h[k] - 1 / h[k + 1], 1 / h[k + 1]
        r[k, k] = (h[k] + h[k + 1]) / 3
        if k:
            r[k, k - 1] = r[k - 1, k] = h[k] / 6
    curvature = np.linalg.solve(
        r + lam * second @ np.diag(1 / weights) @ second.T, second @ y
    )
    value = y - lam / weights * (second.T @ curvature)

    position, _, acceleration = smoothed(time, y, bandwidth)
    np.testing.assert_allclose(position, value, atol=1e-7)
    scale = np.abs(curvature).max()
    np.testing.assert_allclose(acceleration[1:-1], curvature, atol=1e-5 * scale)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 1.0, 2.0])
def test_spline_passes_sines_as_stated(ratio: float) -> None:
    """The amplitude is 1 / (1 + (sqrt(2) - 1) ratio^4), without a phase shift.

    `ratio` is the frequency divided by the bandwidth.
    """
    bandwidth = 2.0
    time = uneven(6000, 0.004, seed=5)
    w = 2 * math.pi * bandwidth * ratio
    gain = 1e-3 / (1 + (math.sqrt(2) - 1) * ratio**4)
    found = smoothed(time, 1e-3 * np.sin(w * time), bandwidth)
    middle = slice(1000, -1000)
    exact = (
        gain * np.sin(w * time),
        gain * w * np.cos(w * time),
        -gain * w**2 * np.sin(w * time),
    )
    for got, expected in zip(found, exact, strict=True):
        scale = np.abs(expected).max()
        np.testing.assert_allclose(got[middle], expected[middle], atol=5e-3 * scale)


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


def test_the_direction_is_that_of_the_way_in_half_a_second() -> None:
    """Below 0.2 % of the rated speed of 30 deg/s there is none."""
    time = np.cumsum(np.random.default_rng(2).uniform(0.01, 0.05, 300))
    q = np.full((300, 4), 1.5)
    rated = math.radians(30)
    q[:, 0] -= 0.0019 * rated * time
    q[:, 1] += 0.0021 * rated * time
    q[:, 2] += 0.003 * rated * np.sin(time)
    smooth = a5.trajectory.smooth(a5.trajectory.motion(time, q))
    assert {*smooth.direction[:, 0]} == {0.0}
    assert {*smooth.direction[:, 1]} == {1.0}
    for i in range(300):
        start, end = max(time[i] - 0.25, time[0]), min(time[i] + 0.25, time[-1])
        before, after = np.interp([start, end], time, q[:, 2])
        speed = (after - before) / (end - start)
        expected = 0.0 if abs(speed) < 0.002 * rated else np.sign(speed)
        assert smooth.direction[i, 2] == expected


def test_the_least_bandwidth_is_as_good_as_it_says() -> None:
    """A sine at the least bandwidth keeps 1/sqrt(2) of its amplitude, to 0.1 %."""
    steps = 1 + 0.5 * np.random.default_rng(1).uniform(-1, 1, 40_000)
    time = 0.02 * np.cumsum(steps)
    width = 1e-4 / float(np.median(np.diff(time)))
    sine = 0.1 * np.sin(2 * math.pi * width * time)
    value, _, _ = smoothed(time, sine, width)
    middle = slice(15_000, -15_000)
    np.testing.assert_allclose(value[middle], math.sqrt(0.5) * sine[middle], atol=2e-4)
    with pytest.raises(InputError) as refusal:
        smoothed(time, sine, width * (1 - 1e-12))
    assert refusal.value.name == "bandwidth"


def test_noise_is_taken_out() -> None:
    time = uneven(3000, 0.02, seed=8)
    truth = 1.5 + np.sin(0.5 * time)[:, None] * np.ones(4)
    noisy = truth + np.random.default_rng(9).normal(scale=0.01, size=truth.shape)
    s = a5.trajectory.smooth(a5.trajectory.motion(time, noisy), "spline", 1.0)
    assert np.std((s.position - truth)[200:-200]) < 0.35 * 0.01
    raw = a5.trajectory.smooth(a5.trajectory.motion(time, noisy), "interpolate")
    error = [
        np.std((x.acceleration + 0.25 * (truth - 1.5))[200:-200]) for x in (s, raw)
    ]
    assert error[0] < 1e-2 * error[1]


def test_what_cannot_be_smoothed_is_refused() -> None:
    motion, _, _ = cubic_motion()
    bare = a5.trajectory.motion(motion.time, motion.position)
    for method in ("kalman", "savgol"):
        with pytest.raises(UnknownNameError):
            a5.trajectory.smooth(motion, method)
    for width in (50.0, 0.0, 1e-5, 1e-300):
        with pytest.raises(InputError) as refusal:
            a5.trajectory.smooth(motion, "spline", width)
        assert refusal.value.name == "bandwidth"
    with pytest.raises(InputError) as refusal:
        a5.trajectory.smooth(bare, use_velocity=True)
    assert refusal.value.name == "use_velocity"
