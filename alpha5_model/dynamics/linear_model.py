"""The linear model of an arm about a state, for controllers that are computed from it.

With x = (dq, dv), the departure from the state, and u that from its torque,

    dx/dt = A x + B u,    A = [[0, 1], [da/dq, da/dv]],    B = [[0], [da/dtau]].

Sampled with a torque that is held for a time step h (zero-order hold), it is exactly
``x[k+1] = A_d x[k] + B_d u[k]`` with ``[[A_d, B_d], [0, 1]] = exp(h [[A, B], [0, 0]])``
[VanLoan1978].

[VanLoan1978] Van Loan: Computing integrals involving the matrix exponential, IEEE
    Transactions on Automatic Control 23(3), 1978.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray, real
from alpha5_model.dynamics.batch import solved
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.motors import joint_losses


class LinearModel(NamedTuple):
    """A linear model; it unpacks as ``A, B``.

    Attributes:
        A: (2 nv, 2 nv).
        B: (2 nv, nv).
    """

    A: FloatArray
    B: FloatArray


def linear_model(
    arm: Any,
    q: FloatArray,
    v: FloatArray,
    tau: FloatArray,
    dt: float | None,
    motors: bool,
    **water: Any,
) -> LinearModel:
    """The model of `Arm.linearized`, whose arguments are checked.

    Args:
        arm: An `Arm`.
        water: ``water_velocity``, for a `HydrodynamicArm` only.
    """
    size = len(v)
    armature, damping = motor_terms(arm) if motors else np.zeros((2, size))
    if motors and not (armature.any() or damping.any()):
        plausibility.warn(
            "motors: the arm's record has no rotor inertia and no viscous friction; "
            "nothing was added"
        )
    inertia = arm.mass_matrix(q) + np.diag(armature)
    bias = arm.inverse_dynamics(q, v, np.zeros(size), **water)
    a = solved(inertia, tau - damping * v - bias)
    of_q, of_v, _ = arm.inverse_dynamics_derivatives(q, v, a, **water)

    kinematic = np.zeros((size, size))
    if arm.floating_base:
        # dq of the base is a twist in its own, moving axes: d(dq)/dt = dv - v x dq.
        kinematic[:6, :6] = -pin.Motion(v[:6]).action
    A = np.block(
        [
            [kinematic, np.eye(size)],
            [-solved(inertia, of_q), -solved(inertia, of_v + np.diag(damping))],
        ]
    )
    B = np.vstack([np.zeros((size, size)), solved(inertia, np.eye(size))])
    return LinearModel(A, B) if dt is None else sampled(A, B, dt)


def motor_terms(arm: Any) -> tuple[FloatArray, FloatArray]:
    """Rotor inertia and viscous friction at the joints of an arm, (nv,) each.

    They are those that its record has, as `joint_losses` gives them to MuJoCo: 0 for
    what was not measured, for the jaw rod and for a floating base.
    """
    losses = joint_losses(arm.parameters)
    armature, damping = np.zeros((2, arm._model.nv))
    first = 6 if arm.floating_base else 0
    for k, joint in enumerate(arm.joint_names, first):
        if joint in losses:
            armature[k] = losses[joint].armature
            damping[k] = losses[joint].damping
    return armature, damping


def sampled(A: FloatArray, B: FloatArray, dt: float) -> LinearModel:
    """The model between samples, with the torque held in between.

    Args:
        A: (n, n).
        B: (n, m).
        dt: Time step [s].

    Raises:
        InputError: A step that is not above 0, or so long that the model overflows.

    Warns:
        ImplausibleWarning: A step above 1 s.
    """
    from scipy.linalg import expm

    step = real("dt", dt, minimum=0.0, strict=True)
    n, m = B.shape
    both = np.zeros((n + m, n + m))
    both[:n, :n] = A
    both[:n, n:] = B
    with np.errstate(all="ignore"):
        power = expm(step * both)
    if not np.isfinite(power).all():
        fastest = float(np.abs(np.linalg.eigvals(A)).max())
        expected = f"a time step [s] of the order of {1 / fastest:.1g} or less"
        raise InputError("dt", dt, expected)
    plausibility.check("dt", step, plausibility.TIME_STEP)
    return LinearModel(power[:n, :n], power[:n, n:])
