"""Old names of arguments still work, and say what they are called now."""

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError

FLOW = (0.3, -0.2, 0.1)
Q = (3.0, 1.0, 1.5, 0.4)
NEW = "water_velocity"
REST = (0.0, 0.0, 0.0, 0.0)


def test_the_water_s_velocity_by_its_old_name() -> None:
    arm = a5.load()
    wet = arm.with_hydrodynamics(FLOW)
    expected = wet.inverse_dynamics(Q, REST, REST)
    with pytest.warns(DeprecationWarning, match=NEW) as caught:
        old = arm.with_hydrodynamics(current=FLOW)
    assert caught[0].filename == __file__
    np.testing.assert_array_equal(old.inverse_dynamics(Q, REST, REST), expected)

    still = arm.with_hydrodynamics()
    with pytest.warns(DeprecationWarning, match=NEW):
        given = still.inverse_dynamics(Q, REST, REST, current=FLOW)
    np.testing.assert_array_equal(given, expected)
    with pytest.warns(DeprecationWarning, match=NEW):
        np.testing.assert_array_equal(wet.current, FLOW)


def test_both_names_at_once_are_refused() -> None:
    wet = a5.load().with_hydrodynamics()
    with pytest.raises(InputError, match="current"):
        wet.dissipated_power(Q, REST, current=FLOW, water_velocity=FLOW)
    with pytest.raises(InputError, match="current"):
        wet.dissipated_power(Q, REST, FLOW, current=FLOW)
