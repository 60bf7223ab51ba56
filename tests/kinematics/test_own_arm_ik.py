"""Inverse kinematics of arms with their own lengths, zeros, limits and tools."""

from __future__ import annotations

import dataclasses
import math
import pickle

import numpy as np
import pytest
from loops import each
from own_arm import limits, random_arm, tips, turned_apart, with_tool, within

import alpha5_model as a5
from alpha5_model.errors import JointLimitError, UnreachableError
from alpha5_model.kernels import numpy_kernels
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import Solutions
from alpha5_model.numbers.parameters import Alpha5Parameters

TARGETS = 4000


def beside(seed: int) -> Alpha5Parameters:
    """A tool point 60 mm from Table 1's, in a random direction."""
    direction = np.random.default_rng(seed).normal(size=3)
    x, y, z = 0.06 * direction / np.linalg.norm(direction)
    return with_tool(x, y, -0.18 + z)


ARMS = {
    "as published": with_tool(0.0, 0.0, -0.18),
    "7 mm along": with_tool(0.0, 0.0, -0.187),
    "43 mm along": with_tool(0.0, 0.0, -0.223),
    "1e-9 m beside, x": with_tool(1e-9, 0.0, -0.18),
    "1e-9 m beside, y": with_tool(0.0, -1e-9, -0.18),
    "1e-9 m to the wrist axis": with_tool(
        0.01,
        0.02,
        -0.2,
        dataclasses.replace(
            a5.parameters(),
            dh=tuple(
                dataclasses.replace(row, a=1e-9) if i == 2 else row
                for i, row in enumerate(a5.parameters().dh)
            ),
        ),
    ),
}
ARMS |= {f"60 mm beside, {i}": beside(i) for i in (1, 2)}
RNG = np.random.default_rng(11)
ARMS |= {f"own lengths {i}": random_arm(RNG, off_axis=False) for i in range(2)}
ARMS |= {f"own lengths, beside {i}": random_arm(RNG, off_axis=True) for i in range(2)}


@each("name", ARMS)
def test_every_position_is_found_again(name: str) -> None:
    arm = ARMS[name]
    q = within(arm, TARGETS, seed=1)
    position = tips(arm, q)
    s = a5.inverse_kinematics(position, q[:, 3], arm=arm)

    reached = tips(arm, np.where(s.exists[..., None], s.q, 0.0))
    error = np.abs(reached - position[:, None]).max(axis=-1)
    assert error[s.exists].max() < 1e-15
    off = np.where(s.within_limits, turned_apart(s.q, q[:, None]), np.inf)
    assert off.min(axis=-1).max() < 1e-8
    lower, upper = limits(arm)
    inside = ((lower <= s.q) & (s.q <= upper)).all(axis=-1)
    assert (s.within_limits == (inside & s.exists)).all()


def newton(
    arm: Alpha5Parameters, position: np.ndarray, wrist: float, starts: int
) -> np.ndarray:
    """All theta_0 ... theta_2 that Newton's method finds, (N, 3), full turns aside."""
    rng = np.random.default_rng(3)
    q = np.column_stack(
        [rng.uniform(-math.pi, math.pi, (starts, 3)), np.full(starts, wrist)]
    )
    h = 1e-6
    for _ in range(60):
        off = tips(arm, q) - position
        columns = []
        for j in range(3):
            moved = q.copy()
            moved[:, j] += h
            columns.append((tips(arm, moved) - position - off) / h)
        jacobian = np.stack(columns, axis=-1)
        damped = jacobian.swapaxes(-1, -2) @ jacobian + 1e-12 * np.eye(3)
        step = np.linalg.solve(damped, (jacobian.swapaxes(-1, -2) @ off[..., None]))
        q[:, :3] -= np.clip(step[..., 0], -0.5, 0.5)
    solved = q[np.abs(tips(arm, q) - position).max(axis=-1) < 1e-9]
    found: list[np.ndarray] = []
    for one in solved:
        if all(turned_apart(one, other) > 1e-4 for other in found):
            found.append(one)
    return np.array(found).reshape(-1, 4)


