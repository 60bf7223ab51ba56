"""Inverse kinematics by the kernels, compiled and NumPy's: 200 000 targets against `solve_one` and FK."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from types import ModuleType

import numpy as np
import pytest
from fk import sample, tip
from ik_targets import EDGES, at_edge, elbow_and_tip, ordinary

import alpha5_model as a5
from alpha5_model.kinematics import ik
from alpha5_model.kinematics.edges import AXIS_TOLERANCE
from alpha5_model.kinematics.ik import batch
from alpha5_model.kinematics.ik.one import solve_one

COUNT, EACH = 130_000, 10_000


@pytest.fixture(params=["_compiled", "numpy_kernels"])
def kernels(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    if request.param == "_compiled" and os.environ.get("ALPHA5_REQUIRE_KERNELS") != "1":
        pytest.importorskip("alpha5_model.kernels._compiled", exc_type=ImportError)
    chosen = import_module(f"alpha5_model.kernels.{request.param}")
    for user in (ik, batch):
        monkeypatch.setattr(user, "module", lambda: chosen)
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
def careful(targets: tuple[np.ndarray, np.ndarray]) -> list[np.ndarray]:
    """q, exists, within limits and singular of all targets by `solve_one`."""
    position, wrist = targets
    answers = [solve_one(*p, w) for p, w in zip(position.tolist(), wrist.tolist(), strict=True)]
    q, exists, within, singular = (np.array(column) for column in zip(*answers, strict=True))
    bits = np.arange(4)
    flags = [(code[:, None] >> bits & 1).astype(bool) for code in (exists, within)]
    return [q.reshape(-1, 4, 4), *flags, singular]


def test_the_quick_forward_kinematics_is_the_one_of_table_1() -> None:
    q = sample(1000, seed=4)
    np.testing.assert_allclose(elbow_and_tip(q)[1], tip(q), rtol=0.0, atol=1e-15)


def test_200_000_targets(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray], careful: list[np.ndarray]
) -> None:
    position, wrist = targets
    assert len(position) == 200_000
    s = a5.inverse_kinematics(position, wrist)
    q, *flags = careful
    for got, wanted in zip((s.exists, s.within_limits, s.singular), flags, strict=True):
        assert np.array_equal(got, wanted)
    assert np.array_equal(np.isnan(s.q).all(axis=-1), ~s.exists)
    assert np.abs(s.q - q)[s.exists].max() < 1e-10
    off = np.linalg.norm(elbow_and_tip(s.q)[1] - position[:, None], axis=-1)
    regular = s.exists & ~s.singular[:, None]
    assert off[regular].max() < 1e-12
    assert off[s.exists].max() < AXIS_TOLERANCE + 1e-12


def test_few_ordinary_targets_are_left_to_solve_one_and_all_that_lie_on_an_edge(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray], careful: list[np.ndarray]
) -> None:
    position, wrist = targets
    near = np.empty(len(position), bool)
    flags = np.empty((2, len(position), 4), bool)
    kernels.inverse_kinematics_rows(position, wrist, np.empty((0, 4, 4)), *flags, near)
    assert near[:COUNT].mean() < 3e-4
    assert near[careful[-1]].all()
    for got, wanted in zip(flags, careful[1:], strict=False):
        assert np.array_equal(got[~near], wanted[~near])


def test_one_target_is_a_row_of_the_batch(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray]
) -> None:
    position, wrist = (x[::200] for x in targets)
    s = a5.inverse_kinematics(position, wrist)
    rounding = 1e-10 if "numpy" in kernels.__name__ else 0.0  # there it is from `solve_one`
    for i, (p, w) in enumerate(zip(position, wrist.tolist(), strict=True)):
        for got, wanted in zip(a5.inverse_kinematics(p, w), s, strict=True):
            assert got.shape == wanted[i].shape
            np.testing.assert_allclose(got, wanted[i], rtol=0.0, atol=rounding)


def test_reach_is_the_same_without_angles(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray], careful: list[np.ndarray]
) -> None:
    position = targets[0]
    assert np.array_equal(a5.reachable(position, limits=False), careful[1].any(axis=-1))
    some = position[::50]
    within = a5.inverse_kinematics(some, 3.0).within_limits.any(axis=-1)
    assert np.array_equal(a5.reachable(some), within)


def test_threads_do_not_disturb_one_another(
    kernels: ModuleType, targets: tuple[np.ndarray, np.ndarray]
) -> None:
    position, wrist = targets
    parts = [slice(k, k + 5000) for k in range(0, 40_000, 5000)]
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda p: a5.inverse_kinematics(position[p], wrist[p]).q, parts))
    for part, answer in zip(parts, answers, strict=True):
        again = a5.inverse_kinematics(position[part], wrist[part]).q
        assert np.array_equal(answer, again, equal_nan=True)


def test_numbers_too_large_for_the_kernel_leave_their_neighbours_alone(kernels: ModuleType) -> None:
    position, wrist = ordinary(100, seed=5)
    wanted = a5.inverse_kinematics(position, wrist)
    position[7], position[40, 1], wrist[70] = 1e308, -1e200, 1e300
    s = a5.inverse_kinematics(position, wrist)
    assert not s.exists[[7, 40]].any()
    assert not s.within_limits[70].any()
    others = np.setdiff1d(np.arange(100), [7, 40, 70])
    assert np.array_equal(s.q[others], wanted.q[others], equal_nan=True)
    assert np.array_equal(s.exists[70], wanted.exists[70])


def test_the_compiled_functions_refuse_what_they_cannot_hold() -> None:
    compiled = pytest.importorskip("alpha5_model.kernels._compiled", exc_type=ImportError)
    for given in ((), (list, [0.1] * 3, 0.0), (5, [0.1] * 3, 0.0), (tuple, [0.1] * 3)):
        with pytest.raises(TypeError, match="kind of tuple, position and wrist"):
            compiled.inverse_kinematics(*given)
    good = [np.zeros((2, 3)), np.zeros(2), np.zeros((2, 4, 4)), *np.zeros((2, 2, 4), bool)]
    good.append(np.zeros(2, bool))
    compiled.inverse_kinematics_rows(*good)
    frozen = good[2].copy()
    frozen.flags.writeable = False
    for place, bad in (
        *((i, None) for i in range(6)),
        *((i, good[i][:1]) for i in (0, 2, 3, 4, 5)),
        *((i, good[i].astype(np.float32)) for i in range(6)),
        (0, np.zeros((3, 2)).T),
        (1, np.zeros(0)),
        (2, frozen),
    ):
        with pytest.raises(TypeError, match=r"near \(n,\)"):
            compiled.inverse_kinematics_rows(*good[:place], bad, *good[place + 1 :])
