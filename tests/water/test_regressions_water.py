"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


def test_a_masked_added_mass_is_no_added_mass():
    masked = np.ma.MaskedArray(np.ones(6), [True] + [False] * 5)
    with pytest.raises(InputError, match="added_mass"):
        a5.Vehicle(1, np.zeros(3), np.eye(3), 1e-3, np.zeros(3), added_mass=masked)