@each("seed", range(12))
def test_newtons_method_finds_the_same_branches_and_no_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, off_axis=seed % 3 > 0)
    q = rng.uniform(-math.pi, math.pi, 4)
    position = tips(arm, q)
    s = a5.inverse_kinematics(position, float(q[3]), arm=arm)
    found = newton(arm, position, float(q[3]), starts=200)
    ours = s.q[s.exists]
    assert len(found) == len(ours)
    for one in found:
        assert turned_apart(one, ours).min() < 1e-6


@each("joint", range(4))
@each("off_axis", [False, True])
def test_limits_are_right_to_1e_12(joint: int, off_axis: bool) -> None:
    arm = random_arm(np.random.default_rng(joint), off_axis)
    lower, upper = limits(arm)
    rng = np.random.default_rng(5)
    for end, outwards in ((lower, -1.0), (upper, 1.0)):
        for beyond, fits in ((0.0, True), (1e-13, True), (3e-12, False)):
            q = within(arm, 400, seed=int(rng.integers(1000)))
            q[:, joint] = end[joint] + outwards * beyond
            s = a5.inverse_kinematics(tips(arm, q), q[:, 3], arm=arm)
            own = turned_apart(s.q, q[:, None]) < 1e-7
            assert own.any(axis=-1).all()
            clear = ~near_singular(arm, q)
            assert clear.sum() > 200
            assert ((own & s.within_limits).any(axis=-1) == fits)[clear].all()
            if fits:
                chosen = s.q[own & s.within_limits][:, joint]
                assert (chosen == end[joint]).mean() > 0.9 or beyond == 0.0


