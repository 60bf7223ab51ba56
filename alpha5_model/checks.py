"""Input checks, in one place: what comes in is a float array of the right shape, or an error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model.errors import InputError, NonFiniteError, ShapeError, UnknownNameError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def float_array(name: str, value: ArrayLike, trailing: tuple[int, ...]) -> FloatArray:
    """Check and convert an array whose last axes are fixed and whose leading axes are free.

    Args:
        name: Name of the argument, for the message.
        value: Anything NumPy can read as real numbers.
        trailing: Expected trailing shape; ``(3,)`` accepts (3,), (N, 3), (..., 3).

    Returns:
        A float64 array of shape (..., \\*trailing); the caller's own array if it already is one.

    Raises:
        InputError: Not real numbers (strings, complex, ragged lists, None).
        ShapeError: Wrong trailing shape.
        NonFiniteError: NaN or infinity; the first bad index is named.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        raise InputError(name, value, "an array of real numbers") from None
    if array.dtype.kind not in "fiu":
        raise InputError(name, value, "an array of real numbers")
    array = np.asarray(array, dtype=np.float64)
    if array.shape[array.ndim - len(trailing) :] != trailing or array.ndim < len(trailing):
        shape = "(" + ", ".join(["...", *map(str, trailing)]) + ")"
        raise ShapeError(name, array.shape, f"shape {shape}")
    if not _all_finite(array):
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise NonFiniteError(name, float(array[index]), index)
    return array


def _all_finite(array: FloatArray) -> bool:
    """Without a mask as long as the array: a sum is finite only if all its terms are."""
    if array.size > 4096:
        with np.errstate(over="ignore", invalid="ignore"):
            if np.isfinite(array.sum()):
                return True
    return bool(np.isfinite(array).all())


def real(name: str, value: Any, minimum: float | None = None, strict: bool = False) -> float:
    """Check and convert one finite real number, optionally bounded below.

    Raises:
        InputError: Not a real number, or below ``minimum`` (at it, if ``strict``).
        NonFiniteError: NaN or infinity.
    """
    array = float_array(name, value, ())
    if array.ndim != 0:
        raise InputError(name, value, "one real number")
    number = float(array)
    if minimum is not None and (number < minimum or (strict and number == minimum)):
        raise InputError(
            name, value, f"a number {'above' if strict else 'of at least'} {minimum:g}"
        )
    return number


def count(name: str, value: Any) -> int:
    """Check a whole number of at least 1.

    Raises:
        InputError: Anything else, True and 1.0 included.
    """
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(name, value, "a whole number of at least 1")
    return value


def choice(kind: str, name: Any, choices: Sequence[str]) -> str:
    """Check a name against the ones that exist.

    Raises:
        UnknownNameError: Not one of ``choices``.
    """
    if not isinstance(name, str) or name not in choices:
        raise UnknownNameError(kind, name, choices)
    return name


def frozen(array: ArrayLike) -> FloatArray:
    """A read-only float64 copy."""
    copy = np.array(array, dtype=np.float64)
    copy.flags.writeable = False
    return copy


def rigid_transform(name: str, value: ArrayLike) -> FloatArray:
    """Check one homogeneous transform: a rotation within 1e-9, a translation, a last row 0 0 0 1.

    Returns:
        A read-only copy, (4, 4).

    Raises:
        InputError: Anything else.
    """
    transform = float_array(name, value, (4, 4))
    rotation = transform[..., :3, :3]
    if (
        transform.shape != (4, 4)
        or not np.allclose(rotation @ rotation.T, np.eye(3), rtol=0, atol=1e-9)
        or np.linalg.det(rotation) < 0
        or not np.array_equal(transform[3], (0, 0, 0, 1))
    ):
        raise InputError(name, transform.tolist(), "one rigid transform, (4, 4)")
    return frozen(transform)
