"""The path of least joint travel through the solutions of a sequence of points.

It is found by dynamic programming [Bellman1957], as for redundant arms [Guigue2007]:
only the way of least travel to each solution of a point is kept.

References:
    [Bellman1957] Dynamic Programming, Princeton University Press.
    [Guigue2007] Guigue, Ahmadi, Hayes, Langlois, Tang: A dynamic programming approach
        to redundancy resolution with multiple criteria, ICRA 2007.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, real, shaped
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.axis_crossing import along_axis
from alpha5_model.kinematics.colliding import collides
from alpha5_model.kinematics.path_points import Front, PathPoints, Ways, step_sizes
from alpha5_model.kinematics.plane import on_axis
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.kinematics.solver import solve
from alpha5_model.numbers.parameters import JointParameters

#: Largest step of a joint from one point to the next that counts as continuous [rad].
MAX_STEP = 0.5


def solve_path(
    shape: ArmShape,
    wrist_joint: JointParameters,
    scene: SelfCollision | None,
    positions: ArrayLike,
    q_start: ArrayLike | None,
    wrist: ArrayLike | None,
    max_step: float,
) -> FloatArray:
    """Joint positions along points (N, 3), continuous and within the limits, (N, 4).

    They are free of self-collision, and so are the straight lines between them, if
    there is a scene.
    """
    target = float_array("positions", positions, (3,))
    if target.ndim != 2:
        raise ShapeError("positions", target.shape, "shape (N, 3)")
    start = np.full(4, np.nan) if q_start is None else shaped("q_start", q_start, (4,))
    max_step = real("max_step", max_step, minimum=0.0, strict=True)
    theta_3 = np.nan_to_num(start[3]) if wrist is None else wrist
    angle = float_array("wrist", theta_3, ())
    if angle.shape not in ((), (len(target),)):
        raise InputError("wrist", angle.shape, f"shape () or ({len(target)},)")

    solutions = solve(SolutionArrays, target, angle, shape)
    no_hits = np.zeros(solutions.exists.shape, np.bool_)
    points = PathPoints(
        solutions=solutions,
        hits=no_hits if scene is None else collides(solutions, scene),
        max_step=max_step,
        shape=shape,
        wrist=wrist_joint,
        scene=scene,
    )
    return _least_travel(_stages(points, start), len(target))


def _stages(points: PathPoints, start: FloatArray) -> list[Ways]:
    """The ways of least travel, in stages: one point, or a stretch on the yaw axis."""
    is_on_axis = on_axis(points.solutions.position)
    # Numbers of the points off the axis, and of the end of the path.
    off_axis = np.append(np.flatnonzero(~is_on_axis), points.number)

    stages: list[Ways] = []
    front = Front(q=start[None], travel=np.zeros(1))
    k = 0
    while k < points.number:
        stop = int(off_axis[np.searchsorted(off_axis, k)])
        if stop == k:
            ways = _step(points, k, front)
        else:
            ways = along_axis(points, k, stop, front)
        stages.append(ways)
        front = ways.front
        k = ways.stop
    return stages


def _step(points: PathPoints, k: int, front: Front) -> Ways:
    """Ways of least travel from a front to each solution of point k."""
    options = points.options(k)
    size, largest = step_sizes(options[:, None, :] - front.q)
    steps = np.argwhere(largest <= points.max_step)
    if not len(steps):
        raise points.jump(k, float(largest.min()))

    to, at = steps.T
    free = points.are_free(front.q[at], options[to])
    if not free.any():
        raise points.collision(k, front.q[at[0]], options[to[0]])

    travel = np.full(size.shape, np.inf)
    travel[to[free], at[free]] = (front.travel + size)[to[free], at[free]]
    origin = travel.argmin(axis=1)
    least = travel[np.arange(len(options)), origin]
    kept = np.isfinite(least)
    return Ways(
        first=k, q=options[kept][:, None], travel=least[kept], origin=origin[kept]
    )


def _least_travel(stages: list[Ways], count: int) -> FloatArray:
    """Joint positions at all points, (count, 4), traced back from the best end."""
    q = np.empty((count, 4))
    if not stages:
        return q
    chosen = int(stages[-1].travel.argmin())
    for ways in reversed(stages):
        q[ways.first : ways.stop] = ways.q[chosen]
        chosen = int(ways.origin[chosen])
    return q
