"""Numbers that are computed, as files have them: the same on every processor.

The last digits of a sum, a sine or an eigenvector differ between processors and
versions of LAPACK. Computed numbers are therefore written with 12 significant digits.
Numbers of the arm's record, most of them printed, are written as they are.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray

#: Significant digits of a computed number.
DIGITS = 12
#: Digits of the largest number of several beyond which all of them are noise.
_NOISE = 15


def rounded(values: ArrayLike, largest_digits: int = _NOISE) -> FloatArray:
    """Numbers of one quantity with `DIGITS` significant digits each.

    Args:
        values: One number, or several that are added to one another.
        largest_digits: No number has more decimal places than the largest one with so
            many digits: what cancels becomes zero.
    """
    array = np.asarray(values, dtype=np.float64)
    numbers = array.ravel().tolist()
    last_place = largest_digits - 1 - max(map(_exponent, numbers), default=0)
    result = []
    for number in numbers:
        places = min(DIGITS - 1 - _exponent(number), last_place)
        # Adding zero turns a negative zero into zero.
        result.append(round(number, places) + 0.0)
    return np.reshape(result, array.shape)


def _exponent(number: float) -> int:
    """Power of ten of the first digit; very small for zero."""
    return math.floor(math.log10(abs(number))) if number else -300


def quaternion(rotation: FloatArray) -> list[float]:
    """Rounded quaternion (w, x, y, z) of a rotation (3, 3).

    Of the two, the one whose first number that is not zero is positive.
    """
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    numbers = rounded([w, x, y, z], largest_digits=DIGITS).tolist()
    first = next(number for number in numbers if number)
    return numbers if first > 0 else [0.0 - number for number in numbers]
