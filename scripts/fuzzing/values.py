"""Values for the fuzz: good ones, ways to spoil them, and what is no answer."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

Rng = np.random.Generator

NUMBERS = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-9,
    1e-300,
    5e-324,
    1e9,
    1e154,
    1e300,
    -1e300,
    1.7976931348623157e308,
)
NOT_FINITE = (math.nan, math.inf, -math.inf)
#: Nothing of these is an array of real numbers, whatever the parameter.
NO_NUMBERS: tuple[Any, ...] = (
    "",
    "abc",
    "1",
    b"1",
    {},
    {1: 2},
    {1.0},
    object(),
    len,
    Path("x"),
    1 + 2j,
    [1, [2, 3]],
    [None],
    [[1.0], "a"],
    np.array(["1", "2", "3"]),
    np.array([1 + 1j, 0, 0]),
    np.array([None, 1, 2]),
    np.array("2020-01-01", "datetime64"),
    np.array([True, False, True]),
    np.zeros(3, [("x", float)]),
)
#: Odd, but someone may have a reason.
ODD: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    1,
    -1,
    2**70,
    -(2**63),
    3.7,
    Decimal("1.5"),
    Fraction(1, 3),
    [],
    (),
    [[]],
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros((3, 0)),
    np.zeros((2, 2, 2)),
    np.float32(1.5),
    np.int8(3),
    np.zeros(4, np.float16),
    np.eye(3, dtype=int),
    range(4),
)
TEXTS = (
    "",
    " ",
    "tcp",
    "link_3",
    "axis_b",
    "base_frame",
    "a\0b",
    "\udcff",
    "é",
    "a\nb",
    "${1/0}",
    "<x>",
    "nan",
    "x" * 5000,
    "locked",
    "jaws",
    "both",
    "printed",
    "[red]",
)


def pick(rng: Rng, choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def spoil(rng: Rng, value: Any) -> tuple[Any, bool]:
    """A value changed at random, and whether nothing but a refusal can be right."""
    array = value if isinstance(value, np.ndarray) and value.dtype == float else None
    way = int(rng.integers(10))
    if array is None or array.size == 0 or way < 2:
        return _another_value(rng, value, way)

    place = int(rng.integers(array.size))
    spoiled = _WAYS.get(way, _in_another_type)
    if spoiled is _in_another_shape and array.ndim == 0:
        spoiled = _in_another_type
    return spoiled(rng, array.copy(), place)


def _another_value(rng: Rng, value: Any, way: int) -> tuple[Any, bool]:
    """Another number for a number, else a value of another kind."""
    if isinstance(value, float) and way >= 4:
        number = pick(rng, NOT_FINITE if way < 6 else NUMBERS)
        return number, not math.isfinite(number)
    if way % 2:
        return pick(rng, ODD), False
    is_array = isinstance(value, np.ndarray) and value.dtype == float
    return pick(rng, NO_NUMBERS), is_array


def _with_infinity(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    array.flat[place] = pick(rng, NOT_FINITE)
    return array, True


def _with_another_number(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    array.flat[place] = pick(rng, NUMBERS)
    return array, False


def _scaled(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    factor = pick(rng, NUMBERS[5:]) if rng.integers(2) else 0.0
    with np.errstate(over="ignore"):
        scaled = array * factor
    return scaled, not np.isfinite(scaled).all()


def _masked(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    mask = np.zeros(array.shape, bool)
    mask.flat[place] = True
    return np.ma.MaskedArray(array, mask), True


def _in_another_shape(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    shapes = (
        array[..., :-1],
        array[..., None],
        np.moveaxis(array, 0, -1),
        array[None],
    )
    return pick(rng, shapes), False


def _with_no_number(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    nested = array.astype(object)
    nested.flat[place] = pick(rng, (None, "x", 1j, [1.0], {}))
    # [[1.0]] for [1.0] is another shape only.
    return nested.tolist(), array.size > 1


def _of_one_number(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    return np.full(array.shape, pick(rng, NUMBERS)), False


def _in_another_type(rng: Rng, array: np.ndarray, place: int) -> tuple[Any, bool]:
    types = (
        array.tolist(),
        array.astype(np.float32),
        np.asfortranarray(array),
        array.round().astype(int),
    )
    return pick(rng, types), False


#: Number drawn by `spoil` -> what it does to a copy of an array, at a place in it.
_WAYS: dict[int, Callable[[Rng, np.ndarray, int], tuple[Any, bool]]] = {
    2: _with_infinity,
    3: _with_another_number,
    4: _scaled,
    5: _masked,
    6: _in_another_shape,
    7: _with_no_number,
    8: _of_one_number,
}


def points(rng: Rng) -> np.ndarray:
    """One point or several, some of them special."""
    shape = pick(rng, ((3,), (1, 3), (4, 3), (2, 2, 3), (0, 3)))
    if rng.integers(4):
        return rng.normal(0, 0.3, shape)
    special = ((0.0, 0.0, 0.4), (0.0, 0.0, 0.0), (1e-12, 0.0, 0.5), (0.3, 0.0, 0.1))
    return np.broadcast_to(pick(rng, special), shape).copy()


def angles(n: int) -> Callable[[Rng], np.ndarray]:
    def draw(rng: Rng) -> np.ndarray:
        shape = pick(rng, ((n,), (1, n), (3, n))) if rng.integers(3) == 0 else (n,)
        return rng.uniform(-1.0, 6.5, shape)

    return draw


def number(low: float, high: float) -> Callable[[Rng], float]:
    return lambda rng: float(rng.uniform(low, high))


def tensor(rng: Rng) -> np.ndarray:
    """Inertia of a possible body, or of two, (3, 3) or (2, 3, 3)."""
    bodies = pick(rng, ((), (2,)))
    spread = rng.normal(0, 0.05, (*bodies, 3, 3))
    second = spread @ np.swapaxes(spread, -1, -2)
    trace = np.trace(second, axis1=-2, axis2=-1)[..., None, None]
    return trace * np.eye(3) - second


def rotation(rng: Rng) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def transform(rng: Rng) -> np.ndarray:
    out = np.eye(4)
    out[:3, :3] = rotation(rng)
    out[:3, 3] = rng.normal(0, 0.3, 3)
    return out


def wrong_answers(
    result: Any, ignored: frozenset[str], place: str = ""
) -> Iterator[str]:
    """Places of NaN or infinity in an answer.

    Args:
        result: The answer.
        ignored: Parts that may be infinite; ``the answer`` stands for all of it.
        place: Of the result in the whole answer.
    """
    if "the answer" in ignored:
        return
    numbers = _as_numbers(result)
    if numbers is not None:
        if not np.isfinite(numbers).all():
            yield place or "the answer"
        return
    for name, part in _parts(result):
        if name.lstrip(".") not in ignored:
            yield from wrong_answers(part, ignored, f"{place}{name}")


def _as_numbers(result: Any) -> np.ndarray | None:
    """The numbers of an answer that has no parts; None if it has none, or has parts."""
    if isinstance(result, np.ndarray):
        return result if result.dtype.kind == "f" else None
    if isinstance(result, float):
        return np.array(result)
    if _is_record(result) or isinstance(result, dict | tuple | list):
        return None
    if hasattr(result, "homogeneous"):
        return np.asarray(result.homogeneous)
    if type(result).__name__ in ("Force", "Motion") and hasattr(result, "vector"):
        return np.asarray(result.vector)
    return None


def _is_record(result: Any) -> bool:
    return dataclasses.is_dataclass(result) or hasattr(result, "_asdict")


def _parts(result: Any) -> Iterator[tuple[str, Any]]:
    """Names and values of an answer's parts: fields, entries or elements."""
    if hasattr(result, "_asdict"):
        for name in result._fields:
            yield f".{name}", getattr(result, name)
    elif dataclasses.is_dataclass(result):
        for field in dataclasses.fields(result):
            yield f".{field.name}", getattr(result, field.name)
    elif isinstance(result, dict):
        for key, value in result.items():
            yield f".{key}", value
    elif isinstance(result, tuple | list):
        for k, value in enumerate(result):
            yield f"[{k}]", value
