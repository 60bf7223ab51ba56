"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


def test_what_almost_vanishes_is_no_rotation_and_no_mass():
    from alpha5_model.numbers import inertia

    for nothing in (np.eye(3) * 5e-324, np.full((3, 3), 5e-324)):
        with pytest.raises(InputError, match="rotation"):
            a5.gravity_in_base(nothing)
    with pytest.raises(InputError, match="mass"):
        inertia.radii_of_gyration(5e-324, np.eye(3))


@pytest.mark.parametrize("tensor", [[[1.0, 2.0]], "x", np.full((3, 3), np.nan)])
def test_a_possible_body_is_made_of_numbers(tensor):
    from alpha5_model.numbers import inertia

    inertia.check_possible("x", 0.0, [0.0, 0.0, 0.0], np.zeros((3, 3)).tolist())
    with pytest.raises(InputError, match="inertia_com"):
        inertia.check_possible("x", 1.0, [0.0, 0.0, 0.0], tensor)
