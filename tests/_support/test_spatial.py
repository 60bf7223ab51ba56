"""Rotations, transforms and angles against SciPy's, near the singular pitch as well."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from alpha5_model._support import spatial

rng = np.random.default_rng(8)


@pytest.mark.parametrize("off", [None, 0.0, 1e-12, 1e-10, 1e-8, 1e-5, 1e-3, 2e-3])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_roll_pitch_yaw_there_and_back(off: float | None, sign: float) -> None:
    for rpy in rng.uniform(-np.pi, np.pi, (50, 3)):
        if off is not None:
            rpy[1] = sign * (np.pi / 2 - off)
        matrix = spatial.rotation_from_rpy(rpy)
        expected = Rotation.from_euler("xyz", rpy)
        np.testing.assert_allclose(matrix, expected.as_matrix(), atol=1e-15)
        again = spatial.rpy_from_rotation(matrix)
        # within 1e-9 of the singular pitch the roll is called zero
        bound = 1e-9 if off in (1e-12, 1e-10) else 2e-15
        np.testing.assert_allclose(spatial.rotation_from_rpy(again), matrix, atol=bound)
        quaternion = np.array(spatial.quaternion_from_rpy(rpy))
        assert abs(quaternion @ expected.as_quat()) == pytest.approx(1.0, abs=1e-15)


def test_rotation_about_an_axis() -> None:
    for vector, angle in zip(
        rng.normal(size=(50, 3)), rng.uniform(-9, 9, 50), strict=True
    ):
        axis = vector / np.linalg.norm(vector)
        expected = Rotation.from_rotvec(angle * axis).as_matrix()
        np.testing.assert_allclose(
            spatial.rotation_about(axis, angle), expected, atol=2e-15
        )


def test_cross_matrix() -> None:
    v, w = rng.normal(size=(2, 3))
    np.testing.assert_allclose(spatial.cross_matrix(v) @ w, np.cross(v, w), atol=1e-15)


@pytest.mark.parametrize("middle", [0.0, 2.0, -70.0])
def test_wrap(middle: float) -> None:
    angle = rng.uniform(-100, 100, (20, 4))
    wrapped = spatial.wrap(angle, middle)
    assert (np.abs(wrapped - middle) <= np.pi + 1e-12).all()
    np.testing.assert_allclose(np.exp(1j * wrapped), np.exp(1j * angle), atol=1e-13)


def test_transforms() -> None:
    xyz, rpy = rng.normal(size=(2, 3))
    placed = spatial.pose(xyz, rpy)
    np.testing.assert_allclose(
        placed[:3, :3], Rotation.from_euler("xyz", rpy).as_matrix()
    )
    np.testing.assert_array_equal(placed[:3, 3], xyz)
    np.testing.assert_array_equal(placed[3], [0, 0, 0, 1])
    np.testing.assert_array_equal(spatial.transform(), np.eye(4))
