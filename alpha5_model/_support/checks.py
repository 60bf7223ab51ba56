"""Input checks: each returns the value in the type for computations, or raises."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model.errors import InputError, NonFiniteError, ShapeError, UnknownNameError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Kind = TypeVar("Kind")

#: A name that URDF, ROS and the simulators all take.
_PLAIN_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
#: Types of numbers that need no further check in a list.
_NUMBERS = {float, int, np.float64}
#: Largest error of a rotation matrix, entrywise in ``R R^T``, and of the norm of a
#: quaternion. URDFs and logs print about seven digits.
ROTATION_TOLERANCE = 1e-6
#: The largest number that dynamics, inertia and actuators compute with, in SI units. A
#: term has at most five such factors (energy: mass, length twice, speed twice), so it
#: does not overflow. The sixth root leaves room for sums.
LARGEST = sys.float_info.max ** (1 / 6)
#: Two turns: larger joint angles are most likely degrees [rad].
MOST_ANGLE = 4 * math.pi


def float_array(name: str, value: ArrayLike, trailing: tuple[int, ...]) -> FloatArray:
    """Check and convert an array with fixed last axes and free leading axes.

    Args:
        name: Name of the argument, for the message.
        value: Anything that NumPy reads as real numbers, without a mask or a unit,
            which NumPy would drop.
        trailing: Expected trailing shape; ``(3,)`` accepts (3,), (N, 3), (..., 3).

    Returns:
        A float64 array of shape (..., \\*trailing), C-contiguous and aligned, as
        compiled code reads it; the caller's own array if it already is one.

    Raises:
        InputError: Not real numbers (strings, complex, truth values, ragged lists,
            None), or not only numbers (masked arrays and other subclasses of NumPy's,
            quantities with a unit).
        ShapeError: Wrong trailing shape.
        NonFiniteError: NaN or infinity; the first bad index is named.
    """
    try:
        array = np.asarray(value) if _holds_only_numbers(value) else None
    except Exception:  # __array__ may raise anything
        array = None
    if array is None or array.dtype.kind not in "fiu":
        raise InputError(name, value, "an array of real numbers, without mask or unit")

    if array.dtype != np.float64:
        # A long double may overflow, a NaN may signal: both are named below.
        with np.errstate(over="ignore", invalid="ignore"):
            array = array.astype(np.float64)
    # A view, a mapped file or a column of records may be neither.
    if not (array.flags.c_contiguous and array.flags.aligned):
        array = array.copy()

    leading = array.ndim - len(trailing)
    if leading < 0 or array.shape[leading:] != trailing:
        shape = ", ".join(["...", *map(str, trailing)])
        raise ShapeError(name, array.shape, f"shape ({shape})")
    if not np.isfinite(array).all():
        first = np.argwhere(~np.isfinite(array))[0]
        index = tuple(int(i) for i in first)
        raise NonFiniteError(name, float(array[index]), index)
    return array


def _holds_only_numbers(value: Any) -> bool:
    """Whether a value holds only numbers, at any depth of lists.

    NumPy would drop masks and units silently.
    """
    if type(value) in (np.ndarray, np.float64, float, int):
        return True
    if isinstance(value, list | tuple):
        # Usually a flat list, which this settles quickly.
        if set(map(type, value)) <= _NUMBERS:
            return True
        return all(map(_holds_only_numbers, value))
    has_unit = hasattr(value, "unit") or hasattr(value, "units")
    is_other = isinstance(
        value, np.ma.MaskedArray | bool | np.bool_ | bytes | bytearray
    )
    return not has_unit and not is_other


def shaped(name: str, value: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """`float_array` without leading axes.

    Raises:
        InputError: Not finite real numbers; ShapeError: not exactly this shape.
    """
    array = float_array(name, value, ())
    if array.shape != shape:
        raise ShapeError(name, array.shape, f"shape {shape}")
    return array


def bounded(name: str, array: FloatArray) -> FloatArray:
    """Check that finite numbers are small enough to compute with.

    Raises:
        InputError: A magnitude above `LARGEST`.
    """
    if array.size and max(array.max(), -array.min()) > LARGEST:
        worst = float(array.flat[np.abs(array).argmax()])
        expected = f"numbers of at most {LARGEST:.1e}, else results overflow"
        raise InputError(name, worst, expected)
    return array


def array(name: str, value: ArrayLike, *shape: int) -> FloatArray:
    """Check and convert an array of one shape: `shaped` and `bounded`."""
    return bounded(name, shaped(name, value, shape))


def real(
    name: str, value: Any, minimum: float | None = None, strict: bool = False
) -> float:
    """Check and convert one finite real number that can be computed with.

    Args:
        minimum: The least number that is allowed; None for any.
        strict: Whether ``minimum`` itself is refused.

    Raises:
        InputError: Not a real number, too large, or below ``minimum`` (at it, if
            ``strict``).
        NonFiniteError: NaN or infinity.
    """
    array = float_array(name, value, ())
    if array.ndim != 0:
        raise InputError(name, value, "one real number")
    number = float(bounded(name, array))
    if minimum is not None and (number < minimum or (strict and number == minimum)):
        bound = "above" if strict else "of at least"
        raise InputError(name, value, f"a number {bound} {minimum:g}")
    return number


def flag(name: str, value: Any) -> bool:
    """Check True or False.

    The truth of 1, "no" or an array may not be what the caller meant.

    Raises:
        InputError: Anything else.
    """
    if not isinstance(value, bool | np.bool_):
        raise InputError(name, value, "True or False")
    return bool(value)


def instance(name: str, value: Any, kind: type[Kind]) -> Kind:
    """Check that a value is of a class.

    Raises:
        InputError: It is not.
    """
    if not isinstance(value, kind):
        article = "an" if kind.__name__.startswith(tuple("AEIO")) else "a"
        raise InputError(name, value, f"{article} {kind.__name__}")
    return value


def listed(name: str, value: Any, expected: str) -> list[Any]:
    """The items of an iterable.

    Raises:
        InputError: Not an iterable, such as a number or None.
    """
    try:
        return list(value)
    except TypeError:
        raise InputError(name, value, expected) from None


def fitting(**given: tuple[ArrayLike, tuple[int, ...]]) -> list[FloatArray]:
    """Arrays of real numbers with given last axes, whose leading axes broadcast.

    Raises:
        InputError: Not finite real numbers; ShapeError: of shapes that do not fit.
    """
    arrays = []
    leading_shapes = []
    for name, (value, trailing) in given.items():
        array = float_array(name, value, trailing)
        arrays.append(array)
        leading_shapes.append(array.shape[: array.ndim - len(trailing)])

    try:
        np.broadcast_shapes(*leading_shapes)
    except ValueError:
        shapes = tuple(array.shape for array in arrays)
        expected = "leading shapes that broadcast"
        raise ShapeError(", ".join(given), shapes, expected) from None
    return arrays


def together(**values: ArrayLike) -> list[FloatArray]:
    """Arrays of real numbers, broadcast to one shape.

    Raises:
        InputError: Not finite real numbers; ShapeError: of shapes that do not
            broadcast.
    """
    scalars = {name: (value, ()) for name, value in values.items()}
    return list(np.broadcast_arrays(*fitting(**scalars)))


def generator(seed: Any) -> np.random.Generator:
    """A generator of random numbers.

    Raises:
        InputError: Not a seed that NumPy takes: a whole number, not negative.
    """
    try:
        return np.random.default_rng(seed)
    except (TypeError, ValueError):
        raise InputError("seed", seed, "a whole number, not negative") from None


def count(name: str, value: Any) -> int:
    """Check a whole number of at least 1.

    Raises:
        InputError: Anything else, True and 1.0 included.
    """
    expected = "a whole number of at least 1"
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(name, value, expected)
    if not 1 <= value <= sys.maxsize:
        raise InputError(name, value, expected)
    return value


def choice(kind: str, name: Any, choices: Sequence[str]) -> str:
    """Check a name against the ones that exist.

    Raises:
        UnknownNameError: Not one of ``choices``.
    """
    if not isinstance(name, str) or name not in choices:
        raise UnknownNameError(kind, name, choices)
    return name


def named(kind: str, names: Any, choices: Sequence[str]) -> tuple[str, ...]:
    """Check names; they are returned in the order of the choices, without repetition.

    Raises:
        InputError: Not a collection of names.
        UnknownNameError: A name that is not one of ``choices``.
    """
    expected = f"a tuple of names, such as ({choices[0]!r},)"
    if isinstance(names, str):
        raise InputError(f"{kind}s", names, expected)
    given = listed(f"{kind}s", names, expected)
    asked = {choice(kind, name, choices) for name in given}
    return tuple(name for name in choices if name in asked)


def plain_name(name: str, value: Any) -> str:
    """Check a name of letters, digits and underscores.

    Args:
        name: Of the argument, for the message.
        value: What was given.

    Raises:
        InputError: Anything else, or more than 64 characters.
    """
    if not isinstance(value, str) or not _PLAIN_NAME.fullmatch(value):
        expected = "a name of at most 64 letters, digits and _, a letter first"
        raise InputError(name, value, expected)
    return value


def frozen(array: ArrayLike) -> FloatArray:
    """A float64 copy that cannot be made writeable: its memory is that of bytes."""
    given = np.asarray(array, dtype=np.float64)
    return np.ndarray(given.shape, np.float64, given.tobytes())


def fill(record: Any, **values: Any) -> None:
    """Set the checked fields of a frozen record in its ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(record, name, value)


