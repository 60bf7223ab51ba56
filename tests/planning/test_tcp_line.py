"""Straight lines of the tcp: straight, within limits, fast, free, and refused."""

from __future__ import annotations

import builtins
from typing import Any

import numpy as np
import pytest
from coal_world import CoalWorld
from own_arm import tips, with_tool
from reference import dh_frames

import alpha5_model as a5
from alpha5_model.errors import (
    BlockedMotionError,
    DiscontinuousPathError,
    InputError,
    MissingDependencyError,
    UnreachableError,
)

HOME = a5.named_pose("home")
SPEED = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
#: Ends of lines on one branch [m].
LINES = [
    ([0.10, 0.25, 0.05], [0.30, -0.10, 0.15]),
    ([0.20, 0.10, 0.25], [0.20, 0.10, 0.00]),
    ([0.12, -0.15, 0.20], [0.30, -0.15, 0.05]),
]


def at(point: Any) -> np.ndarray:
    return a5.inverse_kinematics(point).best(HOME)


def off_line(points: np.ndarray, start: Any, end: Any) -> float:
    """Largest distance of points (N, 3) from a line [m]."""
    direction = np.subtract(end, start) / np.linalg.norm(np.subtract(end, start))
    away = points - start
    return float(np.linalg.norm(np.cross(away, direction), axis=1).max())


@pytest.mark.parametrize(("start", "end"), LINES)
def test_a_line_is_straight_and_within_limits(start: Any, end: Any) -> None:
    motion = a5.plan(at(start), end, line=True, acceleration=0.8)
    assert motion.kind == "tcp line"
    assert motion.branch == "underarm"
    tips_at = np.array([dh_frames(q)[-1][:3, 3] for q in motion.position])
    assert off_line(tips_at, np.array(start), np.array(end)) < 1e-5
    assert tips_at[[0, -1]] == pytest.approx(np.array([start, end]), abs=1e-9)
    assert (np.diff(tips_at @ np.subtract(end, start)) > -1e-12).all()

    # Speeds by finite differences of the positions, at rest at both ends.
    step = motion.time[1]
    speed = np.abs(np.diff(motion.position, axis=0)) / step
    assert (speed <= SPEED).all()
    assert not motion.velocity[[0, -1]].any()
    assert np.abs(motion.acceleration).max() <= 0.8
    middle = motion.velocity[1:-1]
    differences = (motion.position[2:] - motion.position[:-2]) / (2 * step)
    assert middle == pytest.approx(differences, abs=0.8 * step)


def test_a_line_is_fast() -> None:
    """At each moment a joint is near its speed or its acceleration."""
    motion = a5.plan(at(LINES[0][0]), LINES[0][1], line=True)
    of_speed = (np.abs(motion.velocity) / SPEED).max(axis=1)
    of_acceleration = np.abs(motion.acceleration).max(axis=1)
    assert motion.slowed == 1.0
    busy = np.maximum(of_speed, of_acceleration) > 0.98
    assert busy.mean() > 0.9


@pytest.mark.slow
def test_a_line_is_free_for_coal() -> None:
    post = a5.Obstacle.cylinder("post", 0.02, 1.0, (0.36, 0.05, 0.0))
    start, end = LINES[0]
    motion = a5.plan(at(start), end, line=True, obstacles=[post])
    world = CoalWorld(obstacles=[post])
    assert min(world.distances(q).min() for q in motion.position[::5]) > 0.004

    near = a5.Obstacle.cylinder("post", 0.02, 1.0, (0.22, 0.05, 0.0))
    with pytest.raises(BlockedMotionError, match="straight line of the tcp") as error:
        a5.plan(at(start), end, line=True, obstacles=[near])
    assert "post" in error.value.names


def test_the_wrist_turns_evenly() -> None:
    start, end = LINES[1]
    motion = a5.plan(at(start), end, line=True, wrist=1.0)
    assert motion.position[-1, 3] == pytest.approx(1.0, abs=1e-12)
    tips_at = np.array([dh_frames(q)[-1][:3, 3] for q in motion.position])
    share = (tips_at - start) @ np.subtract(end, start) / 0.0625
    turned = motion.position[:, 3] - motion.position[0, 3]
    assert turned == pytest.approx(share * turned[-1], abs=1e-5)


