"""The kernels without a compiler: the generated formulas on NumPy's arrays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from alpha5_model._support.checks import LARGEST, MOST_ANGLE, FloatArray
from alpha5_model.errors import KernelError
from alpha5_model.kernels.generated.formulas import KERNELS

#: States in a block: what a formula holds of them at a time stays in the cache.
BLOCK = 4096


def rows(
    name: str, parameters: FloatArray, *inputs: FloatArray
) -> tuple[FloatArray, ...]:
    """A kernel for each row; see `alpha5_model.kernels.choice.rows`."""
    if name not in KERNELS:
        raise KernelError(name, "the name of a kernel")
    formula: Any
    formula, shapes, outputs = KERNELS[name]
    *of_states, of_parameters = shapes
    if not _is_plain(parameters) or parameters.shape != of_parameters:
        raise KernelError(name, "its number of parameters, float64")
    sizes = [math.prod(shape) for shape in of_states]
    n = len(inputs[0]) if inputs and _is_array(inputs[0]) else 0
    if len(inputs) != len(sizes) or not all(
        _is_array(given) and len(given) == n and given.size == n * size
        for given, size in zip(inputs, sizes, strict=True)
    ):
        raise KernelError(name, "its inputs as C-contiguous float64 rows")

    results = tuple(np.empty((n, *shape)) for shape in outputs)
    with np.errstate(all="ignore"):
        for start in range(0, n, BLOCK):
            block = slice(start, start + BLOCK)
            columns = [
                np.ascontiguousarray(given[block].reshape(-1, size).T)
                for given, size in zip(inputs, sizes, strict=True)
            ]
            if not all((np.abs(x) <= LARGEST).all() for x in columns):
                raise KernelError(name, "finite numbers that are not huge")
            of_block = formula(*columns, parameters, np)
            for result, elements in zip(results, of_block, strict=True):
                flat = result[block].reshape(len(result[block]), -1)
                for k, element in enumerate(elements):
                    flat[:, k] = element
    return results


def is_state(nq: int, nv: int, *state: Any) -> bool:
    """Whether arrays are a plain state; see `alpha5_model.kernels.choice`."""
    n = nq
    for x in state:
        if not _is_plain(x) or x.shape != (n,):
            return False
        if not math.hypot(*x.tolist()) < LARGEST:
            return False
        n = nv
    of_base = 0 if nq == nv else 7  # position and quaternion
    return all(abs(angle) <= MOST_ANGLE for angle in state[0][of_base:].tolist())


def _is_plain(x: Any) -> bool:
    """Whether a value is a C-contiguous float64 array."""
    return _is_float64(x) and bool(x.flags.c_contiguous and x.flags.aligned)


def _is_array(x: Any) -> bool:
    """Whether a value is such an array of rows, or one row for all."""
    if _is_float64(x) and x.ndim == 2 and x.strides[0] == 0:
        return _is_plain(x[:1])
    return _is_plain(x) and x.ndim > 0


def _is_float64(x: Any) -> bool:
    return type(x) is np.ndarray and x.dtype == np.float64
