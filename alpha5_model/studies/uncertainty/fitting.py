"""The fit of the unknowns to a recording, by least squares weighted by its noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.uncertainty.misfit import (
    Equations,
    Problem,
    Suspect,
    contradiction,
    named_causes,
    ranked,
    untested,
)
from alpha5_model.studies.uncertainty.noise import (
    EXACT,
    ORDER,
    noise_of_channel,
    root_mean_square,
    whitened,
)
from alpha5_model.studies.uncertainty.recorded import Recording
from alpha5_model.studies.uncertainty.sampling import DEVIATION
from alpha5_model.studies.uncertainty.unknowns import Unknowns

#: Least noise [N m, N]: a computed recording has none.
_LEAST_NOISE = 1e-12
#: Smaller gains are rounding errors, relative to the largest one.
RANK = 1e-12
#: Gauss-Newton steps.
_STEPS = 4
#: Misfits that are smaller than this, relative to what is recorded, are no problem.
_HARMLESS = 1e-6
#: Times the digits' half width that numbers may be off when the noise is told.
_LOOSE = 20.0
#: Weight of the digits' middle where only their bounds should count.
_FAINT = 1e-3


class Fit(NamedTuple):
    """The unknowns that fit a recording best.

    Attributes:
        z: (count,).
        factor: Times its transpose, the covariance of z, (count, count).
        noise: Standard deviation of the residuals, (n,).
        of_data: Weighted least-squares equations of the recording, (m, count).
        correlation: Coefficients of the channels' noise, (n, 3).
        problems: Causes that explain what the fit does not.
    """

    z: FloatArray
    factor: FloatArray
    noise: FloatArray
    of_data: FloatArray
    correlation: FloatArray
    problems: tuple[Problem, ...]


class Weights(NamedTuple):
    """What makes the noise of the channels white and of size 1.

    Attributes:
        correlation: Coefficients of the channels' noise, (n, 3).
        deviation: Standard deviation of the white noise that drives it, (n,).
        known: Whether it is; else it is the size of the residuals.
        independent: Samples of all channels that this noise leaves independent.
        likely: Other noise that the recording does not rule out, see `Noise.likely`,
            (S, n, ORDER + 1): coefficients, then deviation; none without noise.
    """

    correlation: FloatArray
    deviation: FloatArray
    known: bool
    independent: float
    likely: FloatArray


class _Triangle(NamedTuple):
    """Whitened rows of a recording, reduced by a QR factorization.

    Attributes:
        by_base_parameters: (m, 38).
        by_geometry: (m, count).
        by_suspects: (m, s).
        measured: (m,).
        samples: Rows that were reduced.
    """

    by_base_parameters: FloatArray
    by_geometry: FloatArray
    by_suspects: FloatArray
    measured: FloatArray
    samples: int


class _Linear(NamedTuple):
    """The recording as linear equations of the unknowns, about one of their values.

    Attributes:
        of_data: (m, count).
        rest: (m,).
    """

    of_data: FloatArray
    rest: FloatArray


class System:
    """A recording, and all that may explain it.

    Attributes:
        recording: What was measured.
        unknowns: The uncertain numbers.
        known: Base parameters of the payload, (38,).
        causes: What else may change the recording.
    """

    def __init__(
        self,
        recording: Recording,
        unknowns: Unknowns,
        known: FloatArray,
        causes: tuple[Suspect, ...],
    ) -> None:
        self.recording = recording
        self.unknowns = unknowns
        self.known = known
        self.causes = causes
        self._by_geometry = unknowns.by_geometry(
            recording.position,
            recording.velocity,
            recording.acceleration,
            recording.channels,
        )
        self._suspects = np.concatenate([cause.columns for cause in causes], axis=-1)

    def fitted(self) -> Fit:
        """Fit the unknowns within their intervals."""
        problems = self._problems()
        weights = self._weights(suspected=bool(problems))
        by_digits = np.eye(self.unknowns.count) / DEVIATION
        target_of_digits = np.zeros(self.unknowns.count)

        z = np.zeros(self.unknowns.count)
        for _ in range(_STEPS):
            linear = self._linear(self._triangle(weights), z)
            of_all = np.vstack([linear.of_data, by_digits])
            z = _within_bounds(of_all, np.append(linear.rest, target_of_digits))
            noise = self._residuals(z) + _LEAST_NOISE
            if not weights.known:
                weights = weights._replace(deviation=noise)

        return Fit(
            z=z,
            factor=self._factor(of_all, weights, z),
            noise=noise,
            of_data=linear.of_data,
            correlation=weights.correlation,
            problems=problems,
        )

    def _residuals(self, z: FloatArray) -> FloatArray:
        """Root of the mean square of what a fit leaves in each channel, (n,)."""
        base_parameters = self.unknowns.base_parameters(z) + self.known
        fitted = self.recording.regressor @ base_parameters + self._by_geometry @ z
        left_over = self.recording.measured - fitted
        return root_mean_square(left_over)

    def _columns(self, z: FloatArray) -> FloatArray:
        """Columns of unknowns, then suspects, then the rest, (N, n, count + s + 1)."""
        rest = self._rest(z)[..., None]
        return np.concatenate([self._of_unknowns(), self._suspects, rest], axis=-1)

    def _of_unknowns(self) -> FloatArray:
        """What each unknown changes, (N, n, count)."""
        by_base_parameters = self.recording.regressor @ self.unknowns.slope.T
        return by_base_parameters + self._by_geometry

    def _rest(self, z: FloatArray) -> FloatArray:
        """What the unknowns are to explain, linear about z, (N, n)."""
        at_zero = self._at_zero(z)
        return self.recording.measured - self.recording.regressor @ at_zero

    def _at_zero(self, z: FloatArray) -> FloatArray:
        """Base parameters at 0, linear about z, (38,)."""
        slope = self.unknowns.slope
        return self.unknowns.base_parameters(z) + self.known - z @ slope

    def _weights(self, suspected: bool) -> Weights:
        """Noise of each channel about the best fit.

        Args:
            suspected: Whether all suspects may be true, and numbers far beyond their
                intervals: otherwise a misfit would be taken for noise. Without them,
                slow noise is known better.
        """
        by_unknowns = self._of_unknowns()
        suspects = self._suspects
        if suspected:
            by_unknowns = _LOOSE * by_unknowns
        else:
            suspects = np.delete(suspects, slice(None), axis=-1)
        rest = self._rest(np.zeros(self.unknowns.count))
        size = float(root_mean_square(self.recording.measured).max())
        noise = [
            noise_of_channel(suspects[:, k], by_unknowns[:, k], of_channel, size)
            for k, of_channel in enumerate(rest.T)
        ]
        deviation = np.array([one.deviation for one in noise])
        if np.isnan(deviation).any():
            shape = (len(noise), ORDER)
            return Weights(
                correlation=np.zeros(shape),
                deviation=np.ones(len(noise)),
                known=False,
                independent=np.nan,
                likely=np.zeros((0, len(noise), ORDER + 1)),
            )
        likely = np.stack([one.likely for one in noise], axis=1)
        likely[..., -1] += _LEAST_NOISE
        if (deviation <= EXACT * size).any():
            likely = likely[:0]
        return Weights(
            correlation=np.array([one.coefficients for one in noise]),
            deviation=deviation + _LEAST_NOISE,
            known=True,
            independent=sum(one.independent for one in noise),
            likely=likely,
        )

    def _triangle(self, weights: Weights) -> _Triangle:
        """The recording's equations, whitened and reduced."""
        rows = self._rows()
        of_channels = [
            whitened(rows[:, k], weights.correlation[k]) / deviation
            for k, deviation in enumerate(weights.deviation.tolist())
        ]
        every_row = np.concatenate(of_channels)
        complete = every_row[np.isfinite(every_row).all(axis=1)]
        triangle = np.asarray(np.linalg.qr(complete, mode="r"))
        return self._split(triangle, len(complete))

    def _rows(self) -> FloatArray:
        """Columns of base parameters, geometry, suspects, measured, (N, n, k)."""
        parts = [
            self.recording.regressor,
            self._by_geometry,
            self._suspects,
            self.recording.measured[..., None],
        ]
        return np.concatenate(parts, axis=-1)

    def _split(self, triangle: FloatArray, samples: int) -> _Triangle:
        """The columns of `_rows` by their kinds."""
        widths = [
            self.recording.regressor.shape[-1],
            self.unknowns.count,
            self._suspects.shape[-1],
        ]
        base, geometry, suspects, last = np.split(triangle, np.cumsum(widths), axis=1)
        return _Triangle(
            by_base_parameters=base,
            by_geometry=geometry,
            by_suspects=suspects,
            measured=last.ravel(),
            samples=samples,
        )

    def _linear(self, triangle: _Triangle, z: FloatArray) -> _Linear:
        """The equations of the unknowns, linear about z."""
        by_base_parameters = triangle.by_base_parameters
        return _Linear(
            of_data=by_base_parameters @ self.unknowns.slope.T + triangle.by_geometry,
            rest=triangle.measured - by_base_parameters @ self._at_zero(z),
        )

    def _factor(
        self, of_all: FloatArray, weights: Weights, z: FloatArray
    ) -> FloatArray:
        """Factor of the covariance of z, over all likely noise, (count, count)."""
        if not len(weights.likely):
            _, singular, directions = np.linalg.svd(of_all, full_matrices=False)
            return np.asarray(directions.T / singular)

        count = self.unknowns.count
        prior = np.eye(count) / DEVIATION**2
        products = [lagged_products(rows) for rows in self._columns(z).swapaxes(0, 1)]
        estimates = []
        covariances = []
        for noise in weights.likely:
            squares = _squares(products, noise)
            covariance = np.linalg.inv(squares[:count, :count] + prior)
            estimates.append(covariance @ squares[:count, -1])
            covariances.append(covariance)
        between = np.cov(np.transpose(estimates), bias=True)
        values, vectors = np.linalg.eigh(np.mean(covariances, axis=0) + between)
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

    def _problems(self) -> tuple[Problem, ...]:
        """What the digits do not explain, and by which cause it could be explained."""
        recording = self.recording
        weights = self._weights(suspected=True)
        if not weights.known:
            return (untested(len(recording.measured)),)
        floor = _HARMLESS * root_mean_square(recording.measured)
        deviation = np.maximum(weights.deviation, floor)
        triangle = self._triangle(weights._replace(deviation=deviation))
        best = [self._equations(triangle, weights.independent)]
        found = [*named_causes(best, self.causes), *contradiction(best)]
        if not found or (weights.deviation <= floor).any():
            return ranked(found)

        # What is found must hold for other noise that is likely, too.
        products = [lagged_products(rows) for rows in self._rows().swapaxes(0, 1)]
        for noise in weights.likely:
            other = self._split(_root(_squares(products, noise)), triangle.samples)
            best.append(self._equations(other, weights.independent))
        confirmed = [*named_causes(best, self.causes), *contradiction(best)]
        return ranked(
            problem
            for problem in confirmed
            if any(problem.name == one.name for one in found)
        )

    def _equations(self, triangle: _Triangle, independent: float) -> Equations:
        """The equations of unknowns and suspects, about the best unknowns."""
        count = self.unknowns.count
        by_digits = np.eye(count) / DEVIATION
        no_prior = np.zeros(count)
        linear = self._linear(triangle, no_prior)
        restricted = np.vstack([linear.of_data, by_digits])
        z = _within_bounds(restricted, np.append(linear.rest, no_prior))
        linear = self._linear(triangle, z)

        # The last rows of the triangle are what no base parameters can explain.
        singular = np.linalg.svd(triangle.by_base_parameters, compute_uv=False)
        rank = int((singular > RANK * singular[0]).sum())
        faint = np.vstack([linear.of_data, _FAINT * by_digits])
        best = _within_bounds(faint, np.append(linear.rest, no_prior))
        basis = np.linalg.svd(triangle.by_base_parameters, full_matrices=False)[0]
        distance = basis[:, :rank].T @ (linear.rest - linear.of_data @ best)

        zeros = np.zeros((count, self._suspects.shape[-1]))
        return Equations(
            restricted=np.vstack([linear.of_data, by_digits]),
            of_suspects=np.vstack([triangle.by_suspects, zeros]),
            rest=np.append(linear.rest, no_prior),
            squared=float(distance @ distance),
            rank=rank,
            samples=triangle.samples,
            independent=independent,
        )


