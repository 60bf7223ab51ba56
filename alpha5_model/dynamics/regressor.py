"""Torques and the load on the mount as what they are: linear in the base parameters.

The columns are what the generated kernels give for one base parameter of 1 and none of the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model import kernels
from alpha5_model.base_parameters import BASE_PARAMETERS
from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.batch import arm_parameters
from alpha5_model.dynamics.states import rows

#: Those that are no gravity.
NAMES = tuple(BASE_PARAMETERS)[:-3]


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
