"""Principal axes: nearest to the body's own, and the same on every processor."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import permutations, product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from alpha5_model.description.committed import same_content
from alpha5_model.description.principal_axes import principal_axes

MOMENTS = np.array([2e-4, 3e-4, 4.5e-4])
#: Two equal moments in each place, and three.
EQUAL = [[2e-4, 2e-4, 3e-4], [3e-4, 2e-4, 2e-4], [2e-4, 3e-4, 2e-4], [2e-4] * 3]


def tensor(rotation: np.ndarray, moments: np.ndarray) -> np.ndarray:
    return rotation @ np.diag(moments) @ rotation.T


def axes_of(inertia: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Moments and the rotation of the quaternion."""
    moments, (w, x, y, z) = principal_axes(inertia)
    return moments, Rotation.from_quat([x, y, z, w]).as_matrix()


def turn(rotation: np.ndarray) -> float:
    return float(Rotation.from_matrix(rotation).magnitude())


def test_of_all_24_frames_it_is_the_nearest() -> None:
    for true in Rotation.random(60, random_state=4).as_matrix():
        inertia = tensor(true, MOMENTS)
        moments, found = axes_of(inertia)
        assert tensor(found, moments) == pytest.approx(inertia, abs=2e-15)
        others = []
        for order in permutations(range(3)):
            for signs in product((1.0, -1.0), repeat=3):
                frame = true[:, order] * signs
                if np.linalg.det(frame) > 0:
                    others.append(turn(frame))
        assert len(others) == 24
        assert turn(found) == pytest.approx(min(others), abs=1e-9)


@pytest.mark.parametrize("moments", EQUAL)
def test_equal_moments_have_the_nearest_axes_whatever_the_rounding(
    moments: list[float],
) -> None:
    """Brute force: a fine circle of frames about the axis of the other moment."""
    rng = np.random.default_rng(3)
    circle = Rotation.from_rotvec(np.outer(np.linspace(0, np.pi, 721), [0, 0, 1]))
    others = np.array(moments)
    alone = int(np.argmax(np.abs(others - np.median(others))))
    to_z = np.roll(np.eye(3), 2 - alone, axis=1)
    for true in Rotation.random(6, random_state=5).as_matrix():
        inertia = tensor(true, others)
        _, found = axes_of(inertia)
        noise = 1e-19 * rng.normal(size=(3, 3))
        _, again = axes_of(inertia + noise + noise.T)
        assert again == pytest.approx(found, abs=1e-10)
        if len(set(moments)) == 1:
            assert found == pytest.approx(np.eye(3), abs=0)
            continue
        nearest = np.pi
        for order in permutations(range(3)):
            for signs in product((1.0, -1.0), repeat=3):
                frames = true @ to_z @ circle.as_matrix()
                frames = frames[:, :, order] * signs
                frames = frames[np.linalg.det(frames) > 0]
                if len(frames):
                    angles = Rotation.from_matrix(frames).magnitude()
                    nearest = min(nearest, float(angles.min()))
        assert turn(found) <= nearest + 1e-9


def test_a_diagonal_tensor_is_not_turned() -> None:
    for moments in permutations(MOMENTS):
        found, quaternion = principal_axes(np.diag(moments))
        assert quaternion == [1.0, 0.0, 0.0, 0.0]
        assert found.tolist() == list(moments)


def test_axes_halfway_between_the_bodys_are_chosen_by_rule() -> None:
    """At 45 degrees two frames are equally near; rounding does not choose."""
    half = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    inertia = tensor(half, MOMENTS)
    rng = np.random.default_rng(6)
    _, expected = axes_of(inertia)
    for _ in range(50):
        noise = 1e-19 * rng.normal(size=(3, 3))
        _, found = axes_of(inertia + noise + noise.T)
        assert found == pytest.approx(expected, abs=1e-9)


TEXTS = """
from alpha5_model.description.mjcf import MjcfOptions, mjcf
for gripper in ("locked", "jaws"):
    print(mjcf(MjcfOptions(gripper, hydrodynamics=True)))
"""


@pytest.mark.slow
def test_every_processor_writes_the_same_model() -> None:
    """OpenBLAS and NumPy take other instructions on other processors."""
    features = "AVX512F AVX512CD AVX512_SKX AVX2 FMA3"
    machines = [
        {},
        {"OPENBLAS_CORETYPE": "Haswell"},
        {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": features},
    ]
    texts = []
    for machine in machines:
        done = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", TEXTS],
            env={**os.environ, **machine},
            capture_output=True,
            check=True,
        )
        texts.append(done.stdout)
    for text in texts[1:]:
        assert same_content(text, texts[0])


#: Two texts -> whether they are the same content.
PAIRS = {
    ("a 0.0043523456789012", "a 0.0043523456789013"): True,
    ("a 0.0043523456789012", "a 0.0043523567890123"): False,
    ("a 0.00435234568", "a 0.0043523456789"): True,
    ("m 0.355", "m 0.356"): False,
    ("m 0.355", "m 0.35500000000000004"): True,
    ("m 0.35", "m 0.350"): False,
    ("m 1.23456789012", "m -1.23456789012"): False,
    ("link_1 1.5", "link_2 1.5"): False,
    ("1.5 1.5", "1.5"): False,
    ("\xff", "\xfe"): False,
}


def test_only_the_last_digits_of_computed_numbers_may_differ() -> None:
    wrong = [
        pair
        for pair, same in PAIRS.items()
        if same_content(*(text.encode("latin-1") for text in pair)) != same
    ]
    assert wrong == []
