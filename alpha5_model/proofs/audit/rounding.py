"""Figures that follow from printed numbers, with bounds of rounding and sampling.

References:
    [Cochran1977] Sampling Techniques, section 3.2: standard error of a sampled share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.numbers.quantity import Quantity


class Figure(NamedTuple):
    """A figure that follows from printed numbers.

    Attributes:
        value: Number or array.
        bound: How far it may be off because the numbers are rounded; of the same shape,
            not negative.
    """

    value: Any
    bound: Any


def si(printed: Sequence[Quantity]) -> FloatArray:
    """Printed numbers in SI units, (N,)."""
    return np.array([number.si for number in printed])


def figure(
    function: Callable[[FloatArray], Any], printed: Sequence[Quantity]
) -> Figure:
    """A figure, and how far it may be off because its printed inputs are rounded.

    The bound is the worst case, to first order: each input is moved by half a unit of
    its last printed digit, one at a time, and the changes of the result are added up.

    Args:
        function: From the inputs in SI units, (N,), to a result of any shape.
        printed: The N inputs.
    """
    inputs = si(printed)
    value = function(inputs)

    changes = []
    for step in np.diag([number.rounding for number in printed]):
        up = np.abs(function(inputs + step) - value)
        down = np.abs(function(inputs - step) - value)
        changes.append([up, down])
    return Figure(value=value, bound=np.max(changes, axis=1).sum(axis=0))


def sampled_share(hits: BoolArray) -> tuple[float, float]:
    """Share of True among independent samples (N,), and its standard error.

    The standard error is sqrt(p (1 - p) / N) [Cochran1977].
    """
    share = float(hits.mean())
    error = float(np.sqrt(share * (1 - share) / hits.size))
    return share, error
