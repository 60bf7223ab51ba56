"""Paths of least joint travel through points on the yaw axis, where theta_0 is free.

A stretch of points on the axis lies between a start and an end off the axis, where
theta_0 is known. The path has one step from the start to the first point, one between
points, and one to the end. In step k the joints 1 to 3 move by s_k (Euclidean norm) and
theta_0 turns by d_k, so the travel is

    sum_k sqrt(s_k^2 + d_k^2).

The d_k add up to the known turn of theta_0 from start to end. By Minkowski's inequality
the sum is least if the d_k are in proportion to the s_k. A d_k that would exceed the
largest allowed step is that step, and the others share the rest.

So the search has two parts: `_elbow_ways` finds the joints 1 to 3 of least travel, and
`shared_turn` then spreads the turn of theta_0 over the steps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import SelfCollisionError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.path_points import Front, PathPoints, Ways, step_sizes


class _ElbowWays(NamedTuple):
    """Ways of joints 1 to 3 from S starts through the points on the axis.

    Attributes:
        positions: Joints 1 to 3 at the starts, (S, 3), and their E options at each
            point, (E, 3) each [rad].
        parents: For each point, from each start: the option of the point before from
            which each option is reached with least travel, (S, E) each.
        travel: From each start to each option of the last point, (S, E) [rad];
            infinite if no continuous motion leads there.
    """

    positions: list[FloatArray]
    parents: list[NDArray[np.intp]]
    travel: FloatArray

    def ending_at(self, start: int, option: int) -> list[FloatArray]:
        """Joints 1 to 3 from a start to an option of the last point, (3,) each."""
        chosen = [option]
        for parent in reversed(self.parents):
            chosen.append(int(parent[start, chosen[-1]]))
        chosen.reverse()
        return [rows[i] for rows, i in zip(self.positions, chosen, strict=True)]


class _Motion(NamedTuple):
    """A way of joints 1 to 3, and from where to where theta_0 turns on it.

    Attributes:
        joints: Joints 1 to 3 at the start, at the points and at the end,
            (L + 1, 3) [rad].
        sizes: Euclidean norms of the L steps between them, (L,) [rad].
        start_yaw, end_yaw: theta_0 at the start and at the end [rad].
        needed_step: The motion is possible if a joint may step this far [rad].
    """

    joints: FloatArray
    sizes: FloatArray
    start_yaw: float
    end_yaw: float
    needed_step: float


class _Crossing(NamedTuple):
    """The best way found to an end.

    Attributes:
        travel: Since the start of the path [rad].
        motion: On the axis.
        yaw_steps: Sizes of the steps of theta_0, (L,) [rad].
        start: Index in the front of the position where it begins.
        end: Index of the end where it leads to.
    """

    travel: float
    motion: _Motion
    yaw_steps: FloatArray
    start: int
    end: int

    def q(self, shape: ArmShape) -> FloatArray:
        """Joint positions at the points and at the end, (L, 4) [rad]."""
        start_yaw = self.motion.start_yaw
        end_yaw = self.motion.end_yaw
        turned = np.append(0.0, np.cumsum(self.yaw_steps))
        theta_0 = start_yaw + np.copysign(turned, end_yaw - start_yaw)
        theta_0[-1] = end_yaw
        # Rounding may have passed a limit.
        theta_0 = np.clip(theta_0, shape.lower[0], shape.upper[0])
        return np.column_stack([theta_0, self.motion.joints])[1:]


def along_axis(points: PathPoints, first: int, stop: int, front: Front) -> Ways:
    """Ways from a front through the points on the axis to the next point off it.

    Args:
        points: Of the path.
        first, stop: The points first to stop - 1 lie on the axis. Point stop lies off
            it, or the path ends before it.
        front: Where the arm may be before point first.

    Returns:
        Ways through the points first to stop, or to stop - 1 if the path ends there.

    Raises:
        DiscontinuousPathError: No continuous motion leads there.
    """
    first_yaw_step = _steps_into_limits(front.q[:, 0], points.shape)
    elbows = _elbow_ways(points, range(first, stop), front, first_yaw_step)

    path_goes_on = stop < points.number
    ends = points.options(stop) if path_goes_on else np.full((1, 4), np.nan)
    crossings = list(_crossings(points, elbows, ends, front, first_yaw_step))
    if not crossings:
        raise points.jump(stop, _least_needed_step(points, elbows, ends, front))
    crossings = _best_free(points, first, front, crossings)

    q = np.array([crossing.q(points.shape) for crossing in crossings])
    return Ways(
        first=first,
        q=q if path_goes_on else q[:, :-1],
        travel=np.array([crossing.travel for crossing in crossings]),
        origin=np.array([crossing.start for crossing in crossings]),
    )


def _steps_into_limits(yaw: FloatArray, shape: ArmShape) -> FloatArray:
    """How far each theta_0 (S,) is beyond its limits, 0 if it is free (NaN) [rad].

    The first step must bring it back.
    """
    within = np.clip(yaw, shape.lower[0], shape.upper[0])
    return np.nan_to_num(np.abs(within - yaw))


def _crossings(
    points: PathPoints,
    elbows: _ElbowWays,
    ends: FloatArray,
    front: Front,
    first_yaw_step: FloatArray,
) -> Iterator[_Crossing]:
    """Every crossing to ends (E, 4) that a joint's largest step allows."""
    for start, j, motion in _motions(points, elbows, ends, front):
        if motion.needed_step <= points.max_step:
            yield _crossing(points, front, start, j, motion, first_yaw_step[start])


