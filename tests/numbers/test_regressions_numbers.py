"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


def test_what_almost_vanishes_is_no_rotation():
    for nothing in (np.eye(3) * 5e-324, np.full((3, 3), 5e-324)):
        with pytest.raises(InputError, match="rotation"):
            a5.gravity_in_base(nothing)
