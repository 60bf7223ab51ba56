"""The kernels without a compiler: the generated formulas on Python's numbers, and on blocks of NumPy's arrays.

The same two functions as the compiled module has.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial, update_wrapper
from itertools import product
from struct import pack
from typing import Any

import numpy as np

from alpha5_model._support.checks import LARGEST, FloatArray
from alpha5_model.codegen.kernels.generated import formulas, numbers

#: States in a block: what a formula holds of them at a time stays in the cache.
BLOCK = 4096
#: Fewer targets of the inverse kinematics take less time one by one.
FEW = 25
_KERNELS: dict[str, tuple[Any, ...]] = formulas.KERNELS
_FLOAT64 = np.dtype(np.float64)
#: The formulas that hold for Python's numbers.
_ONE: dict[str, tuple[Any, ...]] = {**formulas.KERNELS, **numbers.KERNELS}
_SOLVE: Callable[..., Any] = numbers.inverse_kinematics
#: Shared by all answers; arrays of bytes cannot be made writeable.
_FLAGS: dict[Any, Any] = {
    bits: np.ndarray(4, np.bool_, bytes(bits))
    for bits in product((False, True), repeat=4)
}
_FLAGS |= {bit: np.ndarray((), np.bool_, bytes([bit])) for bit in (False, True)}


def bind(
    name: str,
    parameters: Sequence[float] | FloatArray = (),
    fallback: Callable[..., Any] = lambda *_, **__: None,
) -> Callable[..., Any]:
    """A kernel for one state, with its parameters.

    Args:
        name: Of a kernel.
        parameters: Its last input, copied; of no meaning where it takes none.
        fallback: Computes where the kernel does not; the function has its name and documentation.

    Returns:
        A function of the other inputs: a new array for each output, several in a tuple. What ``fallback``
        makes of the arguments unless each is a C-contiguous float64 array of the right shape whose entries
        can be computed with.
    """
    formula, inputs, outputs = _ONE[name]
    last = (
        ([float(x) for x in parameters],) if inputs[-1] == np.shape(parameters) else ()
    )
    shapes = inputs[: len(inputs) - len(last)]
    return update_wrapper(
        partial(_one, formula, shapes, outputs, last, fallback), fallback
    )


def _one(
    formula: Any,
    shapes: Any,
    outputs: Any,
    last: Any,
    fallback: Any,
    *given: Any,
    **named: Any,
) -> Any:
    if named or len(given) != len(shapes) or not all(map(_clean, given, shapes)):
        return fallback(*given, **named)
    results = formula(*(x.ravel().tolist() for x in given), *last, math)
    arrays = [
        np.array(r, np.float64).reshape(s)
        for r, s in zip(results, outputs, strict=True)
    ]
    return arrays[0] if len(arrays) == 1 else tuple(arrays)


def batch(
    name: str, parameters: Sequence[float] | FloatArray, *arrays: FloatArray
) -> bool:
    """A kernel for each row of its inputs, into the rows of its outputs.

    Args:
        name: Of a kernel.
        parameters: Its last input, for all rows; not looked at where it takes none.
        arrays: The other inputs, then the outputs, one state in each row; inputs may be repeated by
            `numpy.broadcast_to`.

    Returns:
        False, with nothing in the outputs to rely on, unless all are C-contiguous float64 arrays of as many
        rows of the right size, and the entries of the inputs can be computed with.
    """
    formula, inputs, outputs = _KERNELS[name]
    last = (
        ([np.array(x) for x in parameters],)
        if inputs[-1] == np.shape(parameters)
        else ()
    )
    given = len(inputs) - len(last)
    shapes = (*inputs[:given], *outputs)
    if len(arrays) != len(shapes):
        return False
    n = len(arrays[0]) if np.ndim(arrays[0]) else 0
    for place, (x, shape) in enumerate(zip(arrays, shapes, strict=True)):
        is_input = place < given
        if not _plain(x, rows=is_input) or not (is_input or x.flags.writeable):
            return False
        if x.ndim == 0 or len(x) != n or x.size != n * math.prod(shape):
            return False
    rows = [x.reshape(n, math.prod(s)) for x, s in zip(arrays, shapes, strict=True)]
    if n < FEW and name in numbers.KERNELS:
        for i in range(n):
            states = [x[i].tolist() for x in rows[:given]]
            if not all(abs(e) <= LARGEST for state in states for e in state):
                return False
            for out, result in zip(
                rows[given:], _ONE[name][0](*states, math), strict=True
            ):
                out[i] = result
        return True
    with np.errstate(all="ignore"):
        for start in range(0, n, BLOCK):
            here = slice(start, start + BLOCK)
            columns = [np.ascontiguousarray(x[here].T) for x in rows[:given]]
            if not all(np.abs(x).max() <= LARGEST for x in columns):
                return False
            for out, result in zip(
                rows[given:], formula(*columns, *last, np), strict=True
            ):
                for k, column in enumerate(result):
                    out[here, k] = column
    return True


def inverse_kinematics(kind: type[tuple[Any, ...]], position: Any, wrist: Any) -> Any:
    """One target of the inverse kinematics.

    Args:
        kind: A named tuple of five arrays, `alpha5_model.kinematics.ik.Solutions`.
        position: (3,) [m].
        wrist: [rad].

    Returns:
        None where position is not a float64 array, a list or a tuple of three floats, wrist not a float, or a
        number too large or not finite.
    """
    x = position
    if type(x) is np.ndarray and x.shape == (3,):
        x = x.tolist()
    if (
        type(x) not in (list, tuple)
        or len(x) != 3
        or {*map(type, x), type(wrist)} != {float}
    ):
        return None
    if not sum(map(abs, x)) + abs(wrist) <= LARGEST:
        return None
    q, exists, within, (singular,) = _SOLVE(x, (wrist,), math)
    angles, target = (
        np.ndarray((4, 4), float, pack("16d", *q)),
        np.frombuffer(pack("3d", *x)),
    )
    answer = angles, _FLAGS[exists], _FLAGS[within], _FLAGS[singular], target
    return tuple.__new__(kind, answer)


def is_state(nq: int, nv: int, *state: Any) -> bool:
    """Whether q is a contiguous, aligned float64 array (nq,), the others are (nv,), and all can be computed with.

    Near the largest number: no.
    """
    n = nq
    for x in state:
        if type(x) is not np.ndarray or x.dtype is not _FLOAT64 or x.shape != (n,):
            return False
        if not (x.flags.c_contiguous and x.flags.aligned):
            return False
        if not math.hypot(*x.tolist()) < LARGEST:
            return False
        n = nv
    return True


def _plain(x: Any, rows: bool = False) -> bool:
    if type(x) is not np.ndarray or x.dtype != np.float64:
        return False
    if rows and x.ndim == 2 and x.strides[0] == 0:
        x = x[:1]
    return bool(x.flags.c_contiguous and x.flags.aligned)


def _clean(x: Any, shape: tuple[int, ...]) -> bool:
    return (
        _plain(x)
        and x.shape == shape
        and all(map(LARGEST.__ge__, map(abs, x.ravel().tolist())))
    )
