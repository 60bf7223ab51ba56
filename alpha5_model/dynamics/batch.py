"""Many states at once: on the generated kernels, and through Pinocchio's parallel algorithms; torques by cause.

The kernels know the joints and frames of the Reach Alpha 5 on a fixed base with locked jaws; bodies,
payloads included, fluid and gravity are parameters. Other arms are Pinocchio's.

Pinocchio reads one state from each column; a C-ordered (N, n) array transposed is exactly that, so
no state is copied.

A forked process computes in one thread: OpenMP's threads do not survive a fork, yet OpenMP waits
for them. Its siblings use the other processors; processes that are spawned use all threads.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count
from alpha5_model._support.spatial import pose
from alpha5_model.codegen.base_parameters import BASE_PARAMETERS, moments, regrouped
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.description.bodies import joint_placements, tcp_placement
from alpha5_model.dynamics.collision import CollisionModel
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.states import expanded, is_one_state, rows
from alpha5_model.errors import InputError, KernelError
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.parameters import parameters

#: States for which one more thread pays: 3 ms of work, what starting one takes on a busy machine.
STATES_PER_THREAD = 5000
#: States for a thread at a time: some 10 ms, after which a signal (Ctrl-C) is answered.
_STATES_AT_ONCE = 10_000
#: Base parameters that are no gravity.
NAMES = tuple(BASE_PARAMETERS)[:-3]
#: How far a frame may be from where the kernels have it: what rounding does to the numbers of a URDF.
_ROUNDING = 1e-14
_PROCESS = os.getpid()


class Scratch(threading.local):
    """The memory that Pinocchio computes in, one set for each thread.

    Attributes:
        data, fluid_data, net_data: pin.Data of the arm, of the fluid and of their difference.
        placements: pin.SE3 of each frame that refers to `data`: the next computation moves it.
    """

    def __init__(self, model: Any, fluid: Any, net: Any, callers: Any) -> None:
        self.data, self.fluid_data, self.net_data = (
            m.createData() for m in (model, fluid, net)
        )
        self.placements = [self.data.oMf[i] for i in range(model.nframes)]
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


def rnea(
    model: Any, own: Scratch, threads: int, q: FloatArray, *rates: FloatArray
) -> FloatArray:
    """Pinocchio's RNEA of each row of q, v, a on one model, (N, nv); rates that are not given are 0."""
    tau, still = np.empty((len(q), model.nv)), np.zeros((len(q), model.nv))
    v, a = (*rates, still, still)[:2]
    pool = own.pool(model, threads)
    for i in _blocks(len(q), threads):
        pin.rneaInParallel(threads, pool, q[i].T, v[i].T, a[i].T, tau[i].T)
    return tau


def _blocks(states: int, threads: int) -> Iterator[slice]:
    """Parts of many states. Between two of them Python answers signals."""
    size = threads * _STATES_AT_ONCE
    return (slice(start, start + size) for start in range(0, states, size))


def inverse_dynamics(arm: Any, threads: int, *states: FloatArray) -> FloatArray:
    """RNEA of each row of q, v, a with the torque of the water taken off, (N, nv)."""
    tau = rnea(arm._model, arm._own, threads, *states)
    tau -= rnea(arm._fluid, arm._own, threads, states[0])
    return tau


def base_wrench(arm: Any, threads: int, *states: FloatArray) -> FloatArray:
    """Wrench on the mount for each row of q, v, a, (N, 6)."""
    tree, fluid, embedding = arm._free
    out = np.empty((len(states[0]), 6))
    for i in _blocks(len(out), threads):
        q, v, a = expanded(embedding, *(x[i] for x in states))
        water = rnea(fluid, arm._own, threads, q)
        out[i] = (water - rnea(tree, arm._own, threads, q, v, a))[:, :6]
    return out


def forward_dynamics(arm: Any, threads: int, *states: FloatArray) -> FloatArray:
    """ABA of each row of q, v, tau with the torque of the water added, (N, nv); with jaws, which it refuses, solved."""
    q, v, tau = states
    if arm._embedded[0] is not arm._model:
        return solved_rows(arm, q, v, tau, threads)
    total, a = rnea(arm._fluid, arm._own, threads, q), np.empty_like(v)
    total += tau
    pool = arm._own.pool(arm._model, threads)
    for i in _blocks(len(q), threads):
        pin.abaInParallel(threads, pool, q[i].T, v[i].T, total[i].T, a[i].T)
    return a


#: Kernel -> the same by Pinocchio.
_PINOCCHIO: dict[str, Callable[..., FloatArray]] = {
    way.__name__: way for way in (inverse_dynamics, base_wrench, forward_dynamics)
}


