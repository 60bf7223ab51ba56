"""The most probable numbers of an arm, by what was known and what was measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.possible_bodies import PossibleBodies
from alpha5_model.studies.calibration.unknowns import NAMES, ArmUnknowns

#: Steps of the search, and how often each is halved at most.
_STEPS = 30
_HALVINGS = 12
#: The search ends at steps, in standard deviations, and gains that are smaller.
_TOLERANCE = 1e-10
#: The search goes no further from the prior, in its standard deviations.
_FARTHEST = 12.0
#: Directions whose variance shrinks by less than this share are left out.
_LEAST_GAIN = 1e-6


class Estimate(NamedTuple):
    """The most probable unknowns, and how well they are known.

    Attributes:
        values: (K,).
        squared: Least sum of squares of residuals and of changes from the prior, each
            in standard deviations. If the model holds, it is chi-squared with as many
            degrees of freedom as there are readings.
        readings: How many there are.
        factor: With the prior's standard deviations D, the covariance is
            ``D (1 - F F^T) D``, (K, r).
    """

    values: FloatArray
    squared: float
    readings: int
    factor: FloatArray

    def deviation(self, prior: FloatArray) -> FloatArray:
        """Standard deviations, (K,), by those of the prior."""
        left = 1.0 - (self.factor**2).sum(axis=1)
        return np.asarray(prior * np.sqrt(np.maximum(left, 0.0)))


def estimate(equations: Equations) -> Estimate:
    """The most probable unknowns of some readings.

    Unknowns stay within 12 standard deviations of the prior, so that even the wrong
    readings leave an arm.
    """
    unknowns = equations.unknowns
    prior = equations.deviation
    chosen = np.flatnonzero(prior)
    bodies = PossibleBodies(unknowns.arm, equations.middle, prior)

    def free(z: FloatArray) -> FloatArray:
        whole = np.zeros_like(prior)
        whole[chosen] = z
        return whole

    def misfit(z: FloatArray) -> FloatArray:
        values = bodies.values(free(z))
        change = (values - equations.middle)[chosen] / prior[chosen]
        return np.concatenate([equations.residuals(values), change])

    def slopes(z: FloatArray) -> FloatArray:
        by_free = bodies.slopes(free(z))[:, chosen]
        values = bodies.values(free(z))
        of_readings = -equations.matrix(values) @ by_free
        return np.vstack([of_readings, by_free[chosen] / prior[chosen, None]])

    z, squared = _searched(misfit, slopes, len(chosen))
    values = bodies.values(free(z))
    matrix = equations.matrix(values)[:, chosen] * prior[chosen]
    factor = _factor(matrix, chosen, len(prior))
    untold = ~_told(factor)
    values[untold] = equations.middle[untold]
    return Estimate(
        values=values,
        squared=squared,
        readings=len(matrix),
        factor=factor,
    )


def _searched(
    misfit: Callable[[FloatArray], FloatArray],
    slopes: Callable[[FloatArray], FloatArray],
    count: int,
) -> tuple[FloatArray, float]:
    """The least sum of squares by Gauss's and Newton's steps: where, and its value."""
    z = np.zeros(count)
    rest = misfit(z)
    squared = float(rest @ rest)
    for _ in range(_STEPS):
        step = np.linalg.lstsq(slopes(z), -rest, rcond=None)[0]
        for _ in range(_HALVINGS):
            tried = np.clip(z + step, -_FARTHEST, _FARTHEST)
            left = misfit(tried)
            if left @ left <= squared:
                break
            step = step / 2
        else:
            return z, squared
        moved = float(np.abs(tried - z).max())
        gained = squared - float(left @ left)
        z, rest, squared = tried, left, squared - gained
        if moved < _TOLERANCE or gained <= _TOLERANCE * squared:
            return z, squared
    return z, squared


def _told(factor: FloatArray) -> BoolArray:
    """Which unknowns the readings say anything of, (K,) bool."""
    return np.asarray((factor**2).sum(axis=1) > _LEAST_GAIN)


def _factor(matrix: FloatArray, chosen: Any, count: int) -> FloatArray:
    """F of `Estimate`: with A = U s V^T, 1 - F F^T is the inverse of 1 + A^T A."""
    _, singular, directions = np.linalg.svd(matrix, full_matrices=False)
    share = singular**2 / (1.0 + singular**2)
    kept = share > _LEAST_GAIN
    factor = np.zeros((count, int(kept.sum())))
    factor[chosen] = directions[kept].T * np.sqrt(share[kept])
    return factor


def calibrated_arm(
    unknowns: ArmUnknowns, found: Estimate, sources: Sequence[str]
) -> Alpha5Parameters:
    """The arm's record with its new numbers, their half widths and covariance."""
    values = found.values[: len(NAMES)]
    covariance = arm_covariance(unknowns, found)
    record = unknowns.record(values)
    source = f"calibrated: {', '.join(sources)}"
    others = [
        one for one in record.measurements if one.key not in covariance.half_widths
    ]
    measured = [
        Measurement(key=key, source=source, half_width=half_width)
        for key, half_width in covariance.half_widths.items()
    ]
    return replace(record, measurements=(*others, *measured), covariance=covariance)


def arm_covariance(unknowns: ArmUnknowns, found: Estimate) -> Covariance:
    """The covariance of an arm's numbers, all others of a session averaged out."""
    told = _told(found.factor[: len(NAMES)])
    loose = np.full_like(told, unknowns.prior == "loose")
    rows = np.flatnonzero((unknowns.deviation > 0) & (told | loose))
    left, singular, _ = np.linalg.svd(found.factor[rows], full_matrices=False)
    kept = singular**2 > _LEAST_GAIN
    return Covariance(
        names=tuple(NAMES[row] for row in rows),
        deviation=unknowns.deviation[rows],
        factor=left[:, kept] * singular[kept],
    )
