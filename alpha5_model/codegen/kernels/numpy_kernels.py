"""The kernels without a compiler, with the functions of the compiled module.

The generated formulas run on Python's numbers, or on blocks of NumPy's arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial, update_wrapper
from itertools import product
from struct import pack
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import LARGEST, BoolArray, FloatArray
from alpha5_model.codegen.kernels.generated import formulas, numbers

#: States in a block: what a formula holds of them at a time stays in the cache.
BLOCK = 4096
#: Fewer targets of the inverse kinematics take less time one by one.
FEW = 25
_FLOAT64 = np.dtype(np.float64)

Shape = tuple[int, ...]
Formula = Callable[..., Any]


class _Kernel(NamedTuple):
    """A generated formula.

    Attributes:
        formula: Takes a sequence of elements for each input and the elementary
            functions, returns a tuple of elements for each output.
        inputs: Shapes, the parameters' last if it has any.
        outputs: Shapes.
    """

    formula: Formula
    inputs: tuple[Shape, ...]
    outputs: tuple[Shape, ...]

    def inputs_of_states(self, has_parameters: bool) -> tuple[Shape, ...]:
        """Shapes of the inputs without the parameters."""
        return self.inputs[:-1] if has_parameters else self.inputs

    def has_parameters(self, parameters: Sequence[float] | FloatArray) -> bool:
        """Whether such parameters are its last input."""
        return self.inputs[-1] == np.shape(parameters)


def _kernels(table: Mapping[str, Any]) -> dict[str, _Kernel]:
    return {
        name: _Kernel(formula=formula, inputs=inputs, outputs=outputs)
        for name, (formula, inputs, outputs) in table.items()
    }


_OF_ARRAYS = _kernels(formulas.KERNELS)
_OF_NUMBERS = _OF_ARRAYS | _kernels(numbers.KERNELS)
_SOLVE: Formula = numbers.inverse_kinematics


def _flags() -> dict[Any, BoolArray]:
    """Truth values -> array of them.

    All answers share these; arrays of bytes cannot be made writeable.
    """
    flags: dict[Any, BoolArray] = {}
    for bits in product((False, True), repeat=4):
        flags[bits] = np.ndarray(4, np.bool_, bytes(bits))
    for bit in (False, True):
        flags[bit] = np.ndarray((), np.bool_, bytes([bit]))
    return flags


_FLAGS = _flags()


def bind(
    name: str,
    parameters: Sequence[float] | FloatArray = (),
    fallback: Callable[..., Any] = lambda *_, **__: None,
) -> Callable[..., Any]:
    """A kernel for one state, with its parameters.

    Args:
        name: Of a kernel.
        parameters: Its last input, copied; ignored if it takes none.
        fallback: Computes what the kernel cannot; the returned function has its name
            and documentation.

    Returns:
        A function of the other inputs that returns a new array, or a tuple of them if
        there are several outputs. Unless each input is a C-contiguous float64 array of
        the right shape with entries that can be computed with, it returns what
        ``fallback`` makes of the inputs.
    """
    kernel = _OF_NUMBERS[name]
    has_parameters = kernel.has_parameters(parameters)
    inputs = kernel.inputs_of_states(has_parameters)
    bound = ([float(x) for x in parameters],) if has_parameters else ()
    compute = partial(
        _one_state, kernel.formula, inputs, kernel.outputs, bound, fallback
    )
    return update_wrapper(compute, fallback)


def _one_state(
    formula: Formula,
    inputs: tuple[Shape, ...],
    outputs: tuple[Shape, ...],
    bound: tuple[Any, ...],
    fallback: Callable[..., Any],
    /,
    *given: Any,
    **named: Any,
) -> Any:
    """A formula of one state, see `bind`; ``bound`` has its parameters, if any."""
    if named or len(given) != len(inputs) or not all(map(_can_compute, given, inputs)):
        return fallback(*given, **named)

    elements = [x.ravel().tolist() for x in given]
    results = formula(*elements, *bound, math)
    arrays = [
        np.array(result, np.float64).reshape(shape)
        for result, shape in zip(results, outputs, strict=True)
    ]
    return arrays[0] if len(arrays) == 1 else tuple(arrays)


def batch(
    name: str, parameters: Sequence[float] | FloatArray, *arrays: FloatArray
) -> bool:
    """A kernel for each row of its inputs, into the rows of its outputs.

    Args:
        name: Of a kernel.
        parameters: Its last input, for all rows; ignored if it takes none.
        arrays: The other inputs, then the outputs, one state in each row; inputs may be
            repeated by `numpy.broadcast_to`.

    Returns:
        True, unless they are not all C-contiguous float64 arrays of as many rows of the
        right size, or entries of the inputs cannot be computed with. Then the outputs
        hold nothing to rely on.
    """
    kernel = _OF_ARRAYS[name]
    has_parameters = kernel.has_parameters(parameters)
    inputs = kernel.inputs_of_states(has_parameters)
    shapes = (*inputs, *kernel.outputs)
    if len(arrays) != len(shapes):
        return False

    given = arrays[: len(inputs)]
    results = arrays[len(inputs) :]
    if not all(_plain(x, rows=True) for x in given):
        return False
    if not all(_plain(x) and x.flags.writeable for x in results):
        return False

    rows = _as_rows(arrays, shapes)
    if rows is None:
        return False
    given_rows = rows[: len(inputs)]
    result_rows = rows[len(inputs) :]
    if len(given_rows[0]) < FEW and name in numbers.KERNELS:
        own = ([float(x) for x in parameters],) if has_parameters else ()
        return _row_by_row(_OF_NUMBERS[name].formula, given_rows, own, result_rows)
    bound = ([np.array(x) for x in parameters],) if has_parameters else ()
    return _block_by_block(kernel.formula, given_rows, bound, result_rows)


def _as_rows(
    arrays: Sequence[FloatArray], shapes: Sequence[Shape]
) -> list[FloatArray] | None:
    """The arrays with one row for each state; None if their sizes do not fit."""
    n = len(arrays[0]) if arrays[0].ndim else 0
    rows = []
    for x, shape in zip(arrays, shapes, strict=True):
        size = math.prod(shape)
        if x.ndim == 0 or len(x) != n or x.size != n * size:
            return None
        rows.append(x.reshape(n, size))
    return rows


def _row_by_row(
    formula: Formula,
    inputs: Sequence[FloatArray],
    bound: tuple[Any, ...],
    outputs: Sequence[FloatArray],
) -> bool:
    """A formula of Python's numbers for each row; False if a number is too large."""
    for i in range(len(inputs[0])):
        state = [x[i].tolist() for x in inputs]
        if not all(abs(number) <= LARGEST for part in state for number in part):
            return False
        results = formula(*state, *bound, math)
        for out, result in zip(outputs, results, strict=True):
            out[i] = result
    return True


