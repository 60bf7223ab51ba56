"""How far the uncertain numbers of an arm move torques, loads and energies.

All are linear in the derivatives of the loads that `load_slopes` has, so one Jacobian
serves them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.actuators import Interval
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.kernel_numbers import moments_of_links
from alpha5_model.dynamics.load import load, loaded
from alpha5_model.dynamics.states import is_one_state, rows
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.arm_numbers import (
    arm_numbers,
    gravity_slopes,
    load_slopes,
    loads,
    moments_of_record,
)

#: Joints of the arm without its jaws.
_JOINTS = 4
#: Moments that are the rounding of a URDF's digits.
_ROUNDING = 1e-9


class Bounds(NamedTuple):
    """Lower and upper bounds; one state has no axis N.

    Attributes:
        torque: Of the joints, (N, nv) [N m], of the jaw rod [N].
        base_wrench: Force and moment on the mount in base_link, (N, 6) [N, N m].
        kinetic_energy: (N,) [J].
        potential_energy: Of weight and buoyancy, (N,) [J].
    """

    torque: Interval
    base_wrench: Interval
    kinetic_energy: Interval
    potential_energy: Interval


def bounds(
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    arm: Alpha5Parameters | Arm | None = None,
) -> Bounds:
    """What an arm gives, ± what the half widths of its numbers leave open.

    The ± is the worst case to first order: the sum over all numbers of half width times
    the magnitude of the derivative. Masses, centres, tensors, volumes, lengths, zeros,
    attached bodies and the turn of the mount count, as far as they are not known. The
    numbers of a calibrated arm count with the farthest point of their ellipsoid. Terms
    of second order are left out. For the printed digits they are below 0.4 % of the ±.

    Args:
        q, v, a: (4,) each, or (N, 4); (5,) or (N, 5) with jaws. One row is used for all
            states.
        arm: On a fixed base in still water; a record, or None for the catalogue's, is
            the bare arm in sea water. What its record says of half widths holds, its
            other numbers have those of the printed digits. Fluid, gravity and payload
            are known, and so is link 4's share of jaws that move.

    Raises:
        InputError: As of `Arm.inverse_dynamics_batch`, or another arm.
    """
    arm = loaded(arm)
    if arm.floating_base or arm.has_hydrodynamics:
        raise InputError("arm", arm, "one on a fixed base in still water")
    _check_dimensions(arm)
    one = is_one_state(q, v, a)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    slopes = _Slopes(arm, q)
    width = slopes.numbers.half_width_of
    of_loads = width(slopes.loads(v, a))
    values = (
        arm.inverse_dynamics_batch(q, v, a),
        arm.base_wrench_batch(q, v, a),
        np.array([arm.kinetic_energy(*state) for state in zip(q, v, strict=True)]),
        np.array([arm.potential_energy(row) for row in q]),
    )
    half_widths = (
        _of_joints(of_loads, arm),
        of_loads[:, _JOINTS:],
        width(slopes.kinetic_energy(v)),
        width(slopes.potential_energy()),
    )
    intervals = []
    for value, half in zip(values, half_widths, strict=True):
        lower, upper = value - half, value + half
        intervals.append(
            Interval(lower=lower[0] if one else lower, upper=upper[0] if one else upper)
        )
    return Bounds(*intervals)


def torque_margin(arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> FloatArray:
    """How far the numbers of any arm on a fixed base move its torques, see `bounds`.

    Moving water counts as known.

    Returns:
        Lowest and highest difference, (2, nv) or (2, N, nv).

    Raises:
        InputError: An arm with other dimensions than those of its record.
    """
    _check_dimensions(arm)
    one = is_one_state(q, v, a)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    slopes = _Slopes(arm, q)
    half = _of_joints(slopes.numbers.half_width_of(slopes.loads(v, a)), arm)
    half = half[0] if one else half
    return np.array([-half, half])


class _Slopes:
    """Derivatives by the numbers of an arm (K) at positions (N, nv).

    Attributes:
        numbers: Of the arm's record.
    """

    def __init__(self, arm: Arm, q: FloatArray) -> None:
        self.numbers = arm_numbers(arm.parameters)
        self._q = _without_jaws(q)
        self._still = np.zeros_like(self._q)
        self._gravity = np.array(arm._model.gravity.linear)
        self._density = arm.fluid_density
        self._carried = _carried(arm)
        # The turn of the mount turns gravity in base_link, in which loads are linear.
        self._turns = gravity_slopes(self.numbers, self._gravity)
        by_axis = [
            loads(
                self.numbers.arm,
                self._density,
                axis,
                self._q,
                self._still,
                self._still,
                self._carried,
            )
            for axis in np.eye(3)
        ]
        self._by_gravity = np.stack(by_axis, axis=-1)  # (N, 10, 3)

    def loads(self, v: FloatArray, a: FloatArray) -> FloatArray:
        """Of torques, then force and moment on the mount, (N, 10, K)."""
        of_arm = self._under(self._gravity, _without_jaws(v), _without_jaws(a))
        return of_arm + self._by_gravity @ self._turns.T

    def kinetic_energy(self, v: FloatArray) -> FloatArray:
        """(N, K).

        The energy v^T M v / 2 is half of v times the torque M v, which accelerates the
        arm from rest by v.
        """
        v = _without_jaws(v)
        torque = self._under(np.zeros(3), self._still, v)[:, :_JOINTS]
        return np.asarray((v[:, :, None] * torque).sum(axis=1) / 2)

    def potential_energy(self) -> FloatArray:
        """(N, K), of ``-g . S`` with the first moments S of all bodies."""
        along_x, along_y, _ = np.eye(3)
        x = self._under(along_x, self._still, self._still)
        y = self._under(along_y, self._still, self._still)
        by_numbers = np.tensordot(_first_moments(x, y), self._gravity, (0, 0))
        moments = _first_moments(self._by_gravity[..., 0], self._by_gravity[..., 1])
        return np.asarray(-by_numbers - moments.T @ self._turns.T)

    def _under(self, gravity: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """`load_slopes` under some gravity."""
        return load_slopes(
            self.numbers, self._density, gravity, self._q, v, a, self._carried
        )


def _first_moments(x: FloatArray, y: FloatArray) -> FloatArray:
    """The sum S of the first moments m r of all bodies, less their water's, (3, ...).

    Args:
        x, y: Loads under gravity of 1 m/s^2 along x and along y, (N, 10, ...). Their
            last rows are the moments ``S x e_x`` and ``S x e_y``.
    """
    return np.array([y[:, 9], -x[:, 9], x[:, 8]])


def _carried(arm: Arm) -> FloatArray | None:
    """Moments of the payload on each link, (5, 2, 4, 4); None without one."""
    record = arm.parameters
    own = moments_of_record(record, arm.fluid_density)
    if len(arm.joint_names) > _JOINTS:
        # Jaws that move are not part of link 4 in the model.
        own = moments_of_links(load(arm.fluid_density, "jaws", arm=record))[:5]
    carried = moments_of_links(arm)[:5] - own
    return carried if np.abs(carried).max() > _ROUNDING else None


def _without_jaws(rows: FloatArray) -> FloatArray:
    """The columns of the joints that kernels know, as they take them."""
    return np.ascontiguousarray(rows[:, :_JOINTS])


def _of_joints(loads: FloatArray, arm: Arm) -> FloatArray:
    """The torques of loads (N, 10), 0 for the jaw rod, (N, nv)."""
    out = np.zeros((len(loads), arm._model.nv))
    out[:, :_JOINTS] = loads[:, :_JOINTS]
    return out


def _check_dimensions(arm: Arm) -> None:
    """Refuse an arm whose joints are not those of its record."""
    check_dimensions(
        arm._model, "the margin of the uncertain numbers", arm=arm.parameters
    )
