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


def test_many_at_a_time_are_the_single_ones() -> None:
    vectors = rng.normal(size=(2, 5, 3))
    axes = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    angles = rng.uniform(-4.0, 4.0, (2, 5))
    crosses = spatial.cross_matrix(vectors[0])
    turns = spatial.rotation_about(axes[0], angles[0])
    poses = spatial.transform(turns, vectors[1])
    points = spatial.moved(poses, vectors[0])
    for k in range(5):
        vector = vectors[0, k]
        np.testing.assert_array_equal(crosses[k], spatial.cross_matrix(vector))
        turn = spatial.rotation_about(axes[0, k], angles[0, k])
        np.testing.assert_allclose(turns[k], turn, atol=1e-15)
        np.testing.assert_array_equal(poses[k, :3, 3], vectors[1, k])
        np.testing.assert_array_equal(poses[k, 3], [0, 0, 0, 1])
        np.testing.assert_allclose(points[k], turn @ vector + vectors[1, k], atol=1e-15)
    # One axis, several angles.
    about_z = spatial.rotation_about([0.0, 0.0, 1.0], angles[0])
    assert about_z.shape == (5, 3, 3)
    np.testing.assert_allclose(about_z[:, 1, 0], np.sin(angles[0]), atol=1e-15)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_at_the_singular_pitch_the_roll_is_zero(sign: float) -> None:
    for roll, yaw in rng.uniform(-np.pi, np.pi, (20, 2)):
        matrix = spatial.rotation_from_rpy((roll, sign * np.pi / 2, yaw))
        found = spatial.rpy_from_rotation(matrix)
        assert found[0] == pytest.approx(0.0, abs=1e-12)
        assert found[1] == pytest.approx(sign * np.pi / 2, abs=1e-12)
        between = found[2] - (yaw - sign * roll)
        assert np.cos(between) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("point", [(0.5, 0.2, -0.1), (0.0, 1.0, 1.0), (1.0, 0.0, -1.0)])
def test_in_a_box_nothing_is_in_excess(point: tuple[float, ...]) -> None:
    box = np.array([[0.0, 1.0], [0.0, 1.0], [-1.0, 1.0]])
    assert spatial.excess_of_box(np.array(point), box) == 0.0


def test_the_distance_from_a_box_is_that_of_its_nearest_point() -> None:
    box = np.array([[0.0, 1.0], [2.0, 3.0], [-1.0, 1.0]])
    for point in rng.uniform(-5.0, 5.0, (50, 3)):
        nearest = np.clip(point, box[:, 0], box[:, 1])
        expected = np.linalg.norm(point - nearest)
        assert spatial.excess_of_box(point, box) == pytest.approx(expected, abs=1e-15)
