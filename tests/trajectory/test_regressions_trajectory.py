"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


@pytest.mark.parametrize("method", ["voltage", "torque", "holding_torque"])
def test_currents_that_overflow_are_refused(method):
    with pytest.raises(InputError, match="current"):
        getattr(a5.actuators.actuator("axis_b"), method)(1.7e308)


def test_the_joints_of_a_motion_are_names():
    time, position = np.arange(6.0), np.ones((6, 4))
    with pytest.raises(InputError, match="joints"):
        a5.trajectory.motion(time, position, joints=4)


def test_drive_limits_are_kept_as_plain_numbers():
    position = np.linspace(0.5, 1.0, 24).reshape(6, 4)
    motion = a5.trajectory.motion(np.arange(6) * 0.1, position)
    given = {"supply_voltage": np.longdouble(24), "current_limit": np.float32(1.5)}
    analysis = a5.trajectory.analyse(motion, **given)
    assert (type(analysis.supply_voltage), type(analysis.current_limit)) == (
        float,
        float,
    )
