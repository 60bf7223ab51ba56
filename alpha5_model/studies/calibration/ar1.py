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

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray

#: Rounds of fit and correlation that settle both.
ROUNDS = 4
#: How many correlations are compared.
_COMPARED = 24
#: Correlations that are less probable than this are left out.
_IMPROBABLE = 0.01
#: Combinations of columns with smaller singular values are rounding errors.
_RANK = 1e-10


class Correlations(NamedTuple):
    """Correlations of neighbours that the data do not rule out.

    Attributes:
        rho: (R,), each 0 <= rho < 1.
        probability: Of each, (R,); the sum is 1.
    """

    rho: FloatArray
    probability: FloatArray


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
    """The mean of `correlations`."""
    likely = correlations(rest, columns, steps)
    return float(likely.rho @ likely.probability)


def correlations(
    rest: FloatArray,
    columns: FloatArray | None = None,
    steps: NDArray[Any] | None = None,
) -> Correlations:
    """How probable each correlation is, by what a fit leaves.

    A fit takes part of the noise away, slow noise above all. So the likelihood is that
    of the part of ``rest`` which no combination of the columns explains
    [Patterson1971]_; it is the same before and after a linear fit. Before the data,
    arctanh(rho) is as probable everywhere from 0, which also stands for noise that
    alternates, to that of noise which lasts as long as the recording.

    Args:
        rest: (N,), of one channel.
        columns: What was fitted, with any factors, (N, k); None if nothing was.
        steps: As of `whitened`.
    """
    basis = np.zeros((len(rest), 0)) if columns is None else _basis(columns)
    freedom = len(rest) - basis.shape[1]
    if freedom < 3:
        return Correlations(rho=np.zeros(1), probability=np.ones(1))
    span = len(rest) if steps is None else int(steps[-1] - steps[0]) + 1
    rho = np.tanh(np.linspace(0.0, np.arctanh(1.0 - 1.0 / span), _COMPARED))
    rows = np.column_stack([basis, rest])

    log_likelihood = np.empty(_COMPARED)
    for k, one in enumerate(rho.tolist()):
        triangle = np.linalg.qr(whitened(rows, one, steps), mode="r")
        size = np.maximum(np.abs(np.diag(triangle)), np.finfo(float).tiny)
        _, scale = _weights(len(rest), one, steps)
        of_columns = np.log(size[:-1]).sum()
        log_likelihood[k] = np.log(scale).sum() - of_columns
        log_likelihood[k] -= freedom * np.log(size[-1])

    weights = np.exp(log_likelihood - log_likelihood.max())
    probable = weights > _IMPROBABLE * weights.sum()
    return Correlations(
        rho=rho[probable], probability=weights[probable] / weights[probable].sum()
    )


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