def lagged_products(rows: FloatArray) -> FloatArray:
    """Sums of products of rows with the ORDER rows before, without missing ones.

    Args:
        rows: (N, k), more than ORDER.

    Returns:
        (ORDER + 1, ORDER + 1, k, k).
    """
    count = len(rows) - ORDER
    shifts = [rows[ORDER - k : ORDER - k + count] for k in range(ORDER + 1)]
    lagged = np.stack(shifts, axis=1)
    complete = lagged[np.isfinite(lagged).all(axis=(1, 2))]
    flat = complete.reshape(len(complete), -1)
    shape = (ORDER + 1, rows.shape[1], ORDER + 1, rows.shape[1])
    return (flat.T @ flat).reshape(shape).swapaxes(1, 2)


def _squares(products: list[FloatArray], noise: FloatArray) -> FloatArray:
    """Sums of products of the whitened columns of all channels, (k, k)."""
    total = np.zeros(products[0].shape[2:])
    for of_channel, (*coefficients, deviation) in zip(products, noise, strict=True):
        weights = np.append(1.0, np.negative(coefficients)) / deviation
        total += np.tensordot(np.multiply.outer(weights, weights), of_channel, 2)
    return total


def _root(squares: FloatArray) -> FloatArray:
    """A matrix whose columns have these products, (k, k)."""
    sizes = np.sqrt(np.maximum(np.diag(squares), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(squares / np.outer(sizes, sizes))
    roots = np.sqrt(np.maximum(values, 0.0))
    return np.asarray(roots[:, None] * vectors.T * sizes)


def _within_bounds(equations: FloatArray, target: FloatArray) -> FloatArray:
    """The scaled numbers within -1 to 1 that solve equations best, (count,)."""
    from scipy.optimize import lsq_linear

    found = lsq_linear(equations, target, bounds=(-1.0, 1.0), method="bvls")
    return np.asarray(found.x)
