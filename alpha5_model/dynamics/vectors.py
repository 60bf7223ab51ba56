"""Input checks that cost a tenth of the microsecond that Pinocchio needs.

``isfinite(sum(x.tolist()))`` tells a clean vector in 0.1 us where ``numpy.isfinite(x).all()`` takes 1 us. A
vector that is not plainly clean (a list, integers, a wrong shape, NaN, a sum that overflows) takes the
slow road through `vector`, which converts it or says what is wrong.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.errors import InputError, NonFiniteError, ShapeError

_FLOAT64 = np.dtype(np.float64)


def ready(x: Any, n: int) -> bool:
    """Whether x is a finite float64 array of shape (n,)."""
    try:
        # A second axis makes the list one of lists, which sum() refuses.
        return x.dtype is _FLOAT64 and len(x) == n and isfinite(sum(x.tolist()))
    except (AttributeError, TypeError):
        return False


def ready_2(x: Any, y: Any, n_x: int, n_y: int) -> bool:
    """`ready` for two vectors at once."""
    try:
        return (
            x.dtype is y.dtype is _FLOAT64
            and len(x) == n_x
            and len(y) == n_y
            and isfinite(sum(x.tolist() + y.tolist()))
        )
    except (AttributeError, TypeError):
        return False


def ready_3(x: Any, y: Any, z: Any, n_x: int, n_yz: int) -> bool:
    """`ready` for three vectors at once; the second and third are equally long."""
    try:
        return (
            x.dtype is y.dtype is z.dtype is _FLOAT64
            and len(x) == n_x
            and len(y) == len(z) == n_yz
            and isfinite(sum(x.tolist() + y.tolist() + z.tolist()))
        )
    except (AttributeError, TypeError):
        return False


def vector(name: str, value: ArrayLike, n: int) -> FloatArray:
    """Check and convert one vector.

    Raises:
        InputError: Not real numbers.
        ShapeError: Not of shape (n,).
        NonFiniteError: NaN or infinity.
    """
    if np.shape(value) not in ((n,), ()):  # () is left to float_array, which tells what else it is
        raise ShapeError(name, np.shape(value), f"shape ({n},)")
    array = float_array(name, value, (n,))
    return array


def forces(fext: Any, njoints: int) -> Any:
    """Check and convert external forces, one for each joint, in the joint's frame.

    Returns:
        pin.StdVec_Force of length njoints.

    Raises:
        InputError: Not a sequence of ``njoints`` pin.Force.
        NonFiniteError: NaN or infinity in a force.
    """
    try:
        count = len(fext)
        if not all(isinstance(force, pin.Force) for force in fext):
            count = -1
    except TypeError:
        count = -1
    if count != njoints:
        raise InputError("fext", fext, f"{njoints} pin.Force, one for each joint and the universe")
    for joint, force in enumerate(fext):
        if not isfinite(sum(force.vector.tolist())):
            raise NonFiniteError("fext", force.vector.tolist(), (joint,))
    return fext if isinstance(fext, pin.StdVec_Force) else pin.StdVec_Force(list(fext))
