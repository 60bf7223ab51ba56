"""Correlated noise, against the full covariance of all samples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter

from alpha5_model.studies.calibration.ar1 import correlation, whitened


def covariance(rho: float, steps: np.ndarray) -> np.ndarray:
    """Of noise that chance of deviation 1 drives in each step."""
    return np.asarray(rho ** abs(steps[:, None] - steps) / (1 - rho**2))


@pytest.mark.parametrize("rho", [0.0, 0.7, 0.99])
def test_whitened_noise_has_the_identity_as_covariance(rho: float) -> None:
    steps = np.array([3, 4, 5, 9, 10, 30, 31])
    white = whitened(np.eye(7), rho, steps)
    expected = pytest.approx(np.eye(7), abs=1e-9)
    assert white @ covariance(rho, steps) @ white.T == expected
    assert whitened(np.ones(7), rho, steps) == pytest.approx(white @ np.ones(7))


def test_the_correlation_is_that_of_the_greatest_restricted_likelihood() -> None:
    rng = np.random.default_rng(4)
    steps = np.flatnonzero(rng.random(200) < 0.7)
    columns = np.column_stack([np.ones(len(steps)), np.sin(steps / 9), steps])
    chance = rng.normal(size=200)
    noise = lfilter([1.0], [1.0, -0.8], chance)[steps]

    def minus_log_likelihood(rho: float) -> float:
        every = covariance(rho, steps)
        squares = columns.T @ np.linalg.solve(every, columns)
        by_noise = columns.T @ np.linalg.solve(every, noise)
        left = noise - columns @ np.linalg.solve(squares, by_noise)
        rest = left @ np.linalg.solve(every, left)
        logs = np.linalg.slogdet(every)[1] + np.linalg.slogdet(squares)[1]
        return float((len(steps) - 3) * np.log(rest) + logs)

    limits = {"bounds": (0.0, 0.999), "method": "bounded"}
    best = minimize_scalar(minus_log_likelihood, **limits).x
    given = noise + columns @ [3.0, -2.0, 0.5]
    repeated = np.column_stack([columns, 1e6 * columns[:, 1]])
    assert correlation(given, repeated, steps) == pytest.approx(best, abs=1e-4)
    assert best == pytest.approx(0.8, abs=0.1)


def test_noise_that_alternates_counts_as_white() -> None:
    alternating = np.tile([1.0, -0.8], 25)
    assert correlation(alternating) == 0.0
