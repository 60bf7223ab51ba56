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
from scipy.special import expit, logit

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.arm_numbers import PER_BODY
from alpha5_model.studies.printed_digits import UPPER

#: Of the numbers of a body.
_MASS, _COM, _INERTIA, _VOLUME = 0, 1, slice(4, 10), 10
#: Exponents beyond this are cut: no body is e^30 times as heavy.
_LARGEST = 30.0
_ROWS, _COLUMNS = np.transpose([*UPPER.values()])


def possible_values(
    arm: Alpha5Parameters, middle: FloatArray, deviation: FloatArray, free: FloatArray
) -> FloatArray:
    """Values (K,) that free numbers (K,) stand for: near 0, ``middle + deviation free``.

    Args:
        arm: Record, whose bounds hold the centres of mass.
        middle: Values at 0, those of the bodies first, (K,).
        deviation: The scale of each free number, (K,). Where it is 0, the value stays.
        free: (K,).
    """
    values = middle + deviation * free
    for body, link in enumerate(arm.links):
        own = slice(body * PER_BODY, (body + 1) * PER_BODY)
        at, by, z = middle[own], deviation[own], free[own]
        possible = values[own]
        for k in (_MASS, _VOLUME):
            if at[k] > 0.0:
                exponent = np.clip(by[k] / at[k] * z[k], -_LARGEST, _LARGEST)
                possible[k] = at[k] * np.exp(exponent)
        for k, (lower, upper) in enumerate(link.bounds, _COM):
            if lower < at[k] < upper and by[k]:
                width = upper - lower
                share = (at[k] - lower) / width
                steepness = by[k] / (width * share * (1.0 - share))
                exponent = np.clip(steepness * z[k], -_LARGEST, _LARGEST)
                possible[k] = lower + width * expit(logit(share) + exponent)
        if by[_INERTIA].any():
            possible[_INERTIA] = _inertia(at[_INERTIA], by[_INERTIA], z[_INERTIA])
    return values


def _inertia(middle: FloatArray, deviation: FloatArray, free: FloatArray) -> FloatArray:
    """Moments of inertia with positive second moments, (6,)."""
    if not free.any():
        return middle
    tensor = np.empty((3, 3))
    tensor[_ROWS, _COLUMNS] = middle
    tensor[_COLUMNS, _ROWS] = middle
    second = np.trace(tensor) / 2 * np.eye(3) - tensor
    triangle = np.zeros((3, 3))
    triangle[np.tril_indices(3)] = deviation.max() / np.trace(second) * free
    grown = np.exp(np.clip(np.diag(triangle), -_LARGEST, _LARGEST))
    np.fill_diagonal(triangle, grown)
    moved = np.linalg.cholesky(second) @ triangle
    second = moved @ moved.T
    tensor = np.trace(second) * np.eye(3) - second
    return np.asarray(tensor[_ROWS, _COLUMNS])
