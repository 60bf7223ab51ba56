"""Numbers of recordings that are too large, or in another unit than is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from short_recording import (
    JOINTS,
    POSITION,
    STALLED,
    TIME,
    csv,
    kinds,
    motion,
    positions,
    refused,
)

import alpha5_model as a5

# --- numbers that are too large -------------------------------------------------------


@pytest.mark.parametrize(("late", "much"), [(0.5, True), (0.0, False), (-0.5, False)])
def test_times_go_up_to_1e12(late: float, much: bool) -> None:
    time = TIME.copy()
    time[-1] = 1e12 + late
    with refused(much, "a time of at most 1e"):
        a5.trajectory.motion(time, POSITION)


@pytest.mark.parametrize("quantity", ["position", "velocity", "effort"])
@pytest.mark.parametrize(("more", "much"), [(0.5, True), (0.0, False), (-0.5, False)])
def test_other_numbers_go_up_to_1e9(quantity: str, more: float, much: bool) -> None:
    arrays: dict[str, Any] = {"position": POSITION.copy(), quantity: POSITION.copy()}
    arrays[quantity][6, 2] = -1e9 - more
    if much:  # the first of several is told
        arrays[quantity][7:9, 0] = 3e9
    with refused(much, r"axis_c\[6\]: expected a .*of at most 1e\+09 in size"):
        a5.trajectory.motion(TIME, **arrays)


# --- angles in degrees ----------------------------------------------------------------


@pytest.mark.parametrize(("far", "degrees"), [(10, False), (11, True)])
def test_most_samples_decide(far: int, degrees: bool) -> None:
    angles = np.tile([1.5, 1.5, 1.5, 1.5], (20, 1))
    angles[:far, 1] = 90.0
    angles[:, [0, 2, 3]] = 10.0
    with refused(degrees, r"axis_d.*90 is an angle of axis_d in degrees"):
        a5.trajectory.motion(np.arange(20.0), angles)
    # As degrees, most must be within the range of every joint.
    angles[:, 1] = 90.0
    angles[: 20 - far, 2] = 1e4
    with refused(degrees, "is an angle of axis_d in degrees"):
        a5.trajectory.motion(np.arange(20.0), angles)


# --- efforts and currents -------------------------------------------------------------


@pytest.fixture(scope="module")
def possible() -> Any:
    """What each sample may take without a payload: torque and friction [N m]."""
    taken = a5.trajectory.analyse(motion())
    return np.abs(taken.torque) + [motor.joint_friction for motor in taken.actuators]


@pytest.mark.parametrize(("times", "unit"), [(1.99, "N m"), (2.01, "mA")])
@pytest.mark.parametrize("known", ["all", "few", "one"])
def test_efforts_are_milliamperes_above_twice_what_is_possible(
    times: float, unit: str, known: str, possible: Any
) -> None:
    effort = times * possible
    if known == "few":
        effort[::5] = np.nan
        effort[1::5] = np.nan
        effort[2::5, 1] = np.nan
    if known == "one":
        effort[:] = np.nan
        effort[7, 3] = times * possible[7, 3]
    # As of a file, where a number may be missing.
    recorded = replace(motion(), effort=effort)
    analysis = a5.trajectory.analyse(recorded)
    assert kinds(analysis) == ["effort_unit"] * (unit == "mA")
    assert (analysis.effort is None) == (unit == "mA")
    for warning in analysis.warnings:
        assert (warning.count, warning.first) == (1, "all samples")
        assert "2.01 times the torque with friction" in warning.text


def test_the_effort_of_the_jaw_rod_decides_nothing(possible: Any) -> None:
    """It is a force, and mostly unknown."""
    position = np.column_stack([POSITION, np.full(TIME.size, 0.005)])
    effort = np.column_stack([1.5 * possible, np.full(TIME.size, 500.0)])
    with_rod = a5.trajectory.motion(TIME, position, effort=effort)
    analysis = a5.trajectory.analyse(with_rod)
    assert kinds(analysis) == []
    np.testing.assert_array_equal(analysis.effort, effort)


@pytest.mark.parametrize(("share", "count"), [(0.999, 0), (1.001, 3)])
def test_currents_of_a_file_are_amperes_up_to_a_stalled_motor(
    share: float, count: int, tmp_path: Path
) -> None:
    current = np.ones_like(POSITION)
    current[4:7, 2] = -share * STALLED / 1e3
    if count:  # the first of several is told
        current[5:7, 2] *= 1.5
    columns = {f"{joint}_current": current[:, k] for k, joint in enumerate(JOINTS)}
    path = csv(tmp_path / "m.csv", {"time": TIME, **positions(), **columns})
    found = a5.trajectory.read_motion(path)
    assert [(w.kind, w.count, w.first) for w in found.warnings] == (
        [("current_unit", count, "line 1")] if count else []
    )
    assert found.current is not None
    np.testing.assert_allclose(found.current, current * (1e-3 if count else 1.0))
    with refused(count > 0, f"divide milliamperes by 1000, got {current[4, 2]}"):
        motion(current=current)


# --- velocities -----------------------------------------------------------------------


def with_velocities(step: float, count: int, slow: float, fast: float) -> Any:
    """A sway of 0.1 Hz with one of 1 Hz on it, whose velocities have these gains."""
    time = step * np.arange(count)
    angle = 1.5 + 0.4 * np.sin(0.2 * np.pi * time) + 0.1 * np.sin(2 * np.pi * time)
    rate = slow * 0.08 * np.pi * np.cos(0.2 * np.pi * time)
    rate += fast * 0.2 * np.pi * np.cos(2 * np.pi * time)
    ones = np.ones(4)
    return a5.trajectory.motion(time, np.outer(angle, ones), np.outer(rate, ones))


@pytest.mark.parametrize(
    ("slow", "fast", "found"), [(1.0, 3.0, 0), (1.5, 1.0, 4), (1.0, 1.0, 0)]
)
def test_only_slow_parts_of_velocities_are_judged(
    slow: float, fast: float, found: int
) -> None:
    analysis = a5.trajectory.analyse(with_velocities(0.02, 2000, slow, fast))
    assert kinds(analysis) == ["velocity"] * found
