"""Ways of straight joint lines to one of several goals, each line proved free.

The straight line is tried first, to the goals from the quickest to the slowest. axis_e
cannot cross its gap: a goal on the other side of it may be far for one branch and near
for another. Then come ways by retracted poses: retract, turn, extend.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.planning.goals import Goal
from alpha5_model.planning.s_curve import JointLimits, travel_time
from alpha5_model.planning.surroundings import Obstruction, Surroundings

#: Kinds of ways.
STRAIGHT = "straight"
OTHER_BRANCH = "another branch"
RETRACTED = "by retracted poses"
TCP_LINE = "tcp line"
#: Lines that are tried for one motion at most; each takes up to a millisecond.
MOST_PROOFS = 600
#: Places of a turn that are looked at before it is proved.
_LOOKS = 12


@dataclass(frozen=True, eq=False)
class Route:
    """A way that is proved free.

    Attributes:
        way: Ends of its straight joint lines, (K, 4) [rad].
        kind: `STRAIGHT`, `OTHER_BRANCH`, `RETRACTED` or `TCP_LINE`; of a way through
            several targets, those of its parts.
        branch: Of the inverse kinematics; None if joint positions were asked for.
        ends: Rows of the way that reach a target, in their order.
    """

    way: FloatArray
    kind: str
    branch: str | None
    ends: tuple[int, ...]


class Search:
    """Looks for a way from one joint position. Each line is proved once.

    Attributes:
        obstruction: What is in the quickest straight way; None before one was found
            blocked.
    """

    def __init__(
        self, surroundings: Surroundings, q0: FloatArray, limits: JointLimits
    ) -> None:
        self._surroundings = surroundings
        self._q0 = q0
        self._limits = limits
        self._known: dict[bytes, bool] = {}
        self.obstruction: Obstruction | None = None

    def straight(self, goals: Sequence[Goal]) -> Route | None:
        """The quickest straight line that is free."""
        order = sorted(goals, key=lambda goal: self._time([self._q0, goal.q]))
        for number, goal in enumerate(order):
            if self._free(self._q0, goal.q):
                kind = STRAIGHT if number == 0 else OTHER_BRANCH
                return _route([self._q0, goal.q], kind, goal)
        return None

    def by_retracted(
        self, goals: Sequence[Goal], poses: Sequence[tuple[float, float]]
    ) -> Route | None:
        """A way that retracts, turns about the yaw axis and extends.

        Of those with one retracted pose it is the quickest. If there is none, the arm
        may pass another pose before and after.

        Args:
            goals: Where it may end.
            poses: theta_1 and theta_2 of retracted poses.
        """
        turns = [
            (goal, start, end)
            for goal in goals
            for start, end in self._turns(goal, poses)
        ]
        turns.sort(key=self._time_by_turn)
        for goal, start, end in turns:
            way = [self._q0, start, end, goal.q]
            if self._all_free(way):
                return _route(way, RETRACTED, goal)

        for goal, start, end in turns:
            if not self._free(start, end):
                continue
            before = self._by_another(self._q0, start, poses)
            after = before and self._by_another(end, goal.q, poses)
            if before and after:
                way = [*before, *after]
                return _route(way, RETRACTED, goal)
        return None

    def _turns(
        self, goal: Goal, poses: Sequence[tuple[float, float]]
    ) -> list[tuple[FloatArray, FloatArray]]:
        """Turns in retracted poses from the yaw of q0 to a goal's.

        Those that touch something on the way are left out, if that is seen at a few
        places; the others are not proved yet.
        """
        turns = [
            (_retracted(self._q0, pose), _retracted(goal.q, pose)) for pose in poses
        ]
        shares = np.linspace(0.0, 1.0, _LOOKS)[:, None]
        places = [start + shares * (end - start) for start, end in turns]
        hits = self._surroundings.touches(np.concatenate(places))
        free = ~hits.reshape(len(turns), _LOOKS).any(axis=1)
        return [turns[number] for number in np.flatnonzero(free)]

    def _by_another(
        self,
        start: FloatArray,
        end: FloatArray,
        poses: Sequence[tuple[float, float]],
    ) -> list[FloatArray] | None:
        """A way from start to end, directly or by a third pose at the yaw of start."""
        if self._free(start, end):
            return [start, end]
        others = [_retracted(start, pose) for pose in poses]
        hits = self._surroundings.touches(np.array(others))
        ways = [
            [start, other, end]
            for other, hit in zip(others, hits, strict=True)
            if not hit
        ]
        for way in sorted(ways, key=self._time):
            if self._all_free(way):
                return way
        return None

    def _time_by_turn(self, turn: tuple[Goal, FloatArray, FloatArray]) -> float:
        goal, start, end = turn
        return self._time([self._q0, start, end, goal.q])

    def _all_free(self, way: Sequence[FloatArray]) -> bool:
        # Lines that are known to be blocked need no further proof.
        lines = sorted(pairwise(way), key=self._is_unknown)
        return all(self._free(start, end) for start, end in lines)

    def _time(self, way: Sequence[FloatArray]) -> float:
        return travel_time(np.array(way), self._limits)

    def _is_unknown(self, line: tuple[FloatArray, FloatArray]) -> bool:
        return _key(*line) not in self._known

    def _free(self, start: FloatArray, end: FloatArray) -> bool:
        key = _key(start, end)
        if key not in self._known:
            if len(self._known) >= MOST_PROOFS:
                return False
            found = self._surroundings.obstruction(start, end)
            self._known[key] = found is None
            if self.obstruction is None:
                self.obstruction = found
        return self._known[key]


def _route(way: Sequence[FloatArray], kind: str, goal: Goal) -> Route:
    end = len(way) - 1
    return Route(way=np.array(way), kind=kind, branch=goal.branch, ends=(end,))


def _retracted(q: FloatArray, pose: tuple[float, float]) -> FloatArray:
    """A retracted pose at the yaw and the wrist angle of another position, (4,)."""
    return np.array([q[0], *pose, q[3]])


def _key(start: FloatArray, end: FloatArray) -> bytes:
    return start.tobytes() + end.tobytes()
