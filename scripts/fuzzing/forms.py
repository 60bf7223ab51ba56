"""The same numbers in arrays of other forms: misaligned, mapped, packed, strided, ...

A function must answer with the same bits as for an aligned, contiguous copy of float64,
or refuse both. What is more than numbers (a subclass, an array of objects) may be
refused alone. No argument may be changed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from fuzzing.cases import Case, Target
from fuzzing.values import Rng, pick

from alpha5_model.errors import Alpha5Error

#: An array in another form; the folder is for files.
Form = Callable[[Rng, np.ndarray, Path], Any]
_file_numbers = itertools.count()


def misaligned(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """At an address that is no multiple of 8."""
    offset = int(rng.integers(1, 8))
    buffer = bytearray(offset) + array.tobytes()
    return np.frombuffer(buffer, array.dtype, offset=offset).reshape(array.shape)


def mapped(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """A file in memory, behind a header of any length."""
    offset = int(rng.integers(0, 17))
    path = folder / f"mapped-{next(_file_numbers) % 8}"
    path.unlink(missing_ok=True)  # an earlier map keeps its own file
    path.write_bytes(bytes(offset) + array.tobytes() + b"\0")
    return np.memmap(path, array.dtype, pick(rng, ("r", "c")), offset, array.shape)


def packed_field(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """A field of a structured array without padding."""
    kind = np.dtype([("head", "u1"), ("number", array.dtype), ("tail", "u2")])
    structured = np.zeros(array.shape, kind)
    structured["number"] = array
    return structured["number"]


def packed_rows(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """A field that holds a whole row, of a structured array without padding."""
    if array.ndim < 2:
        return packed_field(rng, array, folder)
    kind = np.dtype([("head", "u1"), ("row", array.dtype, array.shape[1:])])
    structured = np.zeros(len(array), kind)
    structured["row"] = array
    return structured["row"]


def swapped(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """In the other order of bytes."""
    return array.astype(array.dtype.newbyteorder(">"))


def reversed_in_memory(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """With a negative stride."""
    if array.ndim == 0:
        return array
    axis = int(rng.integers(array.ndim))
    return np.flip(np.flip(array, axis).copy(), axis)


def repeated(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """With a stride of zero: one row, or one number, for all."""
    if array.size == 0 or array.ndim == 0:
        return array
    axis = 0 if rng.integers(4) else int(rng.integers(array.ndim))
    first = np.take(array, [0], axis)
    return np.broadcast_to(first, array.shape)


def read_only(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """That must not be written."""
    copy = array.copy()
    copy.flags.writeable = False
    return copy


def fortran(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """Column by column."""
    return np.asfortranarray(array) if array.ndim else array


def spread(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """Every second number of a larger array, others between them."""
    step = int(rng.integers(2, 4))
    larger = np.full([step * n + 1 for n in array.shape], 7.7e77)
    place = tuple(slice(0, step * n, step) for n in array.shape)
    larger[place] = array
    return larger[place]


def odd_strides(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
    """Rows that are apart by no multiple of 8 bytes."""
    if array.ndim == 0:
        return array
    gap = int(rng.integers(1, 8))
    width = array[0].nbytes if len(array) else 8
    raw = np.zeros(len(array) * (width + gap) + 8, np.uint8)
    strides = (width + gap, *np.ascontiguousarray(array).strides[1:])
    view = np.ndarray(array.shape, array.dtype, raw, 0, strides)
    view[...] = array
    return view


def of_type(*types: Any) -> Form:
    """In numbers of another type, which round."""

    def form(rng: Rng, array: np.ndarray, folder: Path) -> np.ndarray:
        with np.errstate(all="ignore"):
            return array.astype(pick(rng, types))

    return form


def nested(rng: Rng, array: np.ndarray, folder: Path) -> Any:
    """Lists of Python's numbers."""
    return array.tolist()


class Own(np.ndarray):
    """A subclass that says nothing new."""


def subclass(rng: Rng, array: np.ndarray, folder: Path) -> Any:
    """Of a class that may mean more than numbers."""
    views: list[Any] = [
        np.ma.MaskedArray(array),
        array.view(Own),
        array.view(np.recarray),
    ]
    if array.ndim == 2:
        views.append(np.asmatrix(array))
    return pick(rng, views)


def objects(rng: Rng, array: np.ndarray, folder: Path) -> Any:
    """Of Python's objects."""
    return array.astype(object)


