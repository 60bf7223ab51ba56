"""Ways along the yaw axis, where theta_0 is free.

Between two points off the axis, steps s_k of the other joints and d_k of theta_0 cost
``sum sqrt(s_k^2 + d_k^2)``. The d_k add up to what lies between the two, so by
Minkowski's inequality the sum is least if they are in proportion to the s_k: the way is
straight when s and theta_0 are drawn against each other. A d_k that would pass the
largest step is that step.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.path_points import Front, PathPoints, Ways, step_sizes
from alpha5_model.kinematics.plane import ArmPlane


class _ElbowWays(NamedTuple):
    """Ways of joints 1 to 3 from S starts through points on the axis.

    Attributes:
        positions: Joints 1 to 3 at the start and at each point, (E, 3) each [rad].
        parents: At each point, from each start, the position before each position,
            (S, E) each.
        travel: From each start to each last position, (S, E) [rad]; infinite if no
            continuous motion leads there.
    """

    positions: list[FloatArray]
    parents: list[NDArray[np.intp]]
    travel: FloatArray

    def ending_at(self, start: int, last: int) -> list[FloatArray]:
        """The way from a start to a last position, (3,) each."""
        chosen = [last]
        for parent in reversed(self.parents):
            chosen.append(int(parent[start, chosen[-1]]))
        chosen.reverse()
        return [rows[i] for rows, i in zip(self.positions, chosen, strict=True)]


class _Motion(NamedTuple):
    """A way of joints 1 to 3, and how far theta_0 turns on it.

    Attributes:
        joints: Joints 1 to 3 from the start to the end, (L + 1, 3) [rad].
        size: Euclidean norms of their steps, (L,) [rad].
        first, last: theta_0 at both ends [rad].
        needed: The largest step that the motion needs [rad].
    """

    joints: FloatArray
    size: FloatArray
    first: float
    last: float
    needed: float


class _Crossing(NamedTuple):
    """The best way found to an end.

    Attributes:
        travel: Since the start of the path [rad].
        motion: What it does on the axis.
        yaw_steps: The steps of theta_0, (L,) [rad].
        start: Where in the front it begins.
    """

    travel: float
    motion: _Motion
    yaw_steps: FloatArray
    start: int

    def q(self, plane: ArmPlane) -> FloatArray:
        """Joint positions at the points and at the end, (L, 4) [rad]."""
        first = self.motion.first
        last = self.motion.last
        turned = np.append(0.0, np.cumsum(self.yaw_steps))
        theta_0 = first + np.copysign(turned, last - first)
        theta_0[-1] = last
        # Rounding may have passed a limit.
        theta_0 = np.clip(theta_0, plane.lower[0], plane.upper[0])
        return np.column_stack([theta_0, self.motion.joints])[1:]


def along_axis(points: PathPoints, first: int, stop: int, front: Front) -> Ways:
    """From a front through points first to stop - 1 on the axis, to point stop.

    Raises:
        DiscontinuousPathError: No continuous motion leads there.
    """
    plane = points.plane
    # A start beyond the limits of theta_0 is back within them with the first step.
    yaw = front.q[:, 0]
    gap = np.nan_to_num(np.abs(np.clip(yaw, plane.lower[0], plane.upper[0]) - yaw))
    elbows = _elbow_ways(points, range(first, stop), front, gap)

    leaves = stop < points.number  # else the path ends on the axis
    ends = points.options(stop) if leaves else np.full((1, 4), np.nan)
    crossings: dict[int, _Crossing] = {}
    least = math.inf
    for start, elbow in np.argwhere(np.isfinite(elbows.travel)).tolist():
        way = elbows.ending_at(start, elbow)
        for j, end in enumerate(ends):
            motion = _motion(points, way, yaw[start], end)
            least = min(least, motion.needed)
            if motion.needed > points.max_step:
                continue
            crossing = _crossing(points, front, start, motion, gap[start])
            if j not in crossings or crossing.travel < crossings[j].travel:
                crossings[j] = crossing
    if not crossings:
        raise points.jump(stop, least)

    found = list(crossings.values())
    q = np.array([crossing.q(plane) for crossing in found])
    return Ways(
        first=first,
        q=q if leaves else q[:, :-1],
        travel=np.array([crossing.travel for crossing in found]),
        origin=np.array([crossing.start for crossing in found]),
    )


def _crossing(
    points: PathPoints, front: Front, start: int, motion: _Motion, gap: float
) -> _Crossing:
    """A motion from a start of the front, with the best steps of theta_0."""
    turn = abs(motion.last - motion.first)
    yaw_steps = shared_turn(motion.size, turn, gap, points.max_step)
    travel_on_axis = np.sqrt(motion.size**2 + yaw_steps**2).sum()
    return _Crossing(
        travel=float(front.travel[start] + travel_on_axis),
        motion=motion,
        yaw_steps=yaw_steps,
        start=start,
    )


def _elbow_ways(
    points: PathPoints, stretch: range, front: Front, gap: FloatArray
) -> _ElbowWays:
    """Least travel of joints 1 to 3, point by point.

    Args:
        points: Of the path.
        stretch: Numbers of the points on the axis.
        front: Where the arm may be before.
        gap: Least first step of theta_0 from each start, (S,) [rad].
    """
    positions = [front.q[:, 1:]]
    parents = []
    travel = np.where(np.eye(len(front.q)), 0.0, np.inf)
    for k in stretch:
        # Facing a target on the axis and turning the back to it are the same.
        options = points.options(k)[::2, 1:]
        size, largest = step_sizes(options - positions[-1][:, None])
        if k == stretch.start:
            largest = np.maximum(largest, gap[:, None])
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
    """The motion along a way on the axis to an end (4,), NaN if the path has no more.

    Args:
        points: Of the path.
        way: Joints 1 to 3 at the start and at the points.
        yaw: theta_0 at the start [rad]; NaN if it is free.
        end: Joint position after the axis.
    """
    plane = points.plane
    joints = np.array([*way, end[1:]])
    size, largest = step_sizes(np.diff(joints, axis=0))

    known = [angle for angle in (yaw, end[0]) if not np.isnan(angle)]
    first = known[0] if known else plane.middle[0]
    stays = np.clip(first, plane.lower[0], plane.upper[0])
    last = stays if np.isnan(end[0]) else end[0]
    turn_of_last_step = abs(last - first) - points.max_step * (len(size) - 1)
    return _Motion(
        joints=joints,
        size=size,
        first=first,
        last=last,
        needed=max(float(largest[-1]), turn_of_last_step),
    )


def shared_turn(size: FloatArray, turn: float, first: float, most: float) -> FloatArray:
    """Steps of theta_0 that add up to a turn, for the least joint travel.

    That is the sum of ``sqrt(size^2 + step^2)``.

    Args:
        size: Steps of the other joints, (N,) [rad].
        turn: At most N times ``most`` [rad].
        first: The first step is at least this [rad].
        most: No step is larger [rad].

    Returns:
        (N,) [rad].
    """
    step = np.zeros(len(size))
    left = turn
    largest_first = np.argsort(-size)
    for done, k in enumerate(largest_first):
        rest = largest_first[done:]
        share = _shares(size[rest])
        if left * share[0] <= most:
            step[rest] = left * share
            break
        step[k] = most
        left -= most

    if step[0] < first:
        others = shared_turn(size[1:], turn - first, 0.0, most)
        step = np.append(first, others)
    return step


def _shares(size: FloatArray) -> FloatArray:
    """The part of each size in their sum, equal parts of nothing, (N,)."""
    total = size.sum()
    if total > 0.0:
        return np.asarray(size / total)
    return np.full(len(size), 1 / len(size))
