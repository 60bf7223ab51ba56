"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


def test_a_batch_of_no_states_with_one_row_for_all():
    for gripper, n in (("locked", 4), ("jaws", 5)):
        arm, empty = a5.load(gripper=gripper), np.zeros((0, n))
        assert arm.forward_dynamics_batch(empty, empty, np.ones((1, n))).shape == (0, n)


def test_ragged_lists_of_states_are_refused():
    ragged = [[1.0], "a"]
    with pytest.raises(InputError, match="v:"):
        a5.load().regressor(np.zeros(4), ragged, np.zeros(4))
    with pytest.raises(InputError, match="a:"):
        a5.uncertainty.bounds(np.zeros(4), np.zeros(4), ragged)
