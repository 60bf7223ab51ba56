"""Inverse kinematics at and near the limits, the stretched arm and the yaw axis."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from fk import FOLDED, STRETCHED, sample, tip
from hypothesis import given, settings
from hypothesis import strategies as st
from loops import each
from reference import LOWER, UPPER

import alpha5_model as a5

CLOSE = (0.0, 1e-15, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)


def check(q: np.ndarray) -> None:
    """The targets of configurations within the limits are solved within the limits."""
    position = tip(q)
    s = a5.inverse_kinematics(position, q[:, 3])
    lost = ~s.within_limits.any(axis=-1)
    assert not lost.any(), q[lost][:5]
    assert not np.isnan(s.q[s.exists]).any()
    reached = tip(s.q[s.exists])
    target = np.broadcast_to(position[:, None], (*s.exists.shape, 3))[s.exists]
    assert np.linalg.norm(reached - target, axis=-1).max() < 1e-12
    inside = s.q[s.within_limits]
    assert ((inside >= LOWER) & (inside <= UPPER)).all(), (
        "in limits means in limits, to the bit"
    )
    # The original configuration itself is found, as far as rounding can tell.
    distance = np.abs(s.q - q[:, None])[..., 1:].max(axis=-1)
    off = np.where(s.within_limits, distance, np.inf)
    assert off.min(axis=-1).max() < 3e-7
    for i in range(0, len(q), max(1, len(q) // 50)):
        one = a5.inverse_kinematics(position[i], float(q[i, 3]))
        assert np.array_equal(one.within_limits, s.within_limits[i])
        assert np.array_equal(one.exists, s.exists[i])


def test_every_corner_and_edge_of_the_joint_ranges() -> None:
    middle = (LOWER + UPPER) / 2
    grid = itertools.product(*zip(LOWER, middle, UPPER, strict=True))
    check(np.array(list(grid)))


@each("joint", range(4))
@each("limit", [LOWER, UPPER])
def test_exactly_at_a_limit(joint: int, limit: np.ndarray) -> None:
    q = sample(2000, seed=20 + joint)
    q[:, joint] = limit[joint]
    check(q)


@pytest.mark.parametrize("joint", range(3))
def test_beyond_a_limit_is_beyond(joint: int) -> None:
    """The control: a configuration 1e-9 rad past a limit is not counted as within."""
    for limit, side in ((LOWER, -1.0), (UPPER, 1.0)):
        q = sample(500, seed=30 + joint)
        q[:, joint] = limit[joint] + side * 1e-9
        # theta_1 is known to 1e-9 only where the arm is not stretched.
        q[:, 2] = np.where(np.abs(q[:, 2] - STRETCHED) < 0.1, STRETCHED - 0.5, q[:, 2])
        position = tip(q)
        far = np.hypot(position[:, 0], position[:, 1]) > 1e-3
        s = a5.inverse_kinematics(position, q[:, 3])
        same = np.abs(s.q - q[:, None]).max(axis=-1) < 1e-10
        assert same[far].any(axis=-1).all()
        assert not s.within_limits[far][same[far]].any()


@each("gap", CLOSE)
def test_close_to_the_stretched_arm(gap: float) -> None:
    for side in (-1.0, 1.0):
        q = sample(500, seed=40)
        q[:, 2] = STRETCHED + side * gap
        check(q)
        q[:, 1] = LOWER[1]
        check(q)
        q[:, 1] = UPPER[1] - gap
        check(q)


def test_on_the_stretched_arm_both_elbows_coincide() -> None:
    q = sample(300, seed=41)
    q[:, 2] = STRETCHED
    s = a5.inverse_kinematics(tip(q), q[:, 3])
    assert s.singular.all()
    best = s.best(q, allow_collision=True)
    assert np.abs(best - q).max() < 2e-7
    pair = (np.abs(s.q[:, :2, 2] - STRETCHED) < 1e-6).argmax(axis=-1)
    rows = np.arange(300)
    np.testing.assert_allclose(s.q[rows, pair], s.q[rows, pair + 2], rtol=0, atol=1e-6)


@pytest.mark.parametrize("excess", [1e-16, 1e-13, 1e-11, 9e-11])
def test_rounding_beyond_the_edge_is_on_it(excess: float) -> None:
    q = sample(300, seed=42)
    q[:, 2] = STRETCHED
    position = tip(q)
    out = outwards(q)
    s = a5.inverse_kinematics(position + excess * out, q[:, 3])
    assert s.within_limits.any(axis=-1).all()
    best = s.best(q, allow_collision=True)
    assert np.linalg.norm(tip(best) - position - excess * out, axis=-1).max() < 1e-9


@pytest.mark.parametrize("excess", [2e-10, 1e-9, 1e-6, 1e-2])
def test_a_point_beyond_the_edge_is_not_reached(excess: float) -> None:
    q = sample(300, seed=43)
    q[:, 2] = STRETCHED
    position = tip(q) + excess * outwards(q)
    s = a5.inverse_kinematics(position)
    # If the stretched arm is not the outer edge of the set, the other pose reaches it.
    elsewhere = s.exists & (np.abs(s.q[..., 2] - STRETCHED) > 0.01)
    assert not (s.exists & ~elsewhere).any()


def outwards(q: np.ndarray) -> np.ndarray:
    """Direction from the shoulder to the stretched tcp, (N, 3)."""
    shoulder = np.stack(
        [
            0.020 * np.cos(q[:, 0] + math.pi),
            0.020 * np.sin(q[:, 0] + math.pi),
            0 * q[:, 0] + 0.0462,
        ],
        axis=-1,
    )
    arm = tip(q) - shoulder
    return arm / np.linalg.norm(arm, axis=-1, keepdims=True)


@each("radius", [0.0, 1e-16, 1e-14, 5e-14, 2e-13, 1e-11, 9e-10, 2e-9, 1e-8, 1e-6, 1e-4])
def test_on_and_close_to_the_yaw_axis(radius: float) -> None:
    azimuth = np.linspace(-math.pi, math.pi, 73)
    for z in (0.3, 0.2, -0.27):
        position = np.stack(
            [radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(73, z)],
            axis=-1,
        )
        s = a5.inverse_kinematics(position)
        assert s.exists.all()
        assert s.singular.all() == (radius <= 1e-9)
        target = np.broadcast_to(position[:, None], (73, 4, 3))
        # On the axis, within a nanometre, the tcp stands on the axis itself.
        exact = 1e-12 + (radius if radius <= 1e-9 else 0.0)
        assert np.linalg.norm(tip(s.q) - target, axis=-1).max() < exact
        assert s.within_limits.any(axis=-1).all() == (z > 0)


def test_on_the_yaw_axis_theta_0_is_the_middle_and_best_keeps_the_reference() -> None:
    s = a5.inverse_kinematics([0.0, 0.0, 0.3])
    np.testing.assert_allclose(s.q[:, 0], (LOWER[0] + UPPER[0]) / 2)
    best = s.best([1.234, 1.0, 1.0, 0.0])
    assert best[0] == 1.234
    assert np.linalg.norm(tip(best) - [0, 0, 0.3]) < 1e-15
    assert s.best([-9.0, 1.0, 1.0, 0.0])[0] == LOWER[0]


@each("azimuth", [0.0, -0.0, math.pi, -math.pi, math.pi / 2, -math.pi / 2])
@each("off", [0.0, 1e-16, -1e-16, 1e-9, -1e-9])
def test_at_the_cut_of_the_azimuth(azimuth: float, off: float) -> None:
    position = [0.25 * math.cos(azimuth), 0.25 * math.sin(azimuth) + off, 0.1]
    s = a5.inverse_kinematics(position)
    assert s.exists.any()
    target = np.broadcast_to(position, (4, 3))[s.exists]
    assert np.linalg.norm(tip(s.q[s.exists]) - target, axis=-1).max() < 1e-12


def test_the_closed_wedges() -> None:
    """theta_0 ends at 1 and 352 degrees, so one pose only can turn to azimuth 0."""
    z = 0.3
    for azimuth, open_pair, shut_pair in ((0.0, 0, 1), (math.pi, 1, 0)):
        target = [0.05 * math.cos(azimuth), 0.05 * math.sin(azimuth), z]
        s = a5.inverse_kinematics(target)
        assert s.exists.all()
        assert s.within_limits[[open_pair, open_pair + 2]].any()
        assert not s.within_limits[[shut_pair, shut_pair + 2]].any()


special = [
    st.sampled_from([LOWER[j], UPPER[j], *([STRETCHED, FOLDED] if j == 2 else [])])
    for j in range(4)
]
angle = [
    st.one_of(
        st.floats(LOWER[j], UPPER[j]),
        st.builds(
            lambda at, gap, j=j: float(np.clip(at + gap, LOWER[j], UPPER[j])),
            special[j],
            st.sampled_from([s * g for g in CLOSE for s in (-1, 1)]),
        ),
    )
    for j in range(4)
]


@settings(max_examples=400, deadline=None, derandomize=True)
@given(st.tuples(*angle))
def test_property_of_any_configuration(q: tuple[float, ...]) -> None:
    check(np.array([q]))


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    st.tuples(
        *[st.one_of(st.floats(-0.5, 0.5), st.sampled_from([0.0, -0.0, 1e-300, 0.0462]))]
        * 3
    ),
    st.floats(-12, 12),
)
def test_property_of_any_point(
    position: tuple[float, float, float], wrist: float
) -> None:
    s = a5.inverse_kinematics(list(position), wrist)
    batch = a5.inverse_kinematics([position], [wrist])
    for one, many in zip(s, batch, strict=True):
        np.testing.assert_allclose(
            np.asarray(one, float), np.asarray(many[0], float), rtol=0, atol=1e-7
        )
    assert not (s.within_limits & ~s.exists).any()
    if s.exists.any():
        target = np.broadcast_to(position, (4, 3))[s.exists]
        assert np.linalg.norm(tip(s.q[s.exists]) - target, axis=-1).max() < 1e-9 + 1e-15
    assert bool(a5.reachable(position)) == (
        float(a5.distance_to_reach(position)) == 0.0
    )
