"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


@pytest.mark.parametrize("accept", ["é", False, [], np.eye(3)])
def test_what_accepts_is_a_function(accept):
    with pytest.raises(InputError, match="accept"):
        a5.reachable((0.3, 0, 0.1), accept=accept)


def test_a_distance_beyond_all_numbers_is_refused():
    assert a5.distance_to_reach((1.7e308, 0, 0)) == pytest.approx(1.7e308)
    with pytest.raises(InputError, match="position"):
        a5.distance_to_reach(np.full((2, 3), 1.7e308))
    with pytest.raises(InputError, match="gravity"):
        a5.gravity_in_base(np.eye(3), np.full(3, 1.7e308))
