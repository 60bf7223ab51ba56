"""Poses have the least rotation error, paths the least travel, or they are refused."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from fk import STRETCHED, fk, sample, tip
from loops import each
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.errors import DiscontinuousPathError, InputError, ShapeError


def random_poses(count: int, seed: int) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    pose = fk(sample(count, seed))
    pose[:, :3, :3] = Rotation.random(count, random_state=seed).as_matrix()
    return pose


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return (Rotation.from_matrix(a).inv() * Rotation.from_matrix(b)).magnitude()


def test_attainable_poses_are_attained() -> None:
    q = sample(20_000, seed=70)
    pose = fk(q)
    s = a5.inverse_kinematics_pose(pose)
    assert (s.exact & s.within_limits).any(axis=-1).all()
    best = s.best(q, allow_collision=True)
    np.testing.assert_allclose(fk(best), pose, rtol=0, atol=1e-7)
    assert np.quantile(np.abs(best - q).max(axis=-1), 0.99) < 1e-11


def test_rotation_error_is_the_least_that_the_wrist_can_do() -> None:
    pose = random_poses(60, seed=71)
    s = a5.inverse_kinematics_pose(pose)
    wrist = np.linspace(LOWER[3], UPPER[3], 4001)
    for i in range(60):
        for branch in np.flatnonzero(s.exists[i]):
            q = np.repeat(s.q[i, branch][None], len(wrist), axis=0)
            reached = fk(q[:1])[0]
            np.testing.assert_allclose(
                reached[:3, 3], pose[i, :3, 3], rtol=0, atol=1e-12
            )
            error = s.rotation_error[i, branch]
            assert angle_between(reached[:3, :3], pose[i, :3, :3]) == pytest.approx(
                error, abs=1e-9
            )
            q[:, 3] = wrist
            scan = angle_between(fk(q)[:, :3, :3], pose[i, :3, :3])
            assert error <= scan.min() + 1e-12
            assert error == pytest.approx(scan.min(), abs=1e-5)
    assert not s.exact.any()


def test_small_rotation_errors_keep_their_digits() -> None:
    from scipy.spatial.transform import Rotation

    q = sample(50, seed=72)
    pose = fk(q)
    for size in (1e-3, 1e-6, 1e-9):
        # About an axis across the wrist axis, which the wrist cannot make up for.
        across = np.cross(wrist_axis(q), [0.3, -0.5, 0.8])
        across /= np.linalg.norm(across, axis=-1, keepdims=True)
        turned = pose.copy()
        turned[:, :3, :3] = (
            Rotation.from_rotvec(size * across).as_matrix() @ pose[:, :3, :3]
        )
        s = a5.inverse_kinematics_pose(turned)
        error = np.where(s.within_limits, s.rotation_error, np.inf).min(axis=-1)
        np.testing.assert_allclose(error, size, rtol=1e-3, atol=1e-12)
        assert s.exact.any() == (size < 1e-7)


def wrist_axis(q: np.ndarray) -> np.ndarray:
    """The axis of theta_3, from two poses that differ in theta_3 only."""
    from scipy.spatial.transform import Rotation

    turned = q.copy()
    turned[:, 3] += 0.5
    spin = fk(turned)[:, :3, :3] @ np.swapaxes(fk(q)[:, :3, :3], 1, 2)
    return Rotation.from_matrix(spin).as_rotvec() / 0.5


def test_wrist_stays_within_its_limits_in_the_gap() -> None:
    """A wrist angle beyond 6.2 rad becomes the nearer end, with its error."""
    q = sample(200, seed=73)
    q[:, 3] = np.linspace(6.2, 2 * math.pi, 200)
    s = a5.inverse_kinematics_pose(fk(q))
    best = s.best(q, allow_collision=True)
    missed = np.minimum(q[:, 3] - UPPER[3], 2 * math.pi - q[:, 3])
    reached = angle_between(fk(best)[:, :3, :3], fk(q)[:, :3, :3])
    assert (best[:, 3] >= LOWER[3]).all()
    assert (best[:, 3] <= UPPER[3]).all()
    assert (reached <= missed + 1e-9).all()


def test_on_the_yaw_axis_theta_0_turns_to_the_target() -> None:
    start = a5.inverse_kinematics([0.0, 0.0, 0.3]).best([3.0, 1.0, 1.0, 0.5])
    for theta_0 in (0.5, 2.0, 5.5):
        q = start.copy()
        q[0] = theta_0
        s = a5.inverse_kinematics_pose(fk(q))
        assert s.singular
        best = s.best(q)
        np.testing.assert_allclose(fk(best), fk(q), rtol=0, atol=1e-9)


def test_pinocchio_poses_are_taken() -> None:
    arm = a5.load()
    q = sample(1, seed=74)[0]
    s = a5.inverse_kinematics_pose(arm.forward_kinematics(q))
    np.testing.assert_allclose(s.best(q), q, atol=1e-9)
    assert s.q.shape == (4, 4)


@pytest.mark.parametrize("shape", [(), (0,), (3,), (2, 2)])
def test_pose_shapes(shape: tuple[int, ...]) -> None:
    pose = np.broadcast_to(fk(sample(1, seed=75))[0], (*shape, 4, 4))
    s = a5.inverse_kinematics_pose(pose)
    assert s.q.shape == (*shape, 4, 4)
    assert s.rotation_error.shape == s.exact.shape == (*shape, 4)
    for array in s:
        assert not array.flags.writeable


def test_bad_poses() -> None:
    good = fk(sample(3, seed=76))
    for spoil in ("scale", "mirror", "row", "negative row", "corner", "nan"):
        bad = good.copy()
        if spoil == "scale":
            bad[1, :3, :3] *= 1.01
        elif spoil == "mirror":
            bad[1, :3, 0] *= -1
        elif spoil == "row":
            bad[1, 3, 0] = 0.1
        elif spoil == "negative row":
            bad[1, 3, 0] = -0.1
        elif spoil == "corner":
            bad[1, 3, 3] = 0.9
        else:
            bad[1, 0, 0] = np.nan
        with pytest.raises(InputError, match=r"transform\[1"):
            a5.inverse_kinematics_pose(bad)
        bad[2] = bad[1]
        with pytest.raises(InputError, match=r"transform\[1"):  # the first one is named
            a5.inverse_kinematics_pose(bad)
    with pytest.raises(ShapeError):
        a5.inverse_kinematics_pose(np.eye(3))


def test_pose_out_of_reach() -> None:
    far = np.eye(4)
    far[0, 3] = 1.0
    with pytest.raises(a5.UnreachableError):
        a5.inverse_kinematics_pose(far).best(np.zeros(4))


def test_paths_through_joint_space_are_recovered() -> None:
    ends = sample(40, seed=80).reshape(20, 2, 4)
    for first, last in ends:
        q = first + (last - first) * np.linspace(0, 1, 150)[:, None]
        path = a5.inverse_kinematics_path(
            tip(q), q[0], wrist=q[:, 3], allow_collision=True
        )
        np.testing.assert_allclose(tip(path), tip(q), rtol=0, atol=1e-12)
        assert ((path >= LOWER) & (path <= UPPER)).all()
        assert np.abs(np.diff(path, axis=0)).max() < 0.5
        travel = np.linalg.norm(np.diff(path, axis=0), axis=-1).sum()
        assert travel <= np.linalg.norm(np.diff(q, axis=0), axis=-1).sum() + 1e-9


def test_path_has_the_least_travel_by_brute_force() -> None:
    rng = np.random.default_rng(81)
    compared = 0
    for _ in range(30):
        # Near the stretched arm both elbows are close, and the choice is not obvious.
        q = rng.uniform(LOWER + 0.2, UPPER - 0.2) + rng.uniform(-0.15, 0.15, (6, 4))
        q[:, 2] = STRETCHED + rng.uniform(-0.2, 0.2, 6)
        q[:, 3] = 1.0
        s = a5.inverse_kinematics(tip(q), 1.0)
        options = [s.q[k][s.within_limits[k]] for k in range(6)]
        best = math.inf
        for choice in itertools.product(*options):
            step = np.diff(np.array(choice), axis=0)
            if np.abs(step).max() <= 0.5:
                best = min(best, np.linalg.norm(step, axis=-1).sum())
        if best < math.inf:
            path = a5.inverse_kinematics_path(tip(q), wrist=1.0, allow_collision=True)
            travel = np.linalg.norm(np.diff(path, axis=0), axis=-1).sum()
            assert travel == pytest.approx(best, abs=1e-9)
            compared += 1
        else:
            with pytest.raises(DiscontinuousPathError):
                a5.inverse_kinematics_path(tip(q), wrist=1.0, allow_collision=True)
    assert compared > 10


def test_path_changes_the_elbow_where_the_elbows_meet() -> None:
    """A path to the stretched arm and back follows the joints and never jumps."""
    q = np.zeros((101, 4))
    q[:] = [3.0, 1.6, 0.0, 1.0]
    q[:, 2] = np.linspace(STRETCHED - 0.5, STRETCHED + 0.5, 101)
    path = a5.inverse_kinematics_path(tip(q), q[0], wrist=1.0)
    np.testing.assert_allclose(path, q, rtol=0, atol=1e-6)


def test_path_through_the_yaw_axis_does_not_turn_theta_0() -> None:
    x = np.linspace(0.12, -0.12, 49)
    target = np.stack([x, 0 * x, 0 * x + 0.28], axis=-1)
    assert 0.0 in x
    path = a5.inverse_kinematics_path(target)
    assert np.ptp(path[:, 0]) < 1e-12
    np.testing.assert_allclose(tip(path), target, rtol=0, atol=1e-12)


def circle(radius: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    turn = np.linspace(0.0, 2 * math.pi, 401)
    return turn, np.stack(
        [radius * np.cos(turn), radius * np.sin(turn), 0 * turn + z], axis=-1
    )


def test_a_full_circle_stops_at_the_wedge() -> None:
    """The underarm pose ends where theta_0 = azimuth + pi reaches its upper limit."""
    turn, target = circle(0.2, 0.2)
    assert a5.reachable(target).all(), (
        "every point is in reach, one after the other is not"
    )
    with pytest.raises(DiscontinuousPathError) as caught:
        a5.inverse_kinematics_path(target, allow_collision=True)
    k = caught.value.index
    assert turn[k - 1] + math.pi <= UPPER[0] + 1e-9 < turn[k] + math.pi
    assert caught.value.step > 3.0
    part = a5.inverse_kinematics_path(target[:k], allow_collision=True)
    assert np.abs(np.diff(part, axis=0)).max() < 0.1
    # Farther out, the overarm pose does not reach, so no pose reaches the wedge.
    turn, target = circle(0.3, 0.1)
    with pytest.raises(a5.UnreachableError, match=rf"row {k}\b"):
        a5.inverse_kinematics_path(target, allow_collision=True)


def test_the_first_point_without_continuation_is_named() -> None:
    q = sample(1, seed=82)[0] + np.linspace(0, 0.3, 20)[:, None] * [0.1, 0.2, 0.1, 0.0]
    target = tip(np.clip(q, LOWER, UPPER))
    target[13] = -target[13] * [1, 1, -1]
    with pytest.raises(a5.Alpha5Error, match=r"positions\[13\]|row 13"):
        a5.inverse_kinematics_path(target, max_step=0.2)
    target[7] = [0.5, 0.5, 0.5]
    with pytest.raises(a5.UnreachableError, match="row 7"):
        a5.inverse_kinematics_path(target, max_step=0.2)


def test_q_start_counts() -> None:
    q = sample(1, seed=83)[0]
    target = tip(q)[None]
    np.testing.assert_allclose(a5.inverse_kinematics_path(target, q)[0], q, atol=1e-9)
    away = np.clip(q + 1.0, LOWER, UPPER)
    with pytest.raises(DiscontinuousPathError, match=r"positions\[0\]"):
        a5.inverse_kinematics_path(target, away, wrist=q[3], max_step=0.1)


def test_path_shapes_and_bad_input() -> None:
    assert a5.inverse_kinematics_path(np.zeros((0, 3))).shape == (0, 4)
    with pytest.raises(ShapeError):
        a5.inverse_kinematics_path([0.1, 0.2, 0.3])
    with pytest.raises(ShapeError):
        a5.inverse_kinematics_path([[0.1, 0.2, 0.3]], q_start=np.zeros((2, 4)))
    with pytest.raises(InputError):
        a5.inverse_kinematics_path([[0.2, 0.0, 0.1]], wrist=[0.0, 1.0])
    with pytest.raises(InputError):
        a5.inverse_kinematics_path([[0.2, 0.0, 0.1]], max_step=0.0)
    with pytest.raises(a5.Alpha5Error, match=r"positions\[1, 2\]"):
        a5.inverse_kinematics_path([[0.2, 0.0, 0.1], [0.2, 0.0, math.nan]])


def travel_of(path: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=-1).sum())


def least_travel(
    target: np.ndarray, max_step: float, start: np.ndarray | None = None
) -> float:
    """The least travel along targets, of every choice of branches by brute force."""
    on_axis = np.hypot(target[:, 0], target[:, 1]) < 1e-9
    free = on_axis if start is None else np.append(False, on_axis)
    best = math.inf
    for choice in itertools.product(*branches_of(target, on_axis)):
        q = np.array(choice) if start is None else np.vstack([start, *choice])
        others = np.diff(q[:, 1:], axis=0)
        if np.abs(others).max() > max_step or math.sqrt((others**2).sum()) > best:
            continue
        best = min(best, least_travel_of_yaw(q, free, max_step))
    return best


def branches_of(target: np.ndarray, on_axis: np.ndarray) -> list[np.ndarray]:
    """The branches within the limits of each target, (k, 4).

    On the yaw axis, branches that differ in theta_0 only are one.
    """
    s = a5.inverse_kinematics(target)
    branches = []
    for q, within, free in zip(s.q, s.within_limits, on_axis, strict=True):
        reached = q[within]
        if free:
            others = np.round(reached[:, 1:], 9)
            _, first = np.unique(others, axis=0, return_index=True)
            reached = reached[first]
        branches.append(reached)
    return branches


def least_travel_of_yaw(q: np.ndarray, free: np.ndarray, max_step: float) -> float:
    """The least travel if theta_0 may change in the free rows, or infinity."""
    from scipy.optimize import LinearConstraint, minimize

    def cost(yaw: np.ndarray) -> float:
        path = q.copy()
        path[free, 0] = yaw
        return travel_of(path)

    # The differences of theta_0, at most max_step, are linear in the free values.
    difference = np.diff(np.eye(len(q)), axis=0)
    fixed = difference[:, ~free] @ q[~free, 0]
    limit = LinearConstraint(difference[:, free], -max_step - fixed, max_step - fixed)
    index = np.arange(len(q))
    guess = np.interp(index[free], index[~free], q[~free, 0])
    best = math.inf
    # If the other joints do not move, the cost has a kink that can hold one start.
    for shift in (0.0, 0.05):
        found = minimize(
            cost,
            guess + shift,
            method="SLSQP",
            bounds=[(LOWER[0], UPPER[0])] * int(free.sum()),
            constraints=limit,
            options={"ftol": 1e-14, "maxiter": 500},
        )
        step = np.abs(difference[:, free] @ found.x + fixed).max()
        if found.success and step < max_step + 1e-7:
            best = min(best, found.fun)
    return best


def along_axis(
    first: float, last: float, heights: list[float], radius: float = 0.02
) -> np.ndarray:
    """A path in from one azimuth, along the axis, and out to another."""
    inwards = [radius * math.cos(first), radius * math.sin(first), heights[0]]
    outwards = [radius * math.cos(last), radius * math.sin(last), heights[-1]]
    return np.array([inwards, *([0.0, 0.0, z] for z in heights), outwards])


#: SLSQP of older SciPy leaves the bounds by a rounding error, and warns that it does.
SLSQP_CLIPS = pytest.mark.filterwarnings("ignore:Values in x were outside bounds")


@pytest.mark.slow
@SLSQP_CLIPS
@pytest.mark.parametrize(
    ("turn", "heights"),
    [
        (0.9, [0.3, 0.3, 0.3]),  # dwelling: one pose of the other joints, theta_0 turns
        (0.9, [0.28, 0.30, 0.33]),  # moving up
        (-1.1, [0.28, 0.29, 0.33]),
        (1.9, [0.30, 0.30, 0.31]),  # some steps at max_step
        (math.pi - 0.4, [0.30, 0.31]),  # turned about: the other pose leaves
        (0.0, [0.25, 0.26, 0.3]),
        (0.3, [0.27]),
    ],
)
def test_theta_0_on_the_axis_has_the_least_travel(
    turn: float, heights: list[float]
) -> None:
    for first in (0.6, 2.0, -1.2):
        target = along_axis(first, first + turn, heights)
        path = a5.inverse_kinematics_path(target)
        np.testing.assert_allclose(tip(path), target, rtol=0, atol=1e-12)
        assert np.abs(np.diff(path, axis=0)).max() <= 0.5 + 1e-12
        assert ((path >= LOWER) & (path <= UPPER)).all()
        # The path is one of the candidates, so it cannot be shorter than the least.
        least = least_travel(target, 0.5)
        assert least - 1e-3 < travel_of(path) <= least + 1e-9


@pytest.mark.slow
@SLSQP_CLIPS
def test_random_paths_across_the_axis_have_the_least_travel() -> None:
    rng = np.random.default_rng(84)
    compared = refused = 0
    for _ in range(40):
        heights = rng.uniform(0.2, 0.36) + rng.uniform(-0.02, 0.02, rng.integers(1, 4))
        target = along_axis(
            *rng.uniform(-3, 3, 2), heights.tolist(), rng.uniform(0.01, 0.03)
        )
        least = least_travel(target, 0.5)
        if least < math.inf:
            path = a5.inverse_kinematics_path(target)
            assert np.abs(np.diff(path, axis=0)).max() <= 0.5 + 1e-12
            assert least - 1e-3 < travel_of(path) <= least + 1e-9
            compared += 1
        else:
            with pytest.raises((DiscontinuousPathError, a5.UnreachableError)):
                a5.inverse_kinematics_path(target)
            refused += 1
    assert compared > 15
    assert refused > 5


def test_dwelling_on_the_axis_turns_in_equal_steps() -> None:
    """On the axis only theta_0 moves, and never backwards."""
    target = along_axis(0.5, 1.1, [0.3] * 9, radius=1e-3)
    path = a5.inverse_kinematics_path(target)
    assert np.ptp(path[1:-1, 1:]) > 0
    assert np.ptp(path[1:-1, 1:], axis=0).max() == 0.0
    assert path[-1, 0] - path[0, 0] == pytest.approx(0.6, abs=1e-12)
    assert (np.diff(path[:, 0]) >= 0).all()


def test_theta_0_moves_with_the_other_joints_in_proportion() -> None:
    target = along_axis(0.5, 1.1, np.linspace(0.25, 0.34, 30).tolist(), radius=5e-3)
    step = np.diff(a5.inverse_kinematics_path(target), axis=0)
    ratio = step[:, 0] / np.linalg.norm(step[:, 1:], axis=-1)
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
    assert ratio[0] > 0.1


def test_a_path_that_starts_or_ends_on_the_axis() -> None:
    target = along_axis(0.5, 1.1, [0.30, 0.31, 0.32])
    inwards = target[:-1]
    outwards = target[1:]
    assert np.ptp(a5.inverse_kinematics_path(inwards)[:, 0]) == 0.0
    assert np.ptp(a5.inverse_kinematics_path(outwards)[:, 0]) == 0.0
    only = a5.inverse_kinematics_path(target[1:-1])
    np.testing.assert_array_equal(only[:, 0], (LOWER[0] + UPPER[0]) / 2)
    start = a5.inverse_kinematics(inwards[1]).best([2.0, 1, 1, 0])
    assert np.ptp(a5.inverse_kinematics_path(inwards[1:], start)[:, 0]) == 0.0
    # With a start, theta_0 turns from there to where the path leaves.
    path = a5.inverse_kinematics_path(outwards, start)
    least = least_travel(outwards, 0.5, start)
    assert least - 1e-3 < travel_of(np.vstack([start, path])) <= least + 1e-9
    assert path[1, 0] != start[0]


def test_a_start_beyond_the_limit_of_theta_0_comes_back_first() -> None:
    target = along_axis(0.5, 1.1, [0.30, 0.31, 0.32])[1:-1]
    start = a5.inverse_kinematics(target[0]).best([0.1, 1, 1, 0])
    start[0] = LOWER[0] - 0.2
    np.testing.assert_array_equal(
        a5.inverse_kinematics_path(target, start)[:, 0], LOWER[0]
    )
    with pytest.raises(
        DiscontinuousPathError, match=r"positions\[0\].*0\.2 rad.*0\.1 rad"
    ):
        a5.inverse_kinematics_path(target, start, max_step=0.1)


def test_too_few_points_on_the_axis_to_turn() -> None:
    """A turn of 1.5 rad does not fit in four steps of 0.3 rad, for any pose."""
    target = along_axis(0.5, 2.0, [0.3] * 3)
    with pytest.raises(DiscontinuousPathError, match=r"positions\[4\]") as caught:
        a5.inverse_kinematics_path(target, max_step=0.3)
    assert caught.value.step == pytest.approx(1.5 - 3 * 0.3, abs=1e-9)
    assert a5.inverse_kinematics_path(target, max_step=0.38).shape == (5, 4)


def test_a_jump_on_the_axis_and_what_lies_behind_it() -> None:
    target = along_axis(0.5, 1.0, [0.30, 0.12, 0.30])
    with pytest.raises(DiscontinuousPathError, match=r"positions\[2\]"):
        a5.inverse_kinematics_path(target, max_step=0.3)
    target[4] = [1.0, 0, 0]  # beyond the jump, out of reach
    with pytest.raises(DiscontinuousPathError, match=r"positions\[2\]"):
        a5.inverse_kinematics_path(target, max_step=0.3)
    target[2] = [0, 0, 0.9]
    with pytest.raises(a5.UnreachableError, match="row 2"):
        a5.inverse_kinematics_path(target, max_step=0.3)


@pytest.mark.parametrize("noise", [1e-15, 1e-12, 4e-10])
def test_the_axis_is_the_same_for_everyone(noise: float) -> None:
    """Flags, poses and paths agree that a target within a nanometre is on the axis."""
    from alpha5_model.kinematics.pose import approach_directions

    target = along_axis(0.5, 1.1, [0.30, 0.31, 0.32, 0.33])
    target[1:-1, :2] += np.random.default_rng(85).uniform(-noise, noise, (4, 2))
    s = a5.inverse_kinematics(target)
    on = np.array([False, True, True, True, True, False])
    assert np.array_equal(s.singular, on)
    assert np.array_equal(approach_directions(target).any_azimuth, on)
    np.testing.assert_array_equal(s.best([1.0, 1, 1, 0])[on, 0], 1.0)
    path = a5.inverse_kinematics_path(target)
    assert np.abs(np.diff(path[:, 0])).max() < 0.3
    assert np.linalg.norm(tip(path) - target, axis=-1).max() < 2e-9


def test_beyond_the_tolerance_a_target_is_off_the_axis() -> None:
    from alpha5_model.kinematics.pose import approach_directions

    target = np.array([[1.1e-9, 0.0, 0.3], [0.0, 0.9e-9, 0.3]])
    assert a5.inverse_kinematics(target).singular.tolist() == [False, True]
    assert approach_directions(target).any_azimuth.tolist() == [False, True]


def poses_on_the_axis(count: int) -> list[np.ndarray]:
    """Random poses on the yaw axis; every other one needs angles next to their limits.

    There the range of theta_0 or of the wrist has its gap.
    """
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(86)
    rotation = Rotation.random(count, random_state=86).as_matrix()
    poses = []
    for k in range(count):
        pose = np.eye(4)
        pose[:3, 3] = [0, 0, rng.uniform(0.2, 0.36)]
        pose[:3, :3] = rotation[k]
        if k % 2:
            q = a5.inverse_kinematics(pose[:3, 3]).best([1, 1, 1, 1])
            q[0] = rng.choice([-0.1, 0.0, -0.05])
            q[3] = rng.choice([-0.04, 6.24])
            small = Rotation.from_rotvec(rng.uniform(-0.05, 0.05, 3)).as_matrix()
            pose[:3, :3] = small @ fk(q)[:3, :3]
        poses.append(pose)
    return poses


def scanned_error(
    q: np.ndarray, rotation: np.ndarray, yaw: np.ndarray, wrist: np.ndarray
) -> float:
    """The least angle to a rotation over a grid of theta_0 and theta_3."""
    grid = np.tile(q, (len(wrist), len(yaw), 1))
    grid[..., 0] = yaw
    grid[..., 3] = wrist[:, None]
    turned = np.einsum("abij,kj->abik", fk(grid)[..., :3, :3], rotation)
    cosine = (np.trace(turned, axis1=-2, axis2=-1) - 1) / 2
    return math.acos(min(1.0, cosine.max()))


@pytest.mark.slow
def test_pose_on_the_axis_has_the_least_error_over_theta_0_and_theta_3() -> None:
    yaw = np.linspace(LOWER[0], UPPER[0], 121)
    fine_yaw = np.linspace(LOWER[0], UPPER[0], 4001)
    wrist = np.linspace(LOWER[3], UPPER[3], 121)
    ends_of_wrist = np.array([LOWER[3], UPPER[3]])
    at_limit = 0
    for pose in poses_on_the_axis(26):
        rotation = pose[:3, :3]
        s = a5.inverse_kinematics_pose(pose)
        for branch in np.flatnonzero(s.exists):
            q = s.q[branch]
            error = s.rotation_error[branch]
            reached = fk(q)
            np.testing.assert_allclose(reached[:3, 3], pose[:3, 3], rtol=0, atol=1e-12)
            angle = angle_between(reached[:3, :3], rotation)
            assert angle == pytest.approx(error, abs=1e-7)
            assert LOWER[0] <= q[0] <= UPPER[0]
            assert LOWER[3] <= q[3] <= UPPER[3]

            # At a limit of the wrist only theta_0 is free: a finer scan is possible.
            assert error <= scanned_error(q, rotation, fine_yaw, ends_of_wrist) + 1e-7
            scanned = scanned_error(q, rotation, yaw, wrist)
            step_of_grid = 0.06
            assert scanned - step_of_grid <= error <= scanned + 1e-9
            at_limit += q[0] in (LOWER[0], UPPER[0]) or q[3] in (LOWER[3], UPPER[3])
    assert at_limit > 20


@each(
    ("size", "turn", "expected"),
    [
        ([1.0, 3.0], 0.4, [0.1, 0.3]),
        ([1.0, 3.0], 0.7, [0.2, 0.5]),  # the larger one at its most
        # And what is left to the one that stands.
        ([3.0, 1.0, 0.0], 1.2, [0.5, 0.5, 0.2]),
        ([0.0, 0.0], 0.6, [0.3, 0.3]),
        ([1.0, 1.0], 1.0, [0.5, 0.5]),
        ([1.0, 2.0], 0.0, [0.0, 0.0]),
    ],
)
def test_how_a_turn_is_shared(
    size: list[float], turn: float, expected: list[float]
) -> None:
    from alpha5_model.kinematics.path import shared_turn

    np.testing.assert_allclose(
        shared_turn(np.array(size), turn, 0.5), expected, rtol=0, atol=1e-15
    )


def test_a_jump_off_the_axis_is_at_the_point_where_it_lands() -> None:
    target = along_axis(0.5, 0.5, [0.30, 0.301, 0.302, 0.303])
    target[-1] = [0.15, 0.0, 0.30]
    s = a5.inverse_kinematics(target)
    last, landing = (s.q[k][s.within_limits[k]][:, 1:] for k in (4, 5))
    least = np.abs(last[:, None] - landing).max(axis=-1).min()
    with pytest.raises(DiscontinuousPathError, match=r"positions\[5\]") as caught:
        a5.inverse_kinematics_path(target, max_step=0.2)
    assert caught.value.step == pytest.approx(least)
    assert a5.inverse_kinematics_path(target, max_step=least + 1e-9).shape == (6, 4)
