"""Inverse kinematics is complete, exact, the same in every route, and as printed."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from fk import FOLDED, STRETCHED, fk, sample, tip
from loops import each
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.errors import InputError

TAU = 2 * math.pi


def residual(s: object, position: np.ndarray) -> np.ndarray:
    """Distance between the target and the tcp of every existing solution [m]."""
    q = s.q  # type: ignore[attr-defined]
    exists = s.exists  # type: ignore[attr-defined]
    target = np.broadcast_to(position[..., None, :], (*exists.shape, 3))
    return np.linalg.norm(tip(q[exists]) - target[exists], axis=-1)


@pytest.mark.slow
def test_every_configuration_is_found_again() -> None:
    q = sample(200_000, seed=1)
    position = tip(q)
    s = a5.inverse_kinematics(position, q[:, 3])
    assert residual(s, position).max() < 1e-12
    off = np.where(s.within_limits, np.abs(s.q - q[:, None]).max(axis=-1), np.inf)
    nearest = off.argmin(axis=-1)
    found = np.take_along_axis(s.q, nearest[:, None, None], axis=1)[:, 0]
    assert np.isfinite(off.min(axis=-1)).all(), "a configuration is in no branch"
    # The residual has the tolerance: near the stretched arm, angles are good to 1e-8.
    assert np.linalg.norm(tip(found) - position, axis=-1).max() < 1e-12
    assert np.quantile(off.min(axis=-1), 0.999) < 1e-12
    assert off.min(axis=-1).max() < 1e-7


def test_two_published_branches_do_not_suffice() -> None:
    """The control of the test above: with the two printed poses a fifth is lost."""
    q = sample(20_000, seed=2)
    s = a5.inverse_kinematics(tip(q), q[:, 3])
    off = np.where(s.within_limits, np.abs(s.q - q[:, None]).max(axis=-1), np.inf)
    share = (off[:, :2].min(axis=-1) < 1e-6).mean()
    assert 0.75 < share < 0.83


def test_angles_lie_in_the_range_where_a_shift_fits() -> None:
    q = sample(20_000, seed=3)
    s = a5.inverse_kinematics(tip(q), q[:, 3])
    angles = s.q[s.exists]
    for turns in (-2, -1, 1, 2):
        shifted = angles + turns * TAU
        fits = (shifted >= LOWER) & (shifted <= UPPER)
        assert not (fits & ((angles < LOWER) | (angles > UPPER))).any()


def test_limit_flags_by_brute_force() -> None:
    q = sample(20_000, seed=4)
    s = a5.inverse_kinematics(tip(q), q[:, 3])
    with np.errstate(invalid="ignore"):
        inside = ((s.q >= LOWER) & (s.q <= UPPER)).all(axis=-1)
    assert np.array_equal(s.within_limits, inside & s.exists)
    assert np.isnan(s.q[~s.exists]).all()
    assert not np.isnan(s.q[s.exists]).any()


def test_no_solution_is_missed_or_invented_by_brute_force() -> None:
    """Solutions are the sign changes of the closure along the elbow's circle."""
    rng = np.random.default_rng(5)
    position = rng.uniform(-0.4, 0.4, (300, 3))
    s = a5.inverse_kinematics(position)
    l_1 = math.hypot(0.040, 0.1453)
    l_2 = math.hypot(0.020, 0.180)
    phi = np.linspace(0.0, TAU, 20_001)
    elbow_r = 0.020 + l_1 * np.cos(phi)
    elbow_z = 0.0462 + l_1 * np.sin(phi)
    for target, exists in zip(position, s.exists, strict=True):
        radius = math.hypot(target[0], target[1])
        for pair, r in enumerate((radius, -radius)):
            gap = np.hypot(r - elbow_r, target[2] - elbow_z) - l_2
            crossings = np.count_nonzero(np.diff(np.sign(gap)) != 0)
            assert crossings == 2 * exists[pair] == 2 * exists[pair + 2]


