"""Many states at once, on the generated kernels or by Pinocchio in parallel.

The kernels know the arm on a fixed base with locked jaws
(`alpha5_model.dynamics.kernel_numbers`). Pinocchio computes other arms.

Pinocchio reads one state from each column. The transpose of a C-ordered (N, n) array
has this layout, so no state is copied.

A forked process computes in one thread, because OpenMP would wait for threads that do
not survive a fork. Spawned processes use all threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count
from alpha5_model.dynamics.scratch import Scratch
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import InputError
from alpha5_model.kernels import choice as kernels

#: Number of states for which one more thread pays. They are 3 ms of work, as long as
#: starting a thread takes on a busy machine.
STATES_PER_THREAD = 5000
#: States that a thread computes at a time: about 10 ms. Python answers signals (Ctrl-C)
#: in between.
_STATES_AT_ONCE = 10_000
_PROCESS = os.getpid()


def kernel_rows(
    arm: Any,
    kernel: str,
    threads: int | None,
    **states: ArrayLike,
) -> FloatArray:
    """The output of a kernel for each row of q and its rates, (N, ...).

    Pinocchio computes it instead if the kernels do not know the arm.

    Args:
        arm: An `Arm`.
        kernel: Name of the kernel.
        threads: How many threads Pinocchio uses at most. The kernels use one, but the
            number is checked in any case.
        states: q and its rates, by name.

    Raises:
        InputError: States that `rows` refuses, or threads that `thread_count` refuses.
    """
    parameters = arm._kernel_parameters
    if parameters is None:
        clean = rows(arm._model, **states)
        n_threads = thread_count(threads, len(clean[0]))
        return _BY_PINOCCHIO[kernel](arm, n_threads, *clean)

    if threads is not None:
        count("threads", threads)
    (out,) = kernels.rows(kernel, parameters, *rows(arm._model, **states))
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
        return kernel_rows(arm, "forward_kinematics", 1, q=q)[:, :3, 3].copy()
    (configurations,) = rows(arm._model, q=q)
    origins = [arm.forward_kinematics(row, frame).translation for row in configurations]
    return np.array(origins).reshape(-1, 3)


def thread_count(threads: int | None, states: int) -> int:
    """How many threads to use for a number of states.

    Args:
        threads: The most to use; None for `available_threads`.
        states: Number of states.

    Raises:
        InputError: ``threads`` is not a whole number of at least 1.
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
    model: pin.Model,
    scratch: Scratch,
    threads: int,
    q: FloatArray,
    v: FloatArray | None = None,
    a: FloatArray | None = None,
) -> FloatArray:
    """Pinocchio's RNEA of each row of q, v, a on one model, (N, nv); None is 0."""
    zeros = np.zeros((len(q), model.nv))
    v = zeros if v is None else v
    a = zeros if a is None else a

    tau = np.empty((len(q), model.nv))
    pool = scratch.pool(model, threads)
    for i in _blocks(len(q), threads):
        pin.rneaInParallel(threads, pool, q[i].T, v[i].T, a[i].T, tau[i].T)
    return tau


def _blocks(states: int, threads: int) -> Iterator[slice]:
    """Blocks of many states. Python answers signals between two of them."""
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
    tree = arm._floating_tree
    out = np.empty((len(q), 6))
    for i in _blocks(len(q), threads):
        q_tree, v_tree, a_tree = tree.expand(q[i], v[i], a[i])
        water = rnea(tree.fluid, arm._scratch, threads, q_tree)
        load = rnea(tree.model, arm._scratch, threads, q_tree, v_tree, a_tree)
        out[i] = (water - load)[:, :6]
    return out


def _forward_dynamics(
    arm: Any, threads: int, q: FloatArray, v: FloatArray, tau: FloatArray
) -> FloatArray:
    """ABA of each row with the torque of the water added, (N, nv).

    Pinocchio's ABA refuses mimic joints, so an arm with jaws uses its mass matrix.
    """
    if arm._mimics:
        return solved_rows(arm, q, v, tau, threads)
    total = rnea(arm._fluid, arm._scratch, threads, q)
    total += tau
    a = np.empty_like(v)
    pool = arm._scratch.pool(arm._model, threads)
    for i in _blocks(len(q), threads):
        pin.abaInParallel(threads, pool, q[i].T, v[i].T, total[i].T, a[i].T)
    return a


#: Kernel -> function that computes the same by Pinocchio.
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
    **water_velocity: Any,
) -> FloatArray:
    """Forward dynamics of each row, (N, nv), from mass matrix and inverse dynamics.

    Args:
        arm: An `Arm` or `HydrodynamicArm`.
        q, v, tau: As of `Arm.forward_dynamics_batch`.
        threads: How many threads Pinocchio uses at most.
        water_velocity: Velocity of the water, for a `HydrodynamicArm` only.
    """
    q, v, tau = rows(arm._model, q=q, v=v, tau=tau)
    no_acceleration = np.zeros_like(v)
    bias = arm.inverse_dynamics_batch(q, v, no_acceleration, threads, **water_velocity)
    excess = tau - bias

    a = np.empty(excess.shape)
    for i in _blocks(len(q), threads=1):
        masses = np.array([arm.mass_matrix(row) for row in q[i]])
        a[i] = solved(masses, excess[i, :, None])[..., 0]
    return a


def solved(mass: FloatArray, torque: FloatArray) -> FloatArray:
    """The accelerations at which mass matrices need these torques.

    Raises:
        InputError: A rod so far out that rounding leaves the matrix no inverse.
    """
    try:
        return np.asarray(np.linalg.solve(mass, torque), dtype=np.float64)
    except np.linalg.LinAlgError:
        expected = "positions whose mass matrix has an inverse"
        raise InputError("q", "a singular mass matrix", expected) from None
