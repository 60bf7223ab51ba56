"""Values for the fuzz: good ones by the parameter's name, ways to spoil them, and what is no answer."""

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
    "", "abc", "1", b"1", {}, {1: 2}, {1.0}, object(), len, Path("x"), 1 + 2j, [1, [2, 3]], [None], [[1.0], "a"],
    np.array(["1", "2", "3"]), np.array([1 + 1j, 0, 0]), np.array([None, 1, 2]), np.array("2020-01-01", "datetime64"),
    np.array([True, False, True]), np.zeros(3, [("x", float)]),
)  # fmt: skip
#: Odd, but someone may have a reason.
ODD: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2**70, -(2**63), 3.7, Decimal("1.5"), Fraction(1, 3), [], (), [[]], np.zeros(0), np.zeros((0, 3)),
    np.zeros((3, 0)), np.zeros((2, 2, 2)), np.float32(1.5), np.int8(3), np.zeros(4, np.float16), np.eye(3, dtype=int), range(4),
)  # fmt: skip
TEXTS = (
    "", " ", "tcp", "link_3", "axis_b", "base_frame", "a\0b", "\udcff", "é", "a\nb", "${1/0}", "<x>", "nan", "x" * 5000,
    "locked", "jaws", "both", "printed", "[red]",
)  # fmt: skip


def pick(rng: Rng, choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def spoil(rng: Rng, value: Any) -> tuple[Any, bool]:
    """A value changed at random, and whether nothing but a refusal can be right."""
    array = value if isinstance(value, np.ndarray) and value.dtype == float else None
    way = int(rng.integers(10))
    if array is None or array.size == 0 or way < 2:
        if isinstance(value, float) and way >= 4:
            bad = pick(rng, NOT_FINITE if way < 6 else NUMBERS)
            return bad, not math.isfinite(bad)
        return (
            (pick(rng, ODD), False)
            if way % 2
            else (pick(rng, NO_NUMBERS), array is not None)
        )
    changed, place = array.copy(), int(rng.integers(array.size))
    if way == 2:
        changed.flat[place] = pick(rng, NOT_FINITE)
        return changed, True
    if way == 3:
        changed.flat[place] = pick(rng, NUMBERS)
        return changed, False
    if way == 4:
        with np.errstate(over="ignore"):
            scaled = changed * (pick(rng, NUMBERS[5:]) if rng.integers(2) else 0.0)
        return scaled, not np.isfinite(scaled).all()
    if way == 5:
        mask = np.zeros(array.shape, bool)
        mask.flat[place] = True
        return np.ma.MaskedArray(changed, mask), True
    if way == 6 and array.ndim:
        return pick(
            rng,
            (
                changed[..., :-1],
                changed[..., None],
                np.moveaxis(changed, 0, -1),
                changed[None],
            ),
        ), False
    if way == 7:
        nested = changed.astype(object)
        nested.flat[place] = pick(rng, (None, "x", 1j, [1.0], {}))
        return (
            nested.tolist(),
            array.size > 1,
        )  # [[1.0]] for [1.0] is another shape only
    if way == 8:
        return np.full(array.shape, pick(rng, NUMBERS)), False
    return pick(
        rng,
        (
            changed.tolist(),
            changed.astype(np.float32),
            np.asfortranarray(changed),
            changed.round().astype(int),
        ),
    ), False


def points(rng: Rng) -> np.ndarray:
    shape = pick(rng, ((3,), (1, 3), (4, 3), (2, 2, 3), (0, 3)))
    special = ((0.0, 0.0, 0.4), (0.0, 0.0, 0.0), (1e-12, 0.0, 0.5), (0.3, 0.0, 0.1))
    return (
        rng.normal(0, 0.3, shape)
        if rng.integers(4)
        else np.broadcast_to(pick(rng, special), shape).copy()
    )


def angles(n: int) -> Callable[[Rng], np.ndarray]:
    def draw(rng: Rng) -> np.ndarray:
        shape = pick(rng, ((n,), (1, n), (3, n))) if rng.integers(3) == 0 else (n,)
        return rng.uniform(-1.0, 6.5, shape)

    return draw


def number(low: float, high: float) -> Callable[[Rng], float]:
    return lambda rng: float(rng.uniform(low, high))


def tensor(rng: Rng) -> np.ndarray:
    """Of a possible body, (3, 3) or (2, 3, 3)."""
    spread = rng.normal(0, 0.05, (*pick(rng, ((), (2,))), 3, 3))
    second = spread @ np.swapaxes(spread, -1, -2)
    return np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second


def rotation(rng: Rng) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def transform(rng: Rng) -> np.ndarray:
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation(rng), rng.normal(0, 0.3, 3)
    return out


def wrong_answers(
    result: Any, ignored: frozenset[str], place: str = ""
) -> Iterator[str]:
    """Where NaN or infinity stands in an answer."""
    if "the answer" in ignored:
        return
    if isinstance(result, np.ndarray) and result.dtype.kind == "f":
        if not np.isfinite(result).all():
            yield place or "the answer"
    elif isinstance(result, float):
        if not math.isfinite(result):
            yield place or "the answer"
    elif dataclasses.is_dataclass(result) or hasattr(result, "_asdict"):
        names = (
            result._fields
            if hasattr(result, "_asdict")
            else [f.name for f in dataclasses.fields(result)]
        )
        for name in names:
            if name not in ignored:
                yield from wrong_answers(
                    getattr(result, name), ignored, f"{place}.{name}"
                )
    elif isinstance(result, dict):
        for key, value in result.items():
            if key not in ignored:
                yield from wrong_answers(value, ignored, f"{place}.{key}")
    elif isinstance(result, tuple | list):
        for k, value in enumerate(result):
            yield from wrong_answers(value, ignored, f"{place}[{k}]")
    elif hasattr(result, "homogeneous"):
        yield from wrong_answers(np.asarray(result.homogeneous), ignored, place)
    elif type(result).__name__ in ("Force", "Motion") and hasattr(result, "vector"):
        yield from wrong_answers(np.asarray(result.vector), ignored, place)
