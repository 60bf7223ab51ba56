"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

from alpha5_model.errors import InputError


def test_a_mount_is_three_numbers_not_rows_of_them():
    from alpha5_model.description.urdf import Variant

    with pytest.raises(InputError, match="xyz"):
        Variant(parent="rov", xyz=np.zeros((2, 3)))
    for name in ("dh_frames", "ros2_control"):
        with pytest.raises(InputError, match=name):
            Variant(**{name: np.zeros(4)})