def test_published_branches() -> None:
    position = tip(sample(20_000, seed=6))
    printed = a5.published_inverse_kinematics(position)
    assert printed.shape == (20_000, 2, 3)
    s = a5.inverse_kinematics(position)
    for pair in (0, 1):
        exists = s.exists[:, pair]
        assert np.array_equal(exists, ~np.isnan(printed[:, pair]).any(axis=-1))
        off = s.q[exists, pair, :3] - printed[exists, pair]
        off -= TAU * np.rint(off / TAU)
        # The printed formula has an arccos, which loses digits at the edge of reach.
        clear = np.abs(s.q[exists, pair, 2] - STRETCHED) > 0.01
        assert np.abs(off[clear]).max() < 1e-12
        wrist = np.zeros((exists.sum(), 1))
        q = np.concatenate([printed[exists, pair], wrist], axis=-1)
        assert np.linalg.norm(tip(q) - position[exists], axis=-1)[clear].max() < 1e-12


def test_published_formulas_to_the_letter_at_a_point() -> None:
    x, y, z = 0.2, -0.1, 0.05
    a_1 = math.hypot(0.04, 0.1453)
    l_2 = math.hypot(0.02, 0.18)
    R = math.hypot(x, y)
    l_3 = math.hypot(R + 0.02, z - 0.0462)
    theta_1 = (
        3 * math.pi / 2
        - math.atan2(z - 0.0462, R + 0.02)
        - math.acos((a_1**2 + l_3**2 - l_2**2) / (2 * a_1 * l_3))
        - math.asin(0.04 / a_1)
    )
    under, over = a5.published_inverse_kinematics([x, y, z])
    assert under[0] == math.atan2(y, x) + math.pi
    assert over[0] == math.atan2(y, x)
    assert over[1] == pytest.approx(theta_1, abs=1e-14)


def test_all_routes_agree() -> None:
    """One target, a list and a batch."""
    q = sample(3000, seed=7)
    rng = np.random.default_rng(8)
    position = np.concatenate([tip(q), rng.uniform(-0.4, 0.4, (2000, 3))])
    batch = a5.inverse_kinematics(position, 0.5)
    for i, target in enumerate(position):
        one = a5.inverse_kinematics(target, 0.5)
        listed = a5.inverse_kinematics(target.tolist(), 0.5)
        assert one.q.shape == (4, 4)
        assert np.array_equal(one.q, listed.q, equal_nan=True)
        assert np.array_equal(one.exists, batch.exists[i])
        assert np.array_equal(one.within_limits, batch.within_limits[i])
        assert one.singular == batch.singular[i]
        assert np.array_equal(one.q, batch.q[i], equal_nan=True)
        assert np.array_equal(one.position, target)


@each("shape", [(), (1,), (7,), (0,), (3, 0), (2, 3), (2, 1, 4)])
def test_shapes(shape: tuple[int, ...]) -> None:
    position = np.broadcast_to(np.array([0.2, -0.1, 0.05]), (*shape, 3))
    s = a5.inverse_kinematics(position)
    assert s.q.shape == (*shape, 4, 4)
    assert s.exists.shape == s.within_limits.shape == (*shape, 4)
    assert s.singular.shape == shape
    assert s.position.shape == (*shape, 3)
    if s.q.size:
        assert s.best(np.zeros(4)).shape == (*shape, 4)
    for array in s:
        assert not array.flags.writeable


def test_wrist_broadcasts() -> None:
    s = a5.inverse_kinematics([0.2, -0.1, 0.05], [0.0, 1.0, TAU + 2.0, 6.25])
    assert s.q.shape == (4, 4, 4)
    np.testing.assert_allclose(s.q[:3, 0, 3], [0.0, 1.0, 2.0], atol=1e-12)
    assert s.within_limits[:3].any(axis=-1).all()
    assert not s.within_limits[3].any()
    grid = a5.inverse_kinematics(np.full((5, 1, 3), 0.1), np.zeros(6))
    assert grid.q.shape == (5, 6, 4, 4)
    with pytest.raises(InputError, match=r"broadcasts with \(2, 5\), got"):
        a5.inverse_kinematics(np.zeros((2, 5, 3)), np.zeros(4))


