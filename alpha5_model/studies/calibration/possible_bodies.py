"""Free numbers in which every set of values is an arm of possible bodies.

Masses and volumes are exponentials, centres of mass stay within the bounds of their
body by a logistic function, and the second moments at the centre of mass are
``C L L^T C^T``, where C is the Cholesky factor of the prior's and L is a lower triangle
whose diagonal is an exponential [Rucker2022]. All other numbers are free already.

References:
    [Rucker2022] Rucker, Wensing: Smooth parameterization of rigid-body inertia, IEEE
        RA-L 7(2).
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.calibration.loads import SECOND_BY_INERTIA
from alpha5_model.studies.calibration.unknowns import PER_BODY
from alpha5_model.studies.uncertainty.linear_maps import SYMMETRIC, UPPER

#: Rows and columns of a lower triangle.
_LOWER = np.tril_indices(3)
#: Of the numbers of a body.
_INERTIA = slice(4, 10)
_VOLUME = 10
#: Exponents beyond this are cut: no body is e^30 times as heavy.
_LARGEST = 30.0


class PossibleBodies:
    """Free numbers, 0 at the middle, and the values that they stand for.

    Args:
        arm: Record, whose bounds hold the centres of mass.
        middle: Values beforehand, of the bodies first, (K,).
        deviation: Their standard deviations, (K,): the scale of the free numbers. Where
            it is 0, the value stays.
    """

    def __init__(
        self, arm: Alpha5Parameters, middle: FloatArray, deviation: FloatArray
    ) -> None:
        self._arm = arm
        self._middle = middle
        self._deviation = deviation

    def values(self, free: FloatArray) -> FloatArray:
        """The values (K,) of free numbers (K,)."""
        return self._of(free)[0]

    def slopes(self, free: FloatArray) -> FloatArray:
        """Derivative of the values by the free numbers, (K, K)."""
        return self._of(free)[1]

    def _of(self, free: FloatArray) -> tuple[FloatArray, FloatArray]:
        values = self._middle + self._deviation * free
        slopes = np.diag(self._deviation)
        for body, link in enumerate(self._arm.links):
            first = body * PER_BODY
            for number in (first, first + _VOLUME):
                self._positive(number, free, values, slopes)
            for axis in range(3):
                self._between(first + 1 + axis, link.bounds[axis], free, values, slopes)
            at = slice(first + _INERTIA.start, first + _INERTIA.stop)
            if self._deviation[at].any():
                values[at], slopes[at, at] = self._tensor(at, free)
        return values, slopes

    def _positive(
        self, k: int, free: FloatArray, values: FloatArray, slopes: FloatArray
    ) -> None:
        """A number above 0."""
        middle = self._middle[k]
        if middle > 0 and self._deviation[k]:
            share = self._deviation[k] / middle
            exponent = np.clip(share * free[k], -_LARGEST, _LARGEST)
            values[k] = middle * np.exp(exponent)
            slopes[k, k] = share * values[k]

    def _between(
        self,
        k: int,
        bounds: FloatArray,
        free: FloatArray,
        values: FloatArray,
        slopes: FloatArray,
    ) -> None:
        """A number between bounds, if it is not on one of them beforehand."""
        if self._middle[k] in bounds:
            return
        width = bounds[1] - bounds[0]
        share = (self._middle[k] - bounds[0]) / width
        steepness = self._deviation[k] / (width * share * (1.0 - share))
        exponent = np.clip(steepness * free[k], -_LARGEST, _LARGEST)
        odds = share / (1.0 - share) * np.exp(exponent)
        now = odds / (1.0 + odds)
        values[k] = bounds[0] + width * now
        slopes[k, k] = width * now * (1.0 - now) * steepness

    def _tensor(self, at: slice, free: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Moments of inertia with positive second moments, and their slopes."""
        middle = self._middle[at]
        tensor = middle[SYMMETRIC]
        second = np.trace(tensor) / 2 * np.eye(3) - tensor
        factor = np.linalg.cholesky(second)
        scale = self._deviation[at].max() / np.trace(second)

        triangle = np.zeros((3, 3))
        triangle[_LOWER] = scale * free[at]
        grown = np.exp(np.clip(np.diag(triangle), -_LARGEST, _LARGEST))
        np.fill_diagonal(triangle, grown)
        moved = factor @ triangle
        to_inertia = np.linalg.inv(SECOND_BY_INERTIA)
        values = (moved @ moved.T)[UPPER] @ to_inertia

        slopes = np.empty((6, 6))
        for column, (row, side) in enumerate(zip(*_LOWER, strict=True)):
            step = np.zeros((3, 3))
            step[row, side] = scale * (grown[row] if row == side else 1.0)
            half = factor @ step @ moved.T
            slopes[:, column] = (half + half.T)[UPPER] @ to_inertia
        if not free[at].any():
            values = middle  # to the bit
        return values, slopes
