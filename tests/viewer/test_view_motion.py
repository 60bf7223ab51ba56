"""A motion without the jaws, and how the viewer plays when it is late."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.viewer import visualizer
from alpha5_model.viewer.tracks import motion_track
from alpha5_model.viewer.visualizer import ArmVisualizer

HOME = a5.named_pose("home")


@pytest.fixture(scope="module")
def jaws() -> a5.Arm:
    return a5.load(gripper="jaws")


def moved(step: float, count: int = 9) -> a5.trajectory.Motion:
    time = 3.0 + step * np.arange(count)
    return a5.trajectory.motion(time, HOME + 0.2 * np.sin(time)[:, None])


def test_a_motion_without_the_jaws_leaves_them_at_rest(jaws: a5.Arm) -> None:
    """Their velocity is zero, and what was recorded of them is not known."""
    four = moved(0.5)
    velocity = 0.2 * np.cos(four.time)[:, None] * np.ones(4)
    model = a5.trajectory.analyse(four, a5.load(), method="interpolate")
    effort = model.torque + 0.01
    played = replace(four, velocity=velocity, effort=effort, current=effort / 10)
    track = motion_track(played, jaws, np.array([*HOME, 0.004]))

    def beside(rows: np.ndarray, value: float) -> np.ndarray:
        return np.column_stack([rows, np.full(9, value)])

    whole = a5.trajectory.motion(
        four.time, beside(four.position, 0.004), beside(velocity, 0.0)
    )
    expected = a5.trajectory.analyse(whole, jaws, method="interpolate")
    np.testing.assert_allclose(track.loads["mount"], expected.base_wrench, atol=1e-9)
    for name, rows in (("effort", effort), ("current", effort / 10)):
        recorded = track.compared[name].recorded
        np.testing.assert_array_equal(recorded, beside(rows, np.nan))


class FakeClock:
    """A clock that only sleeps and pictures move on."""

    def __init__(self) -> None:
        self.now = 8.0

    def perf_counter(self) -> float:
        return self.now

    monotonic = perf_counter

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture(scope="module")
def viewer() -> Iterator[ArmVisualizer]:
    found = a5.view(a5.load(), HOME)
    yield found
    found.close()


@pytest.mark.parametrize(
    ("takes", "rows"),
    [(0.0, [0, 1, 2, 3]), (0.25, [0, 1, 2, 3]), (0.5, [0, 2, 3]), (2.0, [0, 3])],
)
def test_rows_are_shown_when_they_are_due_or_dropped(
    viewer: ArmVisualizer,
    monkeypatch: pytest.MonkeyPatch,
    takes: float,
    rows: list[int],
) -> None:
    clock = FakeClock()
    shown = []

    def display(self: ArmVisualizer, q: np.ndarray) -> None:
        shown.append((clock.now, q[0]))
        clock.now += takes

    monkeypatch.setattr(visualizer, "clock", clock)
    monkeypatch.setattr(ArmVisualizer, "display", display)
    took = viewer.play(np.outer(np.arange(4.0), np.ones(4)), 0.25)
    assert [row for _, row in shown] == rows
    assert all(at >= 8.0 + 0.25 * row for at, row in shown)
    assert took == shown[-1][0] + takes - 8.0
