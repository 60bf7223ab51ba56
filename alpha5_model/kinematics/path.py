"""Joint positions along a path of points, without a jump and of least joint travel.

Each point has up to four solutions within the limits, and the path goes through one of
each. It is found by dynamic programming [Bellman1957], as for redundant arms
[Guigue2007]: only the way of least travel to each solution of a point is kept. The
ranges of all joints are shorter than a turn, so each solution has one place in its
range. A step across the closed wedge of theta_0, or onto another branch away from where
the branches meet, is a jump and is not taken.

On the yaw axis theta_0 is free. The search holds it there at its value before the axis,
and counts its turn to the value after the axis by Minkowski's inequality: with joints 1
to 3 moving by s_k in the steps between, the travel ``sum_k sqrt(s_k^2 + d_k^2)`` of any
d_k that add up to the turn is at least ``sqrt((sum_k s_k)^2 + turn^2)``, which is
attained in proportion to the s_k. In the end the turn is spread like that.

References:
    [Bellman1957] Dynamic Programming, Princeton University Press.
    [Guigue2007] Guigue, Ahmadi, Hayes, Langlois, Tang: A dynamic programming approach
        to redundancy resolution with multiple criteria, ICRA 2007.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    flag,
    float_array,
    instance,
    real,
    shaped,
)
from alpha5_model.collision.self_collision import SelfCollision, self_collision
from alpha5_model.errors import (
    DiscontinuousPathError,
    InputError,
    SelfCollisionError,
    ShapeError,
)
from alpha5_model.kinematics.choosing import (
    collides,
    collision_error,
    require_solution,
)
from alpha5_model.kinematics.geometry import Geometry, on_axis
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.kinematics.solver import Branches
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

#: Largest step of a joint from one point to the next that counts as continuous [rad].
MAX_STEP = 0.5


def inverse_kinematics_path(
    positions: ArrayLike,
    q_start: ArrayLike | None = None,
    wrist: ArrayLike | None = None,
    max_step: float = MAX_STEP,
    *,
    allow_collision: bool = False,
    arm: Alpha5Parameters | None = None,
) -> FloatArray:
    """Joint positions along a path of points: continuous, within the limits, free.

    All positions and the straight lines between them are proved free of self-collision
    (`alpha5_model.collision.self_collision`), with the jaws closed.

    The sum of the Euclidean joint steps is the least possible. On the yaw axis theta_0
    turns from its value before the axis to its value after it, in proportion to the
    steps of the other joints. If the whole path lies on the axis, theta_0 is the middle
    of its range. There are two exceptions to the least sum. If ``max_step`` limits the
    turn of theta_0, the elbow is chosen as if it did not. And if the way along the axis
    collides only while theta_0 turns, no other way is tried.

    Args:
        positions: tcp in ``base_link``, (N, 3) [m].
        q_start: Where the arm is before the first point, (4,) [rad]; None lets the path
            start on any branch.
        wrist: theta_3, () or (N,) [rad]; None keeps the one of ``q_start``, or 0.
        max_step: No joint moves farther than this between two points (and from
            ``q_start`` to the first one) [rad]. A path that needs more is sampled too
            coarsely, or jumps.
        allow_collision: Let the arm touch itself.
        arm: Record of the arm; None is the catalogue's.

    Returns:
        (N, 4) [rad].

    Raises:
        DiscontinuousPathError: Names the first point that no continuous motion reaches.
        SelfCollisionError: Names the first point that is reached only by a collision,
            at it or on the line to it, and the links.
        UnreachableError: A point out of reach, if it comes before any such point.
        JointLimitError: A wrist angle beyond its limits.
        InputError: Bad input.
    """
    record = chosen_arm(arm)
    target = float_array("positions", positions, (3,))
    if target.ndim != 2:
        raise ShapeError("positions", target.shape, "shape (N, 3)")
    start = np.full(4, np.nan) if q_start is None else shaped("q_start", q_start, (4,))
    max_step = real("max_step", max_step, minimum=0.0, strict=True)
    theta_3 = np.nan_to_num(start[3]) if wrist is None else wrist
    angle = float_array("wrist", theta_3, ())
    if angle.shape not in ((), (len(target),)):
        raise InputError("wrist", angle.shape, f"shape () or ({len(target)},)")
    allow_collision = flag("allow_collision", allow_collision)

    solutions = inverse_kinematics(target, angle, arm=record)
    scene = None
    hits = np.zeros(solutions.exists.shape, np.bool_)
    if not allow_collision:
        scene = self_collision(record)
        hits = collides(solutions, record)
    path = _Path(record, solutions, hits, on_axis(target), max_step, scene)

    if not len(target):
        return np.empty((0, 4))
    fronts = [_Front.at(start)]
    for k in range(len(target)):
        fronts.append(path.step(k, fronts[-1]))

    # Back from the end of least travel.
    way = np.empty((len(fronts), 4))
    chosen = int(fronts[-1].travel.argmin())
    for k in reversed(range(len(fronts))):
        way[k] = fronts[k].q[chosen]
        chosen = int(fronts[k].origin[chosen])
    return path.turned_on_axis(way)[1:]


class _Front(NamedTuple):
    """The M joint positions that the arm may have at a point.

    Attributes:
        q: (M, 4) [rad]. At the start NaN if the arm may be anywhere; on the yaw axis,
            theta_0 as it was before, NaN if there was nothing before.
        origin: Index of the joint position at the point before, (M,).
        travel: Least joint travel to each, (M,) [rad], without turns on the axis.
        entry: On the axis: index of the last joint position off it, (M,). The ways from
            different ones are kept apart, since their theta_0 differ.
        entry_travel: Least joint travel to that one, (M,) [rad].
        steps: How many steps the arm has made on the axis.
    """

    q: FloatArray
    origin: NDArray[np.intp]
    travel: FloatArray
    entry: NDArray[np.intp]
    entry_travel: FloatArray
    steps: int

    @classmethod
    def at(cls, start: FloatArray) -> _Front:
        """Before the first point."""
        nothing = np.zeros(1)
        first = np.zeros(1, np.intp)
        return cls(start[None], first, nothing, first, nothing, steps=0)


class _Ways(NamedTuple):
    """K ways from a front to solutions of the next point.

    Attributes:
        option, origin: Index of the solution, and of the joint position in the front,
            (K,) each.
        before, q: Joint positions before and at the point, (K, 4) [rad].
        travel: Joint travel since the start of the path, (K,) [rad].
        needed: The way is possible if a joint may step this far, (K,) [rad].
    """

    option: NDArray[np.intp]
    origin: NDArray[np.intp]
    before: FloatArray
    q: FloatArray
    travel: FloatArray
    needed: FloatArray

    def rows(self, index: Any) -> _Ways:
        """Some of them."""
        return _Ways(*(array[index] for array in self))


class _Path(NamedTuple):
    """The points of a path.

    Attributes:
        arm: Record of the arm.
        solutions: All solutions of all N points.
        hits: Which of them touch the arm itself, (N, 4).
        on_axis: Which points lie on the yaw axis, (N,).
        max_step: No joint moves farther than this from one point to the next [rad].
        scene: Where the arm touches itself; None if it may.
    """

    arm: Alpha5Parameters
    solutions: Branches
    hits: BoolArray
    on_axis: BoolArray
    max_step: float
    scene: SelfCollision | None

    def step(self, k: int, front: _Front) -> _Front:
        """The ways of least travel from a front to each solution of point k.

        Raises:
            UnreachableError, JointLimitError: It has no solution within the limits.
            DiscontinuousPathError: No continuous motion leads to it.
            SelfCollisionError: All that do collide.
        """
        ways = self._ways(k, front)
        small = ways.rows(ways.needed <= self.max_step)
        if not len(small.q):
            needed = float(ways.needed.min())
            position = self.solutions.position[k]
            raise DiscontinuousPathError(k, position, needed, self.max_step)
        are_free = self._are_free(small.before, small.q)
        if not are_free.any():
            raise self._collision(k, small.before[0], small.q[0])

        # Of the ways to one option, the one of least travel; on the axis, of those from
        # one entry.
        free = small.rows(are_free)
        free = free.rows(np.argsort(free.travel, kind="stable"))
        kinds = np.column_stack([free.option, np.zeros_like(free.option)])
        if self.on_axis[k]:
            kinds[:, 1] = front.entry[free.origin]
        _, first = np.unique(kinds, axis=0, return_index=True)
        best = free.rows(first)

        is_on_axis = self.on_axis[k]
        return _Front(
            q=best.q,
            origin=best.origin,
            travel=best.travel,
            entry=front.entry[best.origin] if is_on_axis else np.arange(len(best.q)),
            entry_travel=(
                front.entry_travel[best.origin] if is_on_axis else best.travel
            ),
            steps=front.steps + 1 if is_on_axis else 0,
        )

    def _ways(self, k: int, front: _Front) -> _Ways:
        """All ways from a front to solutions of point k."""
        options = self._options(k)
        option, origin = np.indices((len(options), len(front.q))).reshape(2, -1)
        before = front.q[origin]
        q = options[option]
        if self.on_axis[k]:
            q[:, 0] = self._within_limits(before[:, 0])

        # What is not known yet (NaN) does not move.
        moved = np.nan_to_num(np.abs(q - before))
        turn = moved[:, 0]
        with np.errstate(over="ignore"):
            along = np.linalg.norm(moved[:, 1:], axis=1)
        needed = moved[:, 1:].max(axis=1)
        if self.on_axis[k]:
            needed = np.maximum(needed, turn)  # back into the limits
            travel = front.travel[origin] + along
        else:
            # Each step on the axis can take its part of the turn.
            needed = np.maximum(needed, turn - front.steps * self.max_step)
            entry_travel = front.entry_travel[origin]
            on_the_way = front.travel[origin] - entry_travel + along
            travel = entry_travel + np.hypot(on_the_way, turn)
        if front.steps:
            before[:, 0] = q[:, 0]  # theta_0 has turned on the axis
        return _Ways(option, origin, before, q, travel, needed)

    def turned_on_axis(self, way: FloatArray) -> FloatArray:
        """A way whose theta_0 turns on the yaw axis.

        Args:
            way: Joint positions at the start, NaN if there is none, and at the points,
                (N + 1, 4) [rad].

        Raises:
            SelfCollisionError: The arm touches itself while theta_0 turns.
        """
        if not self.on_axis.any():
            return way
        turned = way.copy()
        yaw = turned[:, 0]
        free = np.append(np.isnan(way[0, 0]), self.on_axis)
        known = np.flatnonzero(~free)
        if not len(known):
            yaw[1:] = Geometry.of(self.arm).middle[0]
        else:
            yaw[: known[0]] = yaw[known[0]]
            yaw[known[-1] :] = yaw[known[-1]]
        for first, last in pairwise(known.tolist()):
            turn = yaw[last] - yaw[first]
            sizes = np.linalg.norm(np.diff(way[first : last + 1, 1:], axis=0), axis=1)
            steps = shared_turn(sizes, abs(turn), self.max_step)
            turns = np.copysign(np.cumsum(steps[:-1]), turn)
            yaw[first + 1 : last] = yaw[first] + turns
        yaw[1:] = np.where(self.on_axis, self._within_limits(yaw[1:]), yaw[1:])

        # The search has looked at other theta_0.
        turned[0] = way[0] if not np.isnan(way[0]).any() else turned[1]
        free = self._are_free(turned[:-1], turned[1:])
        if not free.all():
            k = int(free.argmin())
            raise self._collision(k, turned[k], turned[k + 1])
        return turned

    def _options(self, k: int) -> FloatArray:
        """Solutions of point k within the limits, (M, 4).

        They are free of self-collision, but on the yaw axis, where they may collide at
        the theta_0 that they have and not at another.

        Raises:
            UnreachableError, JointLimitError: There is none.
            SelfCollisionError: All of them touch the arm itself.
        """
        within_limits = self.solutions.within_limits[k]
        if not within_limits.any():
            so_far: Any = (array[: k + 1] for array in self.solutions)
            require_solution(Branches(*so_far), self.arm)
        valid = within_limits
        if not self.on_axis[k]:
            valid = valid & ~self.hits[k]
        if not valid.any():
            raise collision_error(
                self.solutions.position[k],
                self.solutions.q[k][within_limits][0],
                self.arm,
                f" (row {k})",
            )
        options: FloatArray = self.solutions.q[k][valid]
        return options

    def _are_free(self, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether straight lines of joint positions (M, 4) are proved free, (M,).

        A line from or to nowhere, NaN, is.
        """
        free = np.ones(len(start), np.bool_)
        if self.scene is not None:
            known = ~np.isnan(start + end).any(axis=1)
            free[known] = self.scene.free_shares(start[known], end[known]) == 1.0
        return free

    def _collision(
        self, k: int, start: FloatArray, end: FloatArray
    ) -> SelfCollisionError:
        """The error to raise if the step from start to end (4,), at point k, collides.

        Raises:
            InputError: The scene is None, so that nothing collides.
        """
        scene = instance("scene", self.scene, SelfCollision)
        share = scene.free_shares(start[None], end[None])[0]
        links, depth = scene.overlap(start + share * (end - start))
        return SelfCollisionError(
            self.solutions.position[k],
            links=links,
            depth=depth,
            place=f" from the position before (row {k})",
        )

    def _within_limits(self, yaw: FloatArray) -> FloatArray:
        """theta_0 within its limits."""
        geometry = Geometry.of(self.arm)
        return np.clip(yaw, geometry.lower[0], geometry.upper[0])


def shared_turn(sizes: FloatArray, turn: float, most: float) -> FloatArray:
    """Steps of theta_0 that add up to a turn, for the least joint travel.

    They are in proportion to the steps of the other joints, and equal if these are 0.
    Where a step would exceed the most, the others share the rest.

    Args:
        sizes: Of the steps of the other joints, (N,) [rad].
        turn: At most N times ``most`` [rad].
        most: No step is larger [rad].

    Returns:
        (N,) [rad].
    """
    steps = np.zeros(len(sizes))
    left = turn
    largest_first = np.argsort(-sizes, kind="stable")
    for done, k in enumerate(largest_first):
        total = sizes[largest_first[done:]].sum()
        share = sizes[k] / total if total > 0.0 else 1 / (len(sizes) - done)
        steps[k] = min(left * share, most)
        left -= steps[k]
    return steps
