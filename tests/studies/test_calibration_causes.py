"""What is wrong with readings is named, and what cannot be is not.

The readings are Pinocchio's, with one known fault.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.shared_recordings import RECORDINGS
from support.weighing import other_arm, random_q, weighed

import alpha5_model as a5

calibrate = a5.calibrate


@cache
def twelve_poses() -> calibrate.Session:
    return calibrate.plan_poses(calibrate.scales())


def on_scales(seed: int, arm: Any = None, poses: Any = None) -> Any:
    """Readings to whole grams, (12, 3) [kg]."""
    planned = twelve_poses()
    true = planned if poses is None else replace(planned, q=poses)
    record = other_arm(seed) if arm is None else arm
    return np.round(weighed(true, record, seed, noise=0.0).readings, 3)


def first(readings: Any, planned: Any = None, **options: Any) -> Any:
    """The problems of readings."""
    poses = twelve_poses() if planned is None else planned
    return calibrate.fit(calibrate.with_readings(poses, readings), **options).problems


def changed(y: Any, pose: int, channel: int, by: float) -> Any:
    found = y.copy()
    found[pose, channel] += by
    return found


def tared(y: Any, pose: int, channel: int) -> Any:
    """A scale that was zeroed just before a pose, as in the pose before that."""
    found = y.copy()
    found[pose:, channel] -= y[pose - 1, channel]
    return found


#: Fault -> its name, words of its message, and what it makes of the readings.
FAULTS: dict[str, tuple[str, str, Callable[[Any], Any]]] = {
    "grams": ("unit", "1000 times too large", lambda y: 1000.0 * y),
    "ounces": ("unit", "ounces", lambda y: 1e-3 * np.round(1e3 * y / 28.3495, 1)),
    "pounds": ("unit", "pounds", lambda y: np.round(y / 0.45359, 2)),
    "sign": ("unit", "of the other sign", lambda y: -y),
    "newtons": ("unit", "newtons", lambda y: 9.80665 * y),
    "5 %": ("scale", "all readings are 1.0", lambda y: 1.05 * y),
    "one of three": ("scale", "scale_2", lambda y: y * [1.0, 1.04, 1.0]),
    "one in ounces": ("unit", "scale_3", lambda y: y * [1, 1, 0.0352740]),
    "reading": ("reading", "scale_2 in pose 4", lambda y: changed(y, 3, 1, 0.02)),
    "tare": ("tare", "scale_3 was zeroed again from pose 7", lambda y: tared(y, 6, 2)),
    "early tare": (
        "tare",
        "scale_1 was zeroed again from pose 3",
        lambda y: tared(y, 2, 0),
    ),
    "swapped": ("channels", "scale_2, scale_1, scale_3", lambda y: y[:, [1, 0, 2]]),
}


@pytest.mark.slow
def test_faults_are_named_first() -> None:
    failures = []
    for seed, (fault, (name, words, change)) in enumerate(FAULTS.items()):
        readings = on_scales(seed)
        problems = first(change(readings))
        if not problems or problems[0].name != name or words not in str(problems[0]):
            failures.append((fault, [str(one) for one in problems]))
        if first(readings):
            failures.append((fault, "a false alarm"))
    assert failures == []


def test_a_scale_that_was_zeroed_again_is_named() -> None:
    """In a file of a lab: from pose 7 on."""
    folder = RECORDINGS / "field" / "25_scales_session"
    if not folder.exists():
        pytest.skip(
            "no recordings: the folder shared/data beside the checkout is absent"
        )
    session = calibrate.read_session(folder / "autozero_from_7.toml")
    problem = calibrate.fit(session).problems[0]
    assert problem.name == "tare"
    assert "scale_3" in problem.message
    assert "from pose 7 on" in problem.message


@pytest.mark.slow
def test_poses_masses_and_zeros_are_named() -> None:
    arm = other_arm(3)
    links = list(arm.links)
    links[2] = replace(links[2], mass=1.2 * links[2].mass)
    (problem, *_) = first(on_scales(3, replace(arm, links=tuple(links))))
    assert problem.name == "mass of link_2"
    assert problem.message.startswith(("0.45", "0.46"))

    rows = list(arm.dh)
    offset = rows[1].theta_offset + np.radians(-9.0)
    rows[1] = replace(rows[1], theta_offset=offset)
    (problem, *_) = first(on_scales(3, replace(arm, dh=tuple(rows))))
    assert problem.name == "zero"
    assert "axis_d reports +" in problem.message

    poses = twelve_poses().q.copy()
    poses[4, 1:3] += np.radians([10.0, -7.0])
    (problem, *_) = first(on_scales(3, poses=poses))
    assert problem.name == "pose"
    assert "pose 5" in problem.message


@pytest.mark.slow
def test_another_fluid_is_named_as_far_as_it_can_be_told() -> None:
    planned = calibrate.plan_poses(
        calibrate.force_torque(), 8, fluid_density=a5.FRESH_WATER
    )
    read = weighed(planned, other_arm(8), 8)
    said = calibrate.session(
        planned.sensor, planned.q, read.readings, fluid_density=a5.AIR
    )
    problem = calibrate.fit(said).problems[0]
    assert problem.name == "fluid"
    assert "fresh water" in problem.message
    # Sea for fresh water is less than the sensor's gain: it is not told.
    said = replace(said, density=a5.SEA_WATER)
    assert calibrate.fit(said).problems == ()


@pytest.mark.slow
def test_late_readings_of_a_moving_arm_are_named() -> None:
    time = np.arange(0.0, 12.0, 0.1)
    rate = np.array([0.5, 0.7, 0.9, 0.6])
    phase = time[:, None] * rate
    q = [3.0, 1.6, 1.7, 3.0] + 0.4 * np.sin(phase)
    late = phase - 0.08 * rate
    states = {"v": 0.4 * rate * np.cos(phase), "a": -0.4 * rate**2 * np.sin(phase)}
    cell = calibrate.force_torque()
    planned = calibrate.session(cell, q, fluid_density=1025.0, **states)
    true = replace(
        planned,
        q=[3.0, 1.6, 1.7, 3.0] + 0.4 * np.sin(late),
        v=0.4 * rate * np.cos(late),
        a=-0.4 * rate**2 * np.sin(late),
    )
    readings = weighed(true, other_arm(1), 1).readings
    for correlated in (False, True):
        problem = first(readings, planned, correlated=correlated)[0]
        assert problem.name == "delay"
        assert "0.08" in problem.message or "0.079" in problem.message


@pytest.mark.slow
def test_causes_that_cannot_be_are_not_listed() -> None:
    """Random readings: no negative mass or factor, no zero of more than half a turn."""
    rng = np.random.default_rng(5)
    for size in (0.01, 1.0, 100.0):
        readings = on_scales(1) + size * rng.normal(size=(12, 3))
        problems = first(readings)
        assert problems
        assert [one.rank for one in problems] == [*range(1, len(problems) + 1)]
        for one in problems:
            number = one.message.split()[0]
            if one.name.startswith("mass"):
                assert float(number) > 0.0
            if one.name == "scale":
                factor = one.message.split(" are ")[1].split()[0]
                assert float(factor) > 0.0
            if one.name == "zero":
                assert abs(float(one.message.split()[2])) <= 45.0


@pytest.mark.slow
def test_sessions_have_their_own_causes() -> None:
    """A wrong reading of one session is named with the session's name."""
    cell = calibrate.force_torque()
    sessions = []
    for k, density in enumerate((a5.AIR, a5.SEA_WATER)):
        planned = calibrate.session(
            cell, random_q(5, k), fluid_density=density, name=f"file {k}"
        )
        sessions.append(weighed(planned, other_arm(2), k))
    assert calibrate.fit(sessions).problems == ()
    wrong = sessions[1].readings.copy()
    wrong[2, 3] += 0.2
    sessions[1] = calibrate.with_readings(sessions[1], wrong)
    problem = calibrate.fit(sessions).problems[0]
    assert (problem.name, problem.session) == ("reading", "file 1")
    assert "Mx in pose 3 is off by +0.2" in problem.message
