"""Correlated noise, against the full covariance of all samples."""

from __future__ import annotations

import numpy as np
import pytest
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


@pytest.mark.parametrize("true", [0.3, 0.8, 0.97])
def test_the_correlation_is_the_mean_over_the_restricted_likelihood(
    true: float,
) -> None:
    rng = np.random.default_rng(4)
    steps = np.flatnonzero(rng.random(200) < 0.7)
    columns = np.column_stack([np.ones(len(steps)), np.sin(steps / 9), steps])
    noise = lfilter([1.0], [1.0, -true], rng.normal(size=300))[100:][steps]

    def log_likelihood(rho: float) -> float:
        every = covariance(rho, steps)
        squares = columns.T @ np.linalg.solve(every, columns)
        by_noise = columns.T @ np.linalg.solve(every, noise)
        left = noise - columns @ np.linalg.solve(squares, by_noise)
        rest = left @ np.linalg.solve(every, left)
        logs = np.linalg.slogdet(every)[1] + np.linalg.slogdet(squares)[1]
        return float(-(len(steps) - 3) * np.log(rest) - logs) / 2

    last = 1 - 1 / (steps[-1] - steps[0] + 1)
    rho = np.tanh(np.linspace(0, np.arctanh(last), 300))
    logs = np.array([log_likelihood(one) for one in rho.tolist()])
    weights = np.exp(logs - logs.max())
    mean = weights @ rho / weights.sum()
    given = noise + columns @ [3.0, -2.0, 0.5]
    repeated = np.column_stack([columns, 1e6 * columns[:, 1]])
    assert correlation(given, repeated, steps) == pytest.approx(mean, abs=0.01)
    assert mean == pytest.approx(true, abs=0.15)


def test_noise_that_alternates_counts_as_white() -> None:
    alternating = np.tile([1.0, -0.8], 25)
    assert correlation(alternating) == pytest.approx(0.0, abs=0.01)
