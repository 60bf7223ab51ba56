"""The kernels' inverse kinematics agrees with long doubles and forward kinematics."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from types import ModuleType

import numpy as np
import pytest
from compiled_kernels import compiled_kernels
from fk import FOLDED, sample, tip
from ik_reference import solved
from ik_targets import EDGES, at_edge, elbow_and_tip, ordinary
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.kernels import choice as kernels_package
from alpha5_model.kernels import numpy_kernels
from alpha5_model.kinematics.tolerances import AXIS_TOLERANCE, LIMIT_TOLERANCE

COUNT, EACH = 130_000, 10_000


@pytest.fixture(params=["compiled", "numpy"])
def kernels(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> ModuleType:
    chosen = numpy_kernels if request.param == "numpy" else compiled_kernels()
    monkeypatch.setattr(kernels_package, "module", lambda: chosen)
    return chosen


@pytest.fixture(scope="module")
def targets() -> tuple[np.ndarray, np.ndarray]:
    """Ordinary ones, and on every edge ones with gaps from none to 1 cm or 0.01 rad."""
    rng = np.random.default_rng(1)
    parts = [ordinary(COUNT, seed=2)]
    for edge in EDGES:
        gap = rng.choice([-1.0, 0.0, 1.0], EACH) * 10 ** rng.uniform(-16.0, -2.0, EACH)
        parts.append(at_edge(edge, EACH, 3, gap))
    position, wrist = map(np.concatenate, zip(*parts, strict=True))
    return position, wrist


@pytest.fixture(scope="module")
def careful(targets: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, ...]:
    """q, exists, within limits and singular of all targets by the second route."""
    return solved(*targets)


def test_the_quick_forward_kinematics_is_the_one_of_table_1() -> None:
    q = sample(1000, seed=4)
    np.testing.assert_allclose(elbow_and_tip(q)[1], tip(q), rtol=0.0, atol=1e-15)


@pytest.mark.slow
def test_200_000_targets(
    kernels: ModuleType,
    targets: tuple[np.ndarray, np.ndarray],
    careful: tuple[np.ndarray, ...],
) -> None:
    position, wrist = targets
    assert len(position) == 200_000
    s = a5.inverse_kinematics(position, wrist)
    q, exists, within_limits, singular = careful
    assert np.array_equal(s.exists, exists)
    assert np.array_equal(s.singular, singular)
    # Both move an angle onto a limit that it passes by less than 1e-12 and rounding.
    doubtful = s.within_limits != within_limits
    passed = np.maximum(q - UPPER, LOWER - q)[doubtful].max(axis=-1, initial=0.0)
    assert np.abs(passed - LIMIT_TOLERANCE).max(initial=0.0) < 1e-13
    assert np.array_equal(np.isnan(s.q).all(axis=-1), ~s.exists)
    # Near the stretched and the folded arm, rounding of the target moves both angles by
    # rounding / sin(gamma).
    sine = np.abs(np.sin(q[..., 2] - FOLDED))[..., None]
    error = (np.abs(s.q - q) * np.maximum(sine, 1e-8)).max(axis=-1)
    at_limit = ((s.q == LOWER) | (s.q == UPPER)).any(axis=-1)
    assert error[s.exists & ~at_limit].max() < 3e-15
    assert error[s.exists].max() < 2.0 * LIMIT_TOLERANCE
    off = np.linalg.norm(elbow_and_tip(s.q)[1] - position[:, None], axis=-1)
    regular = s.exists & ~s.singular[:, None]
    assert off[regular].max() < 1e-12
    assert off[s.exists].max() < AXIS_TOLERANCE + 1e-12


def test_one_target_is_a_row_of_the_batch(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray]
) -> None:
    position, wrist = (x[::200] for x in targets)
    s = a5.inverse_kinematics(position, wrist)
    for i, (p, w) in enumerate(zip(position, wrist.tolist(), strict=True)):
        for got, wanted in zip(a5.inverse_kinematics(p, w), s, strict=True):
            assert got.shape == wanted[i].shape
            np.testing.assert_array_equal(got, wanted[i])


def test_reach_is_the_same_without_angles(
    kernels: ModuleType,
    targets: tuple[np.ndarray, np.ndarray],
) -> None:
    position, wrist = (x[::20] for x in targets)
    exists = solved(position, wrist)[1].any(axis=-1)
    assert np.array_equal(a5.reachable(position, limits=False), exists)
    some = position[::3]
    within = a5.inverse_kinematics(some, 3.0).within_limits.any(axis=-1)
    assert np.array_equal(a5.reachable(some), within)


def test_threads_do_not_disturb_one_another(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray]
) -> None:
    position, wrist = targets
    parts = [slice(k, k + 5000) for k in range(0, 40_000, 5000)]
    with ThreadPoolExecutor(4) as pool:
        answers = list(
            pool.map(lambda p: a5.inverse_kinematics(position[p], wrist[p]).q, parts)
        )
    for part, answer in zip(parts, answers, strict=True):
        again = a5.inverse_kinematics(position[part], wrist[part]).q
        assert np.array_equal(answer, again, equal_nan=True)


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_numbers_too_large_for_the_kernel_leave_their_neighbours_alone(
    kernels: ModuleType,
) -> None:
    position, wrist = ordinary(100, seed=5)
    wanted = a5.inverse_kinematics(position, wrist)
    position[7], position[40, 1], wrist[70] = 1e308, -1e200, 1e300
    s = a5.inverse_kinematics(position, wrist)
    assert not s.exists[[7, 40]].any()
    assert not s.within_limits[70].any()
    others = np.setdiff1d(np.arange(100), [7, 40, 70])
    assert np.array_equal(s.q[others], wanted.q[others], equal_nan=True)
    assert np.array_equal(s.exists[70], wanted.exists[70])
