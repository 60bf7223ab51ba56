"""The exact test and its distances, against coal pair by pair."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest
from coal_reference import CoalReference
from compiled_kernels import compiled_kernels
from fk import sample
from own_arm import random_arm, within
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.collision import self_collision as module
from alpha5_model.collision.bodies import collision_bodies
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.kernels import numpy_kernels

#: coal's distances are right to this [m].
COAL = 1e-6


@pytest.fixture(scope="module")
def locked() -> CoalReference:
    return CoalReference()


@pytest.fixture(scope="module")
def scene() -> SelfCollision:
    return self_collision(a5.parameters())


@pytest.fixture
def without_compiler(monkeypatch: pytest.MonkeyPatch) -> SelfCollision:
    compiled_kernels()
    monkeypatch.setattr(module, "module", lambda: numpy_kernels)
    return SelfCollision(collision_bodies(a5.parameters()))


def bisected(arm: a5.Arm, q: np.ndarray) -> np.ndarray:
    """Positions close to contact between random ones that touch and that do not."""
    hit = arm.in_collision(q)
    count = min(hit.sum(), (~hit).sum())
    touching, free = q[hit][:count].copy(), q[~hit][:count].copy()
    for _ in range(25):
        middle = (free + touching) / 2
        inside = arm.in_collision(middle)
        touching[inside], free[~inside] = middle[inside], middle[~inside]
    return np.concatenate([touching, free])


def test_random_positions_and_those_at_the_limits(locked: CoalReference) -> None:
    arm = a5.load()
    corners = np.array(list(itertools.product(*zip(LOWER, UPPER, strict=True))))
    edges = sample(200, seed=2)
    edges[np.arange(200), np.arange(200) % 4] = np.where(
        np.arange(200) % 8 < 4, LOWER[np.arange(200) % 4], UPPER[np.arange(200) % 4]
    )
    q = np.concatenate([sample(300, seed=1), corners, edges])
    expected = np.array([locked.distance(row) for row in q])
    clear = np.abs(expected) > COAL
    assert clear.sum() > 450
    assert np.array_equal(arm.in_collision(q)[clear], expected[clear] < 0.0)
    assert np.abs(arm.collision_distance(q) - expected).max() < 1.1 * COAL
    for margin in (0.002, 0.02):
        sure = np.abs(expected - margin) > COAL
        found = arm.in_collision(q, margin)
        assert np.array_equal(found[sure], expected[sure] < margin)


def test_positions_bisected_to_contact(locked: CoalReference) -> None:
    q = bisected(a5.load(), sample(900, seed=3))
    assert len(q) > 100
    assert max(abs(locked.distance(row)) for row in q[::3]) < 1.1 * COAL


def test_open_jaws() -> None:
    arm = a5.load(gripper="jaws")
    reference = CoalReference("jaws")
    rng = np.random.default_rng(4)
    limits = arm.limits
    q = rng.uniform(limits.lower, limits.upper, (300, 5))
    q[::3, 4] = limits.upper[4]
    assert reference.model.nq == 5
    expected = np.array([reference.distance(row) for row in q])
    clear = np.abs(expected) > COAL
    assert np.array_equal(arm.in_collision(q)[clear], expected[clear] < 0.0)
    assert np.abs(arm.collision_distance(q) - expected).max() < 1.1 * COAL
    # The fingers count: the same positions with closed jaws answer otherwise.
    closed = q.copy()
    closed[:, 4] = limits.lower[4]
    assert (arm.collision_distance(q) - arm.collision_distance(closed)).min() < -1e-3


def test_a_floating_base_changes_nothing() -> None:
    afloat = a5.load(floating_base=True)
    q = sample(50, seed=5)
    base = np.tile([0.3, -1.0, 2.0, 0.5, 0.5, -0.5, 0.5], (50, 1))
    floating = np.hstack([base, q])
    fixed = a5.load()
    assert np.array_equal(afloat.in_collision(floating), fixed.in_collision(q))
    assert np.array_equal(
        afloat.collision_distance(floating), fixed.collision_distance(q)
    )
    gradient = afloat.collision_distance_gradient(floating[0])
    assert np.array_equal(gradient[:6], np.zeros(6))
    assert np.array_equal(gradient[6:], fixed.collision_distance_gradient(q[0]))


def test_without_a_compiler(without_compiler: SelfCollision) -> None:
    compiled = self_collision(a5.parameters())
    q = np.concatenate([sample(300, seed=8), [[np.nan, 1, 1, 1]]])
    assert np.array_equal(without_compiler.touches(q), compiled.touches(q))
    asked = np.arange(len(q)) % 2 == 0
    few = without_compiler.touches(q, asked=asked)
    assert np.array_equal(few, compiled.touches(q, asked=asked))
    assert not few[~asked].any()
    q = q[:40]
    margin = 0.01
    slow = without_compiler.touches(q, margin)
    assert np.array_equal(slow, compiled.touches(q, margin))
    distances = without_compiler.distance(q)
    assert distances == pytest.approx(compiled.distance(q), abs=1.1 * COAL)
    start, end = q[:20], q[20:40]
    shares = without_compiler.free_shares(start, end)
    quick = compiled.free_shares(start, end)
    assert np.array_equal(shares == 1.0, quick == 1.0)
    assert shares == pytest.approx(quick, abs=1e-3)
    assert without_compiler.one()(q[0], 0.0) is None


@pytest.mark.parametrize("seed", range(3))
def test_arms_of_ones_own(seed: int) -> None:
    record = random_arm(np.random.default_rng(seed), off_axis=False)
    scene = self_collision(record)
    q = within(record, 200, seed)
    coal_distance = np.array([scene._coal.nearest(row).distance for row in q])
    clear = np.abs(coal_distance) > COAL
    assert np.array_equal(scene.touches(q)[clear], coal_distance[clear] < 0.0)
    assert scene.distance(q) == pytest.approx(coal_distance, abs=1.1 * COAL)


def test_no_pair_moves_faster_than_its_rates(locked: CoalReference) -> None:
    scene = self_collision(a5.parameters())
    names = scene.bodies.names
    rng = np.random.default_rng(9)
    start = sample(150, seed=10)
    end = start + rng.normal(scale=0.02, size=start.shape)
    largest = 0.0
    for one, other in zip(start, end, strict=True):
        before, after = locked.link_distances(one), locked.link_distances(other)
        for pair, rates in zip(scene.bodies.pairs, scene.rates, strict=True):
            links = (names[pair[0]], names[pair[1]])
            links = links if links in before else links[::-1]
            if min(before[links], after[links]) < 0.0:
                continue  # of what overlaps, coal's depth is not that of a motion
            change = abs(after[links] - before[links])
            most = rates @ np.abs(other - one)
            assert change <= most + 2 * COAL
            largest = max(largest, change / most)
    assert largest > 0.7, "the rates are not much too large either"


@pytest.mark.slow
def test_lines_that_are_proved_free_are(scene: SelfCollision) -> None:
    """By the exact test every 0.2 degrees, and by coal at the nearest place."""
    rng = np.random.default_rng(11)
    start, end = sample(80, seed=12), sample(80, seed=13)
    end[:70] = np.clip(start[:70] + rng.normal(scale=0.5, size=(70, 4)), LOWER, UPPER)
    shares = scene.free_shares(start, end)
    free = 0
    for share, one, other in zip(shares, start, end, strict=True):
        steps = int(np.ceil(np.abs(other - one).max() / np.radians(0.2)))
        along = np.linspace(0.0, 1.0, steps + 1)
        line = one + along[:, None] * (other - one)
        hits = scene.touches(line)
        distance = scene.distance(line)
        if share == 1.0:
            assert not hits.any()
            nearest = int(distance.argmin())
            assert scene._coal.nearest(line[nearest]).distance > -COAL
            free += 1
            continue
        assert not hits[along < share].any()
        at = one + share * (other - one)
        assert scene.distance(at[None])[0] < 2e-6
    assert 50 < free < 80


def test_a_margin_of_a_line_is_kept(scene: SelfCollision) -> None:
    compiled_kernels()
    start, end = sample(20, seed=14), sample(20, seed=15)
    wide = scene.free_shares(start, end, 0.01)
    assert (wide <= scene.free_shares(start, end) + 1e-12).all()
    for share, one, other in zip(wide, start, end, strict=True):
        line = one + np.linspace(0.0, share, 60)[:, None] * (other - one)
        if share > 0.0:
            assert scene.distance(line).min() > 0.01 - 1e-9
    still = start[~scene.touches(start)][:1]
    assert scene.free_shares(still, still) == [1.0]


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_gradient_by_finite_differences(gripper: str) -> None:
    arm = a5.load(gripper=gripper)
    rng = np.random.default_rng(16)
    limits = arm.limits
    q = rng.uniform(limits.lower, limits.upper, (60, len(limits.lower)))
    q = q[arm.collision_distance(q) > 1e-3]
    # Of some, both links move: not one of them is the base.
    assert sum(arm.closest_links(row)[0] != "link_0" for row in q) > 5
    # Without compiled kernels coal answers, whose distances are off by a micrometre.
    h, tolerance = (1e-5, 1e-4) if a5.backend() == "compiled" else (1e-3, 3e-3)
    smooth = 0
    for row in q:
        gradient = arm.collision_distance_gradient(row)
        for part, step in zip(gradient, h * np.eye(arm.model.nv), strict=True):
            ahead, here, behind = (
                arm.collision_distance(pin.integrate(arm.model, row, side * step))
                for side in (1.0, 0.0, -1.0)
            )
            if abs(ahead - 2 * here + behind) < tolerance * h:
                assert (ahead - behind) / (2 * h) == pytest.approx(part, abs=tolerance)
                smooth += 1
    # At a kink two sides differ; there are few.
    assert smooth > 0.9 * len(q) * arm.model.nv


def test_deep_in_contact_the_gradient_points_out() -> None:
    arm = a5.load()
    q = sample(400, seed=17)
    deeper = 0
    hits = q[arm.collision_distance(q) < -1e-3]
    for row in hits:
        gradient = arm.collision_distance_gradient(row)
        step = 1e-4 * gradient / np.linalg.norm(gradient)
        apart = arm.collision_distance(row + step) - arm.collision_distance(row)
        deeper += apart < 0.3 * 1e-4 * np.linalg.norm(gradient)
    assert len(hits) > 15
    assert deeper <= 0.2 * len(hits)


def test_one_position_answers_as_many() -> None:
    arm = a5.load()
    q = sample(60, seed=18)
    hits = arm.in_collision(q)
    distances = arm.collision_distance(q)
    for row, hit, distance in zip(q, hits, distances, strict=True):
        assert arm.in_collision(row) is bool(hit)
        assert arm.in_collision(row.tolist()) is bool(hit)
        assert arm.in_collision(row.astype(np.longdouble)) is bool(hit)
        assert arm.collision_distance(row) == distance
    block = q.reshape(3, 20, 4)
    assert arm.in_collision(block).shape == (3, 20)
    assert np.array_equal(arm.in_collision(block).ravel(), hits)
    assert arm.collision_distance(np.zeros((0, 4))).shape == (0,)


def test_wrong_input_is_refused_in_one_line() -> None:
    arm = a5.load()
    q = np.ones(4)
    for bad in ([1, 2, 3], np.ones((2, 5)), "a", [np.nan] * 4, np.full((2, 4), np.inf)):
        for ask in (arm.in_collision, arm.collision_distance):
            with pytest.raises(ValueError, match=r"^q"):
                ask(bad)
        with pytest.raises(ValueError, match=r"^q"):
            arm.collision_distance_gradient(bad)
    with pytest.raises(ValueError, match=r"^q: expected shape \(4,\)"):
        arm.collision_distance_gradient(np.ones((2, 4)))
    for margin in (-1e-9, np.nan, np.inf, "wide", [0.1, 0.2]):
        for rows in (q, q[None]):
            with pytest.raises(ValueError, match=r"^margin"):
                arm.in_collision(rows, margin)
    afloat = a5.load(floating_base=True)
    with pytest.raises(ValueError, match="unit quaternion"):
        afloat.in_collision(np.ones((2, 11)))
