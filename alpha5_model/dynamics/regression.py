"""Inverse dynamics as a matrix times the base parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import BASE_PARAMETERS
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.states import is_one_state, rows
from alpha5_model.kernels import choice as kernels

#: Base parameters without the gravity.
NAMES = tuple(BASE_PARAMETERS)[:-3]


@dataclass(frozen=True, eq=False)
class Regressor:
    """``tau = matrix @ parameters`` [Khalil2002].

    See `alpha5_model.codegen.regrouping`.

    Attributes:
        matrix: (nv, 38), or (N, nv, 38) of many states; columns are derivatives with
            respect to the parameters.
        parameters: Base parameters of the arm in its fluid, payloads included, (38,).
        names, units: Of the parameters; those of link_0 load the mount only.
    """

    matrix: FloatArray
    parameters: FloatArray
    names: tuple[str, ...]
    units: tuple[str, ...]


def regressor(arm: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Regressor:
    """Regressor of an arm; see `alpha5_model.dynamics.arm.Arm.regressor`."""
    numbers = arm_parameters(arm)
    single = is_one_state(q, v, a)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    dimensions = arm_dimensions(arm)
    of_joints = regressor_rows(q, v, a, numbers[-3:], dimensions)[:, :4]
    return Regressor(
        matrix=of_joints[0] if single else of_joints,
        parameters=numbers[:-3],
        names=NAMES,
        units=tuple(BASE_PARAMETERS[name] for name in NAMES),
    )


def regressor_rows(
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    gravity: ArrayLike,
    dimensions: FloatArray,
) -> FloatArray:
    """Matrices of joint torques, then force and moment on the mount, (N, 10, 38).

    Args:
        q, v, a: (N, 4) each, checked.
        gravity: In base_link, (3,) [m/s^2].
        dimensions: Of the arm, see `arm_dimensions`.

    Returns:
        Rows 0 to 3 are the joints', rows 4 to 9 the mount's in base_link.
    """
    out = np.empty((len(q), 10, len(NAMES)))
    for k in range(len(NAMES)):
        only_k = np.arange(len(NAMES)) == k
        numbers = np.concatenate([only_k, gravity, dimensions])
        tau, wrench = kernels.rows(
            "inverse_dynamics_with_base_wrench", numbers, q, v, a
        )
        out[:, :4, k] = tau
        out[:, 4:, k] = wrench
    return out
