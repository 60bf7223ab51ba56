"""The noise of a channel, part by part, against full matrices and integrals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov, toeplitz

from alpha5_model.studies.uncertainty.noise import (
    _basis,
    _Channel,
    _curvature,
    _drawn,
    _lagged,
    _rest_deviation,
    _with_likely,
    noise_of_channel,
    root_mean_square,
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


def test_samples_after_a_gap_count_from_the_fourth() -> None:
    """The first three samples that are there begin the noise; no others do."""
    partial = PARTIALS[0]
    rows = rows_of(30)
    rows[[0, 11], 2] = np.nan
    first = rows[1:4]
    begin = toeplitz(autocovariance(partial, 3))
    whitened = [*np.linalg.solve(np.linalg.cholesky(begin), first)]
    for k in range(4, 30):
        before = rows[k - 3 : k][::-1]
        row = rows[k] - stationary(np.array(partial)) @ before
        if np.isfinite(row).all():
            whitened.append(row)
    columns, measured = np.split(np.array(whitened), [2], axis=1)
    _, (rest,), _, _ = np.linalg.lstsq(columns, measured, rcond=None)
    logs = np.linalg.slogdet(columns.T @ columns)[1] + np.linalg.slogdet(begin)[1]

    channel = _Channel(_lagged(rows))
    found = channel.parts(np.array(partial))
    assert channel.freedom == len(whitened) - 2 == 23
    assert found.rest == pytest.approx(rest, rel=1e-9)
    assert found.log_determinant == pytest.approx(logs, rel=1e-9)


def test_a_recording_of_fewer_samples_than_a_gap_needs_has_no_rows() -> None:
    rows = np.ones((2, 3))
    assert _lagged(rows).shape == (0, 4, 3)


@pytest.mark.parametrize("unit", [1e-13, 1.0, 1e9])
def test_a_basis_spans_the_columns_where_something_is_measured(unit: float) -> None:
    """Its rank and its directions depend on no unit."""
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(25, 4)) * unit * [1.0, 1e-6, 1e6, 1.0]
    columns[:, 3] = columns[:, 0] + 2e6 * columns[:, 1]
    columns = np.column_stack([columns, np.zeros(25)])
    measured = np.zeros(25)
    measured[[2, 9]] = np.nan
    present = np.isfinite(measured)
    basis = _basis(columns, measured)
    assert basis.shape == (25, 3)
    of_present = basis[present]
    np.testing.assert_allclose(of_present.T @ of_present, np.eye(3), atol=1e-12)
    sizes = np.linalg.norm(columns[:, :3], axis=0)
    by_basis = basis @ (of_present.T @ columns[present, :3])
    np.testing.assert_allclose(by_basis / sizes, columns[:, :3] / sizes, atol=1e-12)
    assert _basis(np.zeros((25, 0)), measured).shape == (25, 0)


@pytest.mark.parametrize("unit", [1e-13, 1.0, 1e9])
def test_likely_columns_that_are_lost_in_the_noise_are_left_out(unit: float) -> None:
    """Lost is what moves no sum of squares by 0.3 deviations of the noise."""
    rng = np.random.default_rng(5)
    full = np.linalg.qr(rng.normal(size=(40, 6)))[0]
    measured = rng.normal(size=40)
    measured[7] = np.nan
    present = np.isfinite(measured)
    basis = np.linalg.qr(full[present])[0]
    everywhere = np.zeros((40, 6))
    everywhere[present] = basis
    rest = measured[present] - basis @ (basis.T @ measured[present])
    noise = np.sqrt(rest @ rest / (39 - 6))

    sizes = np.array([2.0, 0.31, 0.29, 0.01]) * noise
    likely = everywhere[:, 1:5] * sizes + everywhere[:, :1]
    likely = np.column_stack([likely, 3.0 * noise * everywhere[:, 5]])
    found = _with_likely(everywhere[:, :1], unit * likely, unit * measured)
    assert found.shape == (40, 4)
    kept = found[present]
    np.testing.assert_allclose(kept.T @ kept, np.eye(4), atol=1e-9)
    of_kept = kept.T @ basis[:, [0, 1, 2, 5]]
    np.testing.assert_allclose(of_kept.T @ of_kept, np.eye(4), atol=1e-9)


@pytest.mark.parametrize(("columns", "freedom"), [(0, 4), (2, 2), (3, 1), (4, 1)])
def test_the_deviation_of_what_is_left_counts_the_columns(
    columns: int, freedom: int
) -> None:
    values = np.array([3.0, -2.0, 1.0, 5.0])
    found = _rest_deviation(np.eye(4)[:, :columns], values)
    left = values[columns:]
    assert found == pytest.approx(np.sqrt(left @ left / freedom))


def test_the_curvature_is_that_of_a_known_function() -> None:
    weights = np.array([[1.0, 0.5, 0.0], [0.2, -1.0, 0.7], [0.3, 0.1, 2.0]])
    at = np.array([0.3, -0.2, 0.6])
    found = _curvature(lambda x: float(np.cos(weights @ x).sum()), at)
    exact = -weights.T @ np.diag(np.cos(weights @ at)) @ weights
    np.testing.assert_allclose(found, exact, atol=0.02)


def posterior(minus_log: Callable[[np.ndarray], np.ndarray]) -> tuple[np.ndarray, ...]:
    """Mean and deviation by a sum over a grid of all that is possible.

    Each partial autocorrelation but the first is as likely everywhere from -1 to 1; of
    the first, the arctanh is.
    """
    axes = [np.linspace(-x, x, 61) for x in (4.3, 1.8, 1.8)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = np.exp(-minus_log(grid)) / np.cosh(grid[:, 1:]).prod(axis=1) ** 2
    weights /= weights.sum()
    mean = weights @ grid
    return mean, np.sqrt(weights @ (grid - mean) ** 2)


#: Curvature of the logarithm of a likelihood, and where it is greatest.
LIKELIHOODS = (
    (np.diag([100.0, 25.0, 400.0]), np.array([1.0, 0.3, -0.5])),
    (np.diag([4.0, 2.0, 4.0]), np.array([1.0, 0.8, -0.9])),
    (np.array([[30.0, 20, 0], [20, 40, -10], [0, -10, 20]]), np.array([0, 0.5, 0.4])),
    (np.zeros((3, 3)), np.zeros(3)),
)


@pytest.mark.parametrize("case", range(4))
@pytest.mark.parametrize("constant", [-5000.0, 5000.0])
def test_drawn_noise_has_the_mean_and_spread_of_its_probability(
    case: int, constant: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over many draws; one draw has sixteen points, and its own error.

    The last likelihood tells nothing, so that all that is possible is drawn.
    """
    curvature, best = LIKELIHOODS[case]

    def minus_log(x: np.ndarray) -> np.ndarray:
        off = x - best
        return np.asarray((off @ curvature * off).sum(axis=-1) / 2)

    mean, deviation = posterior(minus_log)
    rng = np.random.default_rng(1)
    monkeypatch.setattr(np.random, "default_rng", lambda _: rng)
    drawn = [_drawn(lambda x: float(minus_log(x)) + constant, best) for _ in range(50)]
    off = np.array(drawn) - mean
    assert off.shape == (50, 16, 3)
    assert (np.abs(off.mean(axis=(0, 1))) < 0.2 * deviation).all()
    spread = np.sqrt((off**2).mean(axis=(0, 1)))
    np.testing.assert_allclose(spread, deviation, rtol=0.15)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_no_noise_is_drawn_that_has_no_probability(side: float, axis: int) -> None:
    def minus_log(x: np.ndarray) -> float:
        return 0.0 if side * x[axis] > 0.0 else 1e4

    drawn = _drawn(minus_log, np.zeros(3))
    assert (side * drawn[:, axis] > 0.0).all()
    assert (np.abs(drawn) <= [4.3, 1.8, 1.8]).all()


