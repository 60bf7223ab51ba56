"""Poses and paths: the least rotation error, the least joint travel, and what cannot be followed."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from fk import STRETCHED, fk, sample, tip
from reference import LOWER, UPPER
from scipy.spatial.transform import Rotation

import alpha5_model as a5
from alpha5_model.errors import DiscontinuousPathError, InputError, ShapeError


def random_poses(count: int, seed: int) -> np.ndarray:
    pose = fk(sample(count, seed))
    pose[:, :3, :3] = Rotation.random(count, random_state=seed).as_matrix()
    return pose


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (Rotation.from_matrix(a).inv() * Rotation.from_matrix(b)).magnitude()


def test_attainable_poses_are_attained() -> None:
    q = sample(20_000, seed=70)
    pose = fk(q)
    s = a5.inverse_kinematics_pose(pose)
    assert (s.exact & s.within_limits).any(axis=-1).all()
    best = s.best(q)
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
            np.testing.assert_allclose(reached[:3, 3], pose[i, :3, 3], rtol=0, atol=1e-12)
            error = s.rotation_error[i, branch]
            assert angle_between(reached[:3, :3], pose[i, :3, :3]) == pytest.approx(error, abs=1e-9)
            q[:, 3] = wrist
            scan = angle_between(fk(q)[:, :3, :3], np.broadcast_to(pose[i, :3, :3], (4001, 3, 3)))
            assert error <= scan.min() + 1e-12
            assert error == pytest.approx(scan.min(), abs=1e-5)
    assert not s.exact.any()


def test_small_rotation_errors_keep_their_digits() -> None:
    q = sample(50, seed=72)
    pose = fk(q)
    for size in (1e-3, 1e-6, 1e-9):
        # About an axis across the wrist axis, which the wrist cannot make up for.
        across = np.cross(wrist_axis(q), [0.3, -0.5, 0.8])
        across /= np.linalg.norm(across, axis=-1, keepdims=True)
        turned = pose.copy()
        turned[:, :3, :3] = Rotation.from_rotvec(size * across).as_matrix() @ pose[:, :3, :3]
        s = a5.inverse_kinematics_pose(turned)
        error = np.where(s.within_limits, s.rotation_error, np.inf).min(axis=-1)
        np.testing.assert_allclose(error, size, rtol=1e-3, atol=1e-12)
        assert s.exact.any() == (size < 1e-7)


def wrist_axis(q: np.ndarray) -> np.ndarray:
    """By finite rotation: the axis that a turn of theta_3 turns about."""
    turned = q.copy()
    turned[:, 3] += 0.5
    spin = fk(turned)[:, :3, :3] @ np.swapaxes(fk(q)[:, :3, :3], 1, 2)
    return Rotation.from_matrix(spin).as_rotvec() / 0.5


def test_wrist_stays_within_its_limits_in_the_gap() -> None:
    """Wanted beyond 6.2 rad: the nearer end of the range, and its error."""
    q = sample(200, seed=73)
    q[:, 3] = np.linspace(6.2, 2 * math.pi, 200)
    s = a5.inverse_kinematics_pose(fk(q))
    best = s.best(q)
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


def test_bad_poses() -> None:
    good = fk(sample(3, seed=76))
    for spoil in ("scale", "mirror", "row", "nan"):
        bad = good.copy()
        if spoil == "scale":
            bad[1, :3, :3] *= 1.01
        elif spoil == "mirror":
            bad[1, :3, 0] *= -1
        elif spoil == "row":
            bad[1, 3, 0] = 0.1
        else:
            bad[1, 0, 0] = np.nan
        with pytest.raises(InputError, match=r"transform\[1"):
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
        path = a5.inverse_kinematics_path(tip(q), q[0], wrist=q[:, 3])
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
            path = a5.inverse_kinematics_path(tip(q), wrist=1.0)
            travel = np.linalg.norm(np.diff(path, axis=0), axis=-1).sum()
            assert travel == pytest.approx(best, abs=1e-9)
            compared += 1
        else:
            with pytest.raises(DiscontinuousPathError):
                a5.inverse_kinematics_path(tip(q), wrist=1.0)
    assert compared > 10


def test_path_changes_the_elbow_where_the_elbows_meet() -> None:
    """Out to the stretched arm and back: a start on the flipped elbow ends on the flipped elbow or not,
    but never jumps."""
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
    return turn, np.stack([radius * np.cos(turn), radius * np.sin(turn), 0 * turn + z], axis=-1)


def test_a_full_circle_stops_at_the_wedge() -> None:
    """The underarm pose ends where theta_0 = azimuth + pi reaches its upper limit."""
    turn, target = circle(0.2, 0.2)
    assert a5.reachable(target).all(), "every point is in reach, one after the other is not"
    with pytest.raises(DiscontinuousPathError) as caught:
        a5.inverse_kinematics_path(target)
    k = caught.value.index
    assert turn[k - 1] + math.pi <= UPPER[0] + 1e-9 < turn[k] + math.pi
    assert caught.value.step > 3.0
    part = a5.inverse_kinematics_path(target[:k])
    assert np.abs(np.diff(part, axis=0)).max() < 0.1
    # Farther out the overarm pose does not reach, and the wedge is out of reach altogether.
    turn, target = circle(0.3, 0.1)
    with pytest.raises(a5.UnreachableError, match=rf"row {k}\b"):
        a5.inverse_kinematics_path(target)


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
