"""Following a path of points without a jump: the least joint travel through branches and limits.

Each point has up to four solutions within the limits. The path of least joint travel through them is
found by dynamic programming [Bellman1957], as for redundant arms [Guigue2007]. The ranges of all joints
are shorter than a turn, so each solution has one place in its range; a step across the closed wedge of
theta_0, or onto another branch away from where the branches meet, is a jump and is not taken.

References:
    [Bellman1957] Dynamic Programming, Princeton University Press.
    [Guigue2007] Guigue, Ahmadi, Hayes, Langlois, Tang: A dynamic programming approach to redundancy
        resolution with multiple criteria, ICRA 2007.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array, real
from alpha5_model.errors import DiscontinuousPathError, InputError, ShapeError
from alpha5_model.kinematics.arm_plane import arm_plane
from alpha5_model.kinematics.ik import Solutions, inverse_kinematics
from alpha5_model.kinematics.ik_choice import on_axis, require_solution

#: Largest step of a joint from one point to the next that counts as continuous [rad].
MAX_STEP = 0.5


def inverse_kinematics_path(
    positions: ArrayLike,
    q_start: ArrayLike | None = None,
    wrist: ArrayLike | None = None,
    max_step: float = MAX_STEP,
) -> FloatArray:
    """Joint positions along a path of points, continuous and within the limits.

    The sum of the Euclidean joint steps is the least possible. Where the tcp is on the yaw axis,
    theta_0 is chosen among its values at the neighbouring points.

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
    start = None
    if q_start is not None:
        start = float_array("q_start", q_start, (4,))
        if start.shape != (4,):
            raise ShapeError("q_start", start.shape, "shape (4,)")
    max_step = real("max_step", max_step, minimum=0.0, strict=True)
    angle = float_array(
        "wrist", (0.0 if start is None else start[3]) if wrist is None else wrist, ()
    )
    if angle.shape not in ((), (len(target),)):
        raise InputError("wrist", angle.shape, f"shape () or ({len(target)},)")
    solutions = inverse_kinematics(target, angle)
    free = on_axis(target)

    nodes: list[FloatArray] = []
    parents: list[np.ndarray] = []
    at = np.zeros((1, 4)) if start is None else start[None]
    travel = np.zeros(1)
    for k in range(len(target)):
        options = _options(solutions, free, k, start)
        if not len(options):
            _explain(solutions, k)
        step = options[:, None, :] - at
        largest = np.abs(step).max(axis=-1)
        if k == 0 and start is None:
            largest[...] = 0.0
            step[...] = 0.0
        cost = np.where(largest <= max_step, travel + np.sqrt(np.square(step).sum(-1)), np.inf)
        parent = cost.argmin(axis=1)
        cost = cost[np.arange(len(options)), parent]
        kept = np.isfinite(cost)
        if not kept.any():
            raise DiscontinuousPathError(k, target[k], float(largest.min()), max_step)
        at, travel = options[kept], cost[kept]
        nodes.append(at)
        parents.append(parent[kept])
    out = np.empty((len(target), 4))
    index = int(travel.argmin()) if len(target) else 0
    for k in reversed(range(len(target))):
        out[k] = nodes[k][index]
        index = int(parents[k][index])
    return out


def _options(
    solutions: Solutions, free: np.ndarray, k: int, start: FloatArray | None
) -> FloatArray:
    """Solutions of point k within the limits, (M, 4); on the yaw axis with each theta_0 worth trying."""
    options: FloatArray = solutions.q[k][solutions.within_limits[k]]
    if not free[k] or not len(options):
        return options
    g = arm_plane()
    off_axis = np.flatnonzero(~free)
    before, after = off_axis[off_axis < k][-1:], off_axis[off_axis > k][:1]
    values = [np.array([g.middle[0]])]
    if start is not None:
        values.append(np.clip(start[:1], g.lower[0], g.upper[0]))
    for row in (*before, *after):
        values.append(solutions.q[row][solutions.within_limits[row], 0])
    theta_0 = np.unique(np.concatenate(values))
    spread = np.repeat(options, len(theta_0), axis=0)
    spread[:, 0] = np.tile(theta_0, len(options))
    return spread


def _explain(solutions: Solutions, k: int) -> None:
    """Raise for point k, the first without a solution."""
    q, exists, within, singular, position = solutions
    end = slice(k + 1)
    require_solution(Solutions(q[end], exists[end], within[end], singular[end], position[end]))