NOTHING = np.zeros((300, 0))


def test_the_likely_noise_of_a_channel_has_its_own_deviations() -> None:
    """Sixteen noises, each with the deviation at its own greatest likelihood."""
    rows = rows_of(60)
    found = noise_of_channel(rows[:, :2], NOTHING[:60], rows[:, 2])
    assert found.likely.shape == (16, 4)
    for *coefficients, deviation in found.likely:
        channel = _Channel(_lagged(rows))
        partial = partial_autocorrelations(np.array(coefficients))
        assert deviation == pytest.approx(channel.deviation(partial), rel=1e-9)
    # The best noise is among the likely ones, not at their edge.
    lowest, highest = found.likely.min(axis=0), found.likely.max(axis=0)
    assert (lowest[:3] < found.coefficients).all()
    assert (found.coefficients < highest[:3]).all()


def partial_autocorrelations(coefficients: np.ndarray) -> np.ndarray:
    """Those of noise with these coefficients, by Durbin's recursion backwards."""
    partial: list[float] = []
    while coefficients.size:
        *shorter, last = coefficients
        partial.insert(0, last)
        coefficients = (shorter + last * np.array(shorter[::-1])) / (1.0 - last**2)
    return np.array(partial)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("lag", "largest"), [(0, 0.9996), (1, 0.95), (2, 0.95)])