def _best_free(
    points: PathPoints, first: int, front: Front, crossings: list[_Crossing]
) -> list[_Crossing]:
    """The crossing of least travel to each end, of those that are free of collision.

    Joints 1 to 3 of a crossing are those of least travel, whether they collide or not.

    Raises:
        SelfCollisionError: All crossings collide.
    """
    best: dict[int, _Crossing] = {}
    collisions = []
    for crossing in sorted(crossings, key=lambda crossing: crossing.travel):
        if crossing.end in best:
            continue
        collision = _collision(points, first, front, crossing)
        if collision is None:
            best[crossing.end] = crossing
        else:
            collisions.append(collision)
    if not best:
        raise collisions[0]
    return list(best.values())


def _collision(
    points: PathPoints, first: int, front: Front, crossing: _Crossing
) -> SelfCollisionError | None:
    """The error of the first step of a crossing that collides; None if none does."""
    q = crossing.q(points.shape)
    q = q[~np.isnan(q).any(axis=1)]  # the path may end on the axis
    before = np.vstack([front.q[crossing.start], q[:-1]])
    free = points.are_free(before, q)
    if free.all():
        return None
    step = int(free.argmin())
    return points.collision(first + step, before[step], q[step])


def _least_needed_step(
    points: PathPoints, elbows: _ElbowWays, ends: FloatArray, front: Front
) -> float:
    """The smallest ``max_step`` [rad] with which some motion leads to an end."""
    motions = _motions(points, elbows, ends, front)
    return min((motion.needed_step for _, _, motion in motions), default=math.inf)


def _motions(
    points: PathPoints, elbows: _ElbowWays, ends: FloatArray, front: Front
) -> Iterator[tuple[int, int, _Motion]]:
    """Every motion from a start along the axis to an end (E, 4).

    Yields:
        Index of the start in the front, index of the end, and the motion.
    """
    for start, option in np.argwhere(np.isfinite(elbows.travel)).tolist():
        way = elbows.ending_at(start, option)
        for j, end in enumerate(ends):
            yield start, j, _motion(points, way, front.q[start, 0], end)


def _crossing(
    points: PathPoints,
    front: Front,
    start: int,
    end: int,
    motion: _Motion,
    first_yaw_step: float,
) -> _Crossing:
    """A motion from a start of the front to an end, with the best steps of theta_0."""
    turn = abs(motion.end_yaw - motion.start_yaw)
    yaw_steps = shared_turn(motion.sizes, turn, first_yaw_step, points.max_step)
    travel_on_axis = np.sqrt(motion.sizes**2 + yaw_steps**2).sum()
    return _Crossing(
        travel=float(front.travel[start] + travel_on_axis),
        motion=motion,
        yaw_steps=yaw_steps,
        start=start,
        end=end,
    )


