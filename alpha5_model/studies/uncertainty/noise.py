"""Autoregressive noise of a channel, by restricted maximum likelihood.

References:
    [Durbin1960] Durbin: The fitting of time-series models, Revue de l'Institut
    International de Statistique 28(3).
    [Patterson1971] Patterson, Thompson: Recovery of inter-block information when block
    sizes are unequal, Biometrika 58(3).
"""

from __future__ import annotations

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
_EXACT = 1e-9
#: What is added to the squares of columns, relative to their sum, to factorize them.
_FLOOR = 1e-14
#: Combinations of likely columns with less effect than this share of one deviation of
#: the noise are lost in it.
_LOST = 0.3
#: Limits of the arctanh of partial autocorrelations: 0.9996 for the first, then 0.95.
_LIMITS = ((-4.3, 4.3), (-1.8, 1.8), (-1.8, 1.8))
#: Where the search may start; far off, the likelihood is flat.
_STARTS = ((-0.5, 0.0, 0.0), (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.5, 0.0, 0.0))


class Noise(NamedTuple):
    """Noise ``e_t = sum_k coefficients[k] e_(t-1-k) + w_t`` with white w.

    Attributes:
        coefficients: (ORDER,); zeros for white noise.
        deviation: Standard deviation of w, in the unit of the channel; NaN if there are
            too few samples to tell it.
        independent: Independent samples whose mean would be as uncertain.
    """

    coefficients: FloatArray
    deviation: float
    independent: float


def noise_of_channel(
    columns: FloatArray, likely: FloatArray, measured: FloatArray
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
    """
    from scipy.optimize import minimize

    basis = _with_likely(_basis(columns, measured), likely, measured)
    lagged = _lagged(np.column_stack([basis, measured]))
    samples, _, width = lagged.shape
    freedom = samples + ORDER - width + 1
    if freedom < _LEAST_FREEDOM:
        return Noise(coefficients=np.zeros(ORDER), deviation=np.nan, independent=0.0)

    flat = lagged.reshape(samples, -1)
    shape = (ORDER + 1, width, ORDER + 1, width)
    products = (flat.T @ flat).reshape(shape).swapaxes(1, 2)
    white = np.zeros(ORDER)
    start = lagged[0, :0:-1]
    least = _likelihood_parts(products, start, white).rest
    size = np.sqrt(np.nanmean(measured**2))
    deviation = float(np.sqrt(least / freedom))
    if deviation <= _EXACT * size:
        return Noise(coefficients=white, deviation=deviation, independent=freedom)

    def minus_log_likelihood(unbounded: FloatArray) -> float:
        parts = _likelihood_parts(products, start, np.tanh(unbounded))
        return float(freedom * np.log(parts.rest) + parts.log_determinant) / 2

    first = min(_STARTS, key=lambda one: minus_log_likelihood(np.array(one)))
    best = minimize(minus_log_likelihood, first, method="L-BFGS-B", bounds=_LIMITS)
    partial = np.tanh(best.x)
    coefficients = stationary(partial)
    rest = _likelihood_parts(products, start, partial).rest
    share = (1.0 - coefficients.sum()) ** 2 / np.prod(1.0 - partial**2)
    return Noise(
        coefficients=coefficients,
        deviation=float(np.sqrt(rest / freedom)),
        independent=max(freedom * min(float(share), 1.0), _LEAST_INDEPENDENT),
    )


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
    independent = singular > _RANK * singular.max(initial=0.0)
    weights = directions[independent].T / singular[independent]
    return np.asarray(columns[:, used] / sizes[used] @ weights)


def _with_likely(
    basis: FloatArray, likely: FloatArray, measured: FloatArray
) -> FloatArray:
    """A basis with the likely columns' combinations that stand out, (N, r)."""
    present = np.isfinite(measured)
    inside = basis[present]
    beyond = likely - basis @ (inside.T @ likely[present])
    left, singular, directions = np.linalg.svd(beyond[present], full_matrices=False)
    values = measured[present] - inside @ (inside.T @ measured[present])
    whole = singular > _RANK * singular.max(initial=0.0)
    rest = values - left[:, whole] @ (left[:, whole].T @ values)
    freedom = max(values.size - basis.shape[1] - int(whole.sum()), 1)
    size = np.linalg.norm(rest) / np.sqrt(freedom)
    outstanding = whole & (singular > _LOST * size)
    weights = directions[outstanding].T / singular[outstanding]
    return np.column_stack([basis, beyond @ weights])


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
    floor = _FLOOR * (np.trace(of_columns) + tiny)
    factor = np.linalg.cholesky(of_columns + floor * np.eye(len(of_columns)))
    explained = np.linalg.solve(factor, squares[:-1, -1])
    rest = float(squares[-1, -1] - explained @ explained)
    of_columns_log = 2 * float(np.log(np.diag(factor)).sum())
    return _Likelihood(
        rest=max(rest, tiny), log_determinant=log_variances + of_columns_log
    )
