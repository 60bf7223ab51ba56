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
    from alpha5_model.water.arm import HydrodynamicArm

#: Magnitude of gravity [m/s^2].
_G = float(np.linalg.norm(GRAVITY))


class TrimOfVehicle:
    """The static trim of a vehicle in still water, which depends on the arm's pose.

    Attributes:
        vehicle: The vehicle.
    """

    def __init__(
        self, vehicle: Carrier, arm_in: Callable[[FloatArray], Arm], density: float
    ) -> None:
        """Make the arms whose weight and buoyancy the trim depends on.

        Args:
            vehicle: The vehicle.
            arm_in: The arm, with what it carries, for a gravity in base_link.
            density: Of the fluid [kg/m^3].
        """
        self.vehicle = vehicle
        #: The arm with gravity along each axis of base_link.
        self.pulled = [arm_in(_G * axis) for axis in np.eye(3)]
        self._own_lever = vehicle.lever(density)

    def angles(self, q: FloatArray) -> FloatArray:
        """Roll and pitch of the vehicle, yaw 0, (N, 2) [rad].

        Args:
            q: (N, 4).
        """
        return np.column_stack(trim_angles(self._upward(q)))

    def gravity(self, q: FloatArray) -> FloatArray:
        """Gravity in base_link, (N, 3) [m/s^2].

        Args:
            q: (N, 4).
        """
        upward = self._upward(q)
        down = -upward / np.linalg.norm(upward, axis=1, keepdims=True)
        return np.asarray(_G * down @ self.vehicle.mount[:3, :3])

    def _upward(self, q: FloatArray) -> FloatArray:
        """The vector of the vehicle's frame that points up at the trim, (N, 3).

        Weight less buoyancy of the arm act as a net mass m at c of base_link. Their
        force on the mount is ``m g``, and their moment ``m c x g``.
        """
        x, _, z = (_static_wrench(arm, q) for arm in self.pulled)
        lever_in_base = np.column_stack([-z[:, 4], z[:, 3], x[:, 4]]) / _G
        net_mass = x[:, :1] / _G
        mount = self.vehicle.mount
        lever = lever_in_base @ mount[:3, :3].T + net_mass * mount[:3, 3]
        return np.asarray(-(lever + self._own_lever))


class ArmInTrim:
    """The arm on its vehicle in trim: the batches that a study computes.

    Attributes:
        still: The arm without gravity, in still water.
    """

    def __init__(self, moving: Arm | HydrodynamicArm, trim: TrimOfVehicle) -> None:
        """Take in the arms.

        Args:
            moving: The arm without gravity.
            trim: Of its vehicle.
        """
        self._moving = moving
        self._trim = trim
        self.still = getattr(moving, "still", moving)

    @property
    def limits(self) -> Any:
        """Those of the arm."""
        return self.still.limits

    def inverse_dynamics_batch(
        self, q: FloatArray, v: FloatArray, a: FloatArray, threads: int
    ) -> FloatArray:
        """Joint torque, (N, 4) [N m]; see `Arm.inverse_dynamics_batch`."""
        torque = self._moving.inverse_dynamics_batch(q, v, a, threads)
        rest = np.zeros_like(q)
        gravity = self._trim.gravity(q)
        for arm, pull in zip(self._trim.pulled, gravity.T / _G, strict=True):
            static = arm.inverse_dynamics_batch(q, rest, rest, threads)
            torque = torque + pull[:, None] * static
        return torque

    def base_wrench_batch(
        self, q: FloatArray, v: FloatArray, a: FloatArray, threads: int
    ) -> FloatArray:
        """Load on the mount in base_link, (N, 6); see `Arm.base_wrench_batch`."""
        wrench = self._moving.base_wrench_batch(q, v, a, threads)
        gravity = self._trim.gravity(q)
        for arm, pull in zip(self._trim.pulled, gravity.T / _G, strict=True):
            wrench = wrench + pull[:, None] * _static_wrench(arm, q)
        return wrench


def _static_wrench(arm: Arm, q: FloatArray) -> FloatArray:
    """The load of the arm at rest on its mount, (N, 6)."""
    rest = np.zeros_like(q)
    return arm.base_wrench_batch(q, rest, rest, 1)
