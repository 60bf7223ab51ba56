"""The unknowns of an identification: the uncertain numbers that a recording may show.

Torques and loads are linear in the base parameters, which are nearly linear in masses,
centres and tensors. Lengths, zeros and the turn of the mount change the regressor, too.
Their intervals are narrow, so that they count to first order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import regrouped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.dynamics.regression import NAMES, regressor_rows
from alpha5_model.kernels import choice as kernels
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers
from alpha5_model.studies.uncertainty.carried import moments_carried
from alpha5_model.studies.uncertainty.linear_maps import groups, split

#: How the names of numbers begin or end that move joints or turn the mount.
_GEOMETRY_ENDS = (".a", ".d", ".opposite", ".adjacent")
_GEOMETRY_STARTS = ("lengths.", "zeros.", "mount.rpy")


class _Geometry(NamedTuple):
    """An arm with another geometry, as the kernels take it.

    Attributes:
        base_parameters: With all that the arm carries, (38,).
        gravity: In base_link, (3,) [m/s^2].
        dimensions: (24,).
    """

    base_parameters: FloatArray
    gravity: FloatArray
    dimensions: FloatArray


class Unknowns:
    """The numbers z that a recording may show, each scaled to -1 to 1.

    Attributes:
        count: Number of unknowns.
        names: Of the numbers, (count,).
        middle, half_width: Of the numbers' intervals, (count,) each, SI units.
        slope: Derivative of the base parameters by each, at z = 0, (count, 38).
        geometric: Which ones change the regressor, (g,).
    """

    def __init__(self, numbers: ArmNumbers, arm: Arm) -> None:
        self._numbers = numbers
        self._arm = arm
        self._density = arm.fluid_density
        self._by_moments = numbers.grouping(arm.fluid_density)
        of_bodies = numbers.half_width * np.abs(numbers.to_bodies).any(axis=(1, 2)) > 0
        believed = arm.parameters
        if numbers.alternatives:
            believed = numbers.parameters(numbers.middle)
        self._moments = moments_carried(arm, believed)
        candidates = {k: self._ends(k) for k in self._candidates()}
        ends = {k: pair for k, pair in candidates.items() if _moves_joints(*pair)}
        used = np.flatnonzero(of_bodies | np.isin(np.arange(of_bodies.size), [*ends]))

        self._scaled = np.diag(numbers.half_width)[used]
        self.names = tuple(np.array(numbers.names)[used].tolist())
        self.count = len(used)
        self.middle = numbers.middle[used]
        self.half_width = numbers.half_width[used]
        self.geometric = np.array([k for k, at in enumerate(used) if at in ends], int)
        self._ends_of_geometric = [ends[used[k]] for k in self.geometric]

        self._by_geometry = np.zeros((self.count, len(NAMES)))
        for k, (low, high) in zip(self.geometric, self._ends_of_geometric, strict=True):
            change = high.base_parameters - low.base_parameters
            self._by_geometry[k] = change / 2
        unit = np.eye(self.count)
        self.slope = (self.base_parameters(unit) - self.base_parameters(-unit)) / 2

    def base_parameters(self, z: FloatArray) -> FloatArray:
        """Base parameters at z (..., count), without gravity, (..., 38)."""
        bodies = groups(self._numbers.bodies(self._values(z)), self._by_moments)
        return np.asarray(bodies + z @ self._by_geometry)

    def spread_by_geometry(self) -> FloatArray:
        """How far geometry alone can move each base parameter, (38,)."""
        return np.asarray(np.abs(self._by_geometry).sum(axis=0))

    def by_geometry(
        self, q: FloatArray, v: FloatArray, a: FloatArray, channels: slice
    ) -> FloatArray:
        """What the unknowns change beyond ``regressor @ slope``, (N, n, count).

        Args:
            q, v, a: (N, 4) each.
            channels: Of the rows of `regressor_rows`.
        """
        out = np.zeros((len(q), 10, self.count))
        if not self.geometric.size:
            return out[:, channels]
        nominal = self._geometry(self._numbers.arm)
        regressor = regressor_rows(q, v, a, nominal.gravity, nominal.dimensions)
        for k, (low, high) in zip(self.geometric, self._ends_of_geometric, strict=True):
            change = _computed(high, q, v, a) - _computed(low, q, v, a)
            out[:, :, k] = change / 2 - regressor @ self._by_geometry[k]
        return out[:, channels]

    def by_density(self) -> FloatArray:
        """Derivative by the fluid's density, without attached payloads, (38,)."""
        bodies = self._numbers.bodies(self._numbers.middle)
        denser = self._numbers.grouping(self._density + 1.0)
        return groups(bodies, denser) - groups(bodies, self._by_moments)

    def by_mass(self) -> FloatArray:
        """Derivative by each link's mass over its own, (5, 38)."""
        bodies = self._numbers.bodies(self._numbers.middle)
        mass = split(bodies).mass
        nominal = groups(bodies, self._by_moments)
        slopes = []
        for link in range(5):
            heavier = bodies.copy()
            heavier[link, 0] += mass[link]
            slopes.append(groups(heavier, self._by_moments) - nominal)
        return np.array(slopes)

    def parameter_set(self, z: FloatArray) -> Alpha5Parameters:
        """The arm's parameters with these numbers."""
        return self._numbers.parameters(self._values(z))

    def _values(self, z: FloatArray) -> FloatArray:
        """The numbers, (..., K)."""
        return self._numbers.middle + z @ self._scaled

    def _candidates(self) -> list[int]:
        """Indices of the numbers that may change the geometry."""
        return [
            k
            for k, name in enumerate(self._numbers.names)
            if name.endswith(_GEOMETRY_ENDS) or name.startswith(_GEOMETRY_STARTS)
        ]

    def _ends(self, k: int) -> tuple[_Geometry, _Geometry]:
        """The arm at the lower and upper end of a number."""
        low, high = (
            self._numbers.parameters(self._numbers.middle + step)
            for step in np.outer((-1, 1), np.diag(self._numbers.half_width)[k])
        )
        return self._geometry(low), self._geometry(high)

    def _geometry(self, record: Alpha5Parameters) -> _Geometry:
        """The arm's bodies on the joints of another record."""
        gravity = arm_parameters(self._arm)[-3:]
        mount = self._arm.parameters.mount
        if mount is not None and record.mount is not None:
            gravity = record.mount.rotation.T @ mount.rotation @ gravity
        return _Geometry(
            base_parameters=regrouped(self._moments, gravity, record)[:-3],
            gravity=gravity,
            dimensions=Geometry.of(record).dimensions,
        )


def _moves_joints(low: _Geometry, high: _Geometry) -> bool:
    """Whether two geometries differ in more than the tool."""
    same = [
        np.array_equal(low.base_parameters, high.base_parameters),
        np.array_equal(low.gravity, high.gravity),
        # The last 12 dimensions are the tool's.
        np.array_equal(low.dimensions[:-12], high.dimensions[:-12]),
    ]
    return not all(same)


def _computed(
    geometry: _Geometry, q: FloatArray, v: FloatArray, a: FloatArray
) -> FloatArray:
    """Torques and loads, (N, 10)."""
    numbers = np.concatenate(geometry)
    return np.hstack(
        kernels.rows("inverse_dynamics_with_base_wrench", numbers, q, v, a)
    )
