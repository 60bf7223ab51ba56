"""Effects of the printed digits on any result: number by number, and all at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count, float_array
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers
from alpha5_model.studies.uncertainty.printed import Names
from alpha5_model.studies.uncertainty.sampling import sample

#: A result of a parameter set: a number or an array.
Result = Callable[[Alpha5Parameters], ArrayLike]


class Sensitivity(NamedTuple):
    """The effect of each printed number on a result, to first order.

    Attributes:
        names: Of the printed numbers, (K,).
        nominal: The result at the middle of all intervals, (...).
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


def sensitivity(
    result: Result, alternatives: Names = (), arm: Alpha5Parameters | None = None
) -> Sensitivity:
    """How much a result depends on each printed number.

    Args:
        result: Function of a parameter set that returns a number or an array, such as
            ``lambda p: arm(p).hydrostatic_torque(q)``.
        alternatives: Names of `ALTERNATIVES` to believe.
        arm: Record of an arm of your own; None for the catalogue's. The half widths of
            its file replace those of the digits, and all that have one are varied:
            zeros, tool, mount and limits, too.

    Raises:
        InputError: A result with numbers that are not finite, or alternatives for an
            arm of your own.
    """
    chosen = printed.believed(alternatives)
    numbers = arm_numbers(chosen_arm(arm), chosen)
    if numbers.offset is not None:
        return _sensitivity_of_own(result, numbers)

    intervals = printed.numbers(chosen)
    # An alternative can move the middle away from the printed number.
    middle = {
        name: number.value
        for name, number in intervals.items()
        if number.value != number.printed.si
    }

    def result_with(values: dict[str, float]) -> FloatArray:
        parameters = printed.parameter_set(middle | values, chosen)
        return float_array("result", result(parameters), ())

    effects = []
    for name, number in intervals.items():
        upper = result_with({name: number.upper})
        lower = result_with({name: number.lower})
        effects.append((upper - lower) / 2)
    return Sensitivity(
        names=tuple(intervals), nominal=result_with({}), effects=np.array(effects)
    )


def _sensitivity_of_own(result: Result, numbers: ArmNumbers) -> Sensitivity:
    """`sensitivity` of an arm of one's own."""

    def result_with(change: FloatArray) -> FloatArray:
        parameters = numbers.parameters(numbers.middle + change)
        return float_array("result", result(parameters), ())

    nominal = result_with(np.zeros(numbers.middle.size))
    effects = []
    for change in np.diag(numbers.half_width):
        if not change.any():
            effects.append(np.zeros_like(nominal))
            continue
        effects.append((result_with(change) - result_with(-change)) / 2)
    return Sensitivity(names=numbers.names, nominal=nominal, effects=np.array(effects))


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
