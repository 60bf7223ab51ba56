"""The noise of a channel, part by part, against full matrices and integrals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov, toeplitz

from alpha5_model.studies.uncertainty.noise import (
    _Channel,
    _lagged,
    noise_of_channel,
    stationary,
)

#: Partial autocorrelations of slow, alternating and white noise.
PARTIALS = ([0.9, -0.4, 0.3], [-0.7, 0.2, -0.5], [0.0, 0.0, 0.0])


def autocovariance(partial: list[float], count: int) -> np.ndarray:
    """Of noise driven by 1, by Lyapunov's equation of three samples, (count,)."""
    coefficients = stationary(np.array(partial))
    step = np.vstack([coefficients, np.eye(3)[:2]])
    driving = np.diag([1.0, 0.0, 0.0])
    found = solve_discrete_lyapunov(step, driving)[0].tolist()
    while len(found) < count:
        found.append(float(coefficients @ found[:-4:-1]))
    return np.array(found)


def autoregressive(partial: list[float], count: int, seed: int) -> np.ndarray:
    """Noise with these partial autocorrelations, driven by 1, (count,)."""
    coefficients = stationary(np.array(partial))
    out = np.random.default_rng(seed).normal(size=count + 3)
    for k in range(3, len(out)):
        out[k] += coefficients @ out[k - 3 : k][::-1]
    return out[3:]


def rows_of(count: int) -> np.ndarray:
    """A constant, a sine and a measured column, (count, 3)."""
    time = 0.1 * np.arange(count)
    measured = np.random.default_rng(1).normal(size=count) + 0.5 * time
    return np.column_stack([np.ones(count), np.sin(time), measured])


@pytest.mark.parametrize("partial", PARTIALS)
def test_the_likelihood_is_that_of_the_covariance_of_all_samples(
    partial: list[float],
) -> None:
    rows = rows_of(30)
    columns, measured = rows[:, :2], rows[:, 2]
    covariance = toeplitz(autocovariance(partial, 30))
    inverse = np.linalg.inv(covariance)
    squares = columns.T @ inverse @ columns
    left_over = measured - columns @ np.linalg.solve(
        squares, columns.T @ inverse @ measured
    )
    rest = left_over @ inverse @ left_over
    logs = np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(squares)[1]

    channel = _Channel(_lagged(rows))
    found = channel.parts(np.array(partial))
    assert channel.freedom == 28
    assert found.rest == pytest.approx(rest, rel=1e-9)
    assert found.log_determinant == pytest.approx(logs, rel=1e-9)
    minus_log = channel.minus_log_likelihood(np.array(partial))
    assert minus_log == pytest.approx((28 * np.log(rest) + logs) / 2, rel=1e-9)
    deviation = channel.deviation(np.array(partial))
    assert deviation == pytest.approx(np.sqrt(rest / 28), rel=1e-9)


NOTHING = np.zeros((300, 0))


def test_noise_that_alternates_is_as_good_as_white() -> None:
    """Its mean is known better still, but it counts as no more samples than it has."""
    measured = autoregressive([-0.9, 0.0, 0.0], 300, 2)
    found = noise_of_channel(NOTHING, NOTHING, measured)
    assert found.coefficients[0] < -0.8
    assert found.independent == 300


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_residuals_of_rounding_are_no_noise(unit: float) -> None:
    """Residuals below 1e-9 of what was recorded; here they alternate, with gaps."""
    time = np.arange(100)
    column = np.cos(0.3 * time)[:, None]
    residual = 1e-6 * unit
    measured = unit * column[:, 0] + residual * (-1.0) ** time
    measured[[4, 50]] = np.nan
    nothing = np.zeros((100, 0))
    for size in (None, 1e8 * residual):
        found = noise_of_channel(column, nothing, measured, size)
        assert found.coefficients.any()
    found = noise_of_channel(column, nothing, measured, 1e10 * residual)
    assert not found.coefficients.any()
    assert found.deviation == pytest.approx(residual, rel=0.05)
    assert (found.likely == [0.0, 0.0, 0.0, found.deviation]).all()
    assert len(found.likely) == 16
    # A gap costs a sample and the three after it; the column costs one.
    assert found.independent == 100 - 2 * 4 - 1
