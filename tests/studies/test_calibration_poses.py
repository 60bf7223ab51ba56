"""How poses are chosen: by determinants, beside a table, in a short order."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.errors import InputError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.studies.calibration.poses import (
    _candidates,
    _greedy,
    _presses,
    _short_way,
    _table,
)

calibrate = a5.calibrate
ARM = a5.parameters()
LOWER = np.array([joint.lower for joint in ARM.joints[:4]])
UPPER = np.array([joint.upper for joint in ARM.joints[:4]])
MARGIN = np.radians(3.0)
STILL = np.zeros(4)


def start(sensor: calibrate.Sensor, **options: Any) -> calibrate.Session:
    return calibrate.session(sensor, np.zeros((1, 4)), **options)


def test_each_pose_adds_the_most_to_the_determinant() -> None:
    rng = np.random.default_rng(1)
    slopes = rng.normal(size=(12, 2, 5)) * rng.uniform(0.1, 3.0, (12, 1, 1))
    taken: list[int] = []
    inner = np.eye(5)
    for _ in range(6):
        volumes = [
            -np.inf if k in taken else np.linalg.slogdet(inner + one.T @ one)[1]
            for k, one in enumerate(slopes)
        ]
        taken.append(int(np.argmax(volumes)))
        inner += slopes[taken[-1]].T @ slopes[taken[-1]]
    assert _greedy(slopes, 6) == taken
    assert _greedy(slopes, 1) == taken[:1]


def test_the_nearest_pose_comes_next() -> None:
    """From the one nearest to zero on; the joint that turns most decides."""
    q = np.array([[0.5, -0.5], [0.2, 0.1], [0.3, 0.6], [-0.4, 0.3], [2.0, 2.0]])
    rows = [7, 3, 9, 4, 1]
    order = [1, 2, 0, 3, 4]
    turns = [np.abs(q[k] - q[order[0]]).max() for k in (2, 0, 3)]
    assert turns == pytest.approx([0.5, 0.6, 0.6])
    assert _short_way(q, rows)[:2] == [3, 9]
    found = [rows.index(row) for row in _short_way(q, rows)]
    for k in range(len(q) - 1):
        left = found[k + 1 :]
        away = np.abs(q[left] - q[found[k]]).max(axis=1)
        assert away[0] == away.min()
    assert sorted(found) == [0, 1, 2, 3, 4]


def test_the_table_ends_at_the_scales_and_reaches_beyond_the_arm() -> None:
    turn = rotation_from_rpy([0.4, -0.3, 0.2])
    level = calibrate.scales().positions
    assert level is not None
    for corners in (level, level @ turn.T):
        (table,) = _table(calibrate.scales(corners))
        box = table.shape
        assert isinstance(box, Primitive)
        rotation = rotation_from_rpy(np.array(box.rpy))
        inside = (corners - box.xyz) @ rotation
        assert inside[:, 2] == pytest.approx([box.size[2] / 2] * 3)
        assert inside[:, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)
        # The origin is above it, and the arm's longest reach within it.
        assert (-np.array(box.xyz) @ rotation)[2] > box.size[2] / 2
        assert min(box.size[:2]) / 2 > 0.1 + sum(
            abs(row.a) + abs(row.d) for row in ARM.dh
        )
    assert _table(calibrate.weight()) == ()


def test_candidates_keep_3_degrees_and_10_mm() -> None:
    sensor = calibrate.scales()
    rng = np.random.default_rng(2)
    q = _candidates(ARM, start(sensor), 600, 3.0, rng)
    assert q.shape == (600, 4)
    ends = np.array([q.min(axis=0) - LOWER, UPPER - q.max(axis=0)])
    assert (ends >= MARGIN).all()
    free = _candidates(ARM, start(calibrate.efforts()), 600, 0.0, rng)
    ends = np.array([free.min(axis=0) - LOWER, UPPER - free.max(axis=0)])
    assert (ends >= MARGIN).all()
    assert (ends < MARGIN + 0.1).all()
    assert not Surroundings(ARM, _table(sensor), 0.00999).touches(q).any()
    assert Surroundings(ARM, _table(sensor), 0.025).touches(q).any()


def narrow(width: float) -> Alpha5Parameters:
    """An arm whose axis_e has a range of some width about 3 rad."""
    joints = list(ARM.joints)
    joints[0] = replace(joints[0], lower=3.0 - width / 2, upper=3.0 + width / 2)
    return replace(ARM, joints=tuple(joints))


def test_a_narrow_range_leaves_its_middle() -> None:
    rng = np.random.default_rng(3)
    session = start(calibrate.efforts())
    q = _candidates(narrow(np.radians(5.0)), session, 50, 0.0, rng)
    assert q[:, 0] == pytest.approx(np.full(50, 3.0))
    q = _candidates(narrow(np.radians(8.0)), session, 50, 0.0, rng)
    assert np.abs(q[:, 0] - 3.0).max() == pytest.approx(np.radians(1.0), rel=0.2)


def test_an_arm_that_always_touches_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    everywhere = lambda self, q: np.ones(len(q), bool)  # noqa: E731
    monkeypatch.setattr(Surroundings, "touches", everywhere)
    with pytest.raises(InputError, match="poses free of collision within its limits"):
        calibrate.plan_poses(calibrate.weight())
    with pytest.raises(InputError, match="scales further apart, or more ballast"):
        calibrate.plan_poses(calibrate.scales())


def test_each_scale_carries_20_grams() -> None:
    sensor = calibrate.scales()
    session = start(sensor)
    q = np.random.default_rng(4).uniform(LOWER, UPPER, (40, 4))
    arm = a5.load(a5.AIR)
    wrenches = [arm.base_wrench(one, STILL, STILL).vector for one in q]
    least = (np.array(wrenches) @ sensor.matrix[:, 4:].T).min(axis=1)
    for ballast in (0.0, 0.6, 3.0):
        found = _presses(ARM, session, q, ballast)
        assert np.array_equal(found, least + ballast / 3 > 0.02)
    edge = 3 * (0.02 - least[0])
    assert not _presses(ARM, session, q[:1], edge - 1e-6)[0]
    assert _presses(ARM, session, q[:1], edge + 1e-6)[0]
    assert _presses(ARM, start(calibrate.efforts()), q, 0.0).all()
    assert _presses(ARM, session, q[:0], 0.0).shape == (0,)


def test_many_poses_are_chosen_among_more() -> None:
    planned = calibrate.plan_poses(calibrate.weight(), 210)
    assert len(np.unique(planned.motion.q, axis=0)) == 210


def test_what_plans_take_if_it_is_not_told() -> None:
    planned = calibrate.plan_poses(calibrate.weight())
    again = calibrate.plan_poses(
        calibrate.weight(),
        12,
        arm=ARM,
        fluid_density=a5.AIR,
        gravity=(0.0, 0.0, -9.81),
        prior="digits",
        ballast=0.0,
        seed=0,
    )
    assert np.array_equal(planned.motion.q, again.motion.q)
    with pytest.raises(InputError, match="ballast"):
        calibrate.plan_poses(calibrate.weight(), ballast=-0.5)