def test_noise_is_never_slower_than_can_be_told(
    lag: int, largest: float, side: float
) -> None:
    """A recording that the sample a lag before predicts all but wholly."""
    rng = np.random.default_rng(6)
    measured = np.zeros(1000)
    for k in range(lag + 1, 1000):
        measured[k] = side * measured[k - lag - 1] + rng.normal()
    if lag == 0:
        measured += side ** np.arange(1000) * np.arange(1000)
    nothing = np.zeros((1000, 0))
    found = noise_of_channel(nothing, nothing, measured)
    of_best = side * partial_autocorrelations(found.coefficients)
    digit = 10.0 ** -len(str(largest)[2:])
    assert of_best[lag] == pytest.approx(largest, abs=digit / 2)
    # Two samples tell the mean of the slowest as well as all do.
    assert (found.independent == 2.0) == (lag == 0 and side > 0)


def test_noise_that_alternates_is_as_good_as_white() -> None:
    """Its mean is known better still, but it counts as no more samples than it has."""
    measured = autoregressive([-0.9, 0.0, 0.0], 300, 2)
    found = noise_of_channel(NOTHING, NOTHING, measured)
    assert found.coefficients[0] < -0.8
    assert found.independent == 300


@pytest.mark.parametrize("columns", [0, 3])
def test_twenty_samples_beyond_the_columns_tell_the_noise(columns: int) -> None:
    rng = np.random.default_rng(8)
    enough = rng.normal(size=(20 + columns, columns + 1))
    nothing = np.zeros((20 + columns, 0))
    found = noise_of_channel(enough[:, :columns], nothing, enough[:, columns])
    assert np.isfinite(found.deviation)
    few = enough[1:]
    white = noise_of_channel(few[:, :columns], nothing[1:], few[:, columns])
    assert np.isnan(white.deviation)
    assert white.independent == 0.0
    assert not white.coefficients.any()


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


def test_noise_in_a_corner_of_what_is_possible_is_all_that_is_drawn() -> None:
    """The likelihood is long across the corner, so that no other point is possible."""
    best = np.array([4.3, 1.8, 1.8])
    along = np.array([1.0, -1.0, 0.0]) / 2**0.5
    curvature = 1e8 * (np.eye(3) - np.outer(along, along))
    drawn = _drawn(lambda x: float((x - best) @ curvature @ (x - best)) / 2, best)
    assert np.array_equal(drawn, np.tile(best, (16, 1)))


def test_a_root_mean_square_leaves_out_what_is_missing() -> None:
    rows = np.array([[3.0, -1.0], [np.nan, 1.0], [-4.0, -2.0]])
    expected = [12.5**0.5, 2.0**0.5]
    np.testing.assert_allclose(root_mean_square(rows), expected)
    assert root_mean_square(rows[:, 0]) == pytest.approx(12.5**0.5)
