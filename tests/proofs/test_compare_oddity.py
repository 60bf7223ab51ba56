"""How odd an alignment of a compared arm is: the cost that ranks the possible ones."""

from __future__ import annotations

import numpy as np
import pytest

from alpha5_model.proofs.comparison.oddity import misplacement


@pytest.mark.parametrize(
    ("off", "expected"),
    [
        ([], 0.0),
        ([0.0], 0.0),
        ([0.025], 0.5),
        ([0.05], 1.0),
        ([3.0], 1.0),
        ([0.0, 0.01, 3.0], (0.0 + 0.2 + 1.0) / 3),
    ],
)
def test_a_body_off_by_50_mm_or_more_is_elsewhere(
    off: list[float], expected: float
) -> None:
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    points = np.multiply.outer(np.array(off), direction)
    assert misplacement(points) == pytest.approx(expected)
