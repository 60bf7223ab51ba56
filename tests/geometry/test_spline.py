"""The spline of the finger's centre line, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from alpha5_model.geometry.spline import cubic_spline


@pytest.mark.parametrize("count", [4, 5, 9, 30])
def test_it_is_scipys(count: int) -> None:
    rng = np.random.default_rng(count)
    knots = np.cumsum(rng.uniform(0.1, 1.0, count))
    values = rng.normal(size=(count, 2))
    at = np.concatenate([knots, rng.uniform(knots[0], knots[-1], 200)])
    expected = CubicSpline(knots, values)(at)
    assert cubic_spline(knots, values, at) == pytest.approx(expected, abs=1e-12)


def test_it_goes_through_the_points_of_a_cubic() -> None:
    knots = np.array([-1.0, 0.0, 0.5, 2.0, 3.0])
    at = np.linspace(-1.0, 3.0, 41)
    cubic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.25])
    found = cubic_spline(knots, cubic(knots)[:, None], at)[:, 0]
    assert found == pytest.approx(cubic(at), abs=1e-13)