def test_integers_and_float32_are_numbers() -> None:
    assert a5.inverse_kinematics([0, 0, 1]).exists.sum() == 0
    s = a5.inverse_kinematics(np.array([[0.25, 0.0, 0.125]], np.float32), 0)
    assert s.q.dtype == np.float64
    assert (
        s.exists.all(axis=None)
        == a5.inverse_kinematics([0.25, 0.0, 0.125]).exists.all()
    )


def test_the_callers_array_stays_writable() -> None:
    position = tip(sample(5, seed=9))
    s = a5.inverse_kinematics(position)
    position[0] = 0.0
    assert position.flags.writeable
    assert not s.position.flags.writeable


def test_blocks_of_a_batch_do_not_mix() -> None:
    q = sample(20_011, seed=10)
    position = tip(q)
    whole = a5.inverse_kinematics(position, q[:, 3])
    part = a5.inverse_kinematics(position[8190:8195], q[8190:8195, 3])
    np.testing.assert_allclose(whole.q[8190:8195], part.q, rtol=0, atol=1e-9)
    last = a5.inverse_kinematics(position[-3:], q[-3:, 3])
    np.testing.assert_allclose(whole.q[-3:], last.q, rtol=0, atol=1e-9)


def test_memory_is_the_output_and_a_fixed_scratch() -> None:
    position = tip(sample(1000, seed=11))
    scratch = []
    for count in (100_000, 400_000):
        target = np.ascontiguousarray(np.resize(position, (count, 3)))
        a5.inverse_kinematics(target[:10_000])  # caches
        tracemalloc.start()
        s = a5.inverse_kinematics(target)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        output = (
            s.q.nbytes + s.exists.nbytes + s.within_limits.nbytes + s.singular.nbytes
        )
        assert output == count * 137
        scratch.append(peak - output)
    assert max(scratch) < 8e6
    assert abs(scratch[1] - scratch[0]) < 2e5


def test_best_is_the_nearest() -> None:
    q = sample(5000, seed=12)
    s = a5.inverse_kinematics(tip(q), q[:, 3])
    assert (
        np.linalg.norm(tip(s.best(q, allow_collision=True)) - s.position, axis=-1).max()
        < 1e-12
    )
    assert (
        np.quantile(np.abs(s.best(q, allow_collision=True) - q).max(axis=-1), 0.999)
        < 1e-12
    )
    reference = np.array([3.0, 1.0, 2.0, 1.0])
    best = s.best(reference, allow_collision=True)
    for i in range(0, 5000, 50):
        options = s.q[i][s.within_limits[i]]
        travel = np.linalg.norm(options - reference, axis=-1)
        assert np.array_equal(best[i], options[travel.argmin()])


def test_best_out_of_reach_says_how_far() -> None:
    s = a5.inverse_kinematics([[0.2, 0.0, 0.1], [0.5, 0.1, 0.1]])
    with pytest.raises(a5.UnreachableError, match=r"row 1") as caught:
        s.best(np.zeros(4))
    error = caught.value
    assert error.distance == pytest.approx(
        float(a5.distance_to_reach([0.5, 0.1, 0.1])), abs=1e-15
    )
    assert a5.reachable(error.nearest)
    assert np.linalg.norm(np.subtract(error.nearest, error.position)) == pytest.approx(
        error.distance
    )


def test_best_blames_the_wrist_when_the_wrist_is_to_blame() -> None:
    from alpha5_model.errors import JointLimitError

    with pytest.raises(JointLimitError, match="axis_b"):
        a5.inverse_kinematics([0.2, 0.0, 0.1], 6.25).best(np.zeros(4))


@each(
    ("position", "wrist"),
    [
        ([0.1, 0.2], 0.0),
        ([[0.1], [0.2]], 0.0),
        (0.1, 0.0),
        ("abc", 0.0),
        (["a", "b", "c"], 0.0),
        ([1j, 0.0, 0.0], 0.0),
        ([None, 0.0, 0.0], 0.0),
        ([True, False, True], 0.0),
        ([[0.1, 0.2, 0.3], [0.1, 0.2]], 0.0),
        ([math.nan, 0.0, 0.0], 0.0),
        ([0.0, 0.0, math.inf], 0.0),
        ([0.1, 0.2, 0.1], math.nan),
        ([0.1, 0.2, 0.1], "x"),
        (np.zeros((3, 3)), np.zeros(2)),
        (np.array([0.1, math.inf, -math.inf]), 0.0),
    ],
)
def test_bad_input(position: object, wrist: object) -> None:
    with pytest.raises(a5.Alpha5Error):
        a5.inverse_kinematics(position, wrist)  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [10, 50_000])
