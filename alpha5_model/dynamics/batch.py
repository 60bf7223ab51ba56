"""Many states at once, through Pinocchio's parallel algorithms.

Pinocchio reads one state from each column; a C-ordered (N, n) array transposed is exactly that, so no state
is copied.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, count, float_array
from alpha5_model.dynamics.vectors import QUATERNION_TOLERANCE
from alpha5_model.errors import InputError, ShapeError


class Pools:
    """Pinocchio's sets of pin.Data for its parallel algorithms, made when first asked for."""

    def __init__(self) -> None:
        self._pools: dict[tuple[int, int], Any] = {}

    def of(self, model: Any, threads: int) -> Any:
        """pin.ModelPool of a model that the arm keeps as long as this object lives."""
        key = (id(model), threads)
        if key not in self._pools:
            self._pools[key] = pin.ModelPool(model, threads)
        return self._pools[key]


def rows(model: Any, **states: ArrayLike) -> list[FloatArray]:
    """Check and convert states in rows; the first one has nq columns, the others nv.

    Raises:
        InputError: Not real numbers, or a quaternion without unit norm.
        ShapeError: Wrong number of columns, or of rows.
        NonFiniteError: NaN or infinity.
    """
    columns = [model.nq, *[model.nv] * (len(states) - 1)]
    arrays = {}
    for (name, value), n in zip(states.items(), columns, strict=True):
        array = float_array(name, value, (n,))
        if array.ndim > 2:
            raise ShapeError(name, array.shape, f"shape (N, {n})")
        arrays[name] = np.atleast_2d(array)
    n_rows = max((len(array) for array in arrays.values()), key=lambda n: (n != 1, n))
    for name, array in arrays.items():
        if len(array) not in (1, n_rows):
            raise ShapeError(name, array.shape, f"{n_rows} rows, as the others, or one")
    if model.nq > model.nv:
        quaternion = arrays["q"][:, 3:7]
        off = np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) > QUATERNION_TOLERANCE
        if off.any():
            row = int(np.argmax(off))
            norm = float(np.linalg.norm(quaternion[row]))
            raise InputError(f"q[{row}, 3:7]", f"norm {norm:.6g}", "a unit quaternion (x, y, z, w)")
    return [
        np.ascontiguousarray(np.broadcast_to(array, (n_rows, array.shape[1])))
        for array in arrays.values()
    ]


def rnea(
    model: Any, pools: Pools, threads: int, q: FloatArray, v: FloatArray, a: FloatArray
) -> FloatArray:
    """Pinocchio's RNEA of each row on one model, (N, nv)."""
    tau = np.empty_like(v)
    # columns are samples there; the transposed views need no copy
    pin.rneaInParallel(threads, pools.of(model, threads), q.T, v.T, a.T, tau.T)
    return tau


def inverse_dynamics(
    model: Any,
    fluid: Any,
    pools: Pools,
    threads: int | None,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
) -> FloatArray:
    """RNEA of each row with the torque of the water taken off, (N, nv)."""
    n = thread_count(threads)
    tau = rnea(model, pools, n, q, v, a)
    tau -= _buoyancy(fluid, n, pools, q)
    return tau


def forward_dynamics(
    model: Any,
    fluid: Any,
    pools: Pools,
    threads: int | None,
    q: FloatArray,
    v: FloatArray,
    tau: FloatArray,
) -> FloatArray:
    """ABA of each row with the torque of the water added, (N, nv)."""
    n = thread_count(threads)
    total = _buoyancy(fluid, n, pools, q)
    total += tau
    a = np.empty_like(v)
    pin.abaInParallel(n, pools.of(model, n), q.T, v.T, total.T, a.T)
    return a


def _buoyancy(fluid: Any, threads: int, pools: Pools, q: FloatArray) -> FloatArray:
    still = np.zeros((len(q), fluid.nv))
    return rnea(fluid, pools, threads, q, still, still)


def thread_count(threads: int | None) -> int:
    """Check a number of threads; None stands for `available_threads`."""
    return available_threads() if threads is None else count("threads", threads)


def available_threads() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1
