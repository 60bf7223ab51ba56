"""What the page on inertia claims of products copied with the wrong sign."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.numbers.inertia import (
    flip_products,
    principal_moments,
    second_moments,
)


def test_a_mirror_keeps_the_moments_and_copied_products_do_not() -> None:
    link = a5.parameters().links[3].inertia
    for axis in range(3):
        mirror = np.eye(3)
        mirror[axis, axis] = -1
        image = mirror @ link @ mirror
        assert (np.sign(image) != np.sign(link)).sum() == 4  # two products, each twice
        np.testing.assert_allclose(
            principal_moments(image), principal_moments(link), rtol=1e-12
        )
    wrong = np.linalg.eigvalsh(flip_products(link))
    assert np.abs(wrong / principal_moments(link) - 1).max() > 1e-3


def test_a_rod_with_copied_products_cannot_be() -> None:
    """A thin rod along (1, 1, 1), whose principal moments are 0, 1 and 1."""
    rod = np.eye(3) - np.ones((3, 3)) / 3
    wrong = flip_products(rod)
    np.testing.assert_allclose(np.linalg.eigvalsh(rod), [0, 1, 1], atol=1e-12)
    np.testing.assert_allclose(
        np.linalg.eigvalsh(wrong), [1 / 3, 1 / 3, 4 / 3], atol=1e-12
    )
    assert principal_moments(second_moments(wrong))[0] == pytest.approx(-1 / 3)
