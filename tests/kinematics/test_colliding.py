"""Solutions, choices and paths that keep the arm away from itself, by brute force."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from fk import sample, tip
from loops import each
from own_arm import random_arm, tips, within
from pinocchio_collision import CollisionModel
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.errors import JointLimitError, SelfCollisionError, UnreachableError
from alpha5_model.kinematics.choosing import nearest_free_yaw

HOME = np.array([3.0, 1.6, 1.6, 1.4])
#: Reached only with link_2 in link_0.
BEHIND = (-0.211669, 0.0861231, 0.0540905)


def targets(count: int, seed: int) -> np.ndarray:
    """Random points that the arm reaches, (count, 3)."""
    return tip(sample(count, seed))


@pytest.fixture(scope="module")
def coal() -> CollisionModel:
    """Pinocchio and coal, which know no table and no kernel."""
    return CollisionModel(a5.load().model)


def free_options(
    solutions: Any, coal: CollisionModel, index: tuple[int, ...] = ()
) -> np.ndarray:
    """Solutions within the limits that coal finds free, (M, 4)."""
    options = solutions.q[index][solutions.within_limits[index]]
    return np.array([q for q in options if not coal.in_collision(q)]).reshape(-1, 4)


def test_flags_against_coal(coal: CollisionModel) -> None:
    s = a5.inverse_kinematics(targets(300, seed=1).reshape(3, 100, 3), 1.0)
    assert s.collides.shape == (3, 100, 4)
    assert not s.collides[~s.within_limits].any()
    expected = [coal.in_collision(q) for q in s.q[s.within_limits]]
    assert np.array_equal(s.collides[s.within_limits], expected)
    assert 0 < sum(expected) < len(expected)
    with pytest.raises(ValueError, match="read-only"):
        s.collides[0] = True


def test_flags_of_poses_and_of_an_own_arm() -> None:
    record = random_arm(np.random.default_rng(3), off_axis=False)
    own = a5.load(arm=record)
    q = within(record, 60, 2)
    s = a5.inverse_kinematics(tips(record, q), q[:, 3], arm=record)
    expected = [own.in_collision(row) for row in s.q[s.within_limits]]
    assert np.array_equal(s.collides[s.within_limits], expected)
    assert any(expected)

    arm = a5.load()
    poses = np.array([arm.forward_kinematics(q).homogeneous for q in sample(60, 3)])
    found = a5.inverse_kinematics_pose(poses)
    expected = [arm.in_collision(row) for row in found.q[found.within_limits]]
    assert np.array_equal(found.collides[found.within_limits], expected)
    assert not found.collides[~found.within_limits].any()


def test_best_is_the_nearest_free_one(coal: CollisionModel) -> None:
    changed = stuck = 0
    for target in targets(60, seed=4):
        s = a5.inverse_kinematics(target, 0.7)
        options = free_options(s, coal)
        if not len(options):
            stuck += 1
            with pytest.raises(SelfCollisionError):
                s.best(HOME)
            continue
        nearest = options[np.linalg.norm(options - HOME, axis=1).argmin()]
        assert np.array_equal(s.best(HOME), nearest)
        assert np.array_equal(s.best(HOME.tolist()), nearest)
        any_will_do = s.best(HOME, allow_collision=True)
        changed += not np.array_equal(any_will_do, nearest)
    assert stuck > 0
    assert changed > 0


def test_one_target_answers_as_many(coal: CollisionModel) -> None:
    p = targets(150, seed=5)
    one = [a5.inverse_kinematics(target, 0.7) for target in p]
    free = np.array([(s.within_limits & ~s.collides).any() for s in one])
    many = a5.inverse_kinematics(p[free], 0.7)
    alone = [s.best(HOME) for s, is_free in zip(one, free, strict=True) if is_free]
    assert many.best(HOME) == pytest.approx(np.array(alone), abs=1e-12)
    references = sample(len(alone), seed=6)
    each_alone = [
        a5.inverse_kinematics(target, 0.7).best(reference)
        for target, reference in zip(p[free], references, strict=True)
    ]
    assert many.best(references) == pytest.approx(np.array(each_alone), abs=1e-12)
    everything = a5.inverse_kinematics(p, 0.7)
    any_will_do = np.array([s.best(HOME, allow_collision=True) for s in one])
    found = everything.best(HOME, allow_collision=True)
    assert found == pytest.approx(any_will_do, abs=1e-12)


def test_a_target_without_a_free_solution_is_named() -> None:
    s = a5.inverse_kinematics([[0.25, 0.1, 0.1], BEHIND])
    with pytest.raises(SelfCollisionError, match=r"\(row 1\): link_0 and link_2") as e:
        s.best(HOME)
    assert isinstance(e.value, UnreachableError)
    assert e.value.links == ("link_0", "link_2")
    assert e.value.position == pytest.approx(BEHIND)
    with pytest.raises(a5.SelfCollisionError) as alone:
        a5.inverse_kinematics(BEHIND).best(HOME)
    assert "row" not in str(alone.value)
    clearance = CollisionModel(a5.load().model).clearance(
        a5.inverse_kinematics(BEHIND).best(HOME, allow_collision=True)
    )
    assert alone.value.depth == pytest.approx(-clearance.distance, abs=2e-6)
    assert alone.value.links == clearance.links


@pytest.mark.slow
def test_what_an_error_proposes_frees_the_target(coal: CollisionModel) -> None:
    def is_free(target: Any, wrist: float) -> bool:
        s = a5.inverse_kinematics(target, wrist)
        options = s.q[s.within_limits]
        return any(coal.clearance(q).distance > -1e-6 for q in options)

    proposed = {"wrist": 0, "yaw": 0}
    for target in np.concatenate([targets(350, seed=7), targets(4000, 8)[:, :]]):
        s = a5.inverse_kinematics(target, 0.0)
        valid = s.within_limits & ~s.collides
        if valid.any() or not s.within_limits.any():
            continue
        with pytest.raises(SelfCollisionError) as caught:
            s.best(HOME)
        error = caught.value
        if not math.isnan(error.wrist):
            assert is_free(target, error.wrist)
            assert LOWER[3] <= error.wrist <= UPPER[3]
            # No angle that is clearly nearer will do.
            for angle in np.arange(0.0, error.wrist - 0.02, 0.02):
                assert not is_free(target, angle)
            assert f"theta_3 = {error.wrist:.4g} rad is free" in str(error)
            proposed["wrist"] += 1
        if proposed["yaw"] < 6 and not math.isnan(error.yaw):
            c, sn = math.cos(error.yaw), math.sin(error.yaw)
            turned = np.array([[c, -sn, 0], [sn, c, 0], [0, 0, 1]]) @ target
            assert is_free(turned, 0.0)
            proposed["yaw"] += 1
            for share in (0.3, 0.6, 0.9, 0.99):
                c, sn = math.cos(share * error.yaw), math.sin(share * error.yaw)
                nearer = np.array([[c, -sn, 0], [sn, c, 0], [0, 0, 1]]) @ target
                if abs(error.yaw) * (1 - share) > 0.02:
                    assert not is_free(nearer, 0.0)
    assert proposed["wrist"] >= 1
    assert proposed["yaw"] == 6


def test_a_wrist_that_collides_on_its_own_is_told_from_a_limit() -> None:
    with pytest.raises(JointLimitError):
        a5.inverse_kinematics([0.2, 0.0, 0.1], 6.25).best(HOME)
    with pytest.raises(UnreachableError) as far:
        a5.inverse_kinematics([0.9, 0.0, 0.1]).best(HOME)
    assert not isinstance(far.value, SelfCollisionError)


def test_on_the_yaw_axis_a_free_theta_0_is_found(coal: CollisionModel) -> None:
    reached = collided = 0
    for z in np.linspace(-0.05, 0.36, 60):
        s = a5.inverse_kinematics([0.0, 0.0, z])
        if not s.within_limits.any():
            continue
        reached += 1
        for yaw in (LOWER[0], 0.3, 2.0, 4.5, UPPER[0]):
            reference = np.array([yaw, 1.6, 1.6, 1.4])
            options = s.q[s.within_limits].copy()
            options[:, 0] = yaw
            hits = [coal.in_collision(q) for q in options]
            best = s.best(reference)
            assert not coal.in_collision(best)
            assert tip(best[None])[0] == pytest.approx([0, 0, z], abs=1e-9)
            collided += all(hits)
            if not all(hits):
                assert best[0] == yaw
    assert reached > 10


def test_the_nearest_free_yaw_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a wall of angles that collide, since the arm has none on its axis."""
    scene = self_collision(a5.parameters())

    def touches(
        self: SelfCollision, angles: Any, margin: float = 0.0, asked: Any = None
    ) -> np.ndarray:
        hits = (angles[:, 0] > 1.0) & (angles[:, 0] < 2.5)
        return hits if asked is None else hits & asked

    monkeypatch.setattr(SelfCollision, "touches", touches)
    s = a5.inverse_kinematics([0.0, 0.0, 0.3])
    assert s.best([1.2, 1.0, 1.0, 0.0])[0] == pytest.approx(1.0, abs=1e-4)
    assert s.best([2.0, 1.0, 1.0, 0.0])[0] == pytest.approx(2.5, abs=1e-4)
    assert s.best([0.9, 1.0, 1.0, 0.0])[0] == 0.9
    assert isinstance(scene, SelfCollision)


