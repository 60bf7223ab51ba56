"""Autoregressive noise of a channel, by restricted maximum likelihood.

References:
    [Durbin1960] Durbin: The fitting of time-series models, Revue de l'Institut
    International de Statistique 28(3).
    [Patterson1971] Patterson, Thompson: Recovery of inter-block information when block
    sizes are unequal, Biometrika 58(3).
    [Rubin1987] Rubin: Comment on Tanner and Wong: sampling by importance resampling,
    Journal of the American Statistical Association 82(398).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray

#: Earlier samples that the noise of a sample depends on.
ORDER = 3
#: Fewer samples than this beyond the unknowns tell nothing about the noise.
_LEAST_FREEDOM = 20
#: Slow noise is known from two samples at least.
_LEAST_INDEPENDENT = 2.0
#: Directions with smaller singular values are rounding errors, relative to the largest.
_RANK = 1e-10
#: Residuals this small, relative to what is measured, are rounding errors.
EXACT = 1e-9
#: What is added to the squares of columns, relative to their sum, to factorize them.
_FLOOR = 1e-14
#: Combinations of likely columns with less effect than this share of one deviation of
#: the noise are lost in it.
_LOST = 0.3
#: Largest arctanh of partial autocorrelations: of 0.9996 for the first, then of 0.95.
_LARGEST = np.array([4.3, 1.8, 1.8])
#: How many noises represent those that the data do not rule out, and of how many points
#: they are chosen.
_LIKELY = 16
_CANDIDATES = 64
#: The points are spread wider than the likelihood by this.
_WIDER = 1.3
#: Least curvature of the likelihood: an arctanh is known within 1.
_LEAST_CURVATURE = 1.0
#: Step of the derivatives of the likelihood.
_STEP = 0.05
#: Where the search for the first arctanh may start, with the others at 0; far off, the
#: likelihood is flat.
_STARTS = (-0.5, 0.0, 0.5, 1.5)


class Noise(NamedTuple):
    """Noise ``e_t = sum_k coefficients[k] e_(t-1-k) + w_t`` with white w.

    Attributes:
        coefficients: (ORDER,); zeros for white noise.
        deviation: Standard deviation of w, in the unit of the channel; NaN if there are
            too few samples to tell it.
        independent: Independent samples whose mean would be as uncertain.
        likely: Noise that the data do not rule out, drawn by its probability, (S,
            ORDER + 1): coefficients, then deviation.
    """

    coefficients: FloatArray
    deviation: float
    independent: float
    likely: FloatArray


def noise_of_channel(
    columns: FloatArray,
    likely: FloatArray,
    measured: FloatArray,
    size: float | None = None,
) -> Noise:
    """Noise of a channel about the best fit of some columns.

    The likelihood of the part of the data that no combination of the columns can
    explain is greatest at the result [Patterson1971]. The samples are taken as evenly
    spaced, and the first ORDER as those of noise that has lasted for long.

    Args:
        columns: (N, k), with any factor.
        likely: (N, j), with factors of about 1: combinations of them that are lost in
            the noise are left out.
        measured: (N,); NaN for what is missing.
        size: Of what was recorded: residuals below 1e-9 of it are rounding errors.
            None for the size of ``measured``.
    """
    from scipy.optimize import minimize

    basis = _with_likely(_basis(columns, measured), likely, measured)
    lagged = _lagged(np.column_stack([basis, measured]))
    if _freedom(lagged) < _LEAST_FREEDOM:
        return _white(deviation=np.nan, independent=0.0)

    channel = _Channel(lagged)
    least = channel.parts(np.zeros(ORDER)).rest
    if size is None:
        size = float(root_mean_square(measured))
    deviation = float(np.sqrt(least / channel.freedom))
    if deviation <= EXACT * size:
        return _white(deviation=deviation, independent=channel.freedom)

    def likelihood(unbounded: FloatArray) -> float:
        return channel.minus_log_likelihood(np.tanh(unbounded))

    starts = np.multiply.outer(_STARTS, np.eye(ORDER)[0])
    start = min(starts, key=likelihood)
    limits = np.column_stack([-_LARGEST, _LARGEST])
    best = minimize(likelihood, start, method="L-BFGS-B", bounds=limits)
    partial = np.tanh(best.x)
    share = (1.0 - stationary(partial).sum()) ** 2 / np.prod(1.0 - partial**2)
    independent = channel.freedom * min(float(share), 1.0)
    drawn = np.tanh(_drawn(likelihood, np.asarray(best.x)))
    return Noise(
        coefficients=stationary(partial),
        deviation=channel.deviation(partial),
        independent=max(independent, _LEAST_INDEPENDENT),
        likely=np.array([[*stationary(x), channel.deviation(x)] for x in drawn]),
    )


def root_mean_square(rows: FloatArray) -> FloatArray:
    """Of each column, (N, ...) to (...); NaN is left out."""
    return np.asarray(np.sqrt(np.nanmean(rows**2, axis=0)))


class _Channel:
    """The restricted likelihood of a channel's noise.

    Attributes:
        freedom: Samples beyond the columns.
    """

    def __init__(self, lagged: FloatArray) -> None:
        samples, _, width = lagged.shape
        flat = lagged.reshape(samples, -1)
        shape = (ORDER + 1, width, ORDER + 1, width)
        self.freedom = _freedom(lagged)
        self._products = (flat.T @ flat).reshape(shape).swapaxes(1, 2)
        self._start = lagged[0, :0:-1]

    def parts(self, partial: FloatArray) -> _Likelihood:
        """Parts of the likelihood of noise with these partial autocorrelations."""
        return _likelihood_parts(self._products, self._start, partial)

    def minus_log_likelihood(self, partial: FloatArray) -> float:
        """Minus its logarithm, at the likeliest deviation."""
        parts = self.parts(partial)
        return float(self.freedom * np.log(parts.rest) + parts.log_determinant) / 2

    def deviation(self, partial: FloatArray) -> float:
        """The likeliest deviation of what drives such noise."""
        return float(np.sqrt(self.parts(partial).rest / self.freedom))


def _freedom(lagged: FloatArray) -> int:
    """Samples beyond the columns."""
    samples, _, width = lagged.shape
    return int(samples + ORDER - width + 1)


def _white(deviation: float, independent: float) -> Noise:
    """White noise, of which nothing else is likely."""
    alone = [*np.zeros(ORDER), deviation]
    return Noise(
        coefficients=np.zeros(ORDER),
        deviation=deviation,
        independent=independent,
        likely=np.tile(alone, (_LIKELY, 1)),
    )


def _drawn(
    minus_log_likelihood: Callable[[FloatArray], float], best: FloatArray
) -> FloatArray:
    """Points drawn by their likelihood, if all partial autocorrelations are possible.

    The points are fixed multiples of the deviations of a normal distribution with the
    curvature of the likelihood at its maximum; each is then taken as often as its
    likelihood asks for [Rubin1987].

    The arctanh of the first one is as likely everywhere, which leaves room for slow
    noise that a short recording hardly shows.

    Args:
        minus_log_likelihood: Of the arctanh of partial autocorrelations, (ORDER,).
        best: Its minimum.

    Returns:
        (_LIKELY, ORDER).
    """
    values, vectors = np.linalg.eigh(_curvature(minus_log_likelihood, best))
    # The symmetric root: it does not depend on the signs of the vectors, which are
    # arbitrary.
    deviations = vectors / np.sqrt(np.maximum(values, _LEAST_CURVATURE)) @ vectors.T
    rng = np.random.default_rng(0)
    steps = _WIDER * rng.normal(size=(_CANDIDATES, ORDER))
    points = best + steps @ deviations.T
    inside = (np.abs(points) <= _LARGEST).all(axis=1)
    points = points[inside]
    steps = steps[inside]
    if not len(points):
        return np.tile(best, (_LIKELY, 1))

    log_prior = np.log(1.0 - np.tanh(points[:, 1:]) ** 2).sum(axis=1)
    log_proposal = -((steps / _WIDER) ** 2).sum(axis=1) / 2
    log_likelihood = -np.array([minus_log_likelihood(point) for point in points])
    log_weights = log_likelihood + log_prior - log_proposal
    weights = np.exp(log_weights - log_weights.max())
    # The midpoints of equal parts of the cumulated weights.
    at = np.cumsum(weights) / weights.sum()
    middles = (np.arange(_LIKELY) + 0.5) / _LIKELY
    chosen = points[np.searchsorted(at, middles)]
    return np.asarray(rng.permutation(chosen))


def _curvature(function: Callable[[FloatArray], float], at: FloatArray) -> FloatArray:
    """Second derivatives of a function of ORDER numbers."""
    step = _STEP * np.eye(ORDER)
    out = np.empty((ORDER, ORDER))
    for i, j in np.ndindex(ORDER, ORDER):
        corners = [
            function(at + step[i] + step[j]),
            -function(at + step[i] - step[j]),
            -function(at - step[i] + step[j]),
            function(at - step[i] - step[j]),
        ]
        out[i, j] = sum(corners) / (4 * _STEP**2)
    return out


def whitened(rows: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Rows (N, ...) less what the ORDER rows before predict.

    The result has (N, ...) rows; the first ORDER rows are NaN, unless all coefficients
    are zero. NaN spreads to the rows that depend on it.
    """
    if not coefficients.any():
        return rows
    out = np.full_like(rows, np.nan)
    out[ORDER:] = rows[ORDER:]
    for k, coefficient in enumerate(coefficients.tolist()):
        first = ORDER - 1 - k
        out[ORDER:] -= coefficient * rows[first : first + len(rows) - ORDER]
    return out


