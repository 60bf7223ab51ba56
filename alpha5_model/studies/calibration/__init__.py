"""Calibration from your own measurements: which poses to take, and what they say.

`plan_poses` proposes poses for a sensor, such as `scales` or `force_torque`. `session`
holds their readings, or those of a recorded motion. `fit` makes an arm file of them,
with the covariance of its numbers, and names what is wrong with the readings. A plan is
written by `session_text`, and read with its readings by `read_session`. `motors`
estimates friction and torque per ampere of the motors from recorded currents.
"""

from alpha5_model.studies.calibration.causes import Problem
from alpha5_model.studies.calibration.fitting import Calibration, fit
from alpha5_model.studies.calibration.kitchen_scales import scales, weight
from alpha5_model.studies.calibration.motor_currents import (
    MotorCalibration,
    Payload,
    motors,
)
from alpha5_model.studies.calibration.motor_record import JointMotor
from alpha5_model.studies.calibration.poses import plan_poses
from alpha5_model.studies.calibration.sensor import Loads, Own, Sensor
from alpha5_model.studies.calibration.sessions import (
    Session,
    read_session,
    session,
    session_text,
    with_readings,
)
from alpha5_model.studies.calibration.tilting_vehicle import vehicle_tilt
from alpha5_model.studies.calibration.torque_sensors import efforts, force_torque

__all__ = [
    "Calibration",
    "JointMotor",
    "Loads",
    "MotorCalibration",
    "Own",
    "Payload",
    "Problem",
    "Sensor",
    "Session",
    "efforts",
    "fit",
    "force_torque",
    "motors",
    "plan_poses",
    "read_session",
    "scales",
    "session",
    "session_text",
    "vehicle_tilt",
    "weight",
    "with_readings",
]
