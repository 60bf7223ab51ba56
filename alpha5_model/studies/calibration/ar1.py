"""Correlated noise: each sample's is rho times that of the sample before, plus chance.

Rows of a least-squares problem are whitened by rho, and rho is told by what the fit
leaves. A fit that is not linear repeats both, as Cochrane and Orcutt do
[Cochrane1949]_::

    rho = 0.0
    for _ in range(ROUNDS):
        fit by least squares of whitened(residuals, rho) and whitened(slopes, rho)
        rho = correlation(residuals, slopes)

.. [Cochrane1949] Cochrane, Orcutt: Application of least squares regression to
   relationships containing auto-correlated error terms, Journal of the American
   Statistical Association 44(245).
.. [Patterson1971] Patterson, Thompson: Recovery of inter-block information when block
   sizes are unequal, Biometrika 58(3).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray

#: Rounds of fit and correlation that settle both.
ROUNDS = 4
#: Noise of a greater correlation cannot be told from a random walk.
_LARGEST = 0.999
#: Combinations of columns with smaller singular values are rounding errors.
_RANK = 1e-10


def whitened(
    rows: FloatArray, rho: float, steps: NDArray[Any] | None = None
) -> FloatArray:
    """Rows less what the row before predicts, all with noise of the same deviation.

    The deviation is that of the chance in each step. The noise itself has this over
    ``sqrt(1 - rho**2)``, and the first row is scaled so.

    Args:
        rows: (N,) or (N, k), in the order of time, without NaN.
        rho: Correlation of the noise of neighbours, 0 <= rho < 1.
        steps: Sample number of each row, (N,), increasing; rows may be missing. None
            if no row is missing.

    Returns:
        Of the shape of ``rows``.
    """
    predicting, scale = _weights(len(rows), rho, steps)
    shape = (-1,) + (1,) * (rows.ndim - 1)
    out = rows.copy()
    out[1:] -= predicting[1:].reshape(shape) * rows[:-1]
    return np.asarray(out * scale.reshape(shape))


def correlation(
    rest: FloatArray,
    columns: FloatArray | None = None,
    steps: NDArray[Any] | None = None,
) -> float:
    """The likeliest correlation of neighbours in what a fit leaves.

    A fit takes part of the noise away, slow noise above all. So the likelihood is that
    of the part of ``rest`` which no combination of the columns explains
    [Patterson1971]_; it is the same before and after a linear fit.

    Args:
        rest: (N,), of one channel.
        columns: What was fitted, with any factors, (N, k); None if nothing was.
        steps: As of `whitened`.

    Returns:
        0 <= rho <= 0.999; 0 for noise that alternates.
    """
    from scipy.optimize import minimize_scalar

    basis = np.zeros((len(rest), 0)) if columns is None else _basis(columns)
    if len(rest) < basis.shape[1] + 3:
        return 0.0
    rows = np.column_stack([basis, rest])

    def minus_log_likelihood(unbounded: float) -> float:
        rho = float(np.tanh(unbounded))
        triangle = np.linalg.qr(whitened(rows, rho, steps), mode="r")
        size = np.maximum(np.abs(np.diag(triangle)), np.finfo(float).tiny)
        _, scale = _weights(len(rest), rho, steps)
        freedom = len(rest) - basis.shape[1]
        of_columns = np.log(size[:-1]).sum()
        return float(freedom * np.log(size[-1]) + of_columns - np.log(scale).sum())

    bounds = (0.0, float(np.arctanh(_LARGEST)))
    found = minimize_scalar(minus_log_likelihood, bounds=bounds, method="bounded")
    if minus_log_likelihood(0.0) <= found.fun:
        return 0.0
    return float(np.tanh(found.x))


def _weights(
    count: int, rho: float, steps: NDArray[Any] | None
) -> tuple[FloatArray, FloatArray]:
    """How much of the row before predicts each row, and the scale of what is left."""
    gap = np.ones(count) if steps is None else np.diff(steps, prepend=steps[0] - 1)
    predicting = rho**gap
    predicting[:1] = 0.0
    scale = np.sqrt((1.0 - rho**2) / (1.0 - predicting**2))
    return predicting, scale


def _basis(columns: FloatArray) -> FloatArray:
    """Orthonormal columns with the same span, (N, r)."""
    sizes = np.linalg.norm(columns, axis=0)
    scaled = columns[:, sizes > 0] / sizes[sizes > 0]
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return np.asarray(left[:, singular > _RANK * singular[:1]])
