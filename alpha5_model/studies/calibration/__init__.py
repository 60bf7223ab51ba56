"""Calibration from your own measurements: which poses to take, and what they say.

`plan_poses` proposes poses for a sensor: `scales`, `weight`, `force_torque`, `efforts`
or `vehicle_tilt`. `plan_excitation` proposes a motion for a force-torque sensor or
efforts. `session` holds their
readings, and `fit` makes an arm file of them, with the covariance of its numbers, and
names what is wrong with the readings. A plan is written by `session_text`, and read
with its readings by `read_session`. `motors` estimates friction and torque per ampere
of the motors from recorded currents.
"""

from alpha5_model.studies.calibration.calibration import Calibration, fit
from alpha5_model.studies.calibration.excitation import (
    Excitation,
    plan_excitation,
)
from alpha5_model.studies.calibration.motor_currents import (
    MotorCalibration,
    Payload,
    motors,
)
from alpha5_model.studies.calibration.motor_record import JointMotor
from alpha5_model.studies.calibration.plan_file import read_session, session_text
from alpha5_model.studies.calibration.poses import plan_poses
from alpha5_model.studies.calibration.problems import Problem
from alpha5_model.studies.calibration.sensors import (
    Sensor,
    efforts,
    force_torque,
    scales,
    weight,
)
from alpha5_model.studies.calibration.sessions import (
    Session,
    session,
    with_readings,
)
from alpha5_model.studies.calibration.tilt_sensor import vehicle_tilt

__all__ = [
    "Calibration",
    "Excitation",
    "JointMotor",
    "MotorCalibration",
    "Payload",
    "Problem",
    "Sensor",
    "Session",
    "efforts",
    "fit",
    "force_torque",
    "motors",
    "plan_excitation",
    "plan_poses",
    "read_session",
    "scales",
    "session",
    "session_text",
    "vehicle_tilt",
    "weight",
    "with_readings",
]