def stationary(partial: FloatArray) -> FloatArray:
    """Coefficients with these partial autocorrelations [Durbin1960], (ORDER,) both."""
    coefficients = np.zeros(0)
    for correlation in partial:
        shorter = coefficients - correlation * coefficients[::-1]
        coefficients = np.append(shorter, correlation)
    return coefficients


def _basis(columns: FloatArray, measured: FloatArray) -> FloatArray:
    """Independent combinations of the columns, orthonormal where measured, (N, r)."""
    present = columns[np.isfinite(measured)]
    sizes = np.linalg.norm(present, axis=0)
    used = sizes > 0
    scaled = present[:, used] / sizes[used]
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    independent = singular > _RANK * singular[:1]
    weights = directions[independent].T / singular[independent]
    return np.asarray(columns[:, used] / sizes[used] @ weights)


def _with_likely(
    basis: FloatArray, likely: FloatArray, measured: FloatArray
) -> FloatArray:
    """A basis with the likely columns' combinations that stand out, (N, r)."""
    present = np.isfinite(measured)
    beyond = likely - basis @ (basis[present].T @ likely[present])
    left, singular, directions = np.linalg.svd(beyond[present], full_matrices=False)
    independent = singular > _RANK * singular[:1]

    everything = np.column_stack([basis[present], left[:, independent]])
    noise = _rest_deviation(everything, measured[present])
    outstanding = independent & (singular > _LOST * noise)
    weights = directions[outstanding].T / singular[outstanding]
    return np.column_stack([basis, beyond @ weights])