def both(*forms: Form) -> Form:
    """One form of another."""

    def form(rng: Rng, array: np.ndarray, folder: Path) -> Any:
        for step in forms:
            array = step(rng, array, folder)
        return array

    return form


#: Forms that must answer as the aligned copy does.
PLAIN: dict[str, Form] = {
    "misaligned": misaligned,
    "memory-mapped": mapped,
    "packed field": packed_field,
    "packed rows": packed_rows,
    "byte-swapped": swapped,
    "negative stride": reversed_in_memory,
    "zero stride": repeated,
    "read-only": read_only,
    "Fortran order": fortran,
    "not contiguous": spread,
    "odd strides": odd_strides,
    "float32": of_type(np.float32, np.float16),
    "long double": of_type(np.longdouble),
    "integers": of_type(np.int64, np.int32, np.int8, np.uint16),
    "lists": nested,
    "misaligned and swapped": both(swapped, misaligned),
    "misaligned float32": both(of_type(np.float32), misaligned),
    "packed and reversed": both(reversed_in_memory, packed_field),
    "packed zero stride": both(packed_field, repeated),
}
#: Forms that may be refused, whatever the aligned copy does.
ODD: dict[str, Form] = {"subclass": subclass, "objects": objects}
#: Functions without an array among their arguments.
WITHOUT_ARRAYS = (
    "a5.compare",
    "a5.dh.DHChain.from_urdf",
    "a5.named_pose",
    "a5.trajectory.read_motion",
)
#: Functions that compute in the type of their input, unchecked: they get float64.
IN_THEIR_TYPE = ("jax.", "a5.planar.Arc.", "a5.planar.Segment.", "a5.workspace.Arc.")
FLOAT64 = {
    name: form
    for name, form in PLAIN.items()
    if name.startswith(("misaligned", "memory", "packed", "read-only"))
    and not any(word in name for word in ("swapped", "float32", "reversed"))
}


def aligned(value: Any) -> Any:
    """The numbers of any form, in an array of its own: float64, contiguous, aligned."""
    with np.errstate(all="ignore"):
        return np.array(value, np.float64, order="C", copy=True, subok=False)


class DifferentError(Exception):
    """The answer depends on where the numbers lie."""


def in_forms(
    draw: Callable[[Rng, bool], Case],
    plain: dict[str, Form] = PLAIN,
    odd: dict[str, Form] = ODD,
) -> Target:
    """A target that computes with arrays in some form and with their aligned copies."""

    def target(rng: Rng, folder: Path) -> Case:
        case = draw(rng, False)
        given = dict(case.arguments)
        names = [name for name, value in given.items() if _array(value)]
        chosen = [name for name in names if rng.integers(2)] or names[:1]
        strict = True
        for name in chosen:
            forms = odd if odd and rng.integers(12) == 0 else plain
            form = pick(rng, [*forms.values()])
            given[name] = form(rng, np.asarray(given[name]), folder)
            strict &= forms is plain

        def call(**given: Any) -> Any:
            return _compared(case.call, given, names, strict)

        return Case(call, given)

    return target


def _compared(
    call: Callable[..., Any], given: dict[str, Any], names: list[str], strict: bool
) -> Any:
    """The answer to arguments, if it is the same as to their aligned copies.

    Args:
        call: Is called with both.
        given: Arguments.
        names: Of those that are arrays.
        strict: Whether only one of the two may not be refused.

    Raises:
        DifferentError: The answers differ, or an argument has changed.
    """
    usual = dict(given)
    for name in names:
        usual[name] = aligned(given[name])
    before = {name: list(bits(usual[name])) for name in names}

    expected = _answer(call, usual)
    found = _answer(call, given)
    may_refuse = isinstance(expected, Alpha5Error) or not strict
    if isinstance(found, Alpha5Error) and may_refuse:
        raise found

    wanted = list(bits(expected))
    got = list(bits(found))
    if wanted != got:
        raise DifferentError(_apart(wanted, got))
    for name in names:
        if list(bits(aligned(given[name]))) != before[name]:
            raise DifferentError(f"changed its argument {name}")
    return found


def _array(value: Any) -> bool:
    if isinstance(value, float):
        return True
    return isinstance(value, np.ndarray) and value.dtype == np.float64


def _answer(call: Callable[..., Any], arguments: dict[str, Any]) -> Any:
    with poisoned():
        try:
            return call(**arguments)
        except Alpha5Error as error:
            return error


