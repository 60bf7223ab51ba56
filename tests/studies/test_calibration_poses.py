"""How poses are chosen: by determinants, within narrow ranges."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.calibration.poses import (
    _candidates,
    _greedy,
)

calibrate = a5.calibrate
ARM = a5.parameters()


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