def _root(squares: FloatArray, floor: float) -> FloatArray:
    """F of F F^T = columns' squares and a floor, (r, r)."""
    try:
        return np.asarray(np.linalg.cholesky(squares + floor * np.eye(len(squares))))
    except np.linalg.LinAlgError:
        # What rounding leaves of columns that are zero in most rows may be below zero.
        values, vectors = np.linalg.eigh(squares)
        return np.asarray(vectors * np.sqrt(np.maximum(values, floor)))


def _rest_deviation(basis: FloatArray, values: FloatArray) -> float:
    """Standard deviation of what an orthonormal basis leaves of values (N,)."""
    rest = values - basis @ (basis.T @ values)
    freedom = max(values.size - basis.shape[1], 1)
    return float(np.linalg.norm(rest) / np.sqrt(freedom))


def _lagged(rows: FloatArray) -> FloatArray:
    """Each row with the ORDER before it, where none is missing, (n, ORDER + 1, k)."""
    count = max(len(rows) - ORDER, 0)
    shifts = [rows[ORDER - k : ORDER - k + count] for k in range(ORDER + 1)]
    stacked = np.stack(shifts, axis=1)
    return np.asarray(stacked[np.isfinite(stacked).all(axis=(1, 2))])


class _Likelihood(NamedTuple):
    """Parts of the restricted likelihood.

    Attributes:
        rest: Sum of whitened squares that the columns leave.
        log_determinant: Of the first samples' covariance and of the columns' squares.
    """

    rest: float
    log_determinant: float


def _likelihood_parts(
    products: FloatArray, start: FloatArray, partial: FloatArray
) -> _Likelihood:
    """Parts of the likelihood of noise with these partial autocorrelations.

    Args:
        products: Of the rows k and j before each row, summed, (4, 4, width, width).
        start: The first ORDER rows, (ORDER, width).
        partial: (ORDER,).
    """
    weights = np.append(1.0, -stationary(partial))
    squares = np.tensordot(np.multiply.outer(weights, weights), products, 2)
    variance = 1.0 / np.prod(1.0 - partial**2)
    log_variances = 0.0
    for k, row in enumerate(start):
        # The row before comes first in the coefficients.
        predicted = stationary(partial[:k]) @ start[:k][::-1]
        error = (row - predicted) / np.sqrt(variance)
        squares = squares + np.outer(error, error)
        log_variances += float(np.log(variance))
        variance *= 1.0 - partial[k] ** 2

    of_columns = squares[:-1, :-1]
    tiny = np.finfo(float).tiny
    floor = _FLOOR * max(float(np.trace(of_columns)), tiny)
    factor = _root(of_columns, floor)
    explained = np.linalg.solve(factor, squares[:-1, -1])
    rest = float(squares[-1, -1] - explained @ explained)
    of_columns_log = 2 * float(np.linalg.slogdet(factor).logabsdet)
    return _Likelihood(
        rest=max(rest, tiny), log_determinant=log_variances + of_columns_log
    )
