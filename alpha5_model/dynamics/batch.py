"""Many states at once, through Pinocchio's parallel algorithms: of arms that the kernels do not know.

Pinocchio reads one state from each column; a C-ordered (N, n) array transposed is exactly that, so
no state is copied.

A forked process computes in one thread: OpenMP's threads do not survive a fork, yet OpenMP waits
for them. Its siblings use the other processors; processes that are spawned use all threads.
"""

from __future__ import annotations

import os
import threading
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, count
from alpha5_model.dynamics.collision import CollisionModel
from alpha5_model.dynamics.states import rows

#: States for which one more thread pays: 3 ms of work, what starting one takes on a busy machine.
STATES_PER_THREAD = 5000
_PROCESS = os.getpid()


class Scratch(threading.local):
    """The memory that Pinocchio computes in, one set for each thread.

    Attributes:
        data, fluid_data, net_data: pin.Data of the arm, of the fluid and of their difference.
        placements: Frame -> pin.SE3 that refers to `data`: the next computation moves it.
    """

    def __init__(self, model: Any, fluid: Any, net: Any, callers: Any) -> None:
        self.data, self.fluid_data, self.net_data = (m.createData() for m in (model, fluid, net))
        self.placements = {frame.name: self.data.oMf[i] for i, frame in enumerate(model.frames)}
        self._model, self._callers = model, callers
        self._pools: dict[int, Any] = {}

    @cached_property
    def callers_data(self) -> Any:
        """pin.Data of the caller's own model, made when first asked for."""
        return self._callers.createData()

    @cached_property
    def collisions(self) -> CollisionModel:
        """The collision bodies, made when first asked for."""
        return CollisionModel(self._model)

    def pool(self, model: Any, threads: int = 1) -> Any:
        """pin.ModelPool for at least so many threads; the model must outlive this object."""
        pool = self._pools.get(id(model))
        if pool is None or pool.size() < threads:
            pool = self._pools[id(model)] = pin.ModelPool(model, threads)
        return pool


def rnea(model: Any, own: Scratch, threads: int, *states: FloatArray) -> FloatArray:
    """Pinocchio's RNEA of each row of q, v, a on one model, (N, nv)."""
    tau = np.empty_like(states[1])
    pin.rneaInParallel(threads, own.pool(model, threads), *(x.T for x in states), tau.T)
    return tau


def inverse_dynamics(
    model: Any, fluid: Any, own: Scratch, threads: int | None, *states: FloatArray
) -> FloatArray:
    """RNEA of each row of q, v, a with the torque of the water taken off, (N, nv)."""
    n = thread_count(threads, len(states[0]))
    tau = rnea(model, own, n, *states)
    tau -= _buoyancy(fluid, own, n, states[0])
    return tau


def forward_dynamics(
    model: Any, fluid: Any, own: Scratch, threads: int | None, *states: FloatArray
) -> FloatArray:
    """ABA of each row of q, v, tau with the torque of the water added, (N, nv)."""
    q, v, tau = states
    n = thread_count(threads, len(q))
    total = _buoyancy(fluid, own, n, q)
    total += tau
    a = np.empty_like(v)
    pin.abaInParallel(n, own.pool(model, n), q.T, v.T, total.T, a.T)
    return a


def solved_rows(
    arm: Any, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None, **current: Any
) -> FloatArray:
    """Forward dynamics of each row by an arm's mass matrix and its inverse dynamics, (N, nv)."""
    q, v, tau = rows(arm._model, q=q, v=v, tau=tau)
    rest = tau - arm.inverse_dynamics_batch(q, v, np.zeros_like(v), threads, **current)
    masses = np.array([arm.mass_matrix(row) for row in q]).reshape(-1, *2 * rest.shape[1:])
    return np.asarray(np.linalg.solve(masses, rest[..., None])[..., 0], dtype=np.float64)


def _buoyancy(fluid: Any, own: Scratch, threads: int, q: FloatArray) -> FloatArray:
    still = np.zeros((len(q), fluid.nv))
    return rnea(fluid, own, threads, q, still, still)


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