def solved_rows(
    arm: Any,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    threads: int | None,
    **current: Any,
) -> FloatArray:
    """Forward dynamics of each row by an arm's mass matrix and its inverse dynamics, (N, nv)."""
    q, v, tau = rows(arm._model, q=q, v=v, tau=tau)
    rest = tau - arm.inverse_dynamics_batch(q, v, np.zeros_like(v), threads, **current)
    out = np.empty(rest.shape)
    for i in _blocks(len(q), threads=1):
        masses = np.array([arm.mass_matrix(row) for row in q[i]])
        out[i] = np.linalg.solve(masses, rest[i, :, None])[..., 0]
    return out


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


def kernel_parameters(arm: Any) -> FloatArray | None:
    """Base parameters of an arm in its fluid, (41,); None if the kernels do not know its joints."""
    model, none = arm._model, np.zeros(3)
    if not _known(model):
        return None
    bodies = [
        moments(x.mass, x.lever, x.inertia, 0.0, none, 0.0) for x in model.inertias
    ]
    links = np.array(bodies)
    for x in arm.displacements:
        water = moments(0.0, none, np.zeros((3, 3)), x.volume, x.cob, arm.fluid_density)
        links[model.getJointId(x.joint)] += water
    return regrouped(links, model.gravity.linear, parameters())


def _known(model: Any) -> bool:
    if [joint.shortname() for joint in list(model.joints)[1:]] != ["JointModelRZ"] * 4:
        return False
    arm, tip = parameters(), model.getFrameId("tcp")
    if tip == model.nframes or list(model.parents) != [0, 0, 1, 2, 3]:
        return False
    frame = model.frames[tip]
    ours = [pose(at.xyz, at.rpy) for at in (*joint_placements(arm), tcp_placement(arm))]
    theirs = [
        at.homogeneous for at in (*list(model.jointPlacements)[1:], frame.placement)
    ]
    return bool(
        frame.parentJoint == 4
        and np.abs(np.subtract(ours, theirs)).max() < _ROUNDING
        and not np.any([*model.armature, *model.gravity.angular])
    )


def kernel_rows(
    arm: Any,
    name: str,
    columns: int,
    threads: int | None,
    parameters: FloatArray | None = None,
    **given: ArrayLike,
) -> FloatArray:
    """A kernel's output for each row of q and its rates, (N, columns); of the arm's base parameters unless told others.

    Where the kernels do not know the arm, Pinocchio computes it.
    Errors are those of `rows` and `thread_count`.
    """
    parameters = arm._kernel_parameters if parameters is None else parameters
    if parameters is None:
        clean = rows(arm._model, **given)
        return _PINOCCHIO[name](arm, thread_count(threads, len(clean[0])), *clean)
    out = None
    states: list[Any] = [*given.values()]
    if type(states[0]) is np.ndarray and states[0].ndim == 2:
        with suppress(
            KernelError
        ):  # not plainly rows: they are converted, or refused, below
            out = _computed(name, parameters, columns, states)
    if out is None:
        out = _computed(name, parameters, columns, rows(arm._model, **given))
    thread_count(threads, len(out))
    return out


def _computed(
    name: str, parameters: FloatArray, columns: int, states: list[FloatArray]
) -> FloatArray:
    out = np.empty((len(states[0]), columns))
    kernels.compute(name, parameters, *states, out)
    return out


def arm_parameters(arm: Any) -> FloatArray:
    """Base parameters of an arm, its fluid, gravity and payloads, (41,).

    Raises:
        InputError: The kernels do not know its joints: a floating base, jaws that move, or other
            dimensions than the catalogue's.
    """
    if arm._kernel_parameters is None:
        if not arm.floating_base and len(arm.joint_names) == 4:
            check_dimensions(arm._model, "the generated formulas", _ROUNDING)
        raise InputError("arm", arm, "one on a fixed base with its jaws locked")
    return np.array(arm._kernel_parameters)


@dataclass(frozen=True, eq=False)
class Regressor:
    """``tau = matrix @ parameters`` [Khalil2002], see `alpha5_model.codegen.base_parameters`.

    Attributes:
        matrix: (nv, 38), or (N, nv, 38) of many states; columns are derivatives by the parameters.
        parameters: Base parameters of the arm in its fluid, payloads included, (38,).
        names, units: Of the parameters; those of link_0 load the mount only.
    """

    matrix: FloatArray
    parameters: FloatArray
    names: tuple[str, ...]
    units: tuple[str, ...]