@each("seed", range(30))
def test_a_gap_of_a_degree_between_collisions_is_found(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the nearer end of the gap is met to a hundredth of a degree."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(2.0, 4.0)
    side = rng.choice([-1.0, 1.0])
    near = start + side * rng.uniform(0.2, 0.8)
    far = near + side * math.radians(1.01)

    def touches(self: SelfCollision, angles: Any, *_: Any, **__: Any) -> np.ndarray:
        yaw = angles[:, 0]
        return np.asarray((yaw - near) * (yaw - far) > 0.0)

    monkeypatch.setattr(SelfCollision, "touches", touches)
    scene = self_collision(a5.parameters())
    q = np.array([start, 1.0, 1.0, 0.0])
    found = nearest_free_yaw(scene, q, LOWER[0], UPPER[0])
    assert abs(found - near) < math.radians(0.01)
    assert (found - near) * side >= 0.0
    none = nearest_free_yaw(scene, q, start - 0.1, start + 0.1)
    assert math.isnan(none)


def test_best_of_poses_is_free(coal: CollisionModel) -> None:
    arm = a5.load()
    stuck = 0
    for q in sample(50, seed=9):
        s = a5.inverse_kinematics_pose(arm.forward_kinematics(q))
        valid = [
            bool(ok) and not coal.in_collision(row)
            for ok, row in zip(s.within_limits, s.q, strict=True)
        ]
        if not any(valid):
            stuck += 1
            with pytest.raises(SelfCollisionError):
                s.best(q)
            s.best(q, allow_collision=True)
            continue
        best = s.best(q)
        assert not coal.in_collision(best)
        chosen = int(np.nanargmin(np.abs(s.q - best).sum(axis=1)))
        assert s.rotation_error[chosen] <= s.rotation_error[valid].min() + 1e-7
    assert stuck > 0


def assert_free(path: np.ndarray, coal: CollisionModel) -> None:
    """Coal finds no contact on the lines between rows, every quarter of a degree."""
    for one, other in itertools.pairwise(path):
        steps = int(np.ceil(np.abs(other - one).max() / np.radians(0.25)))
        for q in np.linspace(one, other, steps + 1):
            assert coal.clearance(q).distance > -1e-6


@pytest.mark.slow
def test_a_path_takes_the_least_travel_of_free_branches(coal: CollisionModel) -> None:
    """By brute force over all choices of branches."""
    followed = blocked = 0
    rng = np.random.default_rng(10)
    for q in sample(90, seed=11):
        turns = np.cumsum(rng.normal(scale=0.1, size=(4, 4)), axis=0)
        target = tip(np.clip(q + turns, LOWER, UPPER))
        s = a5.inverse_kinematics(target, 0.5)
        options = [free_options(s, coal, (k,)) for k in range(4)]
        best, best_path = math.inf, None
        for choice in itertools.product(*options):
            path = np.array(choice)
            step = np.diff(path, axis=0)
            travel = np.linalg.norm(step, axis=1).sum()
            if np.abs(step).max() <= 0.5 and travel < best:
                lines = np.concatenate(
                    [np.linspace(a, b, 12) for a, b in itertools.pairwise(path)]
                )
                if not any(coal.in_collision(row) for row in lines):
                    best, best_path = travel, path
        if best_path is None:
            with pytest.raises(a5.Alpha5Error) as caught:
                a5.inverse_kinematics_path(target, wrist=0.5)
            blocked += isinstance(caught.value, SelfCollisionError)
            continue
        found = a5.inverse_kinematics_path(target, wrist=0.5)
        assert np.linalg.norm(np.diff(found, axis=0), axis=1).sum() == pytest.approx(
            best, abs=1e-9
        )
        followed += 1
    assert blocked > 3
    assert followed > 40


def test_a_path_into_the_base_stops_before_it(coal: CollisionModel) -> None:
    start = a5.inverse_kinematics(BEHIND).best(HOME, allow_collision=True)
    q = np.linspace([start[0] - 1.2, *start[1:]], start, 60)
    target = tip(q)
    with pytest.raises(SelfCollisionError, match=r"row \d+") as caught:
        a5.inverse_kinematics_path(target, q[0])
    k = int(str(caught.value).split("row ")[1].split(")")[0])
    hits = [coal.in_collision(row) for row in q]
    assert hits.index(True) == k
    assert caught.value.position == pytest.approx(target[k])
    path = a5.inverse_kinematics_path(target[:k], q[0])
    assert_free(path, coal)
    through = a5.inverse_kinematics_path(target, q[0], allow_collision=True)
    assert through == pytest.approx(q, abs=1e-9)


@pytest.mark.slow
def test_a_step_through_a_collision_is_refused(coal: CollisionModel) -> None:
    """Both ends are free, the line between them is not."""
    found = None
    rng = np.random.default_rng(12)
    for one in sample(8000, seed=13):
        other = np.clip(one + rng.uniform(-0.45, 0.45, 4), LOWER, UPPER)
        line = np.linspace(one, other, 40)
        hits = a5.load().in_collision(line) if found is None else [False]
        if found is None and not hits[0] and not hits[-1] and hits.any():
            found = one, other
            break
    assert found is not None
    one, other = found
    line = np.linspace(one, other, 300)
    with pytest.raises(SelfCollisionError, match=r"from the position before \(row 1\)"):
        a5.inverse_kinematics_path(
            tip(np.array([one, other])), one, wrist=[one[3], other[3]]
        )
    assert any(coal.in_collision(q) for q in line)


def test_a_start_in_collision_is_refused() -> None:
    start = a5.inverse_kinematics(BEHIND).best(HOME, allow_collision=True)
    away = start - [0.45, 0.0, 0.0, 0.0]
    assert not a5.load().in_collision(away)
    with pytest.raises(SelfCollisionError, match="row 0") as caught:
        a5.inverse_kinematics_path(tip(away[None]), start)
    assert caught.value.depth > 0.01


def test_paths_across_the_yaw_axis_are_free(coal: CollisionModel) -> None:
    for height in (0.28, 0.31):
        x = np.linspace(0.06, -0.06, 41)
        target = np.stack([x, 0.0 * x, 0.0 * x + height], axis=1)
        assert target[20, 0] == 0.0
        path = a5.inverse_kinematics_path(target)
        assert tip(path) == pytest.approx(target, abs=1e-9)
        assert_free(path, coal)


def test_a_collision_on_the_yaw_axis_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every line whose theta_0 turns counts as one that collides."""

    def free_shares(
        self: SelfCollision, start: Any, end: Any, margin: float = 0.0
    ) -> np.ndarray:
        return np.where(np.abs(end[:, 0] - start[:, 0]) > 1e-3, 0.5, 1.0)

    x = np.array([0.02, 0.0, 0.0, 0.0])
    target = np.stack([x, 0.02 - x, 0.0 * x + 0.31], axis=1)
    target[1:3, 1] = 0.0
    target[3, 1] = 0.02
    free = a5.inverse_kinematics_path(target, max_step=2.0)
    assert np.ptp(free[:, 0]) > 1.0
    monkeypatch.setattr(SelfCollision, "free_shares", free_shares)
    with pytest.raises(SelfCollisionError, match=r"row [123]"):
        a5.inverse_kinematics_path(target, max_step=2.0)