def near_singular(arm: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """Where rounding moves angles by more than 1e-12."""
    return a5.workspace.singularities(q, arm=arm).near(angle=3e-2, distance=3e-2)


def stretched_or_folded(
    arm: Alpha5Parameters, count: int, fold: float
) -> tuple[np.ndarray, np.ndarray]:
    """Joint positions with the arm stretched (0) or folded (pi), and its elbows."""
    q = np.random.default_rng(8).uniform(-math.pi, math.pi, (count, 4))
    at_zero = a5.workspace.singularities(q, arm=arm).stretched
    q[:, 2] += fold - at_zero
    row = arm.dh[1]
    phi = q[:, 1] + row.theta_offset
    r = arm.dh[0].a + row.a * np.cos(phi)
    azimuth = q[:, 0] + arm.dh[0].theta_offset
    z = arm.dh[0].d + row.a * np.sin(phi)
    elbow = np.stack([r * np.cos(azimuth), r * np.sin(azimuth), z], axis=-1)
    return q, elbow


@pytest.mark.parametrize("fold", [0.0, math.pi])
def test_the_edge_of_reach_is_right_to_1e_10(fold: float) -> None:
    arm = random_arm(np.random.default_rng(2), off_axis=False)
    q, elbow = stretched_or_folded(arm, 500, fold)
    position = tips(arm, q)
    plane = Geometry.of(arm)
    l_2 = math.hypot(plane.a_2, plane.z)
    outwards = (position - elbow) / l_2
    outwards *= 1.0 if fold == 0.0 or l_2 > plane.a_1 else -1.0
    outwards *= 1.0 if fold == 0.0 else -1.0
    for gap, exists in ((0.0, True), (-1e-12, True), (1e-12, True), (1e-8, False)):
        s = a5.inverse_kinematics(position + gap * outwards, q[:, 3], arm=arm)
        own = (turned_apart(s.q, q[:, None]) < 1e-3).any(axis=-1)
        assert (own == exists).all()
        assert s.singular[own].all()
        at = tips(arm, np.nan_to_num(s.q))
        off = np.linalg.norm(at - (position + gap * outwards)[:, None], axis=-1)
        assert off[s.exists].max() < 5e-12


@pytest.mark.parametrize("seed", range(3))
def test_the_cylinder_is_right_to_1e_10(seed: int) -> None:
    """Targets at the distance |w| of the yaw axis: underarm and overarm coincide."""
    arm = random_arm(np.random.default_rng(seed), off_axis=True)
    shape = Geometry.of(arm)
    q = within(arm, 400, seed=1)
    _, w = shape.tool_in_forearm(q[:, 3])
    rng = np.random.default_rng(2)
    azimuth = rng.uniform(-math.pi, math.pi, 400)
    height = shape.d_0 + rng.choice([-1.0, 1.0], 400) * rng.uniform(0.18, 0.24, 400)
    for gap, outside in ((0.0, True), (-1e-12, True), (1e-12, True), (-1e-8, False)):
        radius = np.abs(w) + gap
        at = [radius * np.cos(azimuth), radius * np.sin(azimuth), height]
        position = np.stack(at, axis=-1)
        s = a5.inverse_kinematics(position, q[:, 3], arm=arm)
        if not outside:
            assert not s.exists.any()
            continue
        assert s.exists.any(axis=-1).mean() > 0.9
        assert s.singular.all()
        reached = tips(arm, np.nan_to_num(s.q))
        off = np.linalg.norm(reached - position[:, None], axis=-1)
        assert off[s.exists].max() < 5e-12
        pair = s.exists[:, 0] & s.exists[:, 1]
        assert turned_apart(s.q[pair, 0], s.q[pair, 1]).max() < 1e-3


def test_theta_0_is_free_on_the_yaw_axis_where_the_tool_reaches_it() -> None:
    arm = with_tool(0.03, 0.02, -0.2)
    shape = Geometry.of(arm)
    wrist = math.atan2(-shape.y, shape.x) - shape.wrist_offset + math.pi
    s = a5.inverse_kinematics([0.0, 0.0, 0.2], wrist, arm=arm)
    assert s.exists.any()
    assert bool(s.singular)
    assert (s.q[s.exists][:, 0] == shape.middle[0]).all()
    assert np.abs(tips(arm, s.q[s.exists]) - [0.0, 0.0, 0.2]).max() < 1e-15
    elsewhere = a5.inverse_kinematics([0.0, 0.0, 0.2], wrist + 0.5, arm=arm)
    assert not elsewhere.exists.any()


def test_theta_2_is_free_with_the_tool_point_on_the_elbow_axis() -> None:
    arm = with_tool(-0.02, 0.05, 0.0)
    shape = Geometry.of(arm)
    wrist = -shape.wrist_offset + math.tau
    q = np.array([2.0, 1.0, 0.3, wrist])
    s = a5.inverse_kinematics(tips(arm, q), wrist, arm=arm)
    assert bool(s.singular)
    assert s.within_limits.any()
    assert (s.q[s.exists][:, 2] == shape.middle[2]).all()
    assert np.abs(tips(arm, s.q[s.exists]) - tips(arm, q)).max() < 1e-15


def test_theta_1_is_free_at_the_shoulder_of_equal_links() -> None:
    published = a5.parameters()
    a_1 = published.dh[1].a
    a_2 = published.dh[2].a
    joints = list(published.joints)
    joints[2] = dataclasses.replace(joints[2], lower=-0.5, upper=4.0)
    wide = dataclasses.replace(published, joints=tuple(joints))
    arm = with_tool(0.0, 0.0, -math.sqrt(a_1**2 - a_2**2), wide)
    shape = Geometry.of(arm)
    shoulder = np.array([-shape.a_0, 0.0, shape.d_0])
    s = a5.inverse_kinematics(shoulder, 0.1, arm=arm)
    assert bool(s.singular)
    free = s.exists & (np.abs(s.q[:, 1] - shape.middle[1]) == 0.0)
    assert free.any()
    assert np.abs(tips(arm, s.q[s.exists]) - shoulder).max() < 1e-9


@pytest.mark.parametrize("count", [1, 5, 500])
@pytest.mark.parametrize("name", ["43 mm along", "60 mm beside, 2"])
def test_numpy_solves_few_and_many_targets_alike(name: str, count: int) -> None:
    """Few rows once had no parameters, so that such arms had no solutions."""
    arm = ARMS[name]
    position = tips(arm, within(arm, count, seed=3))
    expected = a5.inverse_kinematics(position, 0.3, arm=arm)
    numbers = Geometry.of(arm).ik_parameters
    wrist = np.full(count, 0.3)
    q, exists, within_limits, singular = numpy_kernels.rows(
        "inverse_kinematics", numbers, position, wrist
    )
    assert q == pytest.approx(expected.q, abs=1e-12, nan_ok=True)
    assert (exists == expected.exists).all()
    assert (within_limits == expected.within_limits).all()
    assert (singular[:, 0] == expected.singular).all()


@pytest.mark.parametrize("name", ["43 mm along", "60 mm beside, 1"])
def test_one_target_is_solved_as_many_are(name: str) -> None:
    arm = ARMS[name]
    position = tips(arm, within(arm, 100, seed=9))
    many = a5.inverse_kinematics(position, 0.3, arm=arm)
    for i, target in enumerate(position):
        one = a5.inverse_kinematics(target, 0.3, arm=arm)
        listed = a5.inverse_kinematics(target.tolist(), 0.3, arm=arm)
        np.testing.assert_array_equal(one.q, many.q[i])
        np.testing.assert_array_equal(one.q, listed.q)
        for answer in (one, listed):
            assert (answer.within_limits == many.within_limits[i]).all()
            assert not answer.q.flags.writeable


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_targets_far_off_are_out_of_reach() -> None:
    arm = ARMS["60 mm beside, 1"]
    s = a5.inverse_kinematics([[1e200, 0.0, 0.0], [0.2, 0.0, 0.1]], 1e30, arm=arm)
    assert not s.exists[0].any()


def test_the_best_solution_is_that_of_the_own_arm() -> None:
    narrow = random_arm(np.random.default_rng(1), off_axis=True)
    q = within(narrow, 50, seed=2)
    s = a5.inverse_kinematics(tips(narrow, q), q[:, 3], arm=narrow)
    assert s.arm is narrow
    assert turned_apart(s.best(q, allow_collision=True), q).max() < 1e-8
    again = pickle.loads(pickle.dumps(s))
    assert turned_apart(again.best(q, allow_collision=True), q).max() < 1e-8
    assert type(a5.inverse_kinematics([0.2, 0.0, 0.1])) is Solutions


def test_an_error_says_what_is_known() -> None:
    along = ARMS["43 mm along"]
    with pytest.raises(UnreachableError, match="nearest reachable point") as reached:
        a5.inverse_kinematics([0.6, 0.0, 0.1], arm=along).best([0.0] * 4)
    inside = reached.value.nearest
    assert a5.distance_to_reach(inside, arm=along) == 0.0
    off = ARMS["60 mm beside, 1"]
    with pytest.raises(UnreachableError, match=r"within the joint limits$") as error:
        a5.inverse_kinematics([0.6, 0.0, 0.1], arm=off).best([0.0] * 4)
    assert math.isnan(error.value.distance)
    with pytest.raises(JointLimitError, match="axis_b"):
        a5.inverse_kinematics([0.25, 0.0, 0.1], 6.25, arm=off).best([0.0] * 4)


@pytest.mark.parametrize("off", [0.0, 1e-3])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_a_wrist_within_its_limits_is_not_blamed(off: float, end: str) -> None:
    """Another joint is beyond its limit, and the wrist is at its own, or next to it."""
    arm = ARMS["60 mm beside, 1"]
    joint = arm.joints[3]
    wrist = joint.lower + off if end == "lower" else joint.upper - off
    position = np.random.default_rng(8).uniform(-0.35, 0.35, (300, 3))
    s = a5.inverse_kinematics(position, wrist, arm=arm)
    beyond = s.exists.any(axis=-1) & ~s.within_limits.any(axis=-1)
    assert beyond.sum() > 10
    for target in position[beyond][:10]:
        one = a5.inverse_kinematics(target, wrist, arm=arm)
        with pytest.raises(UnreachableError, match=r"within the joint limits$"):
            one.best([0.0] * 4)