def test_a_line_to_where_the_tcp_is() -> None:
    q0 = at(LINES[0][0])
    motion = a5.plan(q0, LINES[0][0], line=True)
    assert motion.position == pytest.approx(np.tile(q0, (len(motion.time), 1)))


def test_lines_of_an_arm_of_ones_own() -> None:
    arm = with_tool(0.015, -0.01, -0.25)
    q0 = np.array([3.0, 1.0, 2.6, 1.0])
    start = tips(arm, q0[None])[0]
    end = start * [0.8, 0.8, 1.1]
    motion = a5.plan(q0, end, arm=arm, line=True)
    assert off_line(tips(arm, motion.position), start, end) < 1e-5


def test_a_line_that_leaves_the_workspace() -> None:
    start, end = np.array([0.15, 0.2, 0.1]), np.array([0.15, -0.2, 0.9])
    with pytest.raises(UnreachableError) as caught:
        a5.plan(at(start), end, line=True)
    assert off_line(caught.value.position[None], start, end) < 1e-9
    assert "row" not in str(caught.value)


def test_random_lines_are_straight_between_their_samples() -> None:
    """To 0.01 mm, as the guide promises; some pass close to the yaw axis."""
    rng = np.random.default_rng(3)
    arm = a5.load()
    found = 0
    for number in range(24):
        q = rng.uniform([0.5, 0.8, 0.4, 0.5], [5.5, 2.6, 2.6, 5.5])
        start = arm.forward_kinematics(q).translation
        end = start + rng.normal(0.0, 0.05, 3)
        if number % 3 == 0:
            end[:2] = -0.8 * start[:2] + rng.normal(0.0, 0.002, 2)
        try:
            motion = a5.plan(q, end, line=True)
        except (UnreachableError, DiscontinuousPathError, BlockedMotionError):
            continue
        found += 1
        # Between two samples: by position and velocity, as the docstring says.
        middle = cubic_middles(motion)
        tips_at = np.array([dh_frames(row)[-1][:3, 3] for row in middle])
        assert off_line(tips_at, start, end) < 1.05e-5, (q, end)
    assert found > 6


def cubic_middles(motion: Any) -> np.ndarray:
    """Positions in the middle between two samples, by Hermite's cubic, (N - 1, 4)."""
    step = motion.time[1]
    position, velocity = motion.position, motion.velocity
    chord = (position[:-1] + position[1:]) / 2
    return np.asarray(chord + step * (velocity[:-1] - velocity[1:]) / 8)


def test_a_line_on_which_the_arm_touches_itself_is_blocked() -> None:
    q = [0.366, 1.192, 2.744, 4.534]
    with pytest.raises(BlockedMotionError) as caught:
        a5.plan(q, [-0.3163, -0.0072, 0.0486], line=True)
    assert set(caught.value.names) == {"link_0", "link_2"}
    assert CoalWorld().distances(caught.value.q).min() < 0.002


def test_a_line_across_the_gap_of_axis_e() -> None:
    q0 = np.array([0.1, 1.5, 1.5, 1.0])
    beyond = np.array([-0.3, 1.5, 1.5, 1.0])
    start, end = (dh_frames(q)[-1][:3, 3] for q in (q0, beyond))
    assert np.linalg.norm(end - start) < 0.15
    with pytest.raises(DiscontinuousPathError, match="jump"):
        a5.plan(q0, end, line=True)


def test_only_a_point_is_reached_by_a_line() -> None:
    with pytest.raises(InputError, match="target: expected a point"):
        a5.plan(HOME, a5.named_pose("reach"), line=True)
    with pytest.raises(InputError, match="line"):
        a5.plan(HOME, LINES[0][1], line=1)  # type: ignore[arg-type]


def test_without_toppra(monkeypatch: pytest.MonkeyPatch) -> None:
    own = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.partition(".")[0] == "toppra":
            raise ImportError(name=name)
        return own(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingDependencyError, match=r"alpha5-model\[line\]"):
        a5.plan(at(LINES[0][0]), LINES[0][1], line=True)
