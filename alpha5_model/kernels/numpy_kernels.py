"""The kernels without a compiler: the generated formulas on Python's numbers, and on blocks of NumPy's arrays.

The same two functions as the compiled module has.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from alpha5_model.checks import LARGEST, BoolArray, FloatArray
from alpha5_model.kernels.generated import formulas
from alpha5_model.kernels.numbers import NUMBERS

#: States in a block: what a formula holds of them at a time stays in the cache.
BLOCK = 2048
#: Fewer targets of the inverse kinematics take less time one by one.
FEW = 25
_KERNELS: dict[str, tuple[Any, ...]] = formulas.KERNELS


def bind(name: str, parameters: Sequence[float] | FloatArray = ()) -> Callable[..., Any]:
    """A kernel for one state, with its parameters.

    Args:
        name: Of a kernel.
        parameters: Its last input, copied; empty where it takes none.

    Returns:
        A function of the other inputs: a new array for each output, several in a tuple. None unless each
        input is a C-contiguous float64 array of the right shape whose entries can be computed with.
    """
    formula, inputs, outputs = _KERNELS[name]
    last = ([float(x) for x in parameters],) if len(parameters) else ()
    shapes = inputs[: len(inputs) - len(last)]

    def kernel(*given: Any) -> Any:
        if len(given) != len(shapes) or not all(map(_clean, given, shapes)):
            return None
        results = formula(*(x.ravel().tolist() for x in given), *last, NUMBERS)
        arrays = [np.array(r, np.float64).reshape(s) for r, s in zip(results, outputs, strict=True)]
        return arrays[0] if len(arrays) == 1 else tuple(arrays)

    return kernel


def batch(name: str, parameters: Sequence[float] | FloatArray, *arrays: FloatArray) -> bool:
    """A kernel for each row of its inputs, into the rows of its outputs.

    Args:
        name: Of a kernel.
        parameters: Its last input, for all rows; empty where it takes none.
        arrays: The other inputs, then the outputs, one state in each row.

    Returns:
        False, with nothing in the outputs to rely on, unless all are C-contiguous float64 arrays of as many
        rows of the right size, and the entries of the inputs can be computed with.
    """
    formula, inputs, outputs = _KERNELS[name]
    last = ([np.array(x) for x in parameters],) if len(parameters) else ()
    given = len(inputs) - len(last)
    shapes, n = (*inputs[:given], *outputs), len(arrays[-1])
    if len(arrays) != len(shapes) or not all(
        _plain(x) and len(x) == n and x.size == n * math.prod(shape)
        for x, shape in zip(arrays, shapes, strict=True)
    ):
        return False
    rows = [x.reshape(n, math.prod(s)) for x, s in zip(arrays, shapes, strict=True)]
    with np.errstate(all="ignore"):
        for start in range(0, n, BLOCK):
            here = slice(start, start + BLOCK)
            columns = [np.ascontiguousarray(x[here].T) for x in rows[:given]]
            if not all(np.abs(x).max() <= LARGEST for x in columns):
                return False
            for out, result in zip(rows[given:], formula(*columns, *last, np), strict=True):
                for k, column in enumerate(result):
                    out[here, k] = column
    return True


def inverse_kinematics(*_: Any) -> None:
    """None, for every target: `inverse_kinematics_rows` has what there is."""


def inverse_kinematics_rows(
    position: FloatArray,
    wrist: FloatArray,
    q: FloatArray,
    exists: BoolArray,
    within: BoolArray,
    near: BoolArray,
) -> None:
    """Inverse kinematics of finite targets, into arrays of n rows.

    Args:
        position: (n, 3) [m].
        wrist: (n,), or (1,) for all rows [rad].
        q: (n, 4, 4), or (0, 4, 4) where no angle is wanted; NaN where a branch does not reach.
        exists, within: (n, 4): the branch reaches the target; and within the joint limits.
        near: (n,): the other three are not to be relied on: too close to an edge, or so few that
            `solve_one` costs less than NumPy's calls.
    """
    if len(position) < FEW:
        near[:] = True
        return
    formula = _KERNELS["inverse_kinematics"][0]
    with np.errstate(all="ignore"):
        for start in range(0, len(position), BLOCK):
            here = slice(start, start + BLOCK)
            theta_3 = wrist[here] if len(wrist) > 1 else wrist
            columns = np.ascontiguousarray(position[here].T)
            angles, reach, limits, (clearance,) = formula(columns, (theta_3,), np)
            near[here] = ~(clearance > 0.0)
            for branch in range(4):
                exists[here, branch] = reached = reach[branch % 2] > 0.0
                within[here, branch] = reached & (limits[branch] >= 0.0)
                for joint in range(4 if len(q) else 0):
                    column = angles[4 * branch + joint]
                    q[here, branch, joint] = np.where(reached, column, np.nan)


def _plain(x: Any) -> bool:
    return type(x) is np.ndarray and x.dtype == np.float64 and x.flags.c_contiguous


def _clean(x: Any, shape: tuple[int, ...]) -> bool:
    return _plain(x) and x.shape == shape and all(abs(e) <= LARGEST for e in x.ravel().tolist())
