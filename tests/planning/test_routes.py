"""The search of a way among lines of which a table says whether they are free."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from alpha5_model.planning.goals import Goal
from alpha5_model.planning.routes import MOST_PROOFS, Search
from alpha5_model.planning.s_curve import JointLimits, travel_time
from alpha5_model.planning.surroundings import Obstruction

LIMITS = JointLimits(speed=np.full(4, 0.5), acceleration=np.ones(4))
Q0 = np.array([1.0, 0.1, 0.2, 0.5])
GOAL = Goal(q=np.array([2.0, 0.9, 0.8, 1.5]), branch="underarm")
POSES = [(1.5, 2.5), (1.1, 2.2), (0.5, 2.0)]


class Lines:
    """Surroundings that know which lines are free."""

    def __init__(self, is_free: Callable[[Any, Any], bool]) -> None:
        self.is_free = is_free
        self.asked: list[tuple[bytes, bytes]] = []
        self.touching: Callable[[Any], bool] = lambda q: False

    def touches(self, q: Any) -> Any:
        return np.array([self.touching(row) for row in q])

    def obstruction(self, start: Any, end: Any) -> Obstruction | None:
        self.asked.append((start.tobytes(), end.tobytes()))
        if self.is_free(start, end):
            return None
        return Obstruction(share=0.5, q=start, names=("wall", "link_2"), distance=0.0)


def search(lines: Lines) -> Search:
    return Search(lines, Q0, LIMITS)  # type: ignore[arg-type]


def same(q: Any, other: Any) -> bool:
    return bool(np.allclose(q, other))


def at(q: Any, pose: tuple[float, float]) -> Any:
    """A retracted pose at the yaw and wrist of q."""
    return np.array([q[0], *pose, q[3]])


def test_the_quickest_goal_whose_line_is_free() -> None:
    near, middle, far = (
        Goal(q=Q0 + size, branch=f"branch {size}") for size in (0.3, -0.6, 1.0)
    )
    for blocked, kind, best in (
        ([], "straight", near),
        ([near], "another branch", middle),
        ([near, middle], "another branch", far),
    ):
        lines = Lines(lambda a, b, no=blocked: not any(same(b, g.q) for g in no))
        made = search(lines)
        route = made.straight([far, near, middle])
        assert route is not None
        assert (route.kind, route.branch) == (kind, best.branch)
        np.testing.assert_array_equal(route.way, [Q0, best.q])
        assert (made.obstruction is None) == (not blocked)
    made = search(Lines(lambda a, b: False))
    assert made.straight([far, near]) is None
    assert made.obstruction is not None
    assert same(made.obstruction.q, Q0)


def way_of(found: Any) -> list[list[float]]:
    assert found is not None
    assert found.kind == "by retracted poses"
    assert found.branch == "underarm"
    return [row.tolist() for row in found.way]


def test_the_quickest_retracted_pose_whose_lines_are_free() -> None:
    ways = [[Q0, at(Q0, pose), at(GOAL.q, pose), GOAL.q] for pose in POSES]
    times = [travel_time(np.array(way), LIMITS) for way in ways]
    for blocked in ([], [int(np.argmin(times))]):
        walls = [pose for k, pose in enumerate(POSES) if k in blocked]
        lines = Lines(lambda a, b, no=walls: not any(same(a[1:3], p) for p in no))
        left = [k for k in range(3) if k not in blocked]
        best = min(left, key=lambda k: times[k])
        found = search(lines).by_retracted([GOAL], POSES)
        np.testing.assert_allclose(way_of(found), ways[best])


def test_another_pose_before_or_after_the_turn() -> None:
    """Only one pose leads to the turn that is free, and only another one to it."""
    turn, other = POSES[0], POSES[2]
    before = [Q0, at(Q0, other), at(Q0, turn)]
    after = [at(GOAL.q, turn), at(GOAL.q, other), GOAL.q]
    direct_start = [Q0, at(Q0, turn)]
    direct_end = [at(GOAL.q, turn), GOAL.q]
    for first in (before, direct_start):
        for last in (after, direct_end):
            allowed = [*pairwise(first), (first[-1], last[0]), *pairwise(last)]

            def is_free(a: Any, b: Any, allowed: Any = allowed) -> bool:
                return any(same(a, one) and same(b, two) for one, two in allowed)

            found = search(Lines(is_free)).by_retracted([GOAL], POSES)
            np.testing.assert_allclose(way_of(found), [*first, *last])


def test_no_way() -> None:
    """Without a free turn, or without a way to it, or from it."""
    turn = (at(Q0, POSES[0]), at(GOAL.q, POSES[0]))
    for allowed in (
        lambda a, b: False,
        lambda a, b: same(a, turn[0]) and same(b, turn[1]),
        lambda a, b: not same(b, GOAL.q),
        lambda a, b: not same(a, Q0),
    ):
        assert search(Lines(allowed)).by_retracted([GOAL], POSES) is None


def test_poses_that_touch_something_are_passed_over() -> None:
    ways = [[Q0, at(Q0, pose), at(GOAL.q, pose), GOAL.q] for pose in POSES]
    times = [travel_time(np.array(way), LIMITS) for way in ways]
    order = np.argsort(times)
    quick, next_one = POSES[order[0]], POSES[order[1]]
    for share in np.linspace(0.0, 1.0, 9):
        lines = Lines(lambda a, b: True)
        yaw = Q0[0] + share * (GOAL.q[0] - Q0[0])
        lines.touching = lambda q, yaw=yaw: (
            same(q[1:3], quick) and abs(q[0] - yaw) < 0.06
        )
        found = search(lines).by_retracted([GOAL], POSES)
        assert way_of(found)[1][1:3] == pytest.approx(next_one)


def test_each_line_is_proved_once_and_not_too_many() -> None:
    """Half of the poses reach the goal, and only the others can be turned in."""
    rng = np.random.default_rng(1)
    poses = [(one, other) for one, other in rng.uniform(0.2, 3.0, (60, 2)).tolist()]
    reaching = {one for one, _ in poses[:30]}

    def is_free(a: Any, b: Any) -> bool:
        if same(b, GOAL.q):
            return float(a[1]) in reaching
        turns = same(a[1:3], b[1:3]) and float(a[1]) not in reaching
        return same(a, Q0) or turns

    lines = Lines(is_free)
    assert search(lines).by_retracted([GOAL], poses) is None
    assert len(set(lines.asked)) == len(lines.asked) == MOST_PROOFS
