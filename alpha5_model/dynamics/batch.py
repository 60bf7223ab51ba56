"""Many states at once, through Pinocchio's parallel algorithms.

Pinocchio reads one state from each column; a C-ordered (N, n) array transposed is exactly that, so no state
is copied.

A forked process computes in one thread: OpenMP's threads are not there after a fork, yet it waits for them.
Its siblings use the other processors; processes that are spawned use all threads.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import ROTATION_TOLERANCE, FloatArray, bounded, count, float_array
from alpha5_model.errors import InputError, ShapeError

#: States for which a further thread is worth waking: 3 ms of work, what a busy machine takes to run one.
STATES_PER_THREAD = 5000
_PROCESS = os.getpid()


class Pools:
    """Pinocchio's sets of pin.Data for its parallel algorithms, made when first asked for."""

    def __init__(self) -> None:
        self._pools: dict[int, Any] = {}

    def of(self, model: Any, threads: int) -> Any:
        """pin.ModelPool, for that many threads or more, of a model that lives as long as this object."""
        pool = self._pools.get(id(model))
        if pool is None or pool.size() < threads:
            pool = self._pools[id(model)] = pin.ModelPool(model, threads)
        return pool


def rows(model: Any, **states: ArrayLike) -> list[FloatArray]:
    """Check and convert states in rows; the first one has nq columns, the others nv.

    Raises:
        InputError: Not real numbers, too large ones, or a quaternion without unit norm.
        ShapeError: Wrong number of columns, or of rows.
        NonFiniteError: NaN or infinity.
    """
    columns = [model.nq, *[model.nv] * (len(states) - 1)]
    arrays = {}
    for (name, value), n in zip(states.items(), columns, strict=True):
        array = bounded(name, float_array(name, value, (n,)))
        if array.ndim > 2:
            raise ShapeError(name, array.shape, f"shape (N, {n})")
        arrays[name] = np.atleast_2d(array)
    n_rows = max((len(array) for array in arrays.values()), key=lambda n: (n != 1, n))
    for name, array in arrays.items():
        if len(array) not in (1, n_rows):
            raise ShapeError(name, array.shape, f"{n_rows} rows, as the others, or one")
    if model.nq > model.nv:
        quaternion = arrays["q"][:, 3:7]
        off = np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) > ROTATION_TOLERANCE
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
    model: Any, fluid: Any, pools: Pools, threads: int | None, *states: FloatArray
) -> FloatArray:
    """RNEA of each row of q, v, a with the torque of the water taken off, (N, nv)."""
    n = thread_count(threads, len(states[0]))
    tau = rnea(model, pools, n, *states)
    tau -= _buoyancy(fluid, n, pools, states[0])
    return tau


def forward_dynamics(
    model: Any, fluid: Any, pools: Pools, threads: int | None, *states: FloatArray
) -> FloatArray:
    """ABA of each row of q, v, tau with the torque of the water added, (N, nv)."""
    q, v, tau = states
    n = thread_count(threads, len(q))
    total = _buoyancy(fluid, n, pools, q)
    total += tau
    a = np.empty_like(v)
    pin.abaInParallel(n, pools.of(model, n), q.T, v.T, total.T, a.T)
    return a


def _buoyancy(fluid: Any, threads: int, pools: Pools, q: FloatArray) -> FloatArray:
    still = np.zeros((len(q), fluid.nv))
    return rnea(fluid, pools, threads, q, still, still)


def thread_count(threads: int | None, states: int) -> int:
    """Threads for a number of states: at most those asked for, None for `available_threads`.

    Raises:
        InputError: Not a whole number of at least 1.
    """
    asked = available_threads() if threads is None else count("threads", threads)
    if os.getpid() != _PROCESS:
        return 1
    return max(1, min(asked, states // STATES_PER_THREAD))


def available_threads() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1