def _block_by_block(
    formula: Formula,
    inputs: Sequence[FloatArray],
    bound: tuple[Any, ...],
    outputs: Sequence[FloatArray],
) -> bool:
    """A formula of arrays for all rows; False if a number cannot be computed with.

    Args:
        formula: Of a kernel.
        inputs: One state in each row.
        bound: Its parameters, if it has any.
        outputs: Are written.
    """
    with np.errstate(all="ignore"):
        for start in range(0, len(inputs[0]), BLOCK):
            block = slice(start, start + BLOCK)
            columns = [np.ascontiguousarray(x[block].T) for x in inputs]
            if not all(np.abs(x).max() <= LARGEST for x in columns):
                return False

            results = formula(*columns, *bound, np)
            for out, result in zip(outputs, results, strict=True):
                _write_columns(out[block], result)
    return True


def _write_columns(rows: FloatArray, columns: Sequence[Any]) -> None:
    for k, column in enumerate(columns):
        rows[:, k] = column


def inverse_kinematics(
    kind: type[tuple[Any, ...]], position: Any, wrist: Any, arm: Any = None
) -> Any:
    """One target of the inverse kinematics.

    Args:
        kind: A named tuple of five arrays, `alpha5_model.kinematics.ik.Solutions`.
        position: (3,) [m].
        wrist: [rad].
        arm: What `bind` makes of the kernel and the numbers of an arm other than the
            catalogue's.

    Returns:
        The solutions. None if position is not a float64 array, a list or a tuple of
        three floats, wrist is not a float, or a number is too large or not finite.
    """
    xyz = position
    if type(xyz) is np.ndarray and xyz.shape == (3,):
        xyz = xyz.tolist()
    if type(xyz) not in (list, tuple) or len(xyz) != 3:
        return None
    if {*map(type, xyz), type(wrist)} != {float}:
        return None
    if not sum(map(abs, xyz)) + abs(wrist) <= LARGEST:
        return None

    if arm is None:
        results = _SOLVE(xyz, (wrist,), math)
    else:
        formula, _, _, numbers_of_arm, _ = arm.args
        results = formula(xyz, (wrist,), *numbers_of_arm, math)
    q, exists, within, (singular,) = results
    angles = np.ndarray((4, 4), float, pack("16d", *q))
    target = np.frombuffer(pack("3d", *xyz))
    answer = angles, _FLAGS[exists], _FLAGS[within], _FLAGS[singular], target
    return tuple.__new__(kind, answer)  # far faster than by keyword


def is_state(nq: int, nv: int, *state: Any) -> bool:
    """Whether arrays are a state that can be computed with.

    q is a contiguous, aligned float64 array (nq,), the others are (nv,). A state with
    numbers near `LARGEST` is none.
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
    """Whether a value is a contiguous float64 array; with rows, or one row for all."""
    if type(x) is not np.ndarray or x.dtype != np.float64:
        return False
    if rows and x.ndim == 2 and x.strides[0] == 0:
        x = x[:1]
    return bool(x.flags.c_contiguous and x.flags.aligned)


def _can_compute(x: Any, shape: Shape) -> bool:
    """Whether a value is a contiguous array of a shape without too large numbers."""
    if not _plain(x) or x.shape != shape:
        return False
    return all(map(LARGEST.__ge__, map(abs, x.ravel().tolist())))
