"""The numbers that an identification found, and the torques that follow from them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.dynamics.states import rows
from alpha5_model.studies.uncertainty.recorded import TORQUES
from alpha5_model.studies.uncertainty.unknowns import Unknowns


class Prediction(NamedTuple):
    """Torques with their uncertainty, (N, 4) each [N m].

    Attributes:
        torque: Expected.
        deviation: Standard deviation; a 95 % interval is 1.96 times that to both sides.
    """

    torque: FloatArray
    deviation: FloatArray


@dataclass(frozen=True, eq=False)
class FittedNumbers:
    """Printed and measured numbers that a recording was fitted by.

    Lengths and zeros are among them, which base parameters do not tell.

    Attributes:
        names: As of `alpha5_model.uncertainty.printed_numbers`, or the keys of the
            arm's file, (k,).
        values: (k,), SI units.
        covariance: (k, k), SI units.
    """

    names: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray
    _arm: Arm = field(repr=False)
    _unknowns: Unknowns = field(repr=False)
    _z: FloatArray = field(repr=False)
    _factor: FloatArray = field(repr=False)
    _known: FloatArray = field(repr=False)

    @property
    def deviation(self) -> FloatArray:
        """Standard deviations, (k,), SI units."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def torque(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Prediction:
        """Torques of other states of the same arm, in the same water.

        Args:
            q, v, a: (4,) each, or (N, 4); one row is used for all states.

        Raises:
            InputError: As of `Arm.inverse_dynamics_batch`.
        """
        arm = self._arm
        q, v, a = rows(arm._model, q=q, v=v, a=a)
        gravity = arm_parameters(arm)[-3:]
        regressor = regressor_rows(q, v, a, gravity, arm_dimensions(arm))[:, TORQUES]
        geometry = self._unknowns.by_geometry(q, v, a, TORQUES)
        base_parameters = self._unknowns.base_parameters(self._z) + self._known
        slope = regressor @ self._unknowns.slope.T + geometry
        return Prediction(
            torque=regressor @ base_parameters + geometry @ self._z,
            deviation=np.linalg.norm(slope @ self._factor, axis=-1),
        )


def fitted_numbers(
    arm: Arm,
    unknowns: Unknowns,
    z: FloatArray,
    factor: FloatArray,
    known: FloatArray,
) -> FittedNumbers:
    """The numbers of a fit.

    Args:
        arm: That was recorded.
        unknowns: Its uncertain numbers.
        z: Their scaled values, (k,).
        factor: Times its transpose, the covariance of z, (k, k).
        known: Base parameters of what the arm carries beside them, (38,).
    """
    scaled = unknowns.half_width[:, None] * factor
    return FittedNumbers(
        names=unknowns.names,
        values=unknowns.middle + unknowns.half_width * z,
        covariance=scaled @ scaled.T,
        _arm=arm,
        _unknowns=unknowns,
        _z=z,
        _factor=factor,
        _known=known,
    )
