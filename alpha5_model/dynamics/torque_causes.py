"""Joint torques by cause: inertia, Coriolis, weight and buoyancy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.batch import kernel_rows, rnea, thread_count
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import InputError


@dataclass(frozen=True, eq=False)
class TorqueTerms:
    """Joint torques by cause, (N, nv) each [N m, N]; their sum is the inverse dynamics.

    Attributes:
        inertia: ``M(q) a``.
        coriolis: ``C(q, v) v``.
        weight: Holds the weight, ``g(q)``.
        buoyancy: Holds the buoyancy, ``-tau_buoyancy(q)``. It is opposite to the weight
            if buoyancy helps to carry it.
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
        arm: On a fixed base, in still water.
        q: (N, nq), or one row for all states, as in `Arm.inverse_dynamics_batch`.
        v: (N, nv).
        a: (N, nv).
        threads: How many to use at most; see `Arm.inverse_dynamics_batch`.

    Raises:
        InputError: An arm on a floating base or in moving water, or arrays that do not
            fit.
    """
    check_fixed_base(arm)
    if arm.has_hydrodynamics:
        raise InputError("arm", arm, "an arm in still water, such as arm.still")
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    if arm._kernel_parameters is None:
        return _terms_by_pinocchio(arm, q, v, a, threads)
    return _terms_by_kernels(arm, q, v, a, threads)


def _terms_by_kernels(
    arm: Any, q: FloatArray, v: FloatArray, a: FloatArray, threads: int | None
) -> TorqueTerms:
    def torque(kernel: str, **rates: FloatArray) -> FloatArray:
        return kernel_rows(arm, kernel, threads, q=q, **rates)

    total = torque("inverse_dynamics", v=v, a=a)
    return TorqueTerms(
        inertia=total - torque("nonlinear_effects", v=v),
        coriolis=torque("coriolis_torque", v=v),
        weight=torque("gravity_torque"),
        buoyancy=-torque("buoyancy_torque"),
    )


def _terms_by_pinocchio(
    arm: Any, q: FloatArray, v: FloatArray, a: FloatArray, threads: int | None
) -> TorqueTerms:
    n_threads = thread_count(threads, len(q))
    total = rnea(arm._model, arm._scratch, n_threads, q, v, a)
    without_acceleration = rnea(arm._model, arm._scratch, n_threads, q, v)
    weight = rnea(arm._model, arm._scratch, n_threads, q)
    return TorqueTerms(
        inertia=total - without_acceleration,
        coriolis=without_acceleration - weight,
        weight=weight,
        buoyancy=-rnea(arm._fluid, arm._scratch, n_threads, q),
    )


def check_fixed_base(arm: Any) -> None:
    """Refuse an arm on a floating base.

    Raises:
        InputError: It is one.
    """
    if arm.floating_base:
        raise InputError("arm", "an arm on a floating base", "an arm on a fixed base")
