"""The tilt of a floating vehicle as a sensor that weighs the arm that it carries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen, real
from alpha5_model.errors import InputError
from alpha5_model.studies.calibration.sensors import LOADS, Sensor
from alpha5_model.water.carrier import Carrier, read_carrier
from alpha5_model.water.vehicle import Vehicle

#: Share of its weight that buoyancy must carry: the tilt of thrust is not known.
_LEAST_BUOYANCY = 0.8
#: Roll and pitch.
_CHANNELS = 2


def vehicle_tilt(
    vehicle: Vehicle | Mapping[str, Any],
    *,
    noise: float = 0.002,
    gain: float = 0.02,
    offset: float = 0.2,
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
    size = real("noise", noise, minimum=0.0, strict=True)
    factor = real("gain", gain, minimum=0.0)
    constant = real("offset", offset, minimum=0.0)
    return Sensor(
        kind="vehicle-tilt",
        channels=("roll", "pitch"),
        unit=("rad", "rad"),
        matrix=frozen(np.zeros((_CHANNELS, LOADS))),
        noise=frozen(np.full(_CHANNELS, size)),
        gain=frozen(np.full(_CHANNELS, factor)),
        offset=frozen(np.full(_CHANNELS, constant)),
        placement=real("yaw", yaw, minimum=0.0),
        carrier=_carrier(vehicle),
    )


def _carrier(vehicle: Vehicle | Mapping[str, Any]) -> Carrier:
    """What the tilt depends on."""
    if not isinstance(vehicle, Vehicle):
        given = dict(vehicle) if isinstance(vehicle, Mapping) else vehicle
        return read_carrier("vehicle", given)
    return Carrier(
        mass=vehicle.mass,
        com=vehicle.com,
        volume=vehicle.volume,
        cob=vehicle.cob,
        mount=vehicle.mount,
    )


def check_floats(carrier: Carrier, density: float) -> None:
    """Refuse a vehicle that does not float upright in a fluid.

    Raises:
        InputError: Thrust would have to carry it, or it does not right itself.
    """
    displaced = density * carrier.volume
    if displaced < _LEAST_BUOYANCY * carrier.mass:
        found = f"{displaced:.3g} kg displaced by {carrier.mass:g} kg"
        raise InputError("vehicle", found, "a vehicle that floats in this fluid")
    height = -carrier.lever(density)[2]
    if height <= 0.0:
        found = f"{height:.3g} kg m"
        expected = "a vehicle that rights itself: volume density cob_z over mass com_z"
        raise InputError("vehicle", found, expected)


def check_readings(readings: FloatArray) -> None:
    """Refuse roll and pitch (N, 2) that are no angles of a vehicle that floats upright.

    Raises:
        InputError: Beyond a quarter turn [rad]; NaN is a reading that is missing.
    """
    beyond = readings[np.abs(readings) > np.pi / 2]
    if beyond.size:
        expected = "roll and pitch in rad, within a quarter turn"
        raise InputError("readings", float(beyond[0]), expected)