def is_rotation(matrix: FloatArray) -> BoolArray:
    """Which matrices (..., 3, 3) are rotations, within `ROTATION_TOLERANCE`."""
    with np.errstate(all="ignore"):
        product = matrix @ np.swapaxes(matrix, -1, -2)
        off = np.abs(product - np.eye(3)).max(axis=(-2, -1))
        keeps_hand = np.linalg.det(matrix) > 0
        return np.asarray((off <= ROTATION_TOLERANCE) & keeps_hand)


def is_rigid(transform: FloatArray) -> BoolArray:
    """Which matrices (..., 4, 4) are a rotation, a translation and 0 0 0 1."""
    last_row_fits = (transform[..., 3, :] == (0, 0, 0, 1)).all(axis=-1)
    return np.asarray(is_rotation(transform[..., :3, :3]) & last_row_fits)


def rigid_transform(name: str, value: ArrayLike) -> FloatArray:
    """Check one rigid transform (`is_rigid`).

    Returns:
        A read-only copy, (4, 4).

    Raises:
        InputError: Anything else.
    """
    transform = float_array(name, value, (4, 4))
    if transform.shape != (4, 4) or not is_rigid(transform):
        raise InputError(name, transform.tolist(), "one rigid transform, (4, 4)")
    return frozen(transform)
