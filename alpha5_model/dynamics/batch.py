"""Many states at once: on the generated kernels, and through Pinocchio's parallel algorithms.

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
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model import kernels
from alpha5_model.base_parameters import BASE_PARAMETERS, base_parameters
from alpha5_model.checks import FloatArray, count
from alpha5_model.description import joint_placements, tcp_placement
from alpha5_model.dynamics.collision import CollisionModel
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import InputError
from alpha5_model.parameters import RigidBody, parameters
from alpha5_model.spatial import pose

#: States for which one more thread pays: 3 ms of work, what starting one takes on a busy machine.
STATES_PER_THREAD = 5000
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
        self.data, self.fluid_data, self.net_data = (m.createData() for m in (model, fluid, net))
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


def kernel_parameters(
    model: Any, displaced: Iterable[Displacement], density: float
) -> FloatArray | None:
    """Base parameters of an arm, (41,); None if the kernels do not know its joints.

    Args:
        model: pin.Model.
        displaced: The volumes on its joints.
        density: Of the fluid [kg/m^3].
    """
    if not _known(model):
        return None
    volumes: list[list[Displacement]] = [[] for _ in model.names]
    for body in displaced:
        volumes[model.getJointId(body.joint)].append(body)
    links = []
    for name, inertia, there in zip(model.names, model.inertias, volumes, strict=True):
        volume = sum(body.volume for body in there)
        moment = sum((body.volume * body.cob for body in there), np.zeros(3))
        cob = moment / (volume or 1.0)
        links.append(RigidBody(name, inertia.mass, inertia.lever, inertia.inertia, volume, cob))
    return base_parameters(links, density, model.gravity.linear)


def _known(model: Any) -> bool:
    if [joint.shortname() for joint in list(model.joints)[1:]] != ["JointModelRZ"] * 4:
        return False
    arm, tip = parameters(), model.getFrameId("tcp")
    if tip == model.nframes or list(model.parents) != [0, 0, 1, 2, 3]:
        return False
    frame = model.frames[tip]
    ours = [pose(at.xyz, at.rpy) for at in (*joint_placements(arm), tcp_placement(arm))]
    theirs = [at.homogeneous for at in (*list(model.jointPlacements)[1:], frame.placement)]
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
) -> FloatArray | None:
    """A kernel's output for each row of q and its rates, (N, columns); of the arm's base parameters unless told others.

    None where the kernels do not know the arm. Errors are those of `rows` and `thread_count`.
    """
    parameters = arm._kernel_parameters if parameters is None else parameters
    if parameters is None:
        return None
    states: list[Any] = [*given.values()]
    run = kernels.module().batch
    plain = type(states[0]) is np.ndarray and states[0].ndim == 2
    out = np.empty((len(states[0]), columns)) if plain else None
    if out is None or not run(name, parameters, *states, out):
        states = rows(arm._model, **given)
        out = np.empty((len(states[0]), columns))
        run(name, parameters, *states, out)
    thread_count(threads, len(out))
    return out


def arm_parameters(arm: Any) -> FloatArray:
    """Base parameters of an arm, its fluid, gravity and payloads, (41,).

    Raises:
        InputError: The kernels do not know its joints: a floating base, or jaws that move.
    """
    if arm._kernel_parameters is None:
        raise InputError("arm", arm, "one on a fixed base with its jaws locked")
    return np.array(arm._kernel_parameters)


@dataclass(frozen=True, eq=False)
class Regressor:
    """``tau = matrix @ parameters`` [Khalil2002], see `alpha5_model.base_parameters`.

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
    single = max(map(np.ndim, (q, v, a))) < 2
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    matrix = regressor_rows(q, v, a, parameters[-3:])[:, :4]
    units = tuple(BASE_PARAMETERS[name] for name in NAMES)
    return Regressor(matrix[0] if single else matrix, parameters[:-3], NAMES, units)


def regressor_rows(q: FloatArray, v: FloatArray, a: FloatArray, gravity: ArrayLike) -> FloatArray:
    """Of joint torques, then force and moment on the mount in base_link, (N, 10, 38).

    Args:
        q, v, a: (N, 4) each, checked; gravity: In base_link, (3,) [m/s^2].
    """
    out = np.empty((len(q), 10, len(NAMES)))
    tau, wrench = np.empty((len(q), 4)), np.empty((len(q), 6))
    for k in range(len(NAMES)):
        one = np.concatenate([np.arange(len(NAMES)) == k, gravity])
        kernels.module().batch("inverse_dynamics_with_base_wrench", one, q, v, a, tau, wrench)
        out[:, :4, k], out[:, 4:, k] = tau, wrench
    return out
