"""Many states at once, term by term: the torques of a recorded or planned motion.

Rows are states. Each term is one pass of the recursive Newton-Euler algorithm, on the kernels or in
Pinocchio, or the difference of two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import kernel_rows
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import InputError
from alpha5_model.hydrodynamics import LEVELS


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
    arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
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
    n, own, still = batch.thread_count(threads, len(q)), arm._own, np.zeros_like(v)
    if arm._kernel_parameters is None:
        total = batch.rnea(arm._model, own, n, q, v, a)
        bias = batch.rnea(arm._model, own, n, q, v, still)
        weight = batch.rnea(arm._model, own, n, q, still, still)
        buoyancy = -batch.rnea(arm._fluid, own, n, q, still, still)
        return TorqueTerms(total - bias, bias - weight, weight, buoyancy)

    def term(name: str, **rates: FloatArray) -> FloatArray:
        return np.asarray(kernel_rows(arm, name, 4, threads, q=q, **rates))

    inertia = term("inverse_dynamics", v=v, a=a) - term("nonlinear_effects", v=v)
    coriolis = term("coriolis_torque", v=v)
    return TorqueTerms(inertia, coriolis, term("gravity_torque"), -term("buoyancy_torque"))


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
    arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: ArrayLike
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


def _on_fixed_base(arm: Arm) -> None:
    if arm.floating_base:
        raise InputError("arm", "an arm on a floating base", "an arm on a fixed base")


def frame_positions(arm: Arm, q: ArrayLike, frame: str = "tcp") -> FloatArray:
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
    poses = kernel_rows(arm, "forward_kinematics", 16, 1, q=q) if frame == "tcp" else None
    if poses is not None:
        return poses[:, 3:12:4].copy()
    (configurations,) = rows(arm._model, q=q)
    origins = [arm.forward_kinematics(row, frame).translation for row in configurations]
    return np.array(origins).reshape(-1, 3)
