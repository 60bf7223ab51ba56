"""The tilt of a floating vehicle as a sensor that weighs the arm that it carries.

At rest, weight and buoyancy of vehicle and arm have no moment about the vehicle's
origin. With the lever ``S = sum (m c - rho V b)`` of all bodies in the vehicle's axes,
the moment is ``S x g``. So -S points up. For small changes the tilt is the arm's moment
over a stiffness.

If weight and buoyancy of the whole differ, a thrust holds the depth. It is taken to act
at the vehicle's origin.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, real
from alpha5_model._support.spatial import rotation_about, rpy_from_rotation
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.studies.calibration.sensor import (
    Loads,
    Own,
    Sensor,
    deviations,
    scaled,
)
from alpha5_model.water.carrier import Carrier
from alpha5_model.water.vehicle import Vehicle, carrier_of, trim_angles

#: Share of its weight that buoyancy must carry: the tilt of thrust is not known.
_LEAST_BUOYANCY = 0.8
#: Units of angles in files.
_ANGLES = {"deg": np.pi / 180, "rad": 1.0}
#: Where the force along x and the moments about x and y are in `Loads`.
_FORCE_X = 4
_MOMENT_X = 7
_MOMENT_Y = 8


@dataclass(frozen=True, eq=False)
class VehicleTilt(Sensor):
    """Roll and pitch of a vehicle; make it with `vehicle_tilt`."""

    kind = "vehicle-tilt"
    channels = ("roll", "pitch")
    unit = ("rad", "rad")
    units = _ANGLES
    guide = (
        "Let the vehicle float without thrust. Move to each pose, wait until it is",
        "still, and write its roll and pitch: turns about fixed axes, x forward, y to",
        "the left, z up.",
    )

    vehicle: Carrier
    noise: FloatArray
    offset: FloatArray
    yaw: float

    @property
    def deviation(self) -> FloatArray:
        return self.noise

    def own(self, moves: bool) -> tuple[Own, ...]:
        return (
            Own("gain", self.channels, self.gain),
            Own("offset", self.channels, self.offset),
            Own("yaw", ("",), np.array([self.yaw])),
        )

    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        # A lever S gives the moments S x e_x = (0, S_z, -S_y) and S x e_z =
        # (S_y, -S_x, 0) on the mount, in gravity of 1 m/s^2 along e_x and e_z.
        along_x = loads.still[..., 0]
        along_z = loads.still[..., 2]
        of_arm = np.stack(
            [-along_z[:, _MOMENT_Y], along_z[:, _MOMENT_X], along_x[:, _MOMENT_Y]], -1
        )
        net_mass = along_x[:, _FORCE_X, None]

        mount = self.vehicle.mount
        yaw = rotation_about((0.0, 0.0, 1.0), own["yaw"].item())
        to_vehicle = yaw @ mount[:3, :3] @ loads.turn
        lever = of_arm @ to_vehicle.T + net_mass * mount[:3, 3]
        upward = -(lever + self.vehicle.lever(loads.density))
        return scaled(np.column_stack(trim_angles(upward)), own)

    def settings(self) -> dict[str, Any]:
        carrier = self.vehicle
        vehicle = {
            "mass": carrier.mass,
            "com": carrier.com,
            "volume": carrier.volume,
            "cob": carrier.cob,
            "xyz": carrier.mount[:3, 3],
            "rpy": np.array(rpy_from_rotation(carrier.mount[:3, :3])),
        }
        return {**super().settings(), "vehicle": vehicle}

    def usual_gravity(self) -> FloatArray:
        """That of a level vehicle."""
        return np.asarray(self.vehicle.mount[:3, :3].T @ GRAVITY)

    def check(self, gravity: FloatArray, density: float, moves: bool) -> None:
        if not np.allclose(gravity, self.usual_gravity(), rtol=0.0, atol=1e-6):
            expected = "none: the vehicle's tilt says where gravity pulls"
            raise InputError("gravity", gravity.tolist(), expected)
        if moves:
            raise InputError("v, a", "an arm that moves", "an arm at rest")
        displaced = density * self.vehicle.volume
        if displaced < _LEAST_BUOYANCY * self.vehicle.mass:
            found = f"{displaced:.3g} kg displaced by {self.vehicle.mass:g} kg"
            raise InputError("vehicle", found, "a vehicle that floats in this fluid")
        height = -self.vehicle.lever(density)[2]
        if height <= 0.0:
            expected = "a vehicle that rights itself: volume density cob_z > mass com_z"
            raise InputError("vehicle", f"{height:.3g} kg m", expected)

    def check_readings(self, readings: FloatArray) -> None:
        beyond = readings[np.abs(readings) > np.pi / 2]
        if beyond.size:
            expected = "roll and pitch in rad, within a quarter turn"
            raise InputError("readings", float(beyond[0]), expected)


def vehicle_tilt(
    vehicle: Vehicle | Mapping[str, Any],
    *,
    noise: ArrayLike = 0.002,
    gain: ArrayLike = 0.02,
    offset: ArrayLike = 0.2,
    yaw: float = 0.035,
) -> Sensor:
    """Roll and pitch [rad] of a vehicle that floats at rest, without thrust.

    Args:
        vehicle: Without the arm: ``mass`` [kg], centre of mass ``com`` [m], displaced
            ``volume`` [m^3], centre of buoyancy ``cob`` [m], both in its own frame (z
            up if it is level), and the pose of base_link there, ``xyz`` [m] and ``rpy``
            [rad], which are 0 if they are not given. Or an `alpha5_model.Vehicle`.
        noise: Standard deviation of a reading [rad].
        gain: That of the factor of roll and of pitch: the vehicle's stiffness, which is
            its weight times the height of its centre of buoyancy above that of mass.
        offset: That of roll and pitch with a level arm: trim, ballast, and the attitude
            sensor's own mount [rad].
        yaw: That of the arm's turn about the vehicle's z axis [rad].

    Raises:
        InputError: Not such numbers, or a noise not above 0.
        UnknownNameError: Another fact of the vehicle.
    """
    return VehicleTilt(
        gain=deviations("gain", gain, 2),
        vehicle=carrier_of("vehicle", vehicle),
        noise=deviations("noise", noise, 2, above_zero=True),
        offset=deviations("offset", offset, 2),
        yaw=real("yaw", yaw, minimum=0.0),
    )
