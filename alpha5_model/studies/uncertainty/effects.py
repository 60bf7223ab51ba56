"""The effect of each uncertain number of an arm on any result."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count, float_array
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.sampling import sample

#: A result of a record: a number or an array.
Result = Callable[[Alpha5Parameters], ArrayLike]


class Sensitivity(NamedTuple):
    """The effect of each uncertain number on a result.

    Attributes:
        names: Of the numbers, (K,), as `PrintedNumber` and arm files have them.
        nominal: The result of the arm itself, (...).
        effects: Half the change of the result from the lower to the upper end of each
            interval, (K, ...).
    """

    names: tuple[str, ...]
    nominal: FloatArray
    effects: FloatArray

    @property
    def half_width(self) -> FloatArray:
        """The sum of the magnitudes of all effects, (...)."""
        return np.asarray(np.abs(self.effects).sum(axis=0))

    def most(self, *index: int, count: int = 5) -> tuple[tuple[str, float], ...]:
        """The numbers with the largest effects on ``nominal[index]``, and these."""
        effects = np.moveaxis(self.effects, 0, -1)[index]
        order = np.argsort(-np.abs(effects), kind="stable")[:count]
        return tuple((self.names[k], float(effects[k])) for k in order)


def sensitivity(result: Result, arm: Alpha5Parameters | None = None) -> Sensitivity:
    """How much a result depends on each uncertain number of an arm.

    Args:
        result: Function of a record that returns a number or an array, such as
            ``lambda p: arm(p).hydrostatic_torque(q)``.
        arm: Record of an arm of your own; None for the catalogue's. The half widths of
            its file replace those of the digits, and all that have one are varied:
            zeros, tool, mount and limits, too.

    Raises:
        InputError: A result with numbers that are not finite.
    """
    numbers = arm_numbers(chosen_arm(arm))

    def result_of(values: FloatArray) -> FloatArray:
        return float_array("result", result(numbers.record(values)), ())

    nominal = result_of(numbers.middle)
    effects = np.zeros((len(numbers.names), *nominal.shape))
    for k in np.flatnonzero(numbers.half_width):
        step = numbers.half_width[k] * (np.arange(len(effects)) == k)
        upper = result_of(numbers.middle + step)
        lower = result_of(numbers.middle - step)
        effects[k] = (upper - lower) / 2
    return Sensitivity(names=numbers.names, nominal=nominal, effects=effects)


class Spread(NamedTuple):
    """Spread of a sampled result.

    Attributes:
        mean: (...).
        standard_deviation: (...).
        standard_error: Of the mean, (...).
    """

    mean: FloatArray
    standard_deviation: FloatArray
    standard_error: FloatArray


def spread(result: Result, n: int = 1000, seed: int = 0, **options: Any) -> Spread:
    """Mean and spread of a result over the sets of `sample`.

    Args:
        result: As of `sensitivity`.
        n, seed, options: As of `sample`.
    """
    if count("n", n) < 2:
        raise InputError("n", n, "at least 2 sets")
    drawn = sample(n, seed, **options)
    found = np.array(
        [float_array("result", result(drawn.parameters(k)), ()) for k in range(n)]
    )
    deviation = found.std(axis=0, ddof=1)
    return Spread(
        mean=found.mean(axis=0),
        standard_deviation=deviation,
        standard_error=deviation / np.sqrt(n),
    )


def reach(parameters: Alpha5Parameters) -> float:
    """Longest distance from shoulder to tcp if no joint has limits [m].

    It is ``a_1 + hypot(a_2, d_3)``.
    """
    dh = parameters.dh
    return dh[1].a + float(np.hypot(dh[2].a, dh[3].d))
