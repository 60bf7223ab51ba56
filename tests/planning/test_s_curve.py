"""S-curves keep their bounds and are the fastest, by linear programs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from alpha5_model.planning.s_curve import (
    MOST_SAMPLES,
    RAMP,
    STEP,
    JointLimits,
    s_curve,
    sampled,
    travel_time,
)

#: Speed, acceleration and jerk that bind: all; without speed; jerk alone; and so on.
BOUNDS = [
    (0.5, 1.0, 10.0),
    (5.0, 1.0, 10.0),
    (5.0, 100.0, 3.0),
    (0.2, 100.0, 3.0),
    (0.5, 2.0, 20.0),
    (1.0, 1.0, 1.0),
]
LIMITS = JointLimits(
    speed=np.array([0.5, 0.4, 0.6, 0.9]), acceleration=np.array([1.0, 2.0, 0.5, 3.0])
)


def can_be_driven(duration: float, bounds: tuple[float, ...], steps: int = 60) -> bool:
    """Whether piecewise constant jerk leads from rest at 0 to rest at 1 in time."""
    speed, acceleration, jerk = bounds
    h = duration / steps
    # State after each step, linear in the jerks.
    s = np.zeros(steps)
    v = np.zeros(steps)
    a = np.zeros(steps)
    rows: dict[str, list[np.ndarray]] = {"v": [], "a": []}
    for k in range(steps):
        s = s + h * v + h**2 / 2 * a
        s[k] += h**3 / 6
        v = v + h * a
        v[k] += h**2 / 2
        a = a.copy()
        a[k] += h
        rows["v"].append(v.copy())
        rows["a"].append(a.copy())
    inequalities = np.vstack([rows["v"], rows["a"]])
    bound = np.concatenate([np.full(steps, speed), np.full(steps, acceleration)])
    found = linprog(
        np.zeros(steps),
        A_ub=np.vstack([inequalities, -inequalities]),
        b_ub=np.concatenate([bound, bound]),
        A_eq=np.vstack([s, v, a]),
        b_eq=[1.0, 0.0, 0.0],
        bounds=(-jerk, jerk),
    )
    return bool(found.status == 0)


@pytest.mark.parametrize("bounds", BOUNDS)
def test_no_other_motion_within_the_bounds_is_faster(
    bounds: tuple[float, ...],
) -> None:
    duration = s_curve(*bounds).duration
    assert can_be_driven(1.03 * duration, bounds)
    assert not can_be_driven(0.97 * duration, bounds)


@pytest.mark.parametrize("bounds", BOUNDS)
def test_differences_keep_the_bounds(bounds: tuple[float, ...]) -> None:
    curve = s_curve(*bounds)
    time = np.linspace(0.0, curve.duration, 20_001)
    profile = curve.at(time)
    h = time[1]
    rate = np.diff(profile.s) / h
    middle = (profile.rate[1:] + profile.rate[:-1]) / 2
    assert rate == pytest.approx(middle, abs=2 * h**2 * bounds[2])
    slope = np.diff(profile.rate) / h
    middle = (profile.acceleration[1:] + profile.acceleration[:-1]) / 2
    assert slope == pytest.approx(middle, abs=2 * h * bounds[2])
    jerk = np.diff(profile.acceleration) / h

    for values, bound in zip((rate, slope, jerk), bounds, strict=True):
        assert np.abs(values).max() <= bound * (1 + 1e-6)
    assert profile.s[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert profile.rate[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert (rate >= -1e-12).all()


def test_joints_stay_on_their_lines_and_rest_between_them() -> None:
    way = np.array([[0.0, 1, 2, 3], [1.0, 1, 1.5, 3], [1.0, 0.2, 1.5, 5]])
    samples = sampled(way, LIMITS)
    assert np.diff(samples.time) == pytest.approx(samples.time[1], abs=1e-9)
    assert samples.time[1] <= STEP
    assert samples.time[-1] == pytest.approx(travel_time(way, LIMITS))
    first = travel_time(way[:2], LIMITS)
    for k, row in enumerate(samples.position):
        start, end = way[:2] if samples.time[k] < first else way[1:]
        share = (row - start) @ (end - start) / np.square(end - start).sum()
        assert row == pytest.approx(start + share * (end - start), abs=1e-12)
    near_corner = np.abs(samples.time - first).argmin()
    assert np.abs(samples.velocity[near_corner]).max() < 0.01
    assert np.array_equal(samples.position[[0, -1]], way[[0, -1]])
    assert not samples.velocity[[0, -1]].any()
    assert (np.abs(samples.velocity).max(axis=0) <= LIMITS.speed + 1e-12).all()
    bound = LIMITS.acceleration + 1e-12
    assert (np.abs(samples.acceleration).max(axis=0) <= bound).all()


def test_samples_are_derivatives_of_each_other() -> None:
    way = np.array([[0.0, 1, 2, 3], [0.3, 1.5, 1.9, 2.0]])
    samples = sampled(way, LIMITS)
    slope = np.gradient(samples.position, samples.time, axis=0)
    jerk = LIMITS.acceleration.max() / RAMP
    assert slope == pytest.approx(samples.velocity, abs=jerk * STEP**2)
    slope = np.gradient(samples.velocity, samples.time, axis=0)
    assert slope == pytest.approx(samples.acceleration, abs=jerk * STEP)


def test_the_slowest_joint_decides() -> None:
    """As long as one joint would take alone, whichever takes longest."""
    start = np.zeros(4)
    end = np.array([0.5, -0.6, 0.2, 1.5])
    alone = []
    for k in range(4):
        only = start.copy()
        only[k] = end[k]
        alone.append(travel_time(np.array([start, only]), LIMITS))
    together = travel_time(np.array([start, end]), LIMITS)
    assert max(alone) <= together < 1.3 * max(alone)


def test_slower_limits_take_longer() -> None:
    way = np.array([np.zeros(4), [1.0, 0.1, 0.4, 2.0]])
    once = travel_time(way, LIMITS)
    twice = travel_time(way, LIMITS.slower(2.0))
    assert 1.9 * once < twice <= 2.0 * once


def test_a_motion_that_stays_where_it_is() -> None:
    way = np.array([[1.0, 1, 1, 1], [1.0, 1, 1, 1]])
    samples = sampled(way, LIMITS)
    assert len(samples.time) > 3
    assert np.array_equal(samples.position, np.ones((len(samples.time), 4)))
    assert travel_time(way, LIMITS) == 0.0


def test_a_very_slow_motion_has_few_samples() -> None:
    way = np.array([np.zeros(4), np.ones(4)])
    samples = sampled(way, LIMITS.slower(1e4))
    assert len(samples.time) == MOST_SAMPLES + 1
    assert samples.position[-1] == pytest.approx(np.ones(4))