def test_a_bad_row_is_named(count: int) -> None:
    position = tip(sample(count, seed=13))
    position[count - 3, 1] = np.inf
    with pytest.raises(a5.Alpha5Error, match=rf"position\[{count - 3}, 1\]"):
        a5.inverse_kinematics(position)
    position[count - 4, 2] = np.nan
    with pytest.raises(a5.Alpha5Error, match=rf"position\[{count - 4}, 2\]"):
        a5.inverse_kinematics(position)


def test_large_finite_numbers_are_no_error() -> None:
    position = np.full((5000, 3), 1e308)
    assert not a5.inverse_kinematics(position * 1e-200).exists.any()
    assert not a5.inverse_kinematics(position).exists.any()
    assert not a5.inverse_kinematics([1e308, 1e308, 1e308]).exists.any()


def test_pinocchio_round_trip() -> None:
    arm = a5.load()
    q = sample(200, seed=14)
    position = np.array([arm.forward_kinematics(row).translation for row in q])
    np.testing.assert_allclose(position, tip(q), rtol=0, atol=1e-12)
    s = a5.inverse_kinematics(position, q[:, 3])
    for i in range(200):
        for branch in np.flatnonzero(s.exists[i]):
            reached = arm.forward_kinematics(s.q[i, branch]).translation
            assert np.linalg.norm(reached - position[i]) < 1e-12


def test_pinocchio_agrees_with_the_dh_chain() -> None:
    import pinocchio as pin

    arm = a5.load()
    chain = a5.dh.DHChain.alpha5()
    for q in sample(50, seed=15):
        np.testing.assert_allclose(
            chain.forward_kinematics(q),
            arm.forward_kinematics(q).homogeneous,
            rtol=0,
            atol=1e-12,
        )
        jacobian = chain.jacobian(q)
        aligned = arm.jacobian(q, reference_frame=pin.LOCAL_WORLD_ALIGNED)
        np.testing.assert_allclose(jacobian, aligned, rtol=0, atol=1e-12)
        step = 1e-6
        for j in range(4):
            moved = np.array([q + step * np.eye(4)[j], q - step * np.eye(4)[j]])
            ahead, behind = fk(moved)
            linear = (ahead[:3, 3] - behind[:3, 3]) / (2 * step)
            spin = (ahead[:3, :3] - behind[:3, :3]) @ fk(q)[:3, :3].T / (2 * step)
            angular = [spin[2, 1], spin[0, 2], spin[1, 0]]
            np.testing.assert_allclose(
                jacobian[:, j], [*linear, *angular], rtol=0, atol=1e-8
            )


def test_the_folded_arm_exists_beyond_the_limits() -> None:
    q = np.array([3.0, 1.5, FOLDED, 0.0])
    s = a5.inverse_kinematics(tip(q))
    assert s.singular
    folded = s.exists & (np.abs(s.q[:, 2] - FOLDED) < 1e-6)
    assert folded.sum() == 2
    assert not s.within_limits[folded].any()
    assert residual(s, tip(q)).max() < 1e-9


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_a_reference_far_away_still_picks_a_solution_within_the_limits() -> None:
    """The best branch is within the limits even if the squared distance overflows."""
    p = np.random.default_rng(0).uniform(-0.3, 0.3, (500, 3))
    s = a5.inverse_kinematics(p)
    only_later = s.within_limits.any(axis=-1) & ~s.within_limits[:, 0]
    assert only_later.any()
    p = p[only_later]
    best = a5.inverse_kinematics(p).best([1e200, 0.0, 0.0, 0.0], allow_collision=True)
    assert np.isfinite(best).all()
    np.testing.assert_allclose(tip(best), p, atol=1e-12)
