"""Many states at once, on the generated kernels or by Pinocchio in parallel.

The kernels know the arm on a fixed base with locked jaws
(`alpha5_model.dynamics.kernel_numbers`). Pinocchio computes other arms.

Pinocchio reads one state from each column. A C-ordered (N, n) array transposed is
exactly that, so no state is copied.

A forked process computes in one thread: OpenMP's threads do not survive a fork, yet
OpenMP waits for them. Its siblings use the other processors; processes that are spawned
use all threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.dynamics.scratch import Scratch
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import KernelError

#: States for which one more thread pays: 3 ms of work, the time that starting a thread
#: takes on a busy machine.
STATES_PER_THREAD = 5000
#: States for a thread at a time: some 10 ms, after which a signal (Ctrl-C) is answered.
_STATES_AT_ONCE = 10_000
_PROCESS = os.getpid()


def kernel_rows(
    arm: Any,
    name: str,
    columns: int,
    threads: int | None,
    numbers: FloatArray | None = None,
    **states: ArrayLike,
) -> FloatArray:
    """A kernel's output for each row of q and its rates, (N, columns).

    If the kernels do not know the arm, Pinocchio computes it. Errors are those of
    `rows` and `thread_count`.

    Args:
        arm: An `Arm`.
        name: Of the kernel.
        columns: Of its output.
        threads: How many Pinocchio uses at most.
        numbers: Parameters of the kernel; None for the arm's base parameters.
        states: q and its rates, by name.
    """
    own_numbers = arm._kernel_parameters if numbers is None else numbers
    if own_numbers is None:
        clean = rows(arm._model, **states)
        return _BY_PINOCCHIO[name](arm, thread_count(threads, len(clean[0])), *clean)

    out = None
    given: list[Any] = [*states.values()]
    if type(given[0]) is np.ndarray and given[0].ndim == 2:
        # What is not plainly rows is converted, or refused, below.
        with suppress(KernelError):
            out = _computed(name, own_numbers, columns, given)
    if out is None:
        out = _computed(name, own_numbers, columns, rows(arm._model, **states))
    thread_count(threads, len(out))
    return out


def _computed(
    name: str, numbers: FloatArray, columns: int, states: list[FloatArray]
) -> FloatArray:
    out = np.empty((len(states[0]), columns))
    kernels.compute(name, numbers, *states, out)
    return out


def frame_positions(arm: Any, q: ArrayLike, frame: str = "tcp") -> FloatArray:
    """Origin of a frame, state by state.

    It is in base_link on a fixed base, else in the world.

    Args:
        arm: The arm.
        q: (N, nq).
        frame: Name of a frame of the model.

    Returns:
        (N, 3) [m].

    Raises:
        InputError: q that cannot be used.
        UnknownNameError: No such frame.
    """
    arm._frame(frame)
    if frame == "tcp" and arm._kernel_parameters is not None:
        poses = kernel_rows(arm, "forward_kinematics", 16, 1, q=q)
        return poses[:, 3:12:4].copy()
    (configurations,) = rows(arm._model, q=q)
    origins = [arm.forward_kinematics(row, frame).translation for row in configurations]
    return np.array(origins).reshape(-1, 3)


def thread_count(threads: int | None, states: int) -> int:
    """Threads for a number of states: at most ``threads``.

    Args:
        threads: None for `available_threads`.
        states: How many.

    Raises:
        InputError: Not a whole number of at least 1.
    """
    most = available_threads() if threads is None else count("threads", threads)
    if os.getpid() != _PROCESS:
        return 1
    return max(1, min(most, states // STATES_PER_THREAD))


def available_threads() -> int:
    """Number of processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1


def rnea(
    model: Any,
    scratch: Scratch,
    threads: int,
    q: FloatArray,
    v: FloatArray | None = None,
    a: FloatArray | None = None,
) -> FloatArray:
    """Pinocchio's RNEA of each row of q, v, a on one model, (N, nv); None is 0."""
    still = np.zeros((len(q), model.nv))
    v = still if v is None else v
    a = still if a is None else a

    tau = np.empty((len(q), model.nv))
    pool = scratch.pool(model, threads)
    for i in _blocks(len(q), threads):
        pin.rneaInParallel(threads, pool, q[i].T, v[i].T, a[i].T, tau[i].T)
    return tau


def _blocks(states: int, threads: int) -> Iterator[slice]:
    """Parts of many states. Between two of them Python answers signals."""
    size = threads * _STATES_AT_ONCE
    return (slice(start, start + size) for start in range(0, states, size))


def _inverse_dynamics(
    arm: Any, threads: int, q: FloatArray, v: FloatArray, a: FloatArray
) -> FloatArray:
    """RNEA of each row less the torque of the water, (N, nv)."""
    tau = rnea(arm._model, arm._scratch, threads, q, v, a)
    tau -= rnea(arm._fluid, arm._scratch, threads, q)
    return tau


def _base_wrench(
    arm: Any, threads: int, q: FloatArray, v: FloatArray, a: FloatArray
) -> FloatArray:
    """Wrench on the mount for each row, (N, 6)."""
    tree, fluid, embedding = arm._floating_tree
    out = np.empty((len(q), 6))
    for i in _blocks(len(q), threads):
        q_tree, v_tree, a_tree = embedding.expand(q[i], v[i], a[i])
        water = rnea(fluid, arm._scratch, threads, q_tree)
        load = rnea(tree, arm._scratch, threads, q_tree, v_tree, a_tree)
        out[i] = (water - load)[:, :6]
    return out


def _forward_dynamics(
    arm: Any, threads: int, q: FloatArray, v: FloatArray, tau: FloatArray
) -> FloatArray:
    """ABA of each row with the torque of the water added, (N, nv).

    Pinocchio's ABA refuses an arm with jaws: its mass matrix is solved.
    """
    if arm._joint_tree.model is not arm._model:
        return solved_rows(arm, q, v, tau, threads)
    total = rnea(arm._fluid, arm._scratch, threads, q)
    total += tau
    a = np.empty_like(v)
    pool = arm._scratch.pool(arm._model, threads)
    for i in _blocks(len(q), threads):
        pin.abaInParallel(threads, pool, q[i].T, v[i].T, total[i].T, a[i].T)
    return a


#: Kernel -> the same by Pinocchio.
_BY_PINOCCHIO: dict[str, Callable[..., FloatArray]] = {
    "inverse_dynamics": _inverse_dynamics,
    "base_wrench": _base_wrench,
    "forward_dynamics": _forward_dynamics,
}


def solved_rows(
    arm: Any,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    threads: int | None,
    **current: Any,
) -> FloatArray:
    """Forward dynamics of each row, (N, nv), from mass matrix and inverse dynamics."""
    q, v, tau = rows(arm._model, q=q, v=v, tau=tau)
    still = np.zeros_like(v)
    bias = arm.inverse_dynamics_batch(q, v, still, threads, **current)
    excess = tau - bias

    a = np.empty(excess.shape)
    for i in _blocks(len(q), threads=1):
        masses = np.array([arm.mass_matrix(row) for row in q[i]])
        a[i] = np.linalg.solve(masses, excess[i, :, None])[..., 0]
    return a