def _apart(wanted: list[Any], got: list[Any]) -> str:
    for one, other in itertools.zip_longest(wanted, got):
        if one != other:
            return f"expected {_shown(one)}, got {_shown(other)}"
    return "the same"


def _shown(entry: Any) -> str:
    if entry and isinstance(entry[-1], bytes) and entry[1] in ("<f8", "|b1", "<i8"):
        entry = (*entry[:-1], np.frombuffer(entry[-1], entry[1])[:8].tolist())
    return str(entry)[:250]


@contextmanager
def poisoned() -> Iterator[None]:
    """New arrays of NumPy's are filled, with other numbers each time.

    What a function never writes then differs between two calls.
    """
    plain = {name: getattr(np, name) for name in ("empty", "empty_like")}

    def filled(name: str) -> Callable[..., np.ndarray]:
        def make(*args: Any, **options: Any) -> np.ndarray:
            array = plain[name](*args, **options)
            if array.dtype.kind == "f":
                array.fill(-7.7e5 - next(_file_numbers))
            return array

        return make

    try:
        for name in plain:
            setattr(np, name, filled(name))
        yield
    finally:
        for name, function in plain.items():
            setattr(np, name, function)


def bits(result: Any, place: str = "") -> Iterator[tuple[Any, ...]]:
    """All numbers and words of an answer with their places, as bytes."""
    if isinstance(result, Alpha5Error):
        yield place, type(result).__name__
    elif isinstance(result, bool | int | float | str | type(None)):
        yield from bits_of_array(np.asarray(result), place)
    elif isinstance(result, dict):
        for key, value in result.items():
            yield from bits(value, f"{place}.{key}")
    elif isinstance(result, tuple | list):
        for k, value in enumerate(result):
            yield from bits(value, f"{place}[{k}]")
    elif isinstance(result, _PINOCCHIO):
        yield from _bits_of_pinocchio(result, place)
    elif not callable(result):
        yield from _bits_of_object(result, place)


_PINOCCHIO = (pin.SE3, pin.Force, pin.Motion, pin.Model, pin.Data)


def _bits_of_pinocchio(result: Any, place: str) -> Iterator[tuple[Any, ...]]:
    """Numbers of an object of Pinocchio's; none of its scratch memory, `pin.Data`."""
    if isinstance(result, pin.SE3):
        yield from bits_of_array(result.homogeneous, place)
    elif isinstance(result, pin.Force | pin.Motion):
        yield from bits_of_array(result.vector, place)
    elif isinstance(result, pin.Model):
        bodies = [
            np.append(x.mass, [*x.lever, *x.inertia.ravel()]) for x in result.inertias
        ]
        yield from bits_of_array(np.array(bodies), f"{place}.inertias")


def _bits_of_object(result: Any, place: str) -> Iterator[tuple[Any, ...]]:
    """An array, the attributes of a record, what an iterator gives, or a word."""
    if hasattr(result, "dtype") or hasattr(result, "__array__"):
        yield from bits_of_array(np.asarray(result), place)
    elif hasattr(result, "__dict__"):
        yield from _bits_of_attributes(result, place)
    elif hasattr(result, "__iter__"):
        yield from bits(list(result), place)
    else:
        yield place, repr(result)


def _bits_of_attributes(result: Any, place: str) -> Iterator[tuple[Any, ...]]:
    """Public attributes of an object, and its model."""
    own = {}
    for name, value in vars(result).items():
        if not name.startswith("_"):
            own[name] = value
    yield from bits(own, f"{place}{type(result).__name__}")
    if hasattr(result, "_model"):
        yield from bits(result._model, f"{place}.model")


def bits_of_array(array: np.ndarray, place: str) -> Iterator[tuple[Any, ...]]:
    """Shape, type and bytes."""
    content = repr(array.tolist()) if array.dtype.kind == "O" else array.tobytes()
    yield place, array.dtype.str, array.shape, content


def targets(draws: dict[str, Callable[[Rng, bool], Case]]) -> dict[str, Target]:
    """Function -> its target, of functions that take arrays."""
    targets: dict[str, Target] = {}
    for name, draw in draws.items():
        if name in WITHOUT_ARRAYS:
            continue
        unchecked = name.startswith(IN_THEIR_TYPE)
        targets[f"forms {name}"] = (
            in_forms(draw, FLOAT64, {}) if unchecked else in_forms(draw)
        )
    return targets
