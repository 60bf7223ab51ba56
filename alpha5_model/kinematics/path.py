"""Following a path of points without a jump: the least joint travel through branches and limits.

Each point has up to four solutions within the limits. The path of least joint travel through them
is found by dynamic programming [Bellman1957], as for redundant arms [Guigue2007]. The ranges of all
joints are shorter than a turn, so each solution has one place in its range; a step across the
closed wedge of theta_0, or onto another branch away from where the branches meet, is a jump and is
not taken.

On the yaw axis theta_0 is free. Between two points off the axis, steps s_k of the other joints and
d_k of theta_0 cost ``sum sqrt(s_k^2 + d_k^2)``. The d_k add up to what lies between the two, so by
Minkowski's inequality the sum is least where they are in proportion to the s_k: the way is straight
when s and theta_0 are drawn against each other. A d_k that would pass the largest step is that
step.

References:
    [Bellman1957] Dynamic Programming, Princeton University Press.
    [Guigue2007] Guigue, Ahmadi, Hayes, Langlois, Tang: A dynamic programming approach to redundancy
        resolution with multiple criteria, ICRA 2007.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray, float_array, real, shaped
from alpha5_model.errors import DiscontinuousPathError, InputError, ShapeError
from alpha5_model.kinematics.ik import Solutions, inverse_kinematics, require_solution
from alpha5_model.kinematics.plane import arm_plane, on_axis

#: Largest step of a joint from one point to the next that counts as continuous [rad].
MAX_STEP = 0.5

#: Ways to the solutions of a point: rows (M, L, 4), travel so far (M,), where each comes from (M,).
_Ways = tuple[FloatArray, FloatArray, NDArray[np.intp]]


def inverse_kinematics_path(
    positions: ArrayLike,
    q_start: ArrayLike | None = None,
    wrist: ArrayLike | None = None,
    max_step: float = MAX_STEP,
) -> FloatArray:
    """Joint positions along a path of points, continuous and within the limits.

    The sum of the Euclidean joint steps is the least possible. On the yaw axis theta_0 turns from
    its value before to its value after, together with the other joints where they move; with
    neither before nor after it is the middle of its range. Only where ``max_step`` holds theta_0
    back and is also wide enough to change the elbow on the axis, the elbow is chosen by the travel
    of the other joints alone.

    Args:
        positions: tcp in ``base_link``, (N, 3) [m].
        q_start: Where the arm is before the first point, (4,) [rad]; None lets the path start on
            any branch.
        wrist: theta_3, () or (N,) [rad]; None keeps the one of ``q_start``, or 0.
        max_step: No joint moves farther than this between two points (and from ``q_start`` to the
            first one) [rad]. A path that needs more is sampled too coarsely, or jumps.

    Returns:
        (N, 4) [rad].

    Raises:
        DiscontinuousPathError: Names the first point that no continuous motion reaches.
        UnreachableError: A point out of reach, reached before any such jump.
        JointLimitError: A wrist angle beyond its limits.
        InputError: Bad input.
    """
    target = float_array("positions", positions, (3,))
    if target.ndim != 2:
        raise ShapeError("positions", target.shape, "shape (N, 3)")
    start = np.full(4, np.nan) if q_start is None else shaped("q_start", q_start, (4,))
    max_step = real("max_step", max_step, minimum=0.0, strict=True)
    angle = float_array(
        "wrist", np.nan_to_num(start[3]) if wrist is None else wrist, ()
    )
    if angle.shape not in ((), (len(target),)):
        raise InputError("wrist", angle.shape, f"shape () or ({len(target)},)")
    solutions = inverse_kinematics(target, angle)
    off_axis = np.append(np.flatnonzero(~on_axis(target)), len(target))

    at, travel = (
        start[None],
        np.zeros(1),
    )  # where the path may be, NaN before a free start
    stages: list[tuple[int, FloatArray, NDArray[np.intp]]] = []
    k = 0
    while k < len(target):
        stop = int(off_axis[np.searchsorted(off_axis, k)])
        if stop == k:
            rows, travel, parent = _step(solutions, k, at, travel, max_step)
        else:
            rows, travel, parent = _along_axis(solutions, k, stop, at, travel, max_step)
        stages.append((k, rows, parent))
        at, k = rows[:, -1], k + rows.shape[1]
    out = np.empty((len(target), 4))
    index = int(travel.argmin()) if stages else 0
    for k, rows, parent in reversed(stages):
        out[k : k + rows.shape[1]] = rows[index]
        index = int(parent[index])
    return out


def _step(
    found: Solutions, k: int, at: FloatArray, travel: FloatArray, max_step: float
) -> _Ways:
    """From joint positions (M, 4) to the solutions of point k; travel so far (M,)."""
    options = _options(found, k)
    size, largest = _sizes(options[:, None, :] - at)
    cost = np.where(largest <= max_step, travel + size, np.inf)
    parent = cost.argmin(axis=1)
    cost = cost[np.arange(len(options)), parent]
    kept = np.isfinite(cost)
    if not kept.any():
        raise DiscontinuousPathError(
            k, found.position[k], float(largest.min()), max_step
        )
    return options[kept][:, None], cost[kept], parent[kept]


def _along_axis(
    solutions: Solutions,
    k: int,
    stop: int,
    starts: FloatArray,
    travel: FloatArray,
    max_step: float,
) -> _Ways:
    """The same along the axis, points k to stop - 1, to the solutions of point stop."""
    g = arm_plane()
    # A start beyond the limits of theta_0 is back within them with the first step.
    inside = np.clip(starts[:, 0], g.lower[0], g.upper[0])
    gap = np.nan_to_num(np.abs(inside - starts[:, 0]))

    # Point by point, least travel of the other joints from each start to each elbow, (S, E).
    elbows, parents = [starts[:, 1:]], []
    length = np.where(np.eye(len(starts)), 0.0, np.inf)
    for i in range(k, stop):
        elbows.append(
            _options(solutions, i)[::2, 1:]
        )  # facing and turning its back are the same
        size, largest = _sizes(elbows[-1] - elbows[-2][:, None])
        if i == k:
            largest = np.maximum(largest, gap[:, None])
        ways = length[:, :, None] + np.where(largest <= max_step, size, np.inf)
        parents.append(ways.argmin(axis=1))
        reachable = np.isfinite(length).any(axis=0)
        length = ways.min(axis=1)
        if not np.isfinite(length).any():
            needed = float(largest[reachable].min())
            raise DiscontinuousPathError(i, solutions.position[i], needed, max_step)

    leaves = stop < len(solutions.position)
    ends = _options(solutions, stop) if leaves else np.full((1, 4), np.nan)
    found: dict[int, tuple[float, FloatArray, int]] = {}
    least = np.inf
    for start, elbow in np.argwhere(np.isfinite(length)).tolist():
        chosen = [elbow]
        for parent in reversed(parents):
            chosen.append(int(parent[start, chosen[-1]]))
        way = [rows[i] for rows, i in zip(elbows, reversed(chosen), strict=True)]
        for j, end in enumerate(ends):
            joints = np.array([*way, end[1:]])
            size, largest = _sizes(np.diff(joints, axis=0))
            first = next(
                a for a in (starts[start, 0], end[0], g.middle[0]) if not np.isnan(a)
            )
            last = end[0] if leaves else np.clip(first, g.lower[0], g.upper[0])
            turn = abs(last - first)
            needed = max(float(largest[-1]), turn - max_step * (len(size) - 1))
            least = min(least, needed)
            if needed > max_step:
                continue
            step = shared_turn(size, turn, gap[start], max_step)
            cost = float(travel[start] + np.sqrt(size**2 + step**2).sum())
            if j not in found or cost < found[j][0]:
                theta_0 = first + np.copysign(
                    np.append(0.0, np.cumsum(step)), last - first
                )
                theta_0[-1] = last
                theta_0 = np.clip(theta_0, g.lower[0], g.upper[0])  # rounding
                rows = np.column_stack([theta_0, joints])[1:]
                found[j] = cost, rows[: stop - k + leaves], start
    if not found:
        raise DiscontinuousPathError(stop, solutions.position[stop], least, max_step)
    costs, ways_found, origins = zip(*found.values(), strict=True)
    return np.array(ways_found), np.array(costs), np.array(origins)


def shared_turn(size: FloatArray, turn: float, first: float, most: float) -> FloatArray:
    """Steps of theta_0 that add up to a turn, for the least ``sum sqrt(size^2 + step^2)``.

    Args:
        size: Steps of the other joints, (N,) [rad].
        turn: At most N times ``most`` [rad].
        first: The first step is at least this [rad].
        most: No step is larger [rad].

    Returns:
        (N,) [rad].
    """
    step = np.zeros(len(size))
    left, order = turn, np.argsort(-size)
    for done, k in enumerate(order):
        rest = order[done:]
        total = size[rest].sum()
        share = size[rest] / total if total > 0.0 else np.full(len(rest), 1 / len(rest))
        if left * share[0] <= most:
            step[rest] = left * share
            break
        step[k] = most
        left -= most
    if step[0] < first:
        step = np.append(first, shared_turn(size[1:], turn - first, 0.0, most))
    return step


def _sizes(step: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Euclidean norm and largest joint of steps (..., J), (...) each; 0 where there is no step."""
    with np.errstate(over="ignore"):
        norm = np.sqrt(np.square(step).sum(axis=-1))
    return np.nan_to_num(norm, posinf=np.inf), np.nan_to_num(np.abs(step).max(axis=-1))


def _options(solutions: Solutions, k: int) -> FloatArray:
    """Solutions of point k within the limits, (M, 4).

    Raises:
        UnreachableError, JointLimitError: There is none.
    """
    options: FloatArray = solutions.q[k][solutions.within_limits[k]]
    if not len(options):
        end = slice(k + 1)
        require_solution(
            solutions.q[end], solutions.within_limits[end], solutions.position[end]
        )
    return options
