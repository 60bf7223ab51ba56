"""Bounds of numbers that can be computed with, at the bound itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from alpha5_model._support import checks
from alpha5_model.errors import InputError, NonFiniteError


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_largest_number_is_taken_and_the_next_is_not(sign: float) -> None:
    largest = sign * checks.LARGEST
    row = np.array([0.0, largest, 1.0])
    assert checks.bounded("q", row) is row
    assert checks.real("mass", largest) == largest
    beyond = math.nextafter(largest, sign * math.inf)
    with pytest.raises(InputError, match=r"^q: .*numbers of at most"):
        checks.bounded("q", np.array([0.0, beyond, 1.0]))
    with pytest.raises(InputError, match=r"^mass"):
        checks.real("mass", beyond)


@pytest.mark.filterwarnings("error")
def test_a_signalling_nan_is_refused_without_a_warning() -> None:
    row = np.frombuffer(b"\x00\x00\xa0\x7f" * 3, "<f4")
    with pytest.raises(NonFiniteError, match=r"^q"):
        checks.float_array("q", row, (3,))


def test_rotations_are_told_from_other_matrices_one_by_one() -> None:
    rng = np.random.default_rng(4)
    turns = Rotation.random(30, random_state=5).as_matrix()
    others = [-turns, 1.001 * turns, turns + rng.normal(0.0, 0.01, (30, 3, 3))]
    for matrices, expected in [(turns, True), *((other, False) for other in others)]:
        found = checks.is_rotation(matrices)
        assert found.tolist() == [expected] * 30
        single = [bool(checks.is_rotation(matrix)) for matrix in matrices]
        assert single == [expected] * 30
        assert checks.is_rotation(matrices.reshape(5, 6, 3, 3)).shape == (5, 6)
