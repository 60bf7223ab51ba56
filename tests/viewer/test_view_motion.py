"""Motions to play: their tracks, tours, steady rates, and how the viewer plays them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import alpha5_model as a5
from alpha5_model.viewer import visualizer
from alpha5_model.viewer.tracks import motion_track, resampled, tour
from alpha5_model.viewer.video_file import film
from alpha5_model.viewer.visualizer import ArmVisualizer

HOME = a5.named_pose("home")


@pytest.fixture(scope="module")
def jaws() -> a5.Arm:
    return a5.load(gripper="jaws")


def moved(step: float, count: int = 9) -> a5.trajectory.Motion:
    time = 3.0 + step * np.arange(count)
    return a5.trajectory.motion(time, HOME + 0.2 * np.sin(time)[:, None])


# ---- tracks


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


# ---- tours


def test_a_tour_rests_and_goes_as_its_docstring_says() -> None:
    """0.6 s at each pose; legs ``s = (1 - cos(pi t / T)) / 2``; 25 samples a second."""
    arm = a5.parameters()
    turns = np.array(
        [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.2, -0.3], [0.5, 0.1, 0.2, 0.0]]
    )
    poses = HOME + turns
    found = tour(poses, arm)
    np.testing.assert_allclose(np.diff(found.time), 0.04, atol=1e-12)
    assert found.time[0] == 0.0
    speeds = np.array([joint.velocity for joint in arm.joints[:4]])
    pieces = [np.tile(poses[0], (15, 1))]
    for start, end in ((poses[0], poses[1]), (poses[1], poses[2])):
        duration = np.max(np.pi / 2 * np.abs(end - start) / speeds)
        steps = round(25 * duration) + 1
        share = (1 - np.cos(np.pi * np.arange(1, steps + 1) / steps)) / 2
        pieces.append(start + np.outer(share, end - start))
        pieces.append(np.tile(end, (15, 1)))
    np.testing.assert_allclose(found.position, np.concatenate(pieces), atol=1e-12)


@pytest.mark.parametrize(
    ("last", "ticks"),
    [(1.0, 11), (1.02, 12), (0.98, 11), (0.3, 4), (0.901, 11)],
)
def test_a_steady_rate_ends_at_the_last_sample_or_just_after(
    last: float, ticks: int
) -> None:
    """Between samples the arm moves evenly; the last picture shows the last sample."""
    time = np.array([5.0, 5.0 + 0.3 * last, 5.0 + last])
    q = np.outer([0.0, 1.0, 3.0], np.ones(4))
    found = np.array(list(resampled(a5.load(), time, q, 10.0)))
    at = 5.0 + 0.1 * np.arange(ticks)
    expected = np.interp(at, time, q[:, 0])
    np.testing.assert_allclose(found, np.outer(expected, np.ones(4)), atol=1e-9)


# ---- playing


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


# ---- video files


@pytest.mark.parametrize(
    ("fps", "rate"), [(1.0, 1.0), (30.0, 100 / 3), (45.0, 50.0), (500.0, 100.0)]
)
def test_a_gif_has_the_nearest_rate_in_hundredths_and_never_ends(
    fps: float, rate: float, tmp_path: Path
) -> None:
    with film(tmp_path / "a.gif", fps) as (found, add):
        assert found == rate
        for level in (0, 90, 250):
            add(np.full((16, 16, 3), level, np.uint8))
    with Image.open(tmp_path / "a.gif") as video:
        assert video.n_frames == 3
        assert video.info["duration"] == pytest.approx(1000 / rate)
        assert video.info["loop"] == 0


# ---- what a scene does with a motion
