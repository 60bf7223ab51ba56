"""An arm on a vehicle that tilts with it, for many states at a time.

Joint torque and load on the mount are linear in gravity: weight and buoyancy both have
its direction. So four arms are enough for every attitude: one without gravity, which
moves, and one at rest for each axis of base_link along which gravity may pull.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.water.carrier import Carrier
from alpha5_model.water.vehicle import trim_angles

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Magnitude of gravity [m/s^2].
_G = float(np.linalg.norm(GRAVITY))


class TrimmedArm:
    """The arm on a vehicle in its static trim in still water.

    Attributes:
        still: The arm without gravity, in still water.
    """

    def __init__(
        self,
        vehicle: Carrier,
        density: float,
        arm_in: Callable[[FloatArray], Arm],
        moving: Any = None,
    ) -> None:
        """Make the arms that pull the vehicle.

        Args:
            vehicle: The vehicle.
            density: Of the fluid [kg/m^3].
            arm_in: The arm, with what it carries, for a gravity in base_link.
            moving: The arm without gravity, an `Arm` or `HydrodynamicArm`; None for
                that of ``arm_in``.
        """
        self._vehicle = vehicle
        self._own_lever = vehicle.lever(density)
        self._pulled = [arm_in(_G * axis) for axis in np.eye(3)]
        self._moving = arm_in(np.zeros(3)) if moving is None else moving
        self.still: Arm = getattr(self._moving, "still", self._moving)

    @property
    def limits(self) -> Any:
        """Those of the arm."""
        return self.still.limits

    def trim(self, q: FloatArray) -> FloatArray:
        """Roll and pitch of the vehicle, yaw 0, (N, 2) [rad].

        Args:
            q: (N, 4).
        """
        return np.column_stack(trim_angles(self._upward(q)))

    def inverse_dynamics_batch(
        self, q: FloatArray, v: FloatArray, a: FloatArray, threads: int
    ) -> FloatArray:
        """Joint torque, (N, 4) [N m]; see `Arm.inverse_dynamics_batch`."""
        torque = self._moving.inverse_dynamics_batch(q, v, a, threads)
        rest = np.zeros_like(q)
        for arm, share in zip(self._pulled, self._shares(q).T, strict=True):
            static = arm.inverse_dynamics_batch(q, rest, rest, threads)
            torque = torque + share[:, None] * static
        return torque

    def base_wrench_batch(
        self, q: FloatArray, v: FloatArray, a: FloatArray, threads: int
    ) -> FloatArray:
        """Load on the mount in base_link, (N, 6); see `Arm.base_wrench_batch`."""
        wrench = self._moving.base_wrench_batch(q, v, a, threads)
        for arm, share in zip(self._pulled, self._shares(q).T, strict=True):
            wrench = wrench + share[:, None] * _static_wrench(arm, q)
        return wrench

    def _shares(self, q: FloatArray) -> FloatArray:
        """The direction of gravity in base_link, (N, 3)."""
        upward = self._upward(q)
        down = -upward / np.linalg.norm(upward, axis=1, keepdims=True)
        return np.asarray(down @ self._vehicle.mount[:3, :3])

    def _upward(self, q: FloatArray) -> FloatArray:
        """The vector of the vehicle's frame that points up at the trim, (N, 3).

        Weight less buoyancy of the arm act as a net mass m at c of base_link. Their
        force on the mount is ``m g``, and their moment ``m c x g``.
        """
        along_x = _static_wrench(self._pulled[0], q)
        along_z = _static_wrench(self._pulled[2], q)
        net_mass = along_x[:, :1] / _G
        lever_x = -along_z[:, 4]
        lever_y = along_z[:, 3]
        lever_z = along_x[:, 4]
        lever_in_base = np.column_stack([lever_x, lever_y, lever_z]) / _G

        mount = self._vehicle.mount
        lever = lever_in_base @ mount[:3, :3].T + net_mass * mount[:3, 3]
        return np.asarray(-(lever + self._own_lever))


def _static_wrench(arm: Arm, q: FloatArray) -> FloatArray:
    """The load of the arm at rest on its mount, (N, 6)."""
    rest = np.zeros_like(q)
    return arm.base_wrench_batch(q, rest, rest, 1)