def _elbow_ways(
    points: PathPoints, stretch: range, front: Front, first_yaw_step: FloatArray
) -> _ElbowWays:
    """Ways of least travel of joints 1 to 3, point by point.

    Args:
        points: Of the path.
        stretch: Numbers of the points on the axis.
        front: Where the arm may be before.
        first_yaw_step: Least first step of theta_0 from each start, (S,) [rad].

    Raises:
        DiscontinuousPathError: A point that no continuous motion reaches.
    """
    positions = [front.q[:, 1:]]
    parents = []
    travel = np.where(np.eye(len(front.q)), 0.0, np.inf)
    for k in stretch:
        # On the axis the underarm and the overarm branch are one solution, and
        # `BRANCHES` lists them side by side: every second option is a repetition.
        options = points.options_at_any_yaw(k)[::2, 1:]
        size, largest = step_sizes(options - positions[-1][:, None])
        if k == stretch.start:
            largest = np.maximum(largest, first_yaw_step[:, None])
        step = np.where(largest <= points.max_step, size, np.inf)
        ways = travel[:, :, None] + step
        reached = np.isfinite(travel).any(axis=0)

        positions.append(options)
        parents.append(ways.argmin(axis=1))
        travel = ways.min(axis=1)
        if not np.isfinite(travel).any():
            raise points.jump(k, float(largest[reached].min()))
    return _ElbowWays(positions=positions, parents=parents, travel=travel)


def _motion(
    points: PathPoints, way: list[FloatArray], yaw: float, end: FloatArray
) -> _Motion:
    """The motion along a way on the axis to an end.

    Args:
        points: Of the path.
        way: Joints 1 to 3 at the start and at the points.
        yaw: theta_0 at the start [rad]; NaN if it is free.
        end: Joint position after the axis, (4,) [rad]; NaN if the path ends on it.
    """
    shape = points.shape
    joints = np.array([*way, end[1:]])
    sizes, largest = step_sizes(np.diff(joints, axis=0))

    # theta_0 does not turn if it is known at one end of the stretch only.
    known = [angle for angle in (yaw, end[0]) if not np.isnan(angle)]
    start_yaw = known[0] if known else shape.middle[0]
    stays = np.clip(start_yaw, shape.lower[0], shape.upper[0])
    end_yaw = stays if np.isnan(end[0]) else end[0]

    # The last step of joints 1 to 3 was not checked yet. theta_0 must turn in that step
    # what the other steps, even the largest allowed, leave of its turn.
    yaw_of_last_step = abs(end_yaw - start_yaw) - points.max_step * (len(sizes) - 1)
    return _Motion(
        joints=joints,
        sizes=sizes,
        start_yaw=start_yaw,
        end_yaw=end_yaw,
        needed_step=max(float(largest[-1]), yaw_of_last_step),
    )


def shared_turn(
    sizes: FloatArray, turn: float, least_first: float, most: float
) -> FloatArray:
    """Steps of theta_0 that add up to a turn, for the least joint travel.

    The travel is the sum of ``sqrt(size^2 + step^2)``.

    Args:
        sizes: Of the steps of the other joints, (N,) [rad].
        turn: At most N times ``most`` [rad].
        least_first: The first step is at least this [rad].
        most: No step is larger [rad].

    Returns:
        (N,) [rad].
    """
    steps = np.zeros(len(sizes))
    left = turn
    largest_first = np.argsort(-sizes, kind="stable")
    for done, k in enumerate(largest_first):
        rest = largest_first[done:]
        share = _shares(sizes[rest])
        if left * share[0] <= most:
            steps[rest] = left * share
            break
        steps[k] = most
        left -= most

    if steps[0] < least_first:
        others = shared_turn(sizes[1:], turn - least_first, 0.0, most)
        steps = np.append(least_first, others)
    return steps


def _shares(sizes: FloatArray) -> FloatArray:
    """Each size as a share of their sum, (N,); equal shares if all sizes are 0."""
    total = sizes.sum()
    if total > 0.0:
        return np.asarray(sizes / total)
    return np.full(len(sizes), 1 / len(sizes))
