"""The sensors that there are."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from alpha5_model.studies.calibration.kitchen_scales import scales, weight
from alpha5_model.studies.calibration.sensor import Sensor
from alpha5_model.studies.calibration.tilting_vehicle import vehicle_tilt
from alpha5_model.studies.calibration.torque_sensors import efforts, force_torque

#: Kind of sensor -> the function that makes it.
SENSORS: Mapping[str, Callable[..., Sensor]] = {
    "scales": scales,
    "weight": weight,
    "force-torque": force_torque,
    "efforts": efforts,
    "vehicle-tilt": vehicle_tilt,
}