def regressor(arm: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Regressor:
    """See `alpha5_model.dynamics.arm.Arm.regressor`."""
    parameters = arm_parameters(arm)
    single = is_one_state(q, v, a)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    matrix = regressor_rows(q, v, a, parameters[-3:])[:, :4]
    units = tuple(BASE_PARAMETERS[name] for name in NAMES)
    return Regressor(matrix[0] if single else matrix, parameters[:-3], NAMES, units)


def regressor_rows(
    q: FloatArray, v: FloatArray, a: FloatArray, gravity: ArrayLike
) -> FloatArray:
    """Of joint torques, then force and moment on the mount in base_link, (N, 10, 38).

    Args:
        q, v, a: (N, 4) each, checked; gravity: In base_link, (3,) [m/s^2].
    """
    out = np.empty((len(q), 10, len(NAMES)))
    tau, wrench = np.empty((len(q), 4)), np.empty((len(q), 6))
    for k in range(len(NAMES)):
        one = np.concatenate([np.arange(len(NAMES)) == k, gravity])
        kernels.compute("inverse_dynamics_with_base_wrench", one, q, v, a, tau, wrench)
        out[:, :4, k], out[:, 4:, k] = tau, wrench
    return out


@dataclass(frozen=True, eq=False)
class TorqueTerms:
    """Joint torques by cause, (N, nv) each [N m, N]; their sum is the inverse dynamics.

    Attributes:
        inertia: ``M(q) a``.
        coriolis: ``C(q, v) v``.
        weight: Holds the weight, ``g(q)``.
        buoyancy: Holds the buoyancy, ``-tau_buoyancy(q)``: against the weight where the water
            helps.
    """

    inertia: FloatArray
    coriolis: FloatArray
    weight: FloatArray
    buoyancy: FloatArray


def torque_terms(
    arm: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
) -> TorqueTerms:
    """Inertia, Coriolis, weight and buoyancy torques of many states.

    Args:
        arm: On a fixed base.
        q: (N, nq), or one row for all states, as in `Arm.inverse_dynamics_batch`.
        v: (N, nv).
        a: (N, nv).
        threads: How many to use at most; see `Arm.inverse_dynamics_batch`.

    Raises:
        InputError: An arm on a floating base, or arrays that do not fit.
    """
    _on_fixed_base(arm)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    if arm._kernel_parameters is None:
        n, own, every = thread_count(threads, len(q)), arm._own, ((v, a), (v,), ())
        total, bias, weight = (rnea(arm._model, own, n, q, *rates) for rates in every)
        buoyancy = -rnea(arm._fluid, own, n, q)
        return TorqueTerms(total - bias, bias - weight, weight, buoyancy)

    def term(name: str, **rates: FloatArray) -> FloatArray:
        return kernel_rows(arm, name, 4, threads, q=q, **rates)

    inertia = term("inverse_dynamics", v=v, a=a) - term("nonlinear_effects", v=v)
    coriolis = term("coriolis_torque", v=v)
    return TorqueTerms(
        inertia, coriolis, term("gravity_torque"), -term("buoyancy_torque")
    )


@dataclass(frozen=True, eq=False)
class WaterTerms:
    """What moving water adds to an arm in still water: added mass and drag, estimated, not published.

    Attributes:
        current: Velocity of the water, uniform, in base_link, (3,) [m/s].
        torque: Joint torque, (N, 3, nv) [N m, N]: with all numbers low, nominal, high.
        wrench: Load on the mount in base_link, (N, 3, 6) [N, N m], likewise.
    """

    current: FloatArray
    torque: FloatArray
    wrench: FloatArray


def water_terms(
    arm: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: ArrayLike
) -> WaterTerms:
    """What moving water adds to the inverse dynamics and the base wrench of many states.

    Args:
        arm: On a fixed base, in still water; q: (N, nq); v: (N, nv); a: (N, nv).
        current: (3,) [m/s].

    Raises:
        InputError: An arm on a floating base, or arrays that do not fit.
    """
    _on_fixed_base(arm)
    levels = [arm.with_hydrodynamics(current, level) for level in LEVELS]
    # Of the tree's torques the first six are the mount's: one pass for both.
    trees = np.stack([wet._water_torques(q, v, a, None) for wet in levels], axis=1)
    return WaterTerms(levels[0].current, trees @ levels[0]._tree.g, -trees[..., :6])


def _on_fixed_base(arm: Any) -> None:
    if arm.floating_base:
        raise InputError("arm", "an arm on a floating base", "an arm on a fixed base")


def frame_positions(arm: Any, q: ArrayLike, frame: str = "tcp") -> FloatArray:
    """Origin of a frame, state by state; in base_link on a fixed base, else in the world.

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
        return kernel_rows(arm, "forward_kinematics", 16, 1, q=q)[:, 3:12:4].copy()
    (configurations,) = rows(arm._model, q=q)
    origins = [arm.forward_kinematics(row, frame).translation for row in configurations]
    return np.array(origins).reshape(-1, 3)
