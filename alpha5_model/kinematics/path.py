"""Joint positions along a path of points, without a jump and of least joint travel.

Each point has up to four solutions within the limits, and the path goes through one of
each (`alpha5_model.kinematics.path_search`). The ranges of all joints are shorter than
a turn, so each solution has one place in its range. A step across the closed wedge of
theta_0, or onto another branch away from where the branches meet, is a jump and is not
taken. On the yaw axis theta_0 is free (`alpha5_model.kinematics.axis_crossing`).
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.catalogue_arm import kinematics_of
from alpha5_model.kinematics.path_search import MAX_STEP
from alpha5_model.numbers.parameters import Alpha5Parameters

__all__ = ["MAX_STEP", "inverse_kinematics_path"]


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
    turn of theta_0 and still lets the elbow change on the axis, the elbow is chosen by
    the travel of the other joints alone. And if that way along the axis collides, no
    other way of the elbow is tried.

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
    of_arm = kinematics_of(arm)
    return of_arm.inverse_kinematics_path(
        positions, q_start, wrist, max_step, allow_collision
    )
