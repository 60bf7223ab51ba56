"""Size of a body of the tables, from its bounds."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import LinkParameters

#: A guessed solid may be larger than the body by this factor.
SIZE_SLACK = 1.25


def body_radius(link: LinkParameters) -> float:
    """Half the least width of a body: all are turned parts [m]."""
    return float(np.ptp(link.bounds, axis=1).min() / 2)


def largest_sizes(link: LinkParameters) -> FloatArray:
    """Largest sides of a solid that was guessed for the body, sorted, (3,) [m]."""
    return np.sort(SIZE_SLACK * np.ptp(link.bounds, axis=1))
